//! One build with all mutants that compile.

use crate::list::Mutant;
use crate::rewrite::{Rewritten, rewrite};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Builds without new errors, at most. Each finds the errors of one phase of the compiler.
const ROUNDS: usize = 40;

/// End of the names of packages of which only unit tests are run.
const LIB: &str = ":lib";

/// A copy of the sources that is rewritten.
#[derive(Debug)]
pub struct Tree<'a> {
    root: &'a Path,
    target: &'a Path,
    mutants: &'a [Mutant],
    originals: BTreeMap<String, String>,
    /// Mutants that do not compile.
    pub unviable: BTreeSet<u32>,
    /// Mutants that the rewritten sources have.
    pub built: BTreeSet<u32>,
}

impl<'a> Tree<'a> {
    /// Tree with these mutants, whose numbers are their places in the list.
    ///
    /// # Errors
    ///
    /// A source file cannot be read.
    pub fn new(root: &'a Path, target: &'a Path, mutants: &'a [Mutant]) -> io::Result<Self> {
        let files: BTreeSet<&String> = mutants.iter().map(|mutant| &mutant.file).collect();
        let read = |file: &String| Ok((file.clone(), fs::read_to_string(root.join(file))?));
        let originals = files.into_iter().map(read).collect::<io::Result<_>>()?;
        Ok(Self { root, target, mutants, originals, unviable: BTreeSet::new(), built: BTreeSet::new() })
    }

    /// Removes mutants until the sources compile, and returns the test programs of these packages.
    ///
    /// # Errors
    ///
    /// The sources do not compile for another reason.
    pub fn programs(&mut self, packages: &[String]) -> io::Result<Vec<Program>> {
        self.append_switches()?;
        for round in 0..ROUNDS {
            let rewritten = self.write()?;
            let (_, messages) = self.cargo(&["check", "--keep-going"], packages)?;
            let errors: Vec<Error> = messages.iter().flat_map(errors).collect();
            let wrong: BTreeSet<u32> = errors
                .iter()
                .filter_map(|error| Some(rewritten.get(&error.file)?.mutants_at(&error.bytes)))
                .flatten()
                .collect();
            eprintln!("build {round}: {} errors, {} mutants removed", errors.len(), wrong.len());
            if errors.is_empty() {
                let (is_built, messages) = self.cargo(&["test", "--no-run"], packages)?;
                let all = messages.iter().filter_map(program);
                let chosen: Vec<Program> = all.filter(|program| is_chosen(program, packages)).collect();
                // Without its tests, a mutant would count as missed.
                let problem = || io::Error::other("the tests of the copy do not compile, or none exist");
                return (is_built && !chosen.is_empty()).then_some(chosen).ok_or_else(problem);
            }
            if wrong.is_empty() {
                return Err(io::Error::other(format!("errors without a mutant: {:?}", errors[0])));
            }
            self.unviable.extend(wrong);
        }
        Err(io::Error::other("too many builds with errors"))
    }

    /// Writes all files with mutants.
    fn write(&mut self) -> io::Result<BTreeMap<String, Rewritten>> {
        let mut of_file: BTreeMap<&str, Vec<(u32, &Mutant)>> = BTreeMap::new();
        for (id, mutant) in (0..).zip(self.mutants).filter(|(id, _)| !self.unviable.contains(id)) {
            of_file.entry(&mutant.file).or_default().push((id, mutant));
        }
        let mut all = BTreeMap::new();
        self.built.clear();
        for (file, original) in &self.originals {
            let mutants = of_file.get(file.as_str()).map_or(&[][..], Vec::as_slice);
            let Some(mut rewritten) = rewrite(original, mutants) else { continue };
            self.built.extend(rewritten.wrappers.iter().flat_map(|(_, ids)| ids));
            if is_root(file) {
                rewritten.text += &switches(self.mutants.len());
            }
            write_if_new(&self.root.join(file), &rewritten.text)?;
            all.insert(file.clone(), rewritten);
        }
        Ok(all)
    }

    /// Appends the module that chooses a mutant to the root of each crate with mutants in other files.
    fn append_switches(&self) -> io::Result<()> {
        let roots: BTreeSet<String> = self.originals.keys().filter_map(|file| root_of(file)).collect();
        for root in roots.iter().filter(|root| !self.originals.contains_key(*root)) {
            let path = self.root.join(root);
            let text = fs::read_to_string(&path)?;
            write_if_new(&path, &(text + &switches(self.mutants.len())))?;
        }
        Ok(())
    }

    /// Runs cargo. Returns true if it succeeds, and its messages.
    fn cargo(&self, command: &[&str], packages: &[String]) -> io::Result<(bool, Vec<Value>)> {
        let output = Command::new("cargo")
            .args(command)
            .arg("--message-format=json")
            .args(packages.iter().flat_map(|package| ["-p", package.trim_end_matches(LIB)]))
            .current_dir(self.root)
            .env("CARGO_TARGET_DIR", self.target)
            .env("RUSTFLAGS", "--cap-lints=allow")
            .stderr(Stdio::null())
            .output()?;
        let lines = output.stdout.split(|b| *b == b'\n');
        Ok((output.status.success(), lines.filter_map(|line| serde_json::from_slice(line).ok()).collect()))
    }
}

fn write_if_new(path: &Path, text: &str) -> io::Result<()> {
    if fs::read_to_string(path).is_ok_and(|old| old == text) { Ok(()) } else { fs::write(path, text) }
}

fn is_root(file: &str) -> bool {
    file.ends_with("src/lib.rs") || file.ends_with("src/main.rs")
}

/// Root of the library that a file belongs to.
fn root_of(file: &str) -> Option<String> {
    let at = if file.starts_with("src/") { 0 } else { file.find("/src/")? + 1 };
    Some(format!("{}src/lib.rs", &file[..at]))
}

/// Module that chooses one of `count` mutants by the variable `MUTANT`. With `MUTANT=record`, the number of each mutant
/// that is reached is appended to the file `MUTANTS_REACHED`.
fn switches(count: usize) -> String {
    include_str!("switches.rs.in").replace("COUNT", &count.to_string())
}

/// Error of the compiler.
#[derive(Debug)]
struct Error {
    file: String,
    bytes: Range<usize>,
    #[expect(dead_code, reason = "shown if no mutant is at the place")]
    message: String,
}

fn errors(message: &Value) -> Vec<Error> {
    let inner = &message["message"];
    if message["reason"] != "compiler-message" || inner["level"] != "error" {
        return Vec::new();
    }
    let spans = inner["spans"].as_array().map_or(&[][..], Vec::as_slice);
    let error = |span: &Value| {
        let byte = |key: &str| span[key].as_u64().map(|n| n as usize);
        Some(Error {
            file: span["file_name"].as_str()?.to_owned(),
            bytes: byte("byte_start")?..byte("byte_end")?,
            message: inner["rendered"].as_str()?.to_owned(),
        })
    };
    spans.iter().filter(|span| span["is_primary"] == true).filter_map(error).collect()
}

/// A test program.
#[derive(Clone, Debug)]
pub struct Program {
    /// Path of the program.
    pub path: PathBuf,
    /// Folder of its package.
    pub folder: PathBuf,
    /// Name of its package.
    pub package: String,
    /// True for unit tests of the library.
    pub is_lib: bool,
}

fn is_chosen(program: &Program, packages: &[String]) -> bool {
    packages.contains(&program.package) || (program.is_lib && packages.contains(&format!("{}{LIB}", program.package)))
}

fn program(message: &Value) -> Option<Program> {
    if message["reason"] != "compiler-artifact" || message["profile"]["test"] != true {
        return None;
    }
    let manifest = Path::new(message["manifest_path"].as_str()?);
    let id = message["package_id"].as_str()?;
    let package = id.rsplit(['#', '/']).next()?.split('@').next()?;
    Some(Program {
        path: message["executable"].as_str()?.into(),
        folder: manifest.parent()?.into(),
        package: package.to_owned(),
        is_lib: message["target"]["kind"].as_array()?.iter().any(|kind| kind == "lib"),
    })
}

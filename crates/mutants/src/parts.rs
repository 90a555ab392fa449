//! Parts of the sources by name, and a copy of the tree.

use crate::list::Mutant;
use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::Path;
use std::process::Command;

/// Files and folders with a name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Part {
    /// Name in the report.
    pub name: String,
    /// Beginnings of the paths of its files.
    pub prefixes: Vec<String>,
}

impl Part {
    /// Part of the words `NAME=PREFIX,PREFIX`.
    pub fn parse(text: &str) -> Option<Self> {
        let (name, prefixes) = text.split_once('=')?;
        let prefixes: Vec<String> = prefixes.split(',').map(str::to_owned).collect();
        (!name.is_empty() && prefixes.iter().all(|prefix| !prefix.is_empty()))
            .then(|| Self { name: name.to_owned(), prefixes })
    }

    /// True if the mutant is in a file of this part.
    pub fn has(&self, mutant: &Mutant) -> bool {
        self.prefixes.iter().any(|prefix| mutant.file.starts_with(prefix.as_str()))
    }

    /// Every n-th mutant of the part, so that at most `limit` are left, and the number of all.
    pub fn sample(&self, mutants: &[Mutant], limit: usize) -> (Vec<usize>, usize) {
        let all: Vec<usize> = (0..mutants.len()).filter(|&i| self.has(&mutants[i])).collect();
        let step = all.len().div_ceil(limit.max(1)).max(1);
        (all.iter().copied().step_by(step).collect(), all.len())
    }
}

/// Copies the files that Git knows. Files that have not changed keep their time, so that they are not compiled again.
///
/// # Errors
///
/// Git cannot be run, or a file cannot be copied.
pub fn copy_tree(root: &Path, to: &Path) -> io::Result<()> {
    let output = Command::new("git").args(["ls-files", "-z"]).current_dir(root).output()?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let files: BTreeSet<&str> = text.split('\0').filter(|file| root.join(file).is_file()).collect();
    for file in files {
        let (from, to) = (root.join(file), to.join(file));
        if let Some(folder) = to.parent() {
            fs::create_dir_all(folder)?;
        }
        let bytes = fs::read(&from)?;
        if !fs::read(&to).is_ok_and(|old| old == bytes) {
            fs::copy(&from, &to)?;
        }
    }
    Ok(())
}

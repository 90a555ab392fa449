//! Modules import only from lower layers (ARCHITECTURE.md), and files have no import cycles. Between crates, Cargo
//! enforces the direction of dependencies.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Source folders of the packages, from the repository's root.
const PACKAGES: [&str; 11] = [
    "src",
    "crates/mesh/src",
    "crates/skeleton/src",
    "crates/network/src",
    "crates/flow/src",
    "crates/domain/src",
    "crates/tet/src",
    "crates/io/src",
    "crates/verify/src",
    "crates/trials/src",
    "crates/mutants/src",
];

/// Modules of the root package by layer. A module may import from layers with a smaller number, and from itself.
const LAYERS: [(&str, u32); 12] = [
    ("main", 7),
    ("cli", 6),
    ("report", 5),
    ("run", 4),
    ("pipeline", 3),
    ("woven", 2),
    ("picture", 2),
    ("view", 2),
    ("block", 1),
    ("surface", 0),
    ("fidelity", 0),
    ("partition", 0),
];

fn layer(module: &str) -> Option<u32> {
    LAYERS.iter().find(|(name, _)| *name == module).map(|&(_, layer)| layer)
}

fn rust_files(dir: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(dir).expect("readable source folder") {
        let path = entry.expect("readable entry").path();
        if path.is_dir() {
            rust_files(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
}

/// Modules named in source text: `crate::module` and, in the binary, `anastomesh::module`; also the first names of a
/// group `crate::{a::X, b::Y}`.
fn modules_named(source: &str) -> Vec<String> {
    let code: String = source.lines().map(|line| line.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n");
    let mut modules = Vec::new();
    for root in ["crate::", "anastomesh::"] {
        for (at, _) in code.match_indices(root) {
            let rest = &code[at + root.len()..];
            match rest.strip_prefix('{') {
                Some(group) => modules.extend(group_heads(group)),
                None => modules.push(head(rest)),
            }
        }
    }
    modules
}

fn head(text: &str) -> String {
    text.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

fn group_heads(group: &str) -> Vec<String> {
    let (mut depth, mut start, mut heads) = (0, 0, Vec::new());
    for (i, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            ',' if depth == 0 => {
                heads.push(head(&group[start..i]));
                start = i + 1;
            }
            '}' if depth == 0 => {
                heads.push(head(&group[start..i]));
                return heads;
            }
            '}' => depth -= 1,
            _ => {}
        }
    }
    heads
}

/// Sources of a package, by path below its source folder.
fn sources(package: &str) -> BTreeMap<String, String> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join(package);
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    assert!(files.len() > 5, "{package}: the source was not found");
    let read = |file: PathBuf| {
        let inside = file.strip_prefix(&src).expect("below src").to_string_lossy().replace('\\', "/");
        (inside, std::fs::read_to_string(&file).expect("readable source"))
    };
    files.into_iter().map(read).collect()
}

#[test]
fn modules_import_downwards_only() {
    let mut wrong = Vec::new();
    for (inside, source) in sources("src") {
        let module = inside.split('/').next().unwrap_or_default().trim_end_matches(".rs");
        if module == "lib" {
            continue;
        }
        let own = layer(module).unwrap_or_else(|| panic!("module `{module}` has no layer"));
        for named in modules_named(&source) {
            if let Some(other) = layer(&named)
                && named != module
                && other >= own
            {
                wrong.push(format!("{inside} imports {named}"));
            }
        }
    }
    assert!(wrong.is_empty(), "imports that do not run downwards:\n{}", wrong.join("\n"));
}

/// Disc joints must not depend on woven joints.
#[test]
fn only_the_pipeline_imports_woven() {
    for (inside, source) in sources("src") {
        let may = ["woven/", "pipeline/", "lib.rs"].iter().any(|start| inside.starts_with(start));
        assert!(may || !modules_named(&source).iter().any(|module| module == "woven"), "{inside} imports woven");
    }
}

#[test]
fn the_reader_of_imports_sees_groups() {
    let found =
        modules_named("use crate::{mesh::{A, B}, tet::X};\nuse crate::io; // crate::cli\nanastomesh::cli::run()");
    assert_eq!(found, ["mesh", "tet", "io", "cli"]);
}

/// The second checker must not repeat faults of the mesher.
#[test]
fn the_second_checker_depends_on_no_crate_of_the_mesher() {
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/verify/Cargo.toml");
    let text = std::fs::read_to_string(manifest).expect("a readable manifest");
    let names: Vec<&str> =
        text.lines().filter_map(|line| line.split_once(['.', ' ', '=']).map(|(name, _)| name)).collect();
    let geometry = ["kiddo", "nalgebra", "robust", "spade"];
    let is_shared = |name: &&&str| name.starts_with("anastomesh") || geometry.contains(*name);
    let shared: Vec<_> = names.iter().filter(is_shared).collect();
    assert!(names.contains(&"num-bigint") && shared.is_empty(), "dependencies on the mesher: {shared:?}");
}

/// Elementary functions of `std`. Their last digits are those of the platform's C library.
const OF_PLATFORM: [&str; 20] = [
    "acos", "asin", "atan", "atan2", "cbrt", "cos", "cosh", "exp", "exp2", "exp_m1", "hypot", "ln", "ln_1p", "log",
    "log10", "log2", "powf", "sin", "sin_cos", "tan",
];

/// Calls of them as methods.
fn calls_of_platform(source: &str) -> Vec<String> {
    let code = source.lines().map(|line| line.split("//").next().unwrap_or(""));
    let is_call = |code: &str| OF_PLATFORM.iter().any(|name| code.contains(&format!(".{name}(")));
    code.filter(|code| is_call(code)).map(|code| code.trim().to_owned()).collect()
}

#[test]
fn elementary_functions_are_the_same_on_all_platforms() {
    let mesher = PACKAGES
        .iter()
        .filter(|package| !["crates/verify/src", "crates/trials/src", "crates/mutants/src"].contains(package));
    for package in mesher {
        for (inside, source) in sources(package) {
            let calls = calls_of_platform(&source);
            assert!(calls.is_empty(), "{package}/{inside}: use libm instead of\n{}", calls.join("\n"));
        }
    }
    assert_eq!(calls_of_platform("let x = y.sin(); // a.cos()\nlibm::exp(x)"), ["let x = y.sin();"]);
}

#[test]
fn no_file_imports_from_one_that_imports_from_it() {
    let circles_in =
        |package: &&str| circles(&sources(package)).iter().map(|circle| circle.join(" ")).collect::<Vec<_>>();
    let found: Vec<String> = PACKAGES.iter().flat_map(circles_in).collect();
    assert!(found.is_empty(), "files that import from each other:\n{}", found.join("\n"));
}

/// Files that import from each other, directly or indirectly. A file imports from the definition of a name, through all
/// re-exports. A module that only declares and re-exports imports nothing. Test modules are ignored.
fn circles(sources: &BTreeMap<String, String>) -> Vec<Vec<String>> {
    let mut crate_of = Crate::default();
    crate_of.add_file(sources, "lib.rs", &[]);
    let imports = crate_of.imports();
    let reached: BTreeMap<&str, BTreeSet<&str>> =
        imports.keys().map(|file| (&**file, reached(&imports, file))).collect();
    let mut circles: BTreeSet<Vec<String>> = BTreeSet::new();
    for (file, others) in reached.iter().filter(|(file, others)| others.contains(*file)) {
        let back = others.iter().filter(|other| reached.get(*other).is_some_and(|from| from.contains(file)));
        circles.insert(back.map(|other| (*other).to_owned()).collect());
    }
    circles.into_iter().collect()
}

/// All files from which a file imports, directly or indirectly.
fn reached<'a>(imports: &'a BTreeMap<String, BTreeSet<String>>, file: &str) -> BTreeSet<&'a str> {
    let mut reached = BTreeSet::new();
    let mut open: Vec<&str> = vec![file];
    while let Some(file) = open.pop() {
        for next in imports.get(file).into_iter().flatten() {
            if reached.insert(&**next) {
                open.push(next);
            }
        }
    }
    reached
}

/// Path of names.
type Names = Vec<String>;

/// Name imported by a `use`.
#[derive(Debug)]
struct Use {
    path: Names,
    /// Local name; `*` for a glob import.
    name: String,
    /// True for a re-export.
    public: bool,
}

/// Contents of a module.
#[derive(Debug, Default)]
struct Module {
    file: String,
    /// Names that it defines.
    defines: BTreeSet<String>,
    uses: Vec<Use>,
    /// Paths in its code, and single names.
    named: Vec<Names>,
}

/// All modules by path.
#[derive(Debug, Default)]
struct Crate(BTreeMap<Names, Module>);

impl Crate {
    /// Reads a file and the modules that it declares; test modules are ignored.
    fn add_file(&mut self, sources: &BTreeMap<String, String>, file: &str, path: &[String]) {
        let tokens = without_tests(&tokens(&sources[file]));
        let mut declared = Vec::new();
        self.add_module(&tokens, file, path, &mut declared);
        let folder = match file.strip_suffix("mod.rs").or(file.strip_suffix("lib.rs")) {
            Some(folder) => folder.to_owned(),
            None => file.trim_end_matches(".rs").to_owned() + "/",
        };
        for child in declared {
            let places = [format!("{folder}{child}.rs"), format!("{folder}{child}/mod.rs")];
            let place = places.iter().find(|place| sources.contains_key(*place));
            let place = place.unwrap_or_else(|| panic!("{file} declares {child}, of which there is no file"));
            self.add_file(sources, place, &joined(path, &child));
        }
    }

    /// Reads the contents of a module and its inner modules.
    fn add_module(&mut self, tokens: &[String], file: &str, path: &[String], declared: &mut Names) {
        let mut module = Module { file: file.into(), ..Module::default() };
        let (mut at, mut depth, mut public) = (0, 0, false);
        while let Some(token) = tokens.get(at) {
            let next = tokens.get(at + 1).map_or("", String::as_str);
            match token.as_str() {
                "use" => {
                    let end = at + position(&tokens[at..], ";");
                    add_uses(&tokens[at + 1..end], &[], public, &mut module.uses);
                    at = end;
                }
                "mod" if depth == 0 && tokens.get(at + 2).is_some_and(|t| t == ";") => declared.push(next.into()),
                "mod" if depth == 0 && is_name(next) => {
                    let end = group_end(tokens, at + 2);
                    self.add_module(&tokens[at + 3..end], file, &joined(path, next), declared);
                    at = end;
                }
                "struct" | "enum" | "trait" | "type" | "fn" | "const" | "static" | "union" if depth == 0 => {
                    module.defines.insert(next.into());
                }
                "{" => depth += 1,
                "}" => depth -= 1,
                name if is_name(name) => {
                    let mut names = vec![name.to_owned()];
                    while tokens.get(at + 1).is_some_and(|t| t == "::")
                        && tokens.get(at + 2).is_some_and(|t| is_name(t))
                    {
                        names.push(tokens[at + 2].clone());
                        at += 2;
                    }
                    module.named.push(names);
                }
                _ => {}
            }
            // `pub`, or the end of `pub(…)`: the next item is public.
            public =
                token == "pub" || (public && matches!(token.as_str(), "(" | "crate" | "super" | "in" | "::" | ")"));
            at += 1;
        }
        self.0.insert(path.to_vec(), module);
    }

    /// Imports of each file, as files.
    fn imports(&self) -> BTreeMap<String, BTreeSet<String>> {
        let mut imports: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for (path, module) in &self.0 {
            let from = imports.entry(module.file.clone()).or_default();
            let heads: BTreeSet<&str> = module.named.iter().map(|names| &*names[0]).collect();
            let used = module.uses.iter().filter(|u| !u.public || heads.contains(&*u.name)).map(|u| &u.path);
            for names in used.chain(module.named.iter().filter(|names| names.len() > 1)) {
                from.extend(self.place(path, names, 0).filter(|file| *file != module.file));
            }
        }
        imports
    }

    /// File that defines the target of a path in a module; `None` for modules and for items of other crates.
    fn place(&self, module: &[String], names: &[String], depth: usize) -> Option<String> {
        let (mut at, mut rest) = self.begin(module, names)?;
        while let [next, more @ ..] = rest
            && self.0.contains_key(&joined(&at, next))
        {
            at = joined(&at, next);
            rest = more;
        }
        let (here, name) = (self.0.get(&at)?, rest.first()?);
        if here.defines.contains(name) || name == "*" {
            return Some(here.file.clone());
        }
        // Cyclic names resolve to nothing.
        let further = |u: &Use, rest: &[String]| {
            let path = [u.path.strip_suffix(&["*".to_owned()]).unwrap_or(&u.path), rest].concat();
            (depth < 20).then(|| self.place(&at, &path, depth + 1))?
        };
        match here.uses.iter().find(|u| u.name == *name) {
            Some(u) => further(u, &rest[1..]),
            None => here.uses.iter().filter(|u| u.name == "*").find_map(|u| further(u, rest)),
        }
    }

    /// Start module of a path, and the remaining names.
    fn begin<'a>(&self, module: &[String], names: &'a [String]) -> Option<(Names, &'a [String])> {
        let (first, rest) = names.split_first()?;
        match first.as_str() {
            "crate" => Some((Names::new(), rest)),
            "self" => Some((module.to_vec(), rest)),
            "super" => {
                let above = &module[..module.len().checked_sub(1)?];
                if rest.first().is_some_and(|next| next == "super") {
                    return self.begin(above, rest);
                }
                Some((above.to_vec(), rest))
            }
            name => {
                let here = self.0.get(module)?;
                let known = self.0.contains_key(&joined(module, name)) || here.uses.iter().any(|u| u.name == name);
                known.then(|| (module.to_vec(), names))
            }
        }
    }
}

/// Adds the names of an import tree.
fn add_uses(tokens: &[String], before: &[String], public: bool, uses: &mut Vec<Use>) {
    let mut path = before.to_vec();
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        match token.as_str() {
            "{" => {
                let end = group_end(tokens, at);
                split_at_commas(&tokens[at + 1..end]).for_each(|tree| add_uses(tree, &path, public, uses));
                return;
            }
            "::" => {}
            "as" => {
                let name = tokens[at + 1].clone();
                uses.push(Use { path, name, public });
                return;
            }
            name => path.push(name.into()),
        }
        at += 1;
    }
    // `self` at the end of a group is the module of the group.
    if path.last().is_some_and(|last| last == "self") && path.len() > 1 {
        path.pop();
    }
    if let Some(name) = path.last().cloned() {
        uses.push(Use { path, name, public });
    }
}

fn split_at_commas(tokens: &[String]) -> impl Iterator<Item = &[String]> {
    let mut depth = 0;
    let parts = tokens.split(move |token| {
        depth += i32::from(token == "{") - i32::from(token == "}");
        depth == 0 && token == ","
    });
    parts.filter(|part| !part.is_empty())
}

fn joined(path: &[String], name: &str) -> Names {
    [path, &[name.to_owned()]].concat()
}

fn is_name(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// Position of the next such token, or the end.
fn position(tokens: &[String], wanted: &str) -> usize {
    tokens.iter().position(|token| token == wanted).unwrap_or(tokens.len())
}

/// End of the group that starts here.
fn group_end(tokens: &[String], start: usize) -> usize {
    let mut depth = 0;
    for (i, token) in tokens.iter().enumerate().skip(start) {
        depth +=
            i32::from(matches!(token.as_str(), "{" | "(" | "[")) - i32::from(matches!(token.as_str(), "}" | ")" | "]"));
        if depth == 0 {
            return i;
        }
    }
    tokens.len()
}

/// Removes attributes, and every item with `#[cfg(test)]`.
fn without_tests(tokens: &[String]) -> Vec<String> {
    let (mut kept, mut at, mut test) = (Vec::new(), 0, false);
    while let Some(token) = tokens.get(at) {
        if token == "#" {
            let open = at + position(&tokens[at..], "[");
            let end = group_end(tokens, open);
            test |= tokens[open..end].join("") == "[cfg(test)";
            at = end + 1;
            continue;
        }
        if test {
            let end = at + position(&tokens[at..], ";");
            let block = at + position(&tokens[at..], "{");
            at = if block < end && token != "use" { group_end(tokens, block) } else { end };
            test = false;
        } else {
            kept.push(token.clone());
        }
        at += 1;
    }
    kept
}

/// Tokens: names, `::` and single characters; comments and quoted text are skipped.
fn tokens(source: &str) -> Names {
    let mut tokens = Names::new();
    let mut rest = source;
    while let Some(c) = rest.chars().next() {
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if let Some(length) = quoted(rest) {
            length
        } else if c.is_alphanumeric() || c == '_' {
            let length = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            tokens.push(rest[..length].into());
            length
        } else {
            let length = if rest.starts_with("::") { 2 } else { c.len_utf8() };
            if !c.is_whitespace() {
                tokens.push(rest[..length].into());
            }
            length
        };
        rest = &rest[length..];
    }
    tokens
}

/// Length of the quoted text or character that starts here; `None` if there is none.
fn quoted(rest: &str) -> Option<usize> {
    let raw = rest.strip_prefix('b').unwrap_or(rest);
    if let Some(hashes) = raw.strip_prefix('r') {
        let body = hashes.trim_start_matches('#');
        if let Some(text) = body.strip_prefix('"') {
            let end = String::from("\"") + &"#".repeat(hashes.len() - body.len());
            let length = text.find(&end).map_or(text.len(), |at| at + end.len());
            return Some(rest.len() - text.len() + length);
        }
    }
    let quote = raw.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    let start = rest.len() - raw.len() + 1;
    let mut escaped = false;
    for (i, c) in rest[start..].char_indices() {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            c if c == quote => return Some(start + i + 1),
            // A lifetime is not closed.
            _ if quote == '\'' && i > 0 && !rest[start..].starts_with('\\') => return None,
            _ => {}
        }
    }
    None
}

fn circles_of(files: &[(&str, &str)]) -> Vec<Vec<String>> {
    circles(&files.iter().map(|&(file, source)| (file.to_owned(), source.to_owned())).collect())
}

#[test]
fn circles_are_found_through_groups_and_re_exports() {
    let lib = ("lib.rs", "pub mod a;\npub mod b;");
    // Through a renamed group import, and through a path in the code.
    let a = ("a.rs", "use crate::{b::{self as other, Y as Z}};\npub struct X;\nfn f(_: Z, _: other::Y) {}");
    let b = ("b.rs", "pub struct Y;\nfn g(_: super::a::X) {}");
    assert_eq!(circles_of(&[lib, a, b]), [["a.rs", "b.rs"]]);
    assert!(
        circles_of(&[lib, a, ("b.rs", "pub struct Y; // super::a::X\nconst S: &str = \"crate::a::X\";")]).is_empty()
    );
    // A module import without use of its names.
    assert!(circles_of(&[lib, ("a.rs", "use crate::b;\npub struct X;"), b]).is_empty());
    // A function called through its module.
    let called = ("a.rs", "use crate::b;\npub struct X;\nfn f() { let _ = 'b'; b::g('\\''); }");
    assert_eq!(circles_of(&[lib, called, ("b.rs", "use crate::a::*;\npub fn g(_: char) {}")]), [["a.rs", "b.rs"]]);
}

#[test]
fn a_module_that_only_declares_is_in_no_circle() {
    let lib = ("lib.rs", "mod part;");
    let only = ("part/mod.rs", "mod a;\nmod b;\npub use a::A;\npub(crate) use b::*;");
    let a = ("part/a.rs", "use super::B;\npub struct A;");
    let b = ("part/b.rs", "pub struct B;");
    assert!(circles_of(&[lib, only, a, b]).is_empty());
    // Siblings that import each other through it.
    assert_eq!(circles_of(&[lib, only, a, ("part/b.rs", "pub struct B(super::A);")]), [["part/a.rs", "part/b.rs"]]);
    // It defines an item, and uses its re-exports.
    let more = ("part/mod.rs", "mod a;\npub use a::A;\npub struct Own(A);");
    let child = ("part/a.rs", "pub struct A;\nimpl A { fn own(&self) -> Option<super::Own> { None } }");
    assert_eq!(circles_of(&[lib, more, child]), [["part/a.rs", "part/mod.rs"]]);
}

#[test]
fn tests_are_in_no_circle() {
    let lib = ("lib.rs", "mod a;\nmod b;");
    let a = ("a.rs", "use crate::b::B;\npub struct A<'a>(&'a B);\n#[cfg(test)]\n#[path = \"a_tests.rs\"]\nmod tests;");
    let b = ("b.rs", "pub struct B;\n#[cfg(test)]\nuse crate::a::{A};\n#[cfg(test)]\nmod tests { use crate::a::A; }");
    assert!(circles_of(&[lib, a, b, ("a_tests.rs", "use super::A;")]).is_empty());
    // An inline module belongs to its file.
    let inner = ("b.rs", "pub struct B;\nmod inner { use super::super::a::A; }");
    assert_eq!(circles_of(&[lib, a, inner]), [["a.rs", "b.rs"]]);
}

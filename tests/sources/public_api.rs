//! Public names of each crate's front page, as a snapshot, and their number for the root crate.

use std::path::Path;

/// Crates that the root re-exports as they are.
const CRATES: [&str; 7] = ["domain", "flow", "io", "mesh", "network", "skeleton", "tet"];

/// Maximum number of public names of the root crate, without those of the crates that it re-exports.
const MOST_NAMES: usize = 75;

/// Names that a `pub use` brings in.
fn used(path: &str) -> Vec<String> {
    let (before, names) = path.split_once('{').unwrap_or(("", path));
    assert!(!names.contains('{'), "nested groups are not read: {before}{names}");
    let names = names.trim_end_matches([' ', '}']).split(',').map(str::trim).filter(|name| !name.is_empty());
    names.map(|name| name.rsplit([' ', ':']).next().unwrap_or(name).to_owned()).collect()
}

/// Name of an item that a line declares as public.
fn declared(line: &str) -> Option<String> {
    let kinds = ["mod", "struct", "enum", "trait", "type", "const", "fn"];
    let (kind, rest) = line.strip_prefix("pub ")?.split_once(' ')?;
    kinds.contains(&kind).then(|| rest.split(|c: char| !c.is_alphanumeric() && c != '_').next().map(str::to_owned))?
}

/// Public names of a `lib.rs` formatted by rustfmt, with those of the modules written in it; hidden items are left out.
fn names(source: &str) -> Vec<String> {
    let (mut names, mut module, mut hidden) = (Vec::new(), None::<(String, bool)>, false);
    let mut lines = source.lines().filter(|line| !line.trim_start().starts_with("//"));
    while let Some(line) = lines.next() {
        if line == "}" {
            module = None;
        }
        let item = if module.is_some() { line.strip_prefix("    ").unwrap_or_default() } else { line };
        if item.starts_with("#[") {
            hidden |= item == "#[doc(hidden)]";
            continue;
        }
        let is_hidden = std::mem::take(&mut hidden) || module.as_ref().is_some_and(|(_, hidden)| *hidden);
        let mut found = Vec::new();
        if let Some(path) = item.strip_prefix("pub use ") {
            let mut path = path.to_owned();
            while !path.ends_with(';') {
                path += lines.next().expect("a `pub use` ends").trim();
            }
            found = used(path.trim_end_matches(';'));
        } else if let Some(name) = declared(item) {
            found.push(name);
        }
        let prefix = module.as_ref().map_or_else(String::new, |(module, _)| format!("{module}::"));
        if !is_hidden {
            names.extend(found.iter().map(|name| format!("{prefix}{name}")));
        }
        if item.starts_with("pub mod ") && item.ends_with('{') {
            module = Some((found.remove(0), is_hidden));
        }
    }
    names.sort();
    names
}

fn front(package: &str) -> Vec<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(package).join("src/lib.rs");
    names(&std::fs::read_to_string(path).expect("a readable front page"))
}

#[test]
fn names_of_each_crate() {
    for (title, package) in [
        ("root", ""),
        ("domain", "crates/domain"),
        ("flow", "crates/flow"),
        ("io", "crates/io"),
        ("mesh", "crates/mesh"),
        ("network", "crates/network"),
        ("skeleton", "crates/skeleton"),
        ("tet", "crates/tet"),
    ] {
        let names = front(package);
        insta::assert_snapshot!(title, format!("{} names\n{}", names.len(), names.join("\n")));
    }
}

#[test]
fn the_root_crate_stays_small() {
    let own = front("").into_iter().filter(|name| !CRATES.contains(&name.as_str())).count();
    assert!(
        own <= MOST_NAMES,
        "{own} public names, at most {MOST_NAMES}: leave some in the crates that are re-exported"
    );
}

#[test]
fn hidden_and_private_items_are_not_listed() {
    let source = "pub use a::{B, c as D};\n#[doc(hidden)]\npub mod e {\n    pub use x::F;\n}\npub mod g {\n    pub use y::H;\n}\nfn i() {}\n";
    assert_eq!(names(source), ["B", "D", "g", "g::H"]);
}

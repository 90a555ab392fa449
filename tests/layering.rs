//! A room imports only from floors below its own (ARCHITECTURE.md).

use std::path::{Path, PathBuf};

/// Rooms by floor; a room may import from rooms with a smaller number, and from itself.
const FLOORS: [(&str, u32); 15] = [
    ("main", 8),
    ("cli", 7),
    ("report", 6),
    ("pipeline", 5),
    ("block", 4),
    ("surface", 3),
    ("tet", 3),
    ("stitch", 3),
    ("io", 3),
    ("refine", 3),
    ("grow", 3),
    ("partition", 3),
    ("mesh", 2),
    ("skeleton", 2),
    ("geometry", 1),
];

fn floor(room: &str) -> Option<u32> {
    FLOORS.iter().find(|(name, _)| *name == room).map(|&(_, floor)| floor)
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

/// Rooms that a piece of source names: `crate::room` and, in the binary, `anastomesh::room`; also the first names of a
/// group `crate::{a::X, b::Y}`.
fn rooms_named(source: &str) -> Vec<String> {
    let code: String = source.lines().map(|line| line.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n");
    let mut rooms = Vec::new();
    for root in ["crate::", "anastomesh::"] {
        for (at, _) in code.match_indices(root) {
            let rest = &code[at + root.len()..];
            match rest.strip_prefix('{') {
                Some(group) => rooms.extend(group_heads(group)),
                None => rooms.push(head(rest)),
            }
        }
    }
    rooms
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

#[test]
fn rooms_import_downwards_only() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&src, &mut files);
    assert!(files.len() > 20, "the source was not found");
    let mut wrong = Vec::new();
    for file in files {
        let inside = file.strip_prefix(&src).expect("below src");
        let first = inside.components().next().expect("a name").as_os_str().to_string_lossy().into_owned();
        let room = first.trim_end_matches(".rs").to_owned();
        if room == "lib" {
            continue;
        }
        let own = floor(&room).unwrap_or_else(|| panic!("room `{room}` has no floor"));
        let source = std::fs::read_to_string(&file).expect("readable source");
        for named in rooms_named(&source) {
            if let Some(other) = floor(&named)
                && named != room
                && other >= own
            {
                wrong.push(format!("{} imports {named}", inside.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "imports that do not run downwards:\n{}", wrong.join("\n"));
}

#[test]
fn the_reader_of_imports_sees_groups() {
    let found = rooms_named("use crate::{mesh::{A, B}, tet::X};\nuse crate::io; // crate::cli\nanastomesh::cli::run()");
    assert_eq!(found, ["mesh", "tet", "io", "cli"]);
}

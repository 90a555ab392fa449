//! Snapshots of all messages in the sources, by module. New and changed messages thus appear beside the others for
//! review: what, where, why, and what to do. `tests/program/messages.rs` tests them in context.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// Calls that contain messages.
const CALLS: [&str; 9] = [
    "#[error(",
    "Failure::input(",
    "Failure::usage(",
    "Failure::stage(",
    "Failure::stopped(",
    "log::note(",
    "log::warning(",
    "log::error(",
    ".note(",
];

/// Source folders of the packages whose messages users see.
const PACKAGES: [&str; 8] = [
    "src",
    "crates/mesh/src",
    "crates/skeleton/src",
    "crates/network/src",
    "crates/tet/src",
    "crates/io/src",
    "crates/flow/src",
    "crates/domain/src",
];

/// Sources of a folder, in order.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") && !path.ends_with("tests.rs") {
            found.push(path);
        }
    }
    found.sort_unstable();
    found
}

/// Texts of a source up to the closing parenthesis, and the rest of the source.
fn texts(source: &str) -> (Vec<String>, &str) {
    let (mut depth, mut found, mut at) = (1, Vec::new(), 0);
    let bytes = source.as_bytes();
    while depth > 0 && at < bytes.len() {
        match bytes[at] {
            b'(' => depth += 1,
            b')' => depth -= 1,
            b'\'' if bytes.get(at + 2) == Some(&b'\'') => at += 2,
            b'"' => {
                let end = text_end(bytes, at + 1);
                found.push(unescaped(&source[at + 1..end]));
                at = end;
            }
            _ => {}
        }
        at += 1;
    }
    (found, &source[at..])
}

/// End of a text that has started.
fn text_end(bytes: &[u8], mut at: usize) -> usize {
    while bytes[at] != b'"' {
        at += if bytes[at] == b'\\' { 2 } else { 1 };
    }
    at
}

/// Text without line continuations of the source.
fn unescaped(text: &str) -> String {
    let mut parts = text.split("\\\n");
    let mut out = parts.next().unwrap_or_default().to_owned();
    parts.for_each(|part| out.push_str(part.trim_start()));
    out.replace("\\\"", "\"")
}

/// Messages of a source, except those of its tests.
fn messages(source: &str) -> Vec<String> {
    let source = source.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let mut found = Vec::new();
    for (line, rest) in
        source.match_indices(|c: char| c == '#' || c.is_alphabetic() || c == '.').map(|(at, _)| (at, &source[at..]))
    {
        let is_comment = source[..line].rsplit('\n').next().is_some_and(|begun| begun.trim_start().starts_with("//"));
        let starts = line == 0 || !source[..line].ends_with(|c: char| c.is_alphanumeric() || c == '_');
        let Some(call) = CALLS.iter().find(|call| rest.starts_with(**call)) else { continue };
        if is_comment || (!starts && !call.starts_with('.')) {
            continue;
        }
        // Single words are names or separators.
        found.extend(texts(&rest[call.len()..]).0.into_iter().filter(|text| text.contains(' ')));
    }
    found
}

/// Snapshot of a source: its package and folder; for readers and writers, the format family.
fn group(package: &str, inside: &Path) -> String {
    let first =
        inside.iter().next().filter(|_| inside.iter().count() > 1).map(|part| part.to_string_lossy().into_owned());
    match (package, first) {
        ("src", None) => "top".into(),
        ("src", Some(module)) => module,
        ("crates/io/src", Some(family)) => format!("io_{family}"),
        _ => package.split('/').nth(1).unwrap_or_default().into(),
    }
}

#[test]
fn each_is_written_down() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut groups: BTreeMap<String, String> = BTreeMap::new();
    let mut count = 0;
    for package in PACKAGES {
        for path in sources(&root.join(package)) {
            let found = messages(&fs::read_to_string(&path).expect("a source"));
            let inside = path.strip_prefix(root.join(package)).expect("a source of ours");
            let Some(_) = found.first() else { continue };
            let out = groups.entry(group(package, inside)).or_default();
            let _ = writeln!(out, "{}", inside.to_string_lossy().replace('\\', "/"));
            for message in found {
                count += 1;
                let _ = writeln!(out, "    {}", message.replace('\n', "\n    "));
            }
        }
    }
    assert!(count > 350, "{count}");
    for (group, text) in groups {
        insta::assert_snapshot!(group, text);
    }
}

#[test]
fn the_reader_of_sources_finds_them() {
    let source = "#[error(\n    \"a (b) {}; \\\n     c\", d(\")\")\n)]\nfn f() { Failure::input(format!(\"no {x} \\\"y\\\"\")) }\n// log::note(\"not me\")\n\
                  fn g() { bars.note(\"x y\"); log::note(\"one\"); catalog::note(\"nor me\") }\n#[cfg(test)]\nmod tests {\nlog::note(\"nor this\")";
    assert_eq!(messages(source), ["a (b) {}; c", "no {x} \"y\"", "x y"]);
}

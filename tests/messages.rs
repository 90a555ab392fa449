//! Every message that the sources hold, by module: whoever adds one or changes one sees it beside the others, and reads whether it
//! says what, where, why and what to do. What the program makes of them is in `messages_cli`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// What a message stands in.
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

/// The sources of a folder, in order.
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

/// The texts of a source up to where a parenthesis that is open closes, and what comes behind it.
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

/// Where a text ends that has begun.
fn text_end(bytes: &[u8], mut at: usize) -> usize {
    while bytes[at] != b'"' {
        at += if bytes[at] == b'\\' { 2 } else { 1 };
    }
    at
}

/// A text as it is written, without what breaks lines of the source.
fn unescaped(text: &str) -> String {
    let mut parts = text.split("\\\n");
    let mut out = parts.next().unwrap_or_default().to_owned();
    parts.for_each(|part| out.push_str(part.trim_start()));
    out.replace("\\\"", "\"")
}

/// The messages of a source, but those of its tests.
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
        // One word is a name or a separator.
        found.extend(texts(&rest[call.len()..]).0.into_iter().filter(|text| text.contains(' ')));
    }
    found
}

/// Snapshot that holds the messages of a source: its package and folder, of readers and writers the format's family.
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
    for package in ["src", "crates/mesh/src", "crates/skeleton/src", "crates/tet/src", "crates/io/src"] {
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

//! Checks of the style guide (docs/style.md) that a machine can make: openings of doc comments, sentence length, words, plurals.
//!
//! Older text breaks some rules. `docs/style-budget.toml` holds the number of violations that remain in each folder, by kind.
//! The test fails if a number rises, and also if it falls and the budget stays, so that the budget only shrinks.
//!
//! ```sh
//! ANASTOMESH_STYLE_LIST=1 cargo test --test sources style:: -- --nocapture    # lists every violation
//! ANASTOMESH_STYLE_LOWER=1 cargo test --test sources style::                  # lowers the budget to the present numbers
//! ```

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

const BUDGET: &str = "docs/style-budget.toml";

/// Maximum number of words in a sentence. A code span counts as one word.
const SENTENCE: usize = 25;

/// Words that must not open a doc comment: they announce a clause, not a thing or an action.
const OPENINGS: [&str; 9] = ["What", "Whether", "Where", "Which", "Who", "How", "When", "The same", "So many"];

/// Phrases to avoid, each with the usual term.
const WORDS: [(&str, &str); 46] = [
    ("so many", "at most N, or the number"),
    ("all but", "almost, or except"),
    ("very", "leave it out; 'exactly' for identity"),
    ("meets itself", "intersects itself"),
    ("meet itself", "intersect itself"),
    ("meet themselves", "intersect themselves"),
    ("run into each other", "overlap"),
    ("runs into each other", "overlaps"),
    ("run into themselves", "overlap"),
    ("is there", "exists"),
    ("are there", "exist"),
    ("there is not", "does not exist"),
    ("that is none", "NaN, or not a number"),
    ("that are none", "NaN, or not numbers"),
    ("there are none", "none exist"),
    ("put out", "extended, or removed"),
    ("by itself", "alone, or separately"),
    ("by themselves", "alone, or separately"),
    ("let go", "removed, or collapsed"),
    ("lets go", "removes, or releases"),
    ("owe each other", "are independent"),
    ("in the mean", "mean N"),
    ("in the median", "median N"),
    ("told apart", "distinguished, or described"),
    ("all there is", "every detail"),
    ("what is left", "the rest, or the residual"),
    ("what was made", "the result"),
    ("what is made", "the result"),
    ("what is typed", "command-line options"),
    ("what comes out", "the result"),
    ("what goes in", "the input"),
    ("nobody reads", "the reader has closed"),
    ("nobody", "no process, or no user"),
    ("further off", "farther, with the distance"),
    ("is said", "is reported"),
    ("says so", "reports it"),
    ("say so", "report it"),
    ("made anew", "rebuilt"),
    ("anew", "again"),
    ("said of", "reported for"),
    ("held against", "compared with"),
    ("purse", "budget"),
    ("itinerary", "sequence of steps"),
    ("house", "workspace, or crates"),
    ("rooms", "modules"),
    ("words for the shell", "shell completions"),
];

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    Opening,
    Sentence,
    Word,
    Plural,
}

/// Verbs that may follow a number that identifies something: 'row 1 names 2'.
const VERBS: [&str; 6] = ["names", "needs", "ends", "changes", "leaves", "refers"];

const KINDS: [(Kind, &str); 4] =
    [(Kind::Opening, "opening"), (Kind::Sentence, "sentence"), (Kind::Word, "word"), (Kind::Plural, "plural")];

#[derive(Debug)]
struct Violation {
    kind: Kind,
    line: usize,
    text: String,
}

/// A piece of text of a Rust source.
#[derive(Debug, PartialEq)]
struct Piece {
    line: usize,
    kind: PieceKind,
    /// A comment begins its line.
    own_line: bool,
    text: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PieceKind {
    Doc,
    Comment,
    Literal,
}

/// Comments and string literals of a source, comments without their slashes.
fn pieces(source: &str) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let (mut at, mut line, mut line_start) = (0, 1, 0);
    while at < source.len() {
        let rest = &source[at..];
        let own_line = source[line_start..at].trim().is_empty();
        let (length, piece) = if rest.starts_with("//") {
            let comment = rest.lines().next().unwrap_or_default();
            (comment.len(), Some(comment_piece(comment)))
        } else if rest.starts_with("/*") {
            (rest.find("*/").map_or(rest.len(), |end| end + 2), None)
        } else {
            literal(source, at)
        };
        let token = &rest[..length];
        pieces.extend(piece.map(|(kind, text)| Piece { line, kind, own_line, text }));
        if let Some(last) = token.rfind('\n') {
            line += token.matches('\n').count();
            line_start = at + last + 1;
        }
        at += length;
    }
    pieces
}

fn comment_piece(comment: &str) -> (PieceKind, String) {
    let doc = comment.strip_prefix("//!").or(comment.strip_prefix("///").filter(|rest| !rest.starts_with('/')));
    match doc {
        Some(text) => (PieceKind::Doc, text.to_owned()),
        None => (PieceKind::Comment, comment.trim_start_matches('/').to_owned()),
    }
}

/// Length of the token at a place, and its text if it is a string literal.
fn literal(source: &str, at: usize) -> (usize, Option<(PieceKind, String)>) {
    let rest = &source[at..];
    let first = rest.chars().next().map_or(1, char::len_utf8);
    let after_name = source[..at].ends_with(|c: char| c.is_alphanumeric() || c == '_');
    if let Some(raw) = rest.strip_prefix('r').filter(|_| !after_name) {
        let hashes = raw.len() - raw.trim_start_matches('#').len();
        if let Some(body) = raw[hashes..].strip_prefix('"') {
            let end = String::from("\"") + &"#".repeat(hashes);
            let length = body.find(&end).unwrap_or(body.len());
            let all = (2 + hashes + length + end.len()).min(rest.len());
            return (all, Some((PieceKind::Literal, body[..length].to_owned())));
        }
    }
    if let Some(body) = rest.strip_prefix('"') {
        let end = closing(body, '"').unwrap_or(body.len());
        return ((end + 2).min(rest.len()), Some((PieceKind::Literal, unescaped(&body[..end]))));
    }
    if let Some(body) = rest.strip_prefix('\'') {
        // A lifetime has no closing quote after one character.
        let character = body.starts_with('\\') || body.chars().nth(1) == Some('\'');
        return (if character { closing(body, '\'').map_or(1, |end| end + 2) } else { 1 }, None);
    }
    (first, None)
}

fn closing(body: &str, quote: char) -> Option<usize> {
    let mut escaped = false;
    for (i, c) in body.char_indices() {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            c if c == quote => return Some(i),
            _ => {}
        }
    }
    None
}

/// Text of a literal with line breaks joined.
fn unescaped(body: &str) -> String {
    let mut parts = body.split("\\\n");
    let head = parts.next().unwrap_or_default().to_owned();
    parts.fold(head, |text, part| text + part.trim_start()).replace("\\n", " \n").replace("\\\"", "\"")
}

/// A paragraph of Markdown. Only prose is made of sentences; headings and rows of tables are not.
#[derive(Debug, PartialEq)]
struct Paragraph {
    line: usize,
    prose: bool,
    text: String,
}

/// Paragraphs, list items, headings and table rows of Markdown, without code blocks.
fn paragraphs<'a>(lines: impl Iterator<Item = (usize, &'a str)>) -> Vec<Paragraph> {
    let mut out: Vec<Paragraph> = Vec::new();
    let (mut open, mut fenced) = (false, false);
    for (line, raw) in lines {
        let text = raw.trim();
        let text = text.strip_prefix("> ").unwrap_or(text);
        if text.starts_with("```") || text.starts_with("~~~") {
            fenced = !fenced;
            open = false;
            continue;
        }
        let other = text.starts_with(['|', '#']) || text.starts_with("![");
        let item = list_item(text);
        if fenced || text.is_empty() || text.chars().all(|c| c == '-') {
            open = false;
        } else if other || item.is_some() || !open {
            out.push(Paragraph { line, prose: !other, text: item.unwrap_or(text).to_owned() });
            open = !other;
        } else if let Some(last) = out.last_mut() {
            last.text += " ";
            last.text += text;
        }
    }
    out
}

/// Text of a list item behind its marker.
fn list_item(text: &str) -> Option<&str> {
    let bullet = ["- ", "* ", "+ "].iter().find_map(|marker| text.strip_prefix(marker));
    let numbered = || {
        let rest = text.trim_start_matches(|c: char| c.is_ascii_digit());
        rest.strip_prefix(". ").filter(|_| rest.len() < text.len())
    };
    bullet.or_else(numbered).map(str::trim_start)
}

/// Text with each code span replaced by the word `Code`, without the addresses of links and emphasis.
fn plain(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(at) = rest.find(['`', ']']) {
        out += &rest[..at];
        rest = &rest[at..];
        if let Some(behind) = rest.strip_prefix(']') {
            let address = behind.strip_prefix('(').and_then(|address| address.split_once(')'));
            rest = address.map_or(behind, |(_, behind)| behind);
            continue;
        }
        let fence = &rest[..rest.len() - rest.trim_start_matches('`').len()];
        rest = &rest[fence.len()..];
        if let Some((_, behind)) = rest.split_once(fence) {
            out += "Code";
            rest = behind;
        }
    }
    (out + rest).replace(['[', '*'], "")
}

/// Sentences of a paragraph of plain text.
fn sentences(text: &str) -> Vec<&str> {
    let (mut start, mut out) = (0, Vec::new());
    for (at, mark) in text.match_indices(['.', '!', '?']) {
        let behind = text[at + mark.len()..].trim_start_matches([')', '\'', '"', '”', '’']);
        let next = behind.trim_start();
        let ends = next.len() < behind.len() && !next.starts_with(char::is_lowercase);
        let before = text[start..at].rsplit(|c: char| c.is_whitespace() || c == '(').next().unwrap_or_default();
        if ends && !matches!(before, "e.g" | "i.e" | "cf" | "vs" | "al" | "Fig" | "Eq" | "pp") {
            let end = text.len() - behind.len();
            out.push(&text[start..end]);
            start = text.len() - next.len();
        }
    }
    out.push(&text[start..]);
    out.retain(|sentence| !sentence.trim().is_empty());
    out
}

fn word_count(sentence: &str) -> usize {
    sentence.split_whitespace().filter(|word| word.contains(char::is_alphanumeric)).count()
}

/// Words in lower case, each with a space before and behind; punctuation stands as a comma, so that no phrase crosses it.
fn words(text: &str) -> String {
    let mut out = String::from(" ");
    for c in text.chars() {
        match c {
            c if c.is_alphanumeric() || c == '-' => out.extend(c.to_lowercase()),
            c if c.is_whitespace() => out.push(' '),
            _ => out += " , ",
        }
    }
    " ".to_owned() + &out.split_whitespace().collect::<Vec<_>>().join(" ") + " "
}

/// Plurals after the number 1, and the makeshift `(s)`.
fn bad_plurals(text: &str) -> Vec<String> {
    let mut found: Vec<String> = Vec::new();
    for (at, _) in text.match_indices("(s)") {
        let noun = text[..at].rsplit(|c: char| !c.is_alphabetic()).next().unwrap_or_default();
        if noun.len() > 2 {
            found.push(format!("{noun}(s)"));
        }
    }
    for (at, _) in text.match_indices("1 ") {
        let counts = !text[..at].ends_with(|c: char| c.is_alphanumeric() || ".,-–_:/#=^".contains(c))
            && !text[..at].trim_end().ends_with(['-', '–', '<', '>', '=', '×', '+', '*', '/']);
        let follower: String = text[at + 2..].chars().take_while(|c| c.is_alphabetic()).collect();
        let other =
            VERBS.contains(&&*follower) || ["ss", "us", "is", "as", "ies"].iter().any(|end| follower.ends_with(end));
        if counts && follower.len() > 3 && follower.ends_with('s') && !other {
            found.push(format!("1 {follower}"));
        }
    }
    found
}

/// Violations of a paragraph, wherever it stands.
fn in_text(line: usize, text: &str, out: &mut Vec<Violation>) {
    let padded = words(text);
    for (phrase, instead) in WORDS {
        let count = padded.match_indices(&format!(" {phrase} ")).count();
        let text = format!("'{phrase}': {instead}");
        out.extend((0..count).map(|_| Violation { kind: Kind::Word, line, text: text.clone() }));
    }
}

fn in_sentences(line: usize, text: &str, out: &mut Vec<Violation>) {
    for sentence in sentences(text) {
        let count = word_count(sentence);
        if count > SENTENCE {
            let start: String = sentence.chars().take(60).collect();
            out.push(Violation { kind: Kind::Sentence, line, text: format!("{count} words: {start}…") });
        }
    }
}

fn in_plurals(line: usize, text: &str, out: &mut Vec<Violation>) {
    out.extend(bad_plurals(text).into_iter().map(|text| Violation { kind: Kind::Plural, line, text }));
}

fn in_paragraphs(paragraphs: &[Paragraph], out: &mut Vec<Violation>) {
    for Paragraph { line, prose, text } in paragraphs {
        let text = plain(text);
        in_text(*line, &text, out);
        if *prose {
            in_sentences(*line, &text, out);
        }
    }
}

fn bad_opening(text: &str) -> Option<&'static str> {
    let opens =
        |opening: &&str| text.strip_prefix(*opening).is_some_and(|rest| !rest.starts_with(char::is_alphanumeric));
    OPENINGS.into_iter().find(opens)
}

/// Violations in a Rust source, and the number of its doc comments.
fn in_source(source: &str, messages: bool) -> (Vec<Violation>, usize) {
    let (mut out, mut docs) = (Vec::new(), 0);
    let pieces = pieces(source);
    let joins = |a: &Piece, b: &Piece| {
        a.kind == b.kind && a.kind != PieceKind::Literal && a.line + 1 == b.line && a.own_line && b.own_line
    };
    for block in pieces.chunk_by(joins) {
        let first = &block[0];
        if first.kind == PieceKind::Literal {
            if messages {
                in_text(first.line, &plain(&first.text), &mut out);
                in_plurals(first.line, &first.text, &mut out);
            }
            continue;
        }
        let paragraphs = paragraphs(block.iter().map(|piece| (piece.line, &*piece.text)));
        if first.kind == PieceKind::Comment {
            for p in &paragraphs {
                in_text(p.line, &plain(&p.text), &mut out);
            }
            continue;
        }
        docs += 1;
        let opening = paragraphs.iter().find(|p| p.prose).and_then(|p| bad_opening(&plain(&p.text)));
        let text = |opening| format!("a doc comment opens with '{opening}'");
        out.extend(opening.map(|o| Violation { kind: Kind::Opening, line: first.line, text: text(o) }));
        in_paragraphs(&paragraphs, &mut out);
    }
    (out, docs)
}

fn in_markdown(text: &str) -> Vec<Violation> {
    let mut out = Vec::new();
    let paragraphs = paragraphs(text.lines().enumerate().map(|(i, line)| (i + 1, line)));
    in_paragraphs(&paragraphs, &mut out);
    for p in &paragraphs {
        in_plurals(p.line, &plain(&p.text), &mut out);
    }
    out
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Files below a folder with one of the extensions, by their paths from the root; of the folder alone if `flat`.
fn files(folder: &str, extensions: &[&str], flat: bool) -> Vec<String> {
    let (mut open, mut out): (Vec<PathBuf>, _) = (vec![root().join(folder)], Vec::new());
    while let Some(dir) = open.pop() {
        for entry in fs::read_dir(&dir).into_iter().flatten() {
            let path = entry.expect("readable entry").path();
            if path.is_dir() {
                open.extend((!flat).then_some(path));
            } else if path.extension().is_some_and(|e| extensions.iter().any(|wanted| e == *wanted)) {
                let inside = path.strip_prefix(root()).expect("below the root");
                out.push(inside.to_string_lossy().replace('\\', "/"));
            }
        }
    }
    out.sort();
    out
}

/// Everything that is checked. `docs/options.md` is generated from doc comments; the guide and this file quote bad examples.
fn checked_files() -> Vec<String> {
    let mut all = files(".", &["md"], true);
    for folder in ["src", "crates", "examples", "benches", "docs"] {
        all.extend(files(folder, &["rs", "md"], false));
    }
    all.extend(files("tests", &["rs", "snap"], false));
    all.retain(|file| !["docs/options.md", "docs/style.md", "tests/sources/style.rs"].contains(&&**file));
    all
}

/// Folder whose budget counts a file: a crate, a folder of the root, or the root.
fn budget_folder(file: &str) -> String {
    let parts: Vec<&str> = file.split('/').collect();
    match parts[..] {
        ["crates", name, ..] => format!("crates/{name}"),
        [_] => "root".into(),
        [folder, ..] => folder.into(),
        [] => unreachable!("a path has parts"),
    }
}

type Counts = BTreeMap<(String, Kind), usize>;

fn read_budget(text: &str) -> Counts {
    let (mut folder, mut counts) = (String::new(), Counts::new());
    for line in text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#')) {
        if let Some(name) = line.strip_prefix('[').and_then(|line| line.strip_suffix(']')) {
            folder = name.trim_matches('"').into();
            continue;
        }
        let (name, number) = line.split_once('=').unwrap_or_else(|| panic!("{BUDGET}: not an entry: {line}"));
        let kind = KINDS.iter().find(|(_, known)| *known == name.trim());
        let (kind, _) = kind.unwrap_or_else(|| panic!("{BUDGET}: unknown kind: {line}"));
        let number = number.trim().parse().unwrap_or_else(|_| panic!("{BUDGET}: not a number: {line}"));
        counts.insert((folder.clone(), *kind), number);
    }
    counts
}

fn budget_text(counts: &Counts) -> String {
    let mut text = String::from(
        "# Remaining violations of docs/style.md in each folder (tests/sources/style.rs). Numbers only fall.\n",
    );
    for folder in folders(counts) {
        let _ = writeln!(text, "\n[\"{folder}\"]");
        for (kind, name) in KINDS {
            if let Some(&count) = counts.get(&(folder.clone(), kind)).filter(|count| **count > 0) {
                let _ = writeln!(text, "{name} = {count}");
            }
        }
    }
    text
}

fn folders(counts: &Counts) -> Vec<String> {
    let mut folders: Vec<String> =
        counts.iter().filter(|(_, c)| **c > 0).map(|((folder, _), _)| folder.clone()).collect();
    folders.dedup();
    folders
}

/// Counts all violations, printing each if asked, and the doc comments of each folder.
fn count(list: bool) -> (Counts, BTreeMap<String, usize>) {
    let (mut counts, mut docs) = (Counts::new(), BTreeMap::new());
    for file in checked_files() {
        let text = fs::read_to_string(root().join(&file)).expect("readable text");
        let folder = budget_folder(&file);
        let violations = match file.rsplit('.').next() {
            Some("rs") => {
                let (violations, blocks) = in_source(&text, file.starts_with("src/") || file.starts_with("crates/"));
                *docs.entry(folder.clone()).or_default() += blocks;
                violations
            }
            Some("md") => in_markdown(&text),
            _ => {
                let mut out = Vec::new();
                text.lines().enumerate().for_each(|(i, line)| in_plurals(i + 1, line, &mut out));
                out
            }
        };
        for Violation { kind, line, text } in violations {
            *counts.entry((folder.clone(), kind)).or_default() += 1;
            if list {
                println!("{file}:{line}: {text}");
            }
        }
    }
    (counts, docs)
}

fn print_table(counts: &Counts, docs: &BTreeMap<String, usize>) {
    println!(
        "{:18} {:>6} {:>8} {:>6} {:>9} {:>6} {:>7}",
        "folder", "docs", "opening", "%", "sentence", "word", "plural"
    );
    for folder in folders(counts) {
        let number = |kind| counts.get(&(folder.clone(), kind)).copied().unwrap_or(0);
        let docs = docs.get(&folder).copied().unwrap_or(0);
        let [o, s, w, p] = KINDS.map(|(kind, _)| number(kind));
        let share = 100.0 * o as f64 / docs.max(1) as f64;
        println!("{folder:18} {docs:6} {o:8} {share:6.1} {s:9} {w:6} {p:7}");
    }
}

#[test]
fn the_style_budget_holds() {
    let asked = |name| std::env::var_os(name).is_some_and(|value| value == "1");
    let list = asked("ANASTOMESH_STYLE_LIST");
    let (counts, docs) = count(list);
    assert!(docs.values().sum::<usize>() > 100, "the sources were not found");
    if list {
        print_table(&counts, &docs);
    }
    let path = root().join(BUDGET);
    let budget = read_budget(&fs::read_to_string(&path).unwrap_or_default());
    let lower = asked("ANASTOMESH_STYLE_LOWER");
    let (mut wrong, mut lowered) = (Vec::new(), Counts::new());
    let keys: BTreeSet<&(String, Kind)> = counts.keys().chain(budget.keys()).collect();
    for key @ (folder, kind) in keys {
        let [found, allowed] = [&counts, &budget].map(|numbers| numbers.get(key).copied().unwrap_or(0));
        lowered.insert(key.clone(), found.min(allowed));
        let name = KINDS.iter().find(|(known, _)| known == kind).map_or("", |(_, name)| *name);
        if found > allowed {
            wrong.push(format!(
                "{folder}: {name}: {found} found, at most {allowed} allowed: ANASTOMESH_STYLE_LIST=1 lists them"
            ));
        } else if found < allowed && !lower {
            wrong.push(format!(
                "{folder}: {name}: {found} found, {allowed} allowed: ANASTOMESH_STYLE_LOWER=1 lowers {BUDGET}"
            ));
        }
    }
    if lower {
        fs::write(&path, budget_text(&lowered)).expect("writable budget");
    }
    assert!(wrong.is_empty(), "style (docs/style.md):\n{}", wrong.join("\n"));
}

fn found_in(source: &str) -> Vec<(Kind, usize)> {
    in_source(source, true).0.iter().map(|v| (v.kind, v.line)).collect()
}

#[test]
fn openings_are_found_in_doc_comments_only() {
    assert_eq!(found_in("/// What it is.\nfn f() {}\n// What it is.\n"), [(Kind::Opening, 1)]);
    assert_eq!(found_in("fn f() {}\n\n//! Which it is,\n//! and more.\n"), [(Kind::Opening, 3)]);
    assert_eq!(found_in("/// However it is.\n///\n/// What follows.\n"), []);
    assert_eq!(found_in("const S: &str = \"/// What it is.\"; // 'a' and \"\nfn f<'a>() {}\n/// So many.\n"), {
        [(Kind::Opening, 3), (Kind::Word, 3)]
    });
}

#[test]
fn sentences_are_counted_across_lines() {
    let long = "word ".repeat(13);
    let source = format!("/// Begin {long}\n/// {long}end. Short one.\n");
    assert_eq!(found_in(&source), [(Kind::Sentence, 1)]);
    assert_eq!(found_in(&source.replacen("word w", "word. W", 1)), [(Kind::Sentence, 1)]);
    assert_eq!(found_in(&format!("/// - {long}\n/// - {long}\n/// ```\n/// {long}{long}\n/// ```\n")), []);
    assert_eq!(sentences("One, e.g. Two `x`. Code is three (four). 5 is next"), {
        ["One, e.g. Two `x`.", "Code is three (four).", "5 is next"]
    });
    assert_eq!(word_count(&plain("the [link to it](docs/a b.md) of `a b c` — done")), 7);
}

#[test]
fn words_are_found_in_comments_and_messages() {
    assert_eq!(found_in("// After so\n// many steps.\n"), [(Kind::Word, 1)]);
    assert_eq!(found_in("fn f() { g(\"the wall \\\n    meets itself\") }"), [(Kind::Word, 1)]);
    assert_eq!(found_in("// `so many`; every; do so. Many\nfn f() {} // r\"x\"\n"), []);
    assert_eq!(in_markdown("| so many |\n\n```\nso many\n```\n").len(), 1);
}

#[test]
fn plurals_are_found_in_messages() {
    assert_eq!(bad_plurals("block(s), 1 loops, 21 loops, 0.1 radii, 1 axis, 1 s, f(s)"), ["block(s)", "1 loops"]);
    assert_eq!(found_in("// 1 loops\nconst S: &str = r#\"1 loops\"#;\n"), [(Kind::Plural, 2)]);
}

#[test]
fn a_budget_is_read_as_it_is_written() {
    let counts: Counts = [(("crates/io".to_owned(), Kind::Word), 3), (("src".to_owned(), Kind::Opening), 12)].into();
    assert_eq!(read_budget(&budget_text(&counts)), counts);
}

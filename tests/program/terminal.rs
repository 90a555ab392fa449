//! Tests of terminal output: summaries, forecasts, plan files, messages for programs.

use crate::common::fixture;
use crate::common::program::*;
use serde_json::Value;
use std::fs;
use std::path::Path;

#[test]
fn a_summary_says_what_was_done_and_verbose_all_of_it() {
    let folder = folder();
    let out = folder.path().join("tree.vtu");
    let short = mesh(&fixture("tree_30.vtp"), &out, &[]);
    assert_code(&short, FINE);
    let said = stderr(&short);
    let starts = [
        "network  30 nodes, 29 edges",
        "blocks ",
        "mesh ",
        "shape ",
        "axis ",
        "radius ",
        "lumen ",
        "changes ",
        "file ",
        "time ",
    ];
    for start in starts {
        assert!(said.lines().any(|line| line.starts_with(start)), "'{start}' in {said}");
    }
    assert!(said.ends_with("\nvalid\n") && said.lines().count() < 18 && !said.contains("  ok   "), "{said}");
    let long = stderr(&mesh(&fixture("tree_30.vtp"), &out, &["--verbose"]));
    assert!(long.contains("  ok   every tetrahedron has positive volume\n") && long.ends_with("\nvalid\n"), "{long}");
    assert!(stderr(&mesh(&fixture("tree_30.vtp"), &out, &["-q"])).is_empty());
    assert_says(&mesh(&fixture("tree_30.vtp"), &out, &["-q", "-v"]), USAGE, &["--verbose"]);
}

#[test]
fn a_dry_run_meshes_nothing_and_comes_close() {
    let folder = folder();
    let out = folder.path().join("tree.vtu");
    let dry = mesh(&fixture("tree_30.vtp"), &out, &["--dry-run", "-j", "2", "-q"]);
    assert_code(&dry, FINE);
    let said = stdout(&dry);
    for word in [
        "blocks ",
        " clusters (largest ",
        "about ",
        " tetrahedra",
        " on 2 threads",
        "memory ",
        "disk ",
        "estimate only",
    ] {
        assert!(said.contains(word), "'{word}' in {said}");
    }
    assert!(entries(folder.path()).is_empty());
    let dry = json(&mesh(&fixture("tree_30.vtp"), &out, &["--dry-run", "--json"]));
    let made = json(&mesh(&fixture("tree_30.vtp"), &out, &["--json"]));
    let [about, found] =
        [&dry["estimate"]["tets"], &made["run"]["mesh"]["tets"]].map(|n| n.as_f64().expect("a number"));
    assert!((0.5..2.0).contains(&(about / found)), "{about} {found}");
    assert_eq!(dry["clusters"], made["run"]["blocks"]["clusters"]);
    let regions = ["--wall", "0.2r", "--tissue", "box", "--json"];
    let dry = json(&mesh(&fixture("tree_30.vtp"), &out, &[&regions[..], &["--dry-run"]].concat()));
    let made = json(&mesh(&fixture("tree_30.vtp"), &out, &regions));
    let [about, found] =
        [&dry["estimate"]["tets"], &made["check"]["counts"]["tets"]].map(|n| n.as_f64().expect("a number"));
    assert!((0.5..2.0).contains(&(about / found)), "{about} {found}");
}

#[test]
fn options_come_from_a_file_and_the_plan_is_written() {
    let folder = folder();
    let [plan, out] = ["plan.toml", "tree.vtu"].map(|name| folder.path().join(name));
    fs::write(&plan, "rho = 4\nroot = [\"7\"]\nquiet = true\nrefine = false\nformat = \"vtu\"\n").expect("written");
    let options = ["--config", plan.to_str().expect("a path"), "--root", "9", "--rho", "3.5"];
    // Roots accumulate, numbers are replaced: 9 is not a terminal, so the error shows that it was read.
    let refused = mesh(&fixture("tree_30.swc"), &out, &options);
    assert_code(&refused, USAGE);
    // A failed run can be repeated, too.
    assert_eq!(entries(folder.path()), ["plan.toml", "tree_plan.toml"]);
    fs::write(&plan, "rho = 4\nquiet = true\nrefine = false\nformat = \"vtu\"\n").expect("written");
    assert_code(&mesh(&fixture("tree_30.swc"), &out, &[options[0], options[1], "--rho", "3.5"]), FINE);
    assert_eq!(entries(folder.path()), ["plan.toml", "tree.vtu", "tree_patches.csv", "tree_plan.toml"]);
    let resolved = fs::read_to_string(folder.path().join("tree_plan.toml")).expect("the plan");
    for line in ["rho = 3.5", "quiet = true", "format = \"vtu\"", "# stretch = 1", "# keep-going = false"] {
        assert!(resolved.lines().any(|l| l == line), "'{line}' in {resolved}");
    }
    // The resolved plan reproduces the mesh.
    let first = fs::read(&out).expect("a mesh");
    let again = folder.path().join("tree_plan.toml");
    let config = ["--config", again.to_str().expect("a path"), "--output", out.to_str().expect("a path")];
    assert_code(&run("mesh", &[&fixture("tree_30.swc")], &config), FINE);
    assert!(fs::read(&out).expect("a mesh") == first);
}

#[test]
fn files_with_other_keys_are_refused() {
    let folder = folder();
    let [plan, out] = ["plan.toml", "tree.vtu"].map(|name| folder.path().join(name));
    let options = ["--config", plan.to_str().expect("a path")];
    let refused = |text: &str, words: &[&str]| {
        fs::write(&plan, text).expect("written");
        assert_says(&mesh(&fixture("tree_30.swc"), &out, &options), BAD_INPUT, words);
    };
    refused("rhoo = 3\n", &["plan.toml", "unknown option 'rhoo' of mesh"]);
    refused("[rho]\na = 1\n", &["plan.toml", "'rho' must be a number"]);
    refused("rho = = 3\n", &["plan.toml", "line 1"]);
    refused("config = \"other.toml\"\n", &["unknown option 'config'"]);
    fs::remove_file(&plan).expect("removed");
    assert_says(&mesh(&fixture("tree_30.swc"), &out, &options), BAD_INPUT, &["plan.toml", "cannot be read"]);
    assert_says(&run("--config", &[], &[]), USAGE, &["--config PLAN.toml"]);
}

#[test]
fn messages_are_lines_or_objects_without_colours() {
    let folder = folder();
    let out = folder.path().join("tree.vtu");
    let made = mesh(&fixture("tree_30.swc"), &out, &["--log-format", "json"]);
    assert_code(&made, FINE);
    let lines: Vec<Value> = stderr(&made)
        .lines()
        .map(|line| serde_json::from_str(line).unwrap_or_else(|e| panic!("{e}: {line}")))
        .collect();
    let level = |line: &Value| line["level"].as_str().expect("a level").to_owned();
    assert!(lines.iter().any(|line| level(line) == "note"));
    let result = lines.last().expect("a result");
    assert!(level(result) == "result" && result["message"] == "valid", "{result}");
    let refused = mesh(Path::new("absent.swc"), &out, &["--log-format", "json"]);
    assert_code(&refused, BAD_INPUT);
    let error: Value = serde_json::from_str(stderr(&refused).trim()).expect("an object");
    assert!(level(&error) == "error" && error["message"].as_str().is_some_and(|m| m.contains("absent.swc")));
    // No colours without a terminal.
    assert!(!stderr(&mesh(&fixture("tree_30.swc"), &out, &[])).contains('\u{1b}'));
    assert!(!stdout(&run("mesh", &[], &["--help"])).contains('\u{1b}'));
}

/// `-h` fits on a screen; `--help` groups all options under headings, each at most a screen long.
#[test]
fn help_is_a_screen_or_in_groups() {
    for verb in [
        "mesh",
        "surface",
        "prepare",
        "refine",
        "dual",
        "generate",
        "flow",
        "tetrahedralize",
        "convert",
        "render",
        "view",
        "check",
        "replay",
        "info",
        "completions",
        "man",
    ] {
        let help = |word| {
            let help = program().args([verb, word]).env("COLUMNS", "100").output().expect("the program runs");
            stdout(&help)
        };
        let short = help("-h");
        assert!(short.lines().count() <= 50, "{verb}: {} lines\n{short}", short.lines().count());
        assert!(short.lines().all(|line| line.chars().count() <= 100), "{short}");
        let help = help("--help");
        let groups: Vec<&str> = help.split("\n\n").collect();
        for group in &groups {
            let options = group.lines().filter(|line| line.trim_start().starts_with('-')).count();
            assert!(options <= 22, "{verb}: {options} options in\n{group}");
        }
    }
}

/// `docs/options.md` matches the program's help.
#[test]
fn the_list_of_options_is_that_of_the_program() {
    let said = stdout(&run("man", &[], &["--markdown"]));
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/options.md");
    if std::env::var_os("ANASTOMESH_WRITE_OPTIONS").is_some() {
        fs::write(&path, &said).expect("written");
    }
    let kept = fs::read_to_string(&path).expect("docs/options.md");
    assert!(said == kept, "docs/options.md is old: ANASTOMESH_WRITE_OPTIONS=1 cargo test --test program terminal::");
    assert!(said.contains("## mesh\n") && said.contains("`--rho <RHO>`") && said.contains("| `3` |"));
}

/// Output of a shell command in a pseudo-terminal, without colours; `None` without the program `script`.
fn in_terminal(command: &str) -> Option<String> {
    let mut script = std::process::Command::new("script");
    script.args(["-qefc", command, "/dev/null"]).env("TERM", "xterm").env("PROGRAM", env!("CARGO_BIN_EXE_anastomesh"));
    let made = script.stdin(std::process::Stdio::null()).output().ok()?;
    Some(stdout(&made).replace("\r\n", "\n"))
}

/// Removes control sequences.
fn plain(text: &str) -> String {
    let mut out = String::new();
    let mut chars = text.chars();
    while let Some(c) = chars.next() {
        if c == '\u{1b}' {
            chars.by_ref().find(char::is_ascii_alphabetic);
        } else {
            out.push(c);
        }
    }
    out
}

#[test]
fn lines_wrap_between_words_in_a_terminal_alone() {
    let folder = folder();
    let (tree, out) = (fixture("measured.swc"), folder.path().join("t.vtu"));
    let command = format!("NO_COLOR=1 COLUMNS=50 $PROGRAM mesh {} -o {} 2>&1", tree.display(), out.display());
    let Some(said) = in_terminal(&command) else { return };
    // What follows the last bar; a bar is overwritten in its line.
    let lines: Vec<String> =
        plain(&said).lines().map(|l| l.rsplit('\r').next().unwrap_or_default().to_owned()).collect();
    let at = lines.iter().position(|line| line.starts_with("network ")).unwrap_or_else(|| panic!("{said}"));
    let is_path = |line: &String| line.contains("t.vtu") || line.contains("t_patches.csv");
    assert!(lines[at..].iter().filter(|line| !is_path(line)).all(|line| line.chars().count() <= 50), "{lines:#?}");
    assert!(lines[at..].iter().any(|line| line.starts_with("         ")), "{lines:#?}");
    assert_eq!(lines.last().map(String::as_str), Some("valid"));
    // Without a terminal, no line is broken.
    let made = mesh(&tree, &out, &[]);
    assert!(stderr(&made).lines().any(|line| line.chars().count() > 100));
}

#[test]
fn a_stopped_run_leaves_no_bar() {
    let folder = folder();
    let (tree, out) = (fixture("tree_30.vtp"), folder.path().join("t.vtu"));
    let fine = "--rho 9 --memory 20GiB -j 1";
    let run = format!("$PROGRAM mesh {} -o {} {fine} 2>&1", tree.display(), out.display());
    // The program gets the signal alone, as the shell ignores it.
    let command = format!("NO_COLOR=1 COLUMNS=80; export NO_COLOR COLUMNS; {run} & sleep 0.7; kill -TERM $!; wait $!");
    let Some(said) = in_terminal(&command) else { return };
    if !said.contains("stopping; press Ctrl-C") {
        // The run was over, or had not begun.
        return;
    }
    let (bars, rest) = said.split_once("stopping; press Ctrl-C").expect("both");
    assert!(bars.contains("blocks"), "no bar was shown: {said:?}");
    // The line of the bar is erased before the message, and none is drawn after it.
    assert!(bars.ends_with("\u{1b}[2K") || bars.ends_with("\u{1b}[K") || bars.ends_with('\r'), "{said:?}");
    assert!(!rest.contains('%') && rest.contains("stopped; nothing is kept"), "{said:?}");
}

/// Every message has the correct level, and no message repeats its level in its text.
#[test]
fn levels_of_messages_are_true() {
    let folder = folder();
    let out = folder.path().join("t.vtu");
    let lines = |options: &[&str]| -> Vec<Value> {
        let made = mesh(&fixture("tree_30.swc"), &out, &[options, &["--log-format", "json"]].concat());
        stderr(&made).lines().map(|line| serde_json::from_str(line).expect("an object")).collect()
    };
    let refused = lines(&["--rho", "abc"]);
    let message = refused[0]["message"].as_str().expect("text");
    assert!(refused[0]["level"] == "error" && message.starts_with("invalid value 'abc'"), "{message}");
    assert!(message.contains("expected a number"), "{message}");
    let unfaithful = lines(&["--max-lumen-error", "0.001"]);
    let last = unfaithful.last().expect("a verdict");
    assert!(last["level"] == "error" && last["message"].as_str().is_some_and(|m| m.starts_with("not faithful: ")));
    assert!(unfaithful[..unfaithful.len() - 1].iter().all(|line| line["level"] != "error"), "{unfaithful:?}");
}

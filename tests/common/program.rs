//! Runs the program like a user, and reads its output.

use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

pub const FINE: i32 = 0;
pub const GATE_NOT_MET: i32 = 1;
pub const USAGE: i32 = 2;
pub const BAD_INPUT: i32 = 3;
pub const STAGE_FAILED: i32 = 4;
pub const STOPPED: i32 = 130;

/// Command without arguments.
pub fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_anastomesh"))
}

/// Runs a command with these paths and options.
pub fn run(verb: &str, paths: &[&Path], options: &[&str]) -> Output {
    program().arg(verb).args(paths).args(options).output().expect("the program runs")
}

/// Meshes a network.
pub fn mesh(network: &Path, out: &Path, options: &[&str]) -> Output {
    run("mesh", &[network, Path::new("--output"), out], options)
}

/// Tetrahedralizes a surface.
pub fn fill(surface: &Path, out: &Path, options: &[&str]) -> Output {
    run("tetrahedralize", &[surface, Path::new("--output"), out], options)
}

/// Rows of a table, as maps from columns.
pub fn table(path: &Path) -> Vec<BTreeMap<String, String>> {
    let text = fs::read_to_string(path).expect("a table");
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned));
    let columns: Vec<String> = lines.next().expect("a head").collect();
    lines.map(|row| columns.iter().cloned().zip(row).collect()).collect()
}

/// Number in a row of a table.
pub fn number(row: &BTreeMap<String, String>, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column} of {row:?}"))
}

/// A good vessel, and a bifurcation with a hair too thin to store its wall. As VTP, so that others keep their radius.
pub const HOPELESS: &str = r#"<VTKFile type="PolyData"><PolyData><Piece NumberOfPoints="6" NumberOfLines="4">
<CellData><DataArray type="Float64" Name="EdgeRadius" format="ascii">1 1 1 1e-9</DataArray></CellData>
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">
0 0 0 0 0 9 50 0 0 50 0 6 50 6 0 50 -1.00000001 0</DataArray></Points>
<Lines><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3 2 4 2 5</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">2 4 6 8</DataArray></Lines></Piece></PolyData></VTKFile>"#;

pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("text")
}

pub fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("text")
}

#[track_caller]
pub fn assert_code(output: &Output, expected: i32) {
    let out = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(expected), "{out}\n{}", stderr(output));
}

/// Asserts the exit code and words of the message.
#[track_caller]
pub fn assert_says(output: &Output, code: i32, words: &[&str]) {
    assert_code(output, code);
    let text = stderr(output);
    for word in words {
        assert!(text.contains(word), "'{word}' in: {text}");
    }
}

/// Asserts a single message with the path and all of `needles`.
#[track_caller]
pub fn assert_message(output: &Output, path: &Path, needles: &[&str]) {
    let said = stderr(output);
    assert_eq!(said.lines().count(), 1, "{said}");
    assert!(said.starts_with(&format!("anastomesh: {}: ", path.display())), "{said}");
    for needle in needles {
        assert!(said.contains(needle), "'{needle}' is not in: {said}");
    }
    assert!(output.stdout.is_empty(), "{}", stdout(output));
}

/// Parses the `--json` output.
#[track_caller]
pub fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {}\n{}", stdout(output), stderr(output)))
}

pub fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// Names of the files in a folder.
pub fn entries(folder: &Path) -> Vec<String> {
    let list = fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> =
        list.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort_unstable();
    names
}

/// Prepared `tetrahedralize` command.
pub fn command(input: &Path, out: Option<&Path>, options: &[&str]) -> Command {
    let mut command = program();
    command.arg("tetrahedralize").arg(input);
    if let Some(out) = out {
        command.arg("--output").arg(out);
    }
    command.args(options);
    command
}

/// Report of a successful run.
#[track_caller]
pub fn report(input: &Path, out: &Path, options: &[&str]) -> Value {
    let mut all = vec!["--json"];
    all.extend(options);
    let output = fill(input, out, &all);
    assert_code(&output, FINE);
    assert!(output.stderr.is_empty(), "{}", stderr(&output));
    json(&output)
}

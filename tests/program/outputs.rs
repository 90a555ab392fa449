//! Runs with several output files: all appear, or all earlier files stay.

use crate::common::fixture;
use crate::common::oracle::missing;
use crate::common::program::*;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output};

/// Options for a mesh with three files beside it.
const OPTIONS: [&str; 7] = ["-q", "-o", "a.vtu", "--certificate", "a.json", "--report", "r.html"];

/// Contents of all files in a folder.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let read = |name: String| (name.clone(), fs::read(folder.join(name)).expect("a file"));
    entries(folder).into_iter().map(read).collect()
}

/// Runs a command that meshes a network in a folder.
fn run_in(folder: &Path, mut command: Command, network: &str, options: &[&str]) -> std::io::Result<Output> {
    command.current_dir(folder).arg("mesh").arg(fixture(network)).args(options).output()
}

/// The folder of the mesh takes the path of the report, which was free before.
#[test]
fn an_output_that_cannot_be_moved_leaves_no_other() {
    let folder = folder();
    fs::write(folder.path().join("r_patches.csv"), "earlier").expect("written");
    let options = ["-q", "--format", "npy", "-o", "r.html", "--report", "r.html"];
    let refused = run_in(folder.path(), program(), "tree_30.vtp", &options).expect("the program runs");
    assert_says(&refused, BAD_INPUT, &["r.html: cannot be written"]);
    assert_eq!(files(folder.path()), BTreeMap::from([("r_patches.csv".to_owned(), b"earlier".to_vec())]));
}

/// Each move fails once, by fault injection of strace.
#[test]
fn a_failed_move_leaves_all_earlier_files() {
    let folder = folder();
    let made = run_in(folder.path(), program(), "crotch.vtp", &OPTIONS).expect("the program runs");
    assert_code(&made, FINE);
    let earlier = files(folder.path());
    assert_eq!(earlier.keys().collect::<Vec<_>>(), ["a.json", "a.vtu", "a_patches.csv", "r.html"]);
    for (number, name) in (1..).zip(["a.vtu", "a_patches.csv", "a.json", "r.html"]) {
        let mut strace = Command::new("strace");
        let inject = format!("inject=rename,renameat,renameat2:error=EIO:when={number}");
        strace.args(["-f", "-qq", "-o", "/dev/null", "-e", &inject, "--"]).arg(program().get_program());
        let Ok(done) = run_in(folder.path(), strace, "tree_30.vtp", &OPTIONS) else {
            return missing("strace is not there (apt-get install strace)");
        };
        if stderr(&done).contains("ptrace") {
            return missing("strace is not permitted to trace");
        }
        assert_says(&done, BAD_INPUT, &[name, "cannot be written: Input/output error"]);
        assert_eq!(files(folder.path()), earlier);
    }
    let made = run_in(folder.path(), program(), "tree_30.vtp", &OPTIONS).expect("the program runs");
    assert_code(&made, FINE);
    let new = files(folder.path());
    assert!(new.keys().eq(earlier.keys()) && new.iter().all(|(name, bytes)| earlier[name] != *bytes));
}

//! README and documentation: commands run, outputs and pictures are up to date, links lead somewhere (`docs/run --help`).

use crate::common::oracle;
use std::path::Path;
use std::process::{Command, Output};

/// Output of `docs/run`; `None` with a note without Python and bash.
fn run(arguments: &[&str]) -> Option<Output> {
    let present = |program: &str| Command::new(program).arg("--version").output().is_ok_and(|out| out.status.success());
    if cfg!(windows) || !present("python3") || !present("bash") {
        oracle::missing("python3 or bash is not installed");
        return None;
    }
    let program = Path::new(env!("CARGO_BIN_EXE_anastomesh")).parent().expect("a folder").to_owned();
    let path = std::env::var_os("PATH").unwrap_or_default();
    let folders = std::iter::once(program).chain(std::env::split_paths(&path));
    let mut command = Command::new("python3");
    command.arg("docs/run").args(arguments).current_dir(env!("CARGO_MANIFEST_DIR"));
    command.env("PATH", std::env::join_paths(folders).expect("a path"));
    Some(command.output().expect("python3 runs"))
}

fn assert_current(pages: &[&str]) {
    // The test's program is not optimised, so times are not compared.
    let Some(done) = run(&[&["--check", "--any-times"], pages].concat()) else { return };
    let (printed, errors) = (String::from_utf8_lossy(&done.stdout), String::from_utf8_lossy(&done.stderr));
    assert!(done.status.success(), "{printed}{errors}\n`docs/run --write` updates outputs and pictures");
    eprint!("{errors}");
}

#[test]
fn readme_is_current() {
    assert_current(&["README.md"]);
}

#[test]
fn guides_are_current() {
    let names =
        ["cluster", "formats", "install", "meshing", "method", "networks", "pictures", "scaling", "tetrahedralize"];
    let pages = names.map(|name| format!("docs/{name}.md"));
    assert_current(&pages.each_ref().map(String::as_str));
}

#[test]
fn flow_and_tutorials_are_current() {
    assert_current(&["docs/flow.md", "docs/tutorials/measured.md", "docs/tutorials/organ.md"]);
}

#[test]
fn links_lead_to_files_and_headings() {
    let Some(done) = run(&["--links"]) else { return };
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stdout));
}

/// A page with a wrong word, a wrong number, a wrong exit code and a broken link.
#[test]
fn differences_are_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let page = folder.path().join("page.md");
    let text = "\
        <!-- run -->\n```sh\necho 100 cells, 3 s\n```\n\n<!-- output -->\n```text\n101 cells, 2 s\n```\n\
        <!-- output -->\n```text\n103 cells, 3 s\n```\n<!-- output -->\n```text\n100 points, 3 s\n```\n\
        <!-- run -->\n```sh\nexit 3\n```\n```sh\necho\n```\n\n![none](none.png)\n[broken](none.md)\n";
    std::fs::write(&page, text).expect("a page");
    let page = page.to_str().expect("text");
    let Some(done) = run(&["--check", "--any-times", page]) else { return };
    let printed = String::from_utf8_lossy(&done.stdout);
    let lines =
        [":12: output differs", ":16: output differs", ":20: exit code 3", ":23: shell block", ":26: no command"];
    for line in lines {
        assert!(printed.contains(line), "{line}: {printed}");
    }
    assert!(printed.contains(&format!("faults: {},", lines.len())), "{printed}");
    let linked = run(&["--links", page]).expect("Python is installed");
    assert!(String::from_utf8_lossy(&linked.stdout).contains(":27: none.md: no such file"));
}

//! Regions around a lumen on the command line.

mod common;

use common::program::{assert_code, folder, program, stderr, stdout};
use common::surfaces::text;
use std::path::{Path, PathBuf};
use std::process::Output;

/// Three vessels at a fork.
const FORK: &str = "1 1 0 0 0 1 -1\n2 1 0 0 10 1 1\n3 1 6 0 16 1 2\n4 1 -6 0 16 1 2\n";

fn mesh(network: &Path, out: &Path, options: &[&str]) -> Output {
    common::program::mesh(network, out, options)
}

fn check(file: &Path) -> Output {
    program().arg("check").arg(file).output().expect("the program runs")
}

fn fork(folder: &tempfile::TempDir) -> PathBuf {
    text(folder, "fork.swc", FORK)
}

#[test]
fn wall_and_tissue_are_valid_regions() {
    let folder = folder();
    let network = fork(&folder);
    let out = folder.path().join("organ.vtu");
    let done = mesh(&network, &out, &["--wall", "0.2r", "--annulus", "0.1r:1", "--tissue", "box", "--split-regions"]);
    assert_code(&done, 0);
    let said = stderr(&done) + &stdout(&done);
    for row in ["lumen: ", "wall: ", "annulus: ", "tissue: ", "full thickness at ", "organ_annulus.vtu"] {
        assert!(said.contains(row), "{row}\n{said}");
    }
    let whole = check(&out);
    assert_code(&whole, 0);
    assert!(stdout(&whole).ends_with("valid\n"), "{}", stdout(&whole));
    for region in ["lumen", "wall", "annulus", "tissue"] {
        assert_code(&check(&folder.path().join(format!("organ_{region}.vtu"))), 0);
    }
}

#[test]
fn tissue_alone_has_the_vessels_as_holes() {
    let folder = folder();
    let network = fork(&folder);
    let out = folder.path().join("tissue.msh");
    assert_code(&mesh(&network, &out, &["--tissue", "box:8", "--tissue-growth", "2", "--without", "lumen"]), 0);
    let checked = check(&out);
    assert_code(&checked, 0);
    assert!(stdout(&checked).contains("tissue: ") && !stdout(&checked).contains("lumen: "));
}

#[test]
fn regions_that_cannot_be_made_are_refused() {
    let folder = folder();
    let network = fork(&folder);
    let out = folder.path().join("x.vtu");
    let small =
        text(&folder, "small.off", "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n");
    let open = text(&folder, "open.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 2 1\n");
    let cases: [(&[&str], i32, &str); 8] = [
        (&["--wall", "thick"], 3, "thick"),
        (&["--wall", "0.2q"], 2, "unknown unit"),
        (&["--wall", "5um"], 2, "--units"),
        (&["--wall", "-0.1r"], 2, "invalid thickness of wall"),
        (&["--wall", "0.1r", "--without", "walls"], 2, "no region is called 'walls'"),
        (&["--split-regions"], 2, "needs several regions"),
        (&["--tissue", small.to_str().expect("text")], 3, "outside the surface around the tissue"),
        (&["--tissue", open.to_str().expect("text")], 3, "cannot be filled"),
    ];
    for (options, code, needle) in cases {
        let done = mesh(&network, &out, options);
        assert_code(&done, code);
        assert!(stderr(&done).contains(needle), "{options:?}: {}", stderr(&done));
        assert!(!out.exists(), "{options:?}");
    }
}

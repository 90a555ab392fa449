//! Tests of networks larger than memory: blocks on disk, interrupted and continued runs, and early rejections.

use crate::common::program::{BAD_INPUT, FINE, USAGE, assert_code, assert_says, program};
use crate::common::{fixture, shared};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

fn command(network: &Path, out: &Path, options: &[&str]) -> Command {
    let mut command = program();
    command.arg("mesh").arg(network).arg("-o").arg(out).arg("-q").args(options);
    command
}

fn run(network: &Path, out: &Path, options: &[&str]) -> Output {
    command(network, out, options).output().expect("the program runs")
}

/// The fixture, or a larger network if available.
fn network() -> PathBuf {
    shared().map_or_else(|| fixture("tree_30.vtp"), |shared| shared.join("data/kidney/subtree_289_clear.vtp"))
}

/// Current size of a file in bytes.
fn length(path: &Path) -> u64 {
    fs::metadata(path).map_or(0, |m| m.len())
}

#[test]
fn bytes_do_not_depend_on_memory_threads_or_where_blocks_are() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    assert_code(&run(&network(), &path("a.vtu"), &[]), FINE);
    let whole = fs::read(path("a.vtu")).expect("a mesh");
    let work = path("work").display().to_string();
    for options in [&["--memory", "48MiB"][..], &["--work-dir", &work, "-j", "1"], &["--work-dir", &work, "-j", "3"]] {
        assert_code(&run(&network(), &path("b.vtu"), options), FINE);
        assert!(fs::read(path("b.vtu")).expect("a mesh") == whole, "{options:?}");
    }
    let mut names: Vec<_> =
        fs::read_dir(folder.path()).expect("a folder").map(|e| e.expect("an entry").file_name()).collect();
    names.sort_unstable();
    assert_eq!(names, ["a.vtu", "a_patches.csv", "b.vtu", "b_patches.csv", "work"]);
}

/// Kills a run once its blocks have grown to `bytes`; returns false if it ended before.
fn kill_at(mut child: Child, blocks: &Path, bytes: u64) -> bool {
    loop {
        if child.try_wait().expect("a child").is_some() {
            return false;
        }
        if length(blocks) >= bytes {
            child.kill().expect("killed");
            child.wait().expect("gone");
            return true;
        }
        std::thread::sleep(Duration::from_micros(300));
    }
}

/// Kills `runs` runs at different progress, then completes one and compares its bytes with an undisturbed run. Returns
/// the number of killed runs.
fn killed(network: &Path, options: &[&str], runs: u64) -> u32 {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let (work, blocks) = (path("work").display().to_string(), path("work").join("anastomesh.blocks"));
    let options = &[options, &["--work-dir", &work, "-j", "2"]].concat();
    assert_code(&run(network, &path("a.vtu"), options), FINE);
    let (whole, all) = (fs::read(path("a.vtu")).expect("a mesh"), length(&blocks));
    fs::remove_dir_all(path("work")).expect("removed");
    let mut killed = 0;
    for step in 0..runs {
        let child = command(network, &path("b.vtu"), options).stderr(Stdio::null()).spawn().expect("the program runs");
        // Sometimes before the first block, during the check, or during output.
        killed += u32::from(kill_at(child, &blocks, all * step * 10 / (9 * runs)));
        assert!(!path("b.vtu").exists() || fs::read(path("b.vtu")).expect("a mesh") == whole, "{options:?}");
    }
    assert_code(&run(network, &path("b.vtu"), options), FINE);
    assert!(fs::read(path("b.vtu")).expect("a mesh") == whole, "{options:?}");
    killed
}

#[test]
fn killed_at_any_moment_it_goes_on_and_ends_with_the_same_bytes() {
    let killed = killed(&network(), &[], 20);
    assert!(killed >= 15, "{killed} kills");
}

#[test]
fn killed_with_any_sizes_it_goes_on_and_ends_with_the_same_bytes() {
    for options in [["--stretch", "4"], ["--layers", "2"], ["--core", "2"], ["--size-at", "0.5"]] {
        let killed = killed(&fixture("tree_30.vtp"), &options, 6);
        assert!(killed >= 3, "{killed} kills with {options:?}");
    }
}

#[test]
fn a_work_directory_belongs_to_one_network_and_its_options() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let work = path("work").display().to_string();
    let tree = fixture("tree_30.vtp");
    assert_code(&run(&tree, &path("a.vtu"), &["--work-dir", &work]), FINE);
    let before = fs::read(path("a.vtu")).expect("a mesh");
    let other = run(&tree, &path("a.vtu"), &["--work-dir", &work, "--rho", "4"]);
    assert_says(&other, BAD_INPUT, &["mesh.rho was 3.0, now 4.0", "--restart"]);
    assert_says(
        &run(&fixture("tree_30.swc"), &path("b.vtu"), &["--work-dir", &work, "--root", "30"]),
        BAD_INPUT,
        &["another"],
    );
    assert!(fs::read(path("a.vtu")).expect("a mesh") == before && !path("b.vtu").exists());
    assert_code(&run(&tree, &path("a.vtu"), &["--work-dir", &work, "--rho", "4", "--restart"]), FINE);
    fs::write(path("work").join("anastomesh.json"), "{\"format\": 0}").expect("written");
    assert_says(&run(&tree, &path("a.vtu"), &["--work-dir", &work]), BAD_INPUT, &["another version"]);
    assert_says(&run(&tree, &path("a.vtu"), &["--restart"]), USAGE, &["--work-dir"]);
}

#[test]
fn two_runs_do_not_share_a_work_directory() {
    let folder = tempfile::tempdir().expect("a folder");
    let work = folder.path().join("work");
    let tree = fixture("tree_30.vtp");
    let options = ["--work-dir", work.to_str().expect("text")];
    assert_code(&run(&tree, &folder.path().join("a.vtu"), &options), FINE);
    let lock = fs::File::options().write(true).open(work.join("anastomesh.lock")).expect("a lock");
    lock.lock().expect("locked");
    assert_says(&run(&tree, &folder.path().join("b.vtu"), &options), BAD_INPUT, &["another run"]);
    drop(lock);
    assert_code(&run(&tree, &folder.path().join("b.vtu"), &options), FINE);
}

#[test]
fn what_cannot_fit_is_refused_with_an_estimate_and_touches_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("a.vtu");
    fs::write(&out, "an earlier mesh").expect("written");
    let tree = fixture("tree_30.vtp");
    let small = run(&tree, &out, &["--memory", "1MiB"]);
    assert_says(&small, BAD_INPUT, &["the largest block", "more than the limit of 1.0 MiB", "--memory"]);
    assert_says(&run(&tree, &out, &["--rho", "1000"]), BAD_INPUT, &["tetrahedra", "TiB", "--rho"]);
    assert_says(&run(&tree, &out, &["--rho", "1000", "--memory", "1000TiB"]), BAD_INPUT, &["has ", " free ("]);
    assert_says(
        &run(&tree, &out, &["--joint", "woven", "--memory", "1MiB"]),
        BAD_INPUT,
        &["need the whole mesh in memory", "--joint disc"],
    );
    let regions = ["--wall", "0.2r", "--tissue", "box", "--memory", "12MiB"];
    assert_says(&run(&tree, &out, &regions), BAD_INPUT, &["regions around the lumen need", "12.0 MiB", "--memory"]);
    for rho in ["0", "-3", "nan", "inf"] {
        assert_says(&run(&tree, &out, &["--rho", rho]), USAGE, &["rho"]);
    }
    for memory in ["0GiB", "2", "much"] {
        assert_code(&run(&tree, &out, &["--memory", memory]), USAGE);
    }
    assert_eq!(fs::read(&out).expect("there"), b"an earlier mesh");
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 1);
}

/// A device on which every write fails like on a full disk.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error_that_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let work = folder.path().join("work");
    let tree = fixture("tree_30.vtp");
    let options = ["--work-dir", work.to_str().expect("text")];
    fs::create_dir(&work).expect("a folder");
    std::os::unix::fs::symlink("/dev/full", work.join("anastomesh.blocks")).expect("a link");
    fs::write(folder.path().join("a.vtu"), "an earlier mesh").expect("written");
    // Files without a manifest are removed, so the manifest must exist first.
    let first = folder.path().join("first");
    assert_code(&run(&tree, &folder.path().join("b.vtu"), &["--work-dir", first.to_str().expect("text")]), FINE);
    fs::copy(first.join("anastomesh.json"), work.join("anastomesh.json")).expect("copied");
    let full = run(&tree, &folder.path().join("a.vtu"), &options);
    assert_says(&full, BAD_INPUT, &["cannot be written", "free some space", "--work-dir"]);
    assert_eq!(fs::read(folder.path().join("a.vtu")).expect("there"), b"an earlier mesh");
}

/// Report of `check`, without quality figures (blockwise percentiles have bin precision).
fn checked(mesh: &Path, options: &[&str]) -> (i32, serde_json::Value) {
    let output = program().arg("check").arg(mesh).arg("--json").args(options).output().expect("the program runs");
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    let mut report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    report["quality"] = serde_json::Value::Null;
    report["counts"]["volume"] = serde_json::Value::Null;
    (output.status.code().expect("an exit code"), report)
}

#[test]
fn a_file_is_checked_block_by_block_as_in_memory() {
    let folder = tempfile::tempdir().expect("a folder");
    let mesh = folder.path().join("a.vtu");
    assert_code(&run(&network(), &mesh, &[]), FINE);
    let (code, whole) = checked(&mesh, &[]);
    assert_eq!((code, whole["verdict"].as_str()), (FINE, Some("valid")));
    assert_eq!(checked(&mesh, &["--memory", "1MiB"]), (code, whole));
}

/// Twelve refined vessels of a grown kidney (250,000 terminals, seed 0). The web in the crotch of a thick bifurcation
/// intersects a thin vessel (here 2.2 times as wide) that overlaps neither branch. Blocks do not know other blocks'
/// vessels. The whole-mesh check finds it, and the bifurcation is remeshed finer.
#[test]
fn a_thin_vessel_runs_through_the_crotch_of_a_thick_fork() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let work = path("work").display().to_string();
    let output = run(&fixture("crotch.vtp"), &path("a.vtu"), &["--json"]);
    assert_code(&output, FINE);
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let retries = report["run"]["retries"].as_array().expect("a list");
    let reasons: Vec<_> = retries.iter().filter_map(|retry| retry["reason"].as_str()).collect();
    assert!(matches!(reasons[..], [reason] if reason.starts_with("its wall meets that of")), "{retries:#?}");
    let expected = fs::read(path("a.vtu")).expect("a mesh");
    // A run with finished blocks also finds the remeshed ones.
    for options in [["--work-dir", &work, "-j", "1"], ["--work-dir", &work, "-j", "3"]] {
        assert_code(&run(&fixture("crotch.vtp"), &path("b.vtu"), &options), FINE);
        assert!(fs::read(path("b.vtu")).expect("a mesh") == expected, "{options:?}");
    }
}

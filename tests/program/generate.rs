//! Command line tests of `generate`, and of other commands on its networks.

use crate::common::program::{json, program};
use serde_json::Value;
use std::path::Path;
use std::process::Output;

fn run(arguments: &[&str], output: &Path) -> Output {
    program().args(arguments).arg(output).output().expect("the program runs")
}

#[test]
fn the_same_seed_gives_the_same_file() {
    let folder = tempfile::tempdir().unwrap();
    let grow = |name: &str, seed: &str, threads: &str| {
        let path = folder.path().join(name);
        let done = run(&["generate", "--terminals", "3000", "--seed", seed, "-j", threads, "-q", "-o"], &path);
        assert!(done.status.success() && done.stdout.is_empty() && done.stderr.is_empty(), "{done:?}");
        std::fs::read(path).unwrap()
    };
    let first = grow("a.vtp", "7", "1");
    assert!(first == grow("b.vtp", "7", "2"));
    assert!(first != grow("c.vtp", "8", "2"));
}

#[test]
fn a_grown_network_is_read_and_refined() {
    let folder = tempfile::tempdir().unwrap();
    for organ in ["kidney", "ellipsoid"] {
        let path = folder.path().join("net.vtp");
        let grown = json(&run(&["generate", "--terminals", "3000", "--organ", organ, "--json", "-o"], &path));
        assert_eq!(grown["parameters"]["organ"], organ);
        assert_eq!(grown["morphometry"]["orders"][0]["count"], 3000);
        let info = json(&run(&["info", "--json"], &path));
        assert_eq!((&info["nodes"], &info["terminals"]), (&grown["nodes"], &Value::from(3001)));
        assert_eq!((&info["components"], &info["loops"]), (&Value::from(1), &Value::from(0)));
        assert_eq!(info["radius"]["max"], grown["root_radius"]);
        let refined = program()
            .args(["refine", "--json"])
            .arg(&path)
            .arg("-o")
            .arg(folder.path().join("refined.vtp"))
            .output()
            .unwrap();
        assert_eq!(refined.status.code(), Some(0), "{refined:?}");
        let result = &json(&refined)["report"]["result"];
        assert_eq!(result["overlaps"], 0);
        let cuttable = &result["metrics"]["cuttable"];
        let share = cuttable["count"].as_f64().unwrap_or(f64::NAN) / cuttable["of"].as_f64().unwrap_or(f64::NAN);
        assert!(share >= 0.97, "{organ}: {cuttable}");
    }
}

#[test]
fn an_swc_file_holds_the_same_nodes() {
    let folder = tempfile::tempdir().unwrap();
    let info = |name: &str| {
        let path = folder.path().join(name);
        assert!(run(&["generate", "--terminals", "200", "-q", "-o"], &path).status.success());
        json(&run(&["info", "--json"], &path))
    };
    let (vtp, swc) = (info("net.vtp"), info("net.swc"));
    for same in ["nodes", "edges", "terminals", "components", "edge_length"] {
        assert_eq!(vtp[same], swc[same]);
    }
    assert_eq!(vtp["radius"]["max"], swc["radius"]["max"]);
}

#[test]
fn what_cannot_be_grown_is_a_usage_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("net.vtp");
    for (arguments, says) in [
        (&["--terminals", "1"][..], "1 terminals: give 2 to"),
        (&["--terminals", "-5"], "invalid value"),
        (&["--terminals", "100", "--size", "100"], "do not fit"),
        (&["--terminals", "100", "--size", "nan"], "size NaN"),
        (&["--terminals", "100", "--terminal-radius", "-1"], "terminal radius -1"),
        (&["--terminals", "100", "--exponent", "0"], "exponent 0"),
        (&["--terminals", "100", "--organ", "heart"], "invalid value"),
        (&[], "--terminals"),
    ] {
        let refused = run(&[&["generate"], arguments, &["-o"]].concat(), &path);
        let text = String::from_utf8_lossy(&refused.stderr);
        assert!(refused.status.code() == Some(2) && text.contains(says), "{arguments:?}: {text}");
        assert!(!path.exists());
    }
    let refused = run(&["generate", "--terminals", "100", "-o"], &folder.path().join("net.obj"));
    assert_eq!(refused.status.code(), Some(3));
}

#[test]
fn capillaries_close_arteries_and_veins_to_loops() {
    let folder = tempfile::tempdir().unwrap();
    let grow = |name: &str, more: &[&str]| {
        let path = folder.path().join(name);
        let base = ["generate", "--terminals", "60", "--organ", "ellipsoid", "--capillaries", "--json"];
        (run(&[&base[..], more, &["-o"]].concat(), &path), path)
    };
    let (done, path) = grow("bed.vtp", &[]);
    let grown = json(&done);
    let info = json(&run(&["info", "--json"], &path));
    assert_eq!(
        (&info["nodes"], &info["edges"], &info["components"]),
        (&grown["nodes"], &grown["edges"], &Value::from(1))
    );
    assert!(info["loops"].as_u64() > Some(200), "{info}");
    assert!(grow("swc.swc", &[]).0.status.code() == Some(3));
    assert!(grow("thick.vtp", &["--capillary-radius", "9"]).0.status.code() == Some(2));
    let kidney = run(&["generate", "--terminals", "60", "--capillaries", "-o"], &folder.path().join("kidney.vtp"));
    assert_eq!(kidney.status.code(), Some(2));
}

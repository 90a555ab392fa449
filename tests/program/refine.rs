//! Command line tests of `refine`, `dual` and `mesh --refine`: files, reports, exit codes.

use crate::common::fixture;
use crate::common::program::{json, program};
use std::path::Path;
use std::process::Output;

fn run(arguments: &[&str], paths: &[(&str, &Path)]) -> Output {
    let mut command = program();
    command.args(arguments);
    for (option, path) in paths {
        if option.is_empty() {
            command.arg(path)
        } else {
            command.arg(option).arg(path)
        };
    }
    command.output().expect("the program runs")
}

/// Two bifurcations whose trunks cross at a point, each with its own terminals.
const CROSSING: &str = "1 0 -20 0 0 1 -1\n2 0 20 0 0 1 1\n3 0 30 10 0 1 2\n4 0 30 -10 0 1 2\n\
                        5 0 0 -20 0 1 -1\n6 0 0 20 0 1 5\n7 0 10 30 5 1 6\n8 0 -10 30 5 1 6\n";

#[test]
fn a_network_that_overlaps_is_refined_and_has_a_valid_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("net.swc"), CROSSING).unwrap();
    let as_it_is = run(&["mesh", "-q"], &[("", &at("net.swc")), ("-o", &at("bad.vtu"))]);
    assert_eq!(as_it_is.status.code(), Some(1));
    let refined = run(
        &["refine", "--json"],
        &[("", &at("net.swc")), ("-o", &at("out.vtp")), ("--metrics", &at("metrics.csv")), ("--plot", &at("plot.svg"))],
    );
    assert_eq!(refined.status.code(), Some(0), "{refined:?}");
    let report = &json(&refined)["report"];
    assert!(report["given"]["overlaps"].as_u64() > Some(0));
    assert_eq!(report["result"]["overlaps"], 0);
    let table = std::fs::read_to_string(at("metrics.csv")).unwrap();
    let columns: Vec<usize> = table.lines().map(|l| l.split(',').count()).collect();
    assert!(columns.len() > 1 && columns.iter().all(|&c| c == columns[0]), "{table}");
    assert!(std::fs::read_to_string(at("plot.svg")).unwrap().ends_with("</svg>\n"));
    // The output is read back, with its radii and without overlaps.
    let info = json(&run(&["info", "--json"], &[("", &at("out.vtp"))]));
    assert_eq!(info["overlaps"]["pairs"].as_array().map(Vec::len), Some(0));
    assert_eq!((info["radius"]["min"].as_f64(), info["radius"]["max"].as_f64()), (Some(1.0), Some(1.0)));
    assert_eq!(info["metrics"]["cuttable"]["of"], report["result"]["metrics"]["cuttable"]["of"]);
    let both = run(
        &["mesh", "--refine", "--json"],
        &[("--refined", &at("again.vtp")), ("", &at("net.swc")), ("-o", &at("good.vtu"))],
    );
    assert_eq!(both.status.code(), Some(0), "{}", String::from_utf8_lossy(&both.stderr));
    assert_eq!(json(&both)["refine"]["result"]["overlaps"], 0);
    // The network of the mesh has no overlaps either. Few overlaps are removed locally, so it is not that of `refine`.
    let info = json(&run(&["info", "--json"], &[("", &at("again.vtp"))]));
    assert_eq!(info["overlaps"]["pairs"].as_array().map(Vec::len), Some(0));
}

#[test]
fn a_second_tree_is_grown_and_separated() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let grown = json(&run(&["dual", "--json"], &[("", &fixture("tree_30.swc")), ("-o", &at("dual.vtp"))]));
    assert!(grown["shared_terminals"].as_u64() > Some(5), "{grown}");
    let info = json(&run(&["info", "--json"], &[("", &at("dual.vtp"))]));
    assert_eq!(info["loops"].as_u64().map(|n| n + 1), grown["shared_terminals"].as_u64());
    let refined = run(&["refine", "-q"], &[("", &at("dual.vtp")), ("-o", &at("apart.vtp"))]);
    assert_eq!(refined.status.code(), Some(0), "{}", String::from_utf8_lossy(&refined.stderr));
}

#[test]
fn what_makes_no_sense_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(at("net.swc"), CROSSING).unwrap();
    let refused = |arguments: &[&str], out: &str, code: i32, needle: &str| {
        let output = run(&[&["refine"], arguments].concat(), &[("", &at("net.swc")), ("-o", &at(out))]);
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{text}");
        assert!(text.contains(needle), "{text}");
        assert!(!at(out).exists());
    };
    refused(&["--clearance", "0.5"], "a.vtp", 2, "clearance");
    refused(&["--clearance", "nan"], "a.vtp", 2, "clearance");
    refused(&["--barrier-rate", "-1"], "a.vtp", 2, "barrier rate");
    refused(&["--hold", "nothing"], "a.vtp", 2, "equation11");
    refused(&["--iterations", "many"], "a.vtp", 2, "iterations");
    refused(&[], "a.swc", 3, "vtp");
}

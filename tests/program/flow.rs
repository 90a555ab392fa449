//! Command line tests of `flow`: one-dimensional solutions, models for other solvers, and results along vessels.

use crate::common::oracle;
use crate::common::program::{
    BAD_INPUT, FINE, USAGE, assert_code, assert_says, entries, folder, json, mesh, number, run, stderr, table,
};
use std::fs;
use std::path::Path;
use std::process::Command;

/// A vessel of radius 2 with branches of 1.6, 1.2 and 0.8; nodes are numbered from 5.
const FORKS: &str = "5 0 0 0 0 2 -1\n6 0 0 0 40 2 5\n7 0 0 30 70 1.6 6\n8 0 0 -30 70 1.6 6\n9 0 20 50 110 1.2 7\n\
                     10 0 -20 50 110 0.8 7\n";
/// Flow at a Reynolds number of 1.
const FLUID: &[&str] = &["--inflow", "3", "--viscosity", "1", "--density", "1"];
/// A bifurcation of two lengths, with a bend in the trunk.
const FORK: &str = "1 0 0 0 0 1 -1\n2 0 0 0 5 1 1\n3 0 0 0 10 1 2\n4 0 6 0 18 0.8 3\n5 0 -5 0 19 0.7 3\n";

fn write(folder: &Path, name: &str, text: &str) -> std::path::PathBuf {
    let path = folder.join(name);
    fs::write(&path, text).expect("a file");
    path
}

/// Runs `flow` on a network.
fn flow(network: &Path, out: &Path, options: &[&str]) -> std::process::Output {
    run("flow", &[network], &[&["-o", out.to_str().expect("a path")], options].concat())
}

#[test]
fn the_table_is_that_of_the_mesh() {
    let folder = folder();
    let network = write(folder.path(), "forks.swc", FORKS);
    let at = |name: &str| folder.path().join(name);
    let found = flow(&network, &at("flow.csv"), &[FLUID, &["--json"]].concat());
    assert_code(&found, FINE);
    let report = json(&found);
    assert_eq!((report["vessels"].as_u64(), report["outlets"].as_u64()), (Some(5), Some(3)));
    assert_code(&mesh(&network, &at("forks.vtu"), FLUID), FINE);
    let rows = table(&at("flow.csv"));
    assert_eq!(rows[0]["start"], "5");
    for cap in table(&at("forks_patches.csv")) {
        let row = rows.iter().find(|row| row["start"] == cap["node"] || row["end"] == cap["node"]).expect("a vessel");
        assert!((number(row, "flow") / number(&cap, "flow") - 1.0).abs() < 1e-10, "{row:?} {cap:?}");
    }
    let drop = number(&rows[0], "pressure_start") - number(&rows[0], "pressure_end");
    assert!((drop / (number(&rows[0], "resistance") * 3.0) - 1.0).abs() < 1e-12);
}

#[test]
fn models_and_networks_are_read_as_the_network() {
    let folder = folder();
    let network = write(folder.path(), "forks.swc", FORKS);
    for name in ["model.json", "model.in", "flow.vtp"] {
        let out = folder.path().join(name);
        assert_code(&flow(&network, &out, &[FLUID, &["--stiffness", "2e6,-2,1e5"]].concat()), FINE);
        let info = json(&run("info", &[&out], &["--json"]));
        assert_eq!((info["nodes"].as_u64(), info["edges"].as_u64()), (Some(6), Some(5)), "{name}: {info}");
    }
    assert_eq!(entries(folder.path()), ["flow.vtp", "forks.swc", "model.in", "model.json"]);
    let model: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("model.json")).unwrap()).unwrap();
    assert!(model["vessels"][0]["zero_d_element_values"]["C"].as_f64() > Some(0.0));
    assert_eq!(model["boundary_conditions"].as_array().map(Vec::len), Some(4));
    let text = fs::read_to_string(folder.path().join("model.in")).unwrap();
    assert!(text.contains("\nMATERIAL WALL OLUFSEN 1.0 1.0 0.0 2.0 2000000.0 -2.0 100000.0\n"), "{text}");
    assert_eq!(text.matches("\nJOINT J").count(), 2);
}

#[test]
fn outlet_models_and_waveforms_are_in_the_models() {
    let folder = folder();
    let network = write(folder.path(), "forks.swc", FORKS);
    let wave = write(folder.path(), "wave.csv", "time,flow\n0,1\n0.4,3\n1,1\n");
    let options = [
        "--viscosity",
        "1",
        "--density",
        "1",
        "--inflow",
        wave.to_str().unwrap(),
        "--outlet-model",
        "rcr",
        "--total-resistance",
        "7",
        "--outlet-time-constant",
        "1.5",
    ];
    let [zero, one] = ["model.json", "model.in"].map(|name| {
        assert_code(&flow(&network, &folder.path().join(name), &options), FINE);
        fs::read_to_string(folder.path().join(name)).unwrap()
    });
    let model: serde_json::Value = serde_json::from_str(&zero).unwrap();
    let conditions = model["boundary_conditions"].as_array().unwrap();
    let flows: Vec<_> = conditions.iter().filter(|condition| condition["bc_type"] == "FLOW").collect();
    assert_eq!((flows.len(), &flows[0]["bc_values"]["Q"]), (1, &serde_json::json!([1.0, 3.0, 1.0])));
    let conductance: f64 = conditions
        .iter()
        .filter(|condition| condition["bc_type"] == "RCR")
        .map(|condition| {
            ["Rp", "Rd"].map(|key| condition["bc_values"][key].as_f64().unwrap()).iter().sum::<f64>().recip()
        })
        .sum();
    assert!((conductance * 7.0 - 1.0).abs() < 1e-12, "{conductance}");
    assert!(one.contains("DATATABLE INFLOW LIST\n0.0 1.0\n0.4 3.0\n1.0 1.0\nENDDATATABLE"), "{one}");
    assert_eq!(one.lines().filter(|line| line.starts_with("SEGMENT") && line.contains(" RCR OUTLET_")).count(), 3);
}

#[test]
fn bad_input_is_named() {
    let folder = folder();
    let two = write(folder.path(), "two.swc", &format!("{FORKS}20 0 300 0 0 1 -1\n21 0 300 0 40 1 20\n"));
    let at = |name: &str| folder.path().join(name);
    assert_code(&flow(&two, &at("two.json"), &[]), FINE);
    let refused = flow(&two, &at("two.in"), &[]);
    assert_says(&refused, BAD_INPUT, &["svOneDSolver takes one inlet, and the network has 2; write a .json model"]);
    let unknown = flow(&two, &at("two.xyz"), &[]);
    assert_says(&unknown, USAGE, &["unrecognised extension; name a .json, .in, .vtp or .csv file"]);
    assert_code(&flow(&two, &at("two.json"), &["--stiffness", "soft"]), USAGE);
    assert_code(&flow(&two, &at("two.json"), &["--result", "case.foam"]), USAGE);
    let missing = flow(&two, &at("two.csv"), &["--result", at("case.foam").to_str().unwrap()]);
    assert_says(&missing, BAD_INPUT, &["cannot be read"]);
    let other = flow(&two, &at("two.csv"), &["--result", two.to_str().unwrap()]);
    assert_says(&other, BAD_INPUT, &["unrecognised result extension '.swc'; known: .foam, .vtu"]);
    // A model without positions, of another program.
    let foreign = "{\"simulation_parameters\": {}, \"vessels\": [], \"boundary_conditions\": []}";
    let refused = run("info", &[&write(folder.path(), "foreign.json", foreign)], &[]);
    assert_says(&refused, BAD_INPUT, &["a svZeroDSolver model without positions"]);
    let model = fs::read_to_string(at("two.json")).unwrap();
    let broken = run(
        "info",
        &[&write(folder.path(), "broken.json", &model.replacen("\"nodes\": [0, 1]", "\"nodes\": [0, 99]", 1))],
        &[],
    );
    assert_says(&broken, BAD_INPUT, &["refers to node 99, and there are 8"]);
}

/// Runs `OpenFOAM` in a case.
fn simple_foam(mut solver: Command, case: &Path) {
    let done = solver.arg("-case").arg(case).output().expect("simpleFoam runs");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stdout));
}

#[test]
fn openfoam_results_agree_with_the_one_dimensional_solution() {
    let Some(solver) = oracle::openfoam("simpleFoam") else { return };
    let folder = folder();
    let network = write(folder.path(), "fork.swc", FORK);
    let at = |name: &str| folder.path().join(name);
    let options = ["--units", "mm:m", "--inflow", "1e-8"];
    assert_code(&mesh(&network, &at("fork.foam"), &options), FINE);
    let unfinished =
        flow(&network, &at("result.csv"), &["--units", "mm:m", "--result", at("fork.foam").to_str().unwrap()]);
    assert_says(&unfinished, BAD_INPUT, &["no time folder with U and p: run the solver"]);
    simple_foam(solver, &at("fork.foam"));
    let result = ["--units", "mm:m", "--result", at("fork.foam").to_str().unwrap(), "--json"].map(str::to_owned);
    let result: Vec<&str> = result.iter().map(String::as_str).collect();
    let report = json(&flow(&network, &at("result.csv"), &result));
    assert!((report["inflow"].as_f64().unwrap() / 1e-8 - 1.0).abs() < 1e-6, "{report}");
    assert!((report["outflow"].as_f64().unwrap() / 1e-8 - 1.0).abs() < 1e-4, "{report}");
    assert!(report["max_flow_spread"].as_f64().unwrap() < 0.02, "{report}");
    assert!(report["max_flow_difference"].as_f64().unwrap() < 0.03, "{report}");
    let rows = table(&at("result.csv"));
    assert_eq!(rows.len(), 3);
    for row in &rows {
        assert!((number(row, "wall_shear") / number(row, "wall_shear_1d") - 1.0).abs() < 0.15, "{row:?}");
    }
    let arrays = flow(&network, &at("result.vtp"), &result[..4]);
    assert_code(&arrays, FINE);
    assert!(stderr(&arrays).contains("flow differs from 1D by median"), "{}", stderr(&arrays));
    let text = fs::read_to_string(at("result.vtp")).unwrap();
    assert!(["Pressure1D", "FlowDifference", "WallShear1D"].iter().all(|name| text.contains(name)));

    let wrong_units = flow(&network, &at("wrong.csv"), &result[2..4]);
    assert_says(&wrong_units, BAD_INPUT, &["give the network of this mesh"]);
    let other = write(folder.path(), "forks.swc", FORKS);
    assert_code(&flow(&other, &at("wrong.csv"), &result[..4]), BAD_INPUT);
    let field = fs::read_dir(at("fork.foam"))
        .unwrap()
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.file_name().unwrap().to_str().unwrap().parse::<f64>().is_ok_and(|time| time > 0.0))
        .max()
        .unwrap()
        .join("U");
    let bytes = fs::read(&field).unwrap();
    fs::write(&field, &bytes[..bytes.len() / 2]).unwrap();
    let cut = flow(&network, &at("wrong.csv"), &result[..4]);
    assert_says(&cut, BAD_INPUT, &["is the file truncated?"]);
    assert!(!at("wrong.csv").exists());
}

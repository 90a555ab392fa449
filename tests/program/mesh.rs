//! Command line tests of `mesh` and `info`, and of exit codes, messages and files of all commands.

use crate::common::program::*;
use crate::common::{fixture, shared};
use anastomesh::io::read_mesh;
use anastomesh::mesh::stacks::MixedMesh;
use serde_json::Value;
use std::fs;
use std::path::Path;

// ---- Successful runs ------------------------------------------------------------------------------------------------

#[test]
fn the_fixture_becomes_a_valid_mesh_in_both_formats() {
    let folder = folder();
    for name in ["tree.vtu", "tree.msh"] {
        let out = folder.path().join(name);
        let made = mesh(&fixture("tree_30.vtp"), &out, &[]);
        assert_code(&made, FINE);
        assert!(stderr(&made).contains("clusters") && made.stdout.is_empty());
        let checked = run("check", &[&out], &[]);
        assert_code(&checked, FINE);
        assert!(stdout(&checked).ends_with("\nvalid\n"), "{}", stdout(&checked));
        assert!(checked.stderr.is_empty());
    }
    assert_eq!(entries(folder.path()), ["tree.msh", "tree.vtu", "tree_patches.csv"]);
    let [vtu, msh] = ["tree.vtu", "tree.msh"].map(|name| read_mesh(&folder.path().join(name)).expect("a mesh"));
    assert_eq!(vtu.volume.mesh, msh.volume.mesh);
    assert_eq!(vtu.volume.boundary_patch, msh.volume.boundary_patch);
    let names = |file: &anastomesh::io::MeshFile| -> Vec<String> {
        file.volume.patches.iter().map(|p| p.name.clone()).collect()
    };
    assert_eq!(names(&vtu), names(&msh));
}

#[test]
fn layers_go_all_along_the_wall_and_caps_stay_flat() {
    let folder = folder();
    let out = folder.path().join("tree.vtu");
    let sizes = |options: &[&str]| {
        let made = mesh(&fixture("tree_30.vtp"), &out, &[&["--json"], options].concat());
        assert_code(&made, FINE);
        let run = &json(&made)["run"];
        assert!(run["failed"].as_array().is_some_and(Vec::is_empty), "{run}");
        assert!(run["thin_layers"].as_array().is_some_and(Vec::is_empty), "{run}");
        ["tets", "wall_triangles"].map(|name| run["mesh"][name].as_u64().expect("a count"))
    };
    let [_, wall] = sizes(&[]);
    let [tets, layered] = sizes(&["--layers", "3"]);
    // Walls are the same but for forks in which layers would be poor.
    assert!(layered.abs_diff(wall) < wall / 50, "{layered} {wall}");
    assert!(tets > 9 * wall, "{tets} {wall}");
    assert_code(&run("check", &[&out], &[]), FINE);
    sizes(&["--layers", "2", "--stretch", "4", "--core", "1.5"]);
    // Prisms as whole cells: three per wall triangle, and the mesh stays valid for a reader that splits them.
    assert_code(&mesh(&fixture("tree_30.vtp"), &out, &["--layers", "3", "--prisms"]), FINE);
    let read = read_mesh(&out).expect("a mesh").volume;
    assert_eq!(read.mesh.tets.len() as u64, tets);
    let mixed = MixedMesh::of(&read);
    assert_eq!(mixed.cells.iter().filter(|cell| cell.layer > 0).count() as u64, 3 * layered);
    assert_code(&run("check", &[&out], &[]), FINE);
    for (options, words) in [
        (&["--layers", "3", "--layer-thickness", "1"][..], &["0.001 to 0.8"][..]),
        (&["--prisms"], &["--prisms needs --layers"]),
        (&["--layers", "3", "--prisms", "--data", "radius"], &["--data"]),
        (&["--layers", "3", "--prisms", "--format", "medit"], &["--prisms", ".vtu, .pvtu or .msh"]),
        (&["--layers", "3", "--joint", "woven"], &["joint style disc"]),
        (&["--core", "0"], &["core", "0.5"]),
    ] {
        assert_says(&mesh(&fixture("tree_30.vtp"), &out, options), USAGE, words);
    }
}

#[test]
fn both_fixtures_are_one_network() {
    let infos = ["tree_30.vtp", "tree_30.swc"].map(|name| {
        let output = run("info", &[&fixture(name)], &["--json"]);
        assert_code(&output, FINE);
        json(&output)
    });
    for key in ["nodes", "edges", "branches", "components", "loops", "terminals", "valences", "total_length"] {
        assert!(!infos[0][key].is_null(), "no '{key}'");
        assert_eq!(infos[0][key], infos[1][key], "{key}");
    }
    assert_eq!((&infos[0]["nodes"], &infos[0]["edges"]), (&30.into(), &29.into()));
    let folder = folder();
    let terminals = infos[0]["terminals"].as_u64().expect("a count");
    for name in ["tree_30.vtp", "tree_30.swc"] {
        let out = folder.path().join(name).with_extension("vtu");
        assert_code(&mesh(&fixture(name), &out, &["-q"]), FINE);
        let caps = read_mesh(&out).expect("a mesh").volume.patches.iter().filter(|p| p.cap.is_some()).count();
        assert_eq!(caps as u64, terminals);
    }
    let text = run("info", &[&fixture("tree_30.vtp")], &[]);
    assert_code(&text, FINE);
    assert!(stdout(&text).contains("nodes: 30 ("), "{}", stdout(&text));
}

#[test]
fn reports_are_json_on_request() {
    let folder = folder();
    let out = folder.path().join("tree.vtu");
    let made = mesh(&fixture("tree_30.swc"), &out, &["--json", "--rho", "2.5", "-q"]);
    assert_code(&made, FINE);
    assert!(made.stderr.is_empty(), "{}", stderr(&made));
    let made = json(&made);
    assert_eq!(made["plan"]["rho"], 2.5);
    assert_eq!(made["check"]["verdict"], "valid");
    assert_eq!(made["run"]["network"], serde_json::json!([30, 29]));
    let run_report = &made["run"];
    for key in ["overlaps", "blocks", "retries", "failed", "mesh", "stages"] {
        assert!(!run_report[key].is_null(), "no '{key}'");
    }
    let count = |value: &Value| value.as_u64().expect("a count");
    assert!(count(&run_report["blocks"]["clusters"]) > 5);
    assert!(count(&run_report["blocks"]["largest_cluster_nodes"]) > 0);
    let checked = run("check", &[&out], &["--json"]);
    assert_code(&checked, FINE);
    let checked = json(&checked);
    assert_eq!(checked["verdict"], "valid");
    assert_eq!(checked["lines"].as_array().map(Vec::len), Some(anastomesh::check::Line::ALL.len()));
    assert_eq!(checked["counts"]["tets"], run_report["mesh"]["tets"]);
    // The blockwise check equals a check of the file. Float sums depend on their order, and blocks read the percentile
    // from a histogram.
    let (mut whole, mut by_blocks) = (checked, made["check"].clone());
    for (path, tolerance) in [("/counts/volume", 1e-9), ("/quality/mean", 1e-9), ("/quality/percentile_1", 2e-3)] {
        let take = |report: &mut Value| report.pointer_mut(path).map(Value::take).and_then(|v| v.as_f64());
        let (a, b) = (take(&mut whole).expect("a number"), take(&mut by_blocks).expect("a number"));
        assert!((a - b).abs() <= tolerance * a.abs(), "{path}: {a} and {b}");
    }
    assert_eq!(whole, by_blocks);
}

#[test]
fn a_root_becomes_the_inlet() {
    let folder = folder();
    let out = folder.path().join("tree.vtu");
    // Ids of the file count from 1.
    let before_last = 28;
    assert_code(&mesh(&fixture("tree_30.swc"), &out, &["-q", "--root", "29"]), FINE);
    let patches = read_mesh(&out).expect("a mesh").volume.patches;
    let inlet = patches.iter().find(|p| p.name == "inlet").expect("an inlet");
    assert_eq!((inlet.id, inlet.cap.map(|c| c.node)), (2, Some(before_last)));
}

/// Meshes a network with 1, 2 and 7 threads and compares the bytes; returns the last run's messages.
fn assert_same_bytes(network: &Path, folder: &Path, expected: i32) -> String {
    let runs = ["1", "2", "7"].map(|threads| {
        let out = folder.join(format!("{threads}.vtu"));
        let made = mesh(network, &out, &["-j", threads]);
        assert_code(&made, expected);
        (fs::read(out).expect("the mesh was written"), stderr(&made))
    });
    let [one, two, (bytes, said)] = runs;
    assert!(one.0 == two.0 && one.0 == bytes, "{}: the bytes depend on -j", network.display());
    said
}

#[test]
fn bytes_do_not_depend_on_the_number_of_threads() {
    let folder = folder();
    assert_same_bytes(&fixture("tree_30.vtp"), folder.path(), FINE);
    let Some(shared) = shared() else { return };
    assert_same_bytes(&shared.join("data/kidney/subtree_59.vtp"), folder.path(), FINE);
}

/// Overlapping vessels: the mesh is written, with a report of invalid places.
#[test]
fn overlapping_vessels_are_meshed_and_named() {
    let Some(shared) = shared() else { return };
    let network = shared.join("data/kidney/subtree_989.vtp");
    let folder = folder();
    let said = assert_same_bytes(&network, folder.path(), GATE_NOT_MET);
    assert!(said.contains("vessels overlap at 55 places (56 edge pairs)"), "{said}");
    assert!(said.contains("FAIL the boundary intersects itself at ") && said.contains("NOT valid"), "{said}");
    let checked = run("check", &[&folder.path().join("7.vtu")], &["-v"]);
    assert_code(&checked, GATE_NOT_MET);
    assert!(stdout(&checked).contains("  ok   every tetrahedron has positive volume\n"), "{}", stdout(&checked));
}

// ---- Bad input ------------------------------------------------------------------------------------------------------

/// All commands reject the network, and an existing output file is unchanged.
#[track_caller]
fn assert_refused(network: &Path, needles: &[&str]) {
    let folder = folder();
    let out = folder.path().join("out.vtu");
    // Unusable radii would otherwise be replaced.
    let refused = mesh(network, &out, &["--json", "--keep-radii"]);
    assert_code(&refused, BAD_INPUT);
    assert_message(&refused, network, needles);
    assert_eq!(entries(folder.path()), [""; 0]);
    fs::write(&out, "precious").expect("a file");
    assert_code(&mesh(network, &out, &["--keep-radii"]), BAD_INPUT);
    assert_eq!(fs::read(&out).expect("the file"), b"precious");
    assert_eq!(entries(folder.path()), ["out.vtu"]);
    let shown = run("info", &[network], &[]);
    if needles.contains(&"radius") {
        // `info` fills radii, as `mesh` does by default.
        assert_code(&shown, FINE);
        assert!(stdout(&shown).contains("repairs: 1 node with a missing or implausible radius"), "{}", stdout(&shown));
    } else {
        assert_code(&shown, BAD_INPUT);
        assert_message(&shown, network, needles);
    }
}

fn refuse(name: &str, content: impl AsRef<[u8]>, needles: &[&str]) {
    let folder = folder();
    let path = folder.path().join(name);
    fs::write(&path, content).expect("a file");
    assert_refused(&path, needles);
}

#[test]
fn paths_that_are_no_files() {
    let folder = folder();
    assert_refused(&folder.path().join("missing.vtp"), &["No such file", "check the path"]);
    assert_refused(&folder.path().join("missing.swc"), &["No such file", "check the path"]);
    assert_refused(folder.path(), &["is a directory; name a network file"]);
    let named_like_one = folder.path().join("folder.swc");
    fs::create_dir(&named_like_one).expect("a folder");
    assert_refused(&named_like_one, &["is a directory; name a network file"]);
    refuse("network.txt", "1 1 0 0 0 1 -1\n", &["extension", ".swc, .vtp"]);
    refuse("network", "1 1 0 0 0 1 -1\n", &["extension", ".swc, .vtp"]);
}

#[test]
fn files_with_nothing_in_them() {
    for name in ["empty.swc", "empty.vtp"] {
        refuse(name, "", &["the file is empty", "copy it again"]);
        refuse(name, " \n\n", &["the file is empty"]);
    }
    refuse("comments.swc", "# id type x y z radius parent\n", &["the file has no nodes", "SWC"]);
}

#[test]
fn a_truncated_vtp_at_every_length() {
    let whole = fs::read(fixture("tree_30.vtp")).expect("the fixture");
    let end = whole.trim_ascii_end().len();
    for share in [5, 20, 50, 60, 80, 90, 99] {
        refuse("cut.vtp", &whole[..end * share / 100], &["again"]);
    }
    refuse("cut.vtp", &whole[..end - 1], &["again"]);
}

#[test]
fn text_of_another_kind() {
    refuse("prose.swc", "It was the best of times.\n", &["line 1", "columns"]);
    refuse("prose.swc", "It was the best of times, it was the worst.\n", &["line 1", "'It'", "not a number"]);
    refuse("table.swc", "# c\n1 1 0 0 0 1 -1\n2,1,0,0,0,1,1\n", &["line 3", "1 column,"]);
    refuse("prose.vtp", "It was the best of times.\n", &["XML", ".vtp"]);
    refuse("page.vtp", "<html><body>404</body></html>", &["<html>", "VTKFile"]);
    refuse("noise.swc", [0xff, 0xfe, 0x00, 0x9c, b'\n', 0x80], &["line 1"]);
    refuse("noise.vtp", [0xff, 0xfe, 0x00, 0x9c, b'\n', 0x80], &["XML", ".vtp"]);
}

#[test]
fn numbers_that_cannot_be_used_in_swc() {
    let with = |row: &str| format!("# c\n1 1 0 0 0 1 -1\n{row}\n3 1 0 0 20 1 2\n");
    for bad in ["nan", "NaN", "inf", "-inf", "1e300"] {
        refuse(
            "bad.swc",
            with(&format!("2 1 0 {bad} 10 1 1")),
            &["line 3", "node 2", "the y ", "finite", "correct it"],
        );
        refuse("bad.swc", with(&format!("2 1 0 0 10 {bad} 1")), &["line 3", "node 2", "radius"]);
    }
    for bad in ["0", "0.0", "-0.0", "-1.5"] {
        refuse(
            "bad.swc",
            with(&format!("2 1 0 0 10 {bad} 1")),
            &["line 3", "node 2", "radius", "positive", "give the radius"],
        );
    }
    refuse("bad.swc", with("2 1 0 0 ten 1 1"), &["line 3", "the z is 'ten'"]);
    refuse("bad.swc", with("2 1 0 0 10 1 2"), &["line 3", "node 2 is its own parent", "-1"]);
    refuse("bad.swc", with("2 1 0 0 10 1 77"), &["line 3", "node 2", "parent 77", "-1"]);
    refuse("bad.swc", with("1 1 0 0 10 1 1"), &["line 3", "node 1", "line 2"]);
}

#[test]
fn networks_without_a_vessel() {
    refuse("one.swc", "1 1 0 0 0 1 -1\n", &["1 node,", "no vessel", "two nodes"]);
    refuse("apart.swc", "1 1 0 0 0 1 -1\n2 1 0 0 9 1 -1\n", &["2 nodes,", "no vessel"]);
    refuse("point.swc", "1 1 0 0 0 1 -1\n2 1 0 0 0 1 1\n", &["no vessel"]);
    refuse("one.vtp", vtp("0 0 0", "1", "", ""), &["no lines"]);
}

/// Single-piece VTP file; offsets and connectivity may be empty.
fn vtp(points: &str, radii: &str, connectivity: &str, offsets: &str) -> String {
    let count = |text: &str| text.split_whitespace().count();
    format!(
        r#"<?xml version="1.0"?>
<VTKFile type="PolyData" version="0.1" byte_order="LittleEndian">
<PolyData><Piece NumberOfPoints="{}" NumberOfLines="{}">
<PointData><DataArray type="Float64" Name="Radius" format="ascii">{radii}</DataArray></PointData>
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">{points}</DataArray></Points>
<Lines>
<DataArray type="Int64" Name="connectivity" format="ascii">{connectivity}</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">{offsets}</DataArray>
</Lines></Piece></PolyData></VTKFile>
"#,
        count(points) / 3,
        count(offsets)
    )
}

#[test]
fn numbers_that_cannot_be_used_in_vtp() {
    const POINTS: &str = "0 0 0  0 0 9  0 0 18";
    let folder = folder();
    let (path, out) = (folder.path().join("fine.vtp"), folder.path().join("fine.vtu"));
    fs::write(&path, vtp(POINTS, "1 1 1", "0 1 2", "3")).expect("a file");
    assert_code(&mesh(&path, &out, &["-q"]), FINE);
    for bad in ["nan", "inf", "-inf", "1e300"] {
        let points = POINTS.replace('9', bad);
        refuse("bad.vtp", vtp(&points, "1 1 1", "0 1 2", "3"), &["node 1", "finite", "correct the file"]);
    }
    for bad in ["0", "-2", "nan", "inf"] {
        let radii = format!("1 1 {bad}");
        refuse("bad.vtp", vtp(POINTS, &radii, "0 1 2", "3"), &["node 2", "radius", "positive", "correct the file"]);
    }
    refuse("bad.vtp", vtp(POINTS, "1 x 1", "0 1 2", "3"), &["value 1 of array 'Radius'", "'x'"]);
    refuse("bad.vtp", vtp(POINTS, "1 1", "0 1 2", "3"), &["'Radius'", "2 values", "3"]);
    for bad in ["3", "-1", "99999999999"] {
        let connectivity = format!("0 1 1 {bad}");
        refuse("bad.vtp", vtp(POINTS, "1 1 1", &connectivity, "2 4"), &["line 1", &format!("point {bad}"), "correct"]);
    }
    refuse("bad.vtp", vtp(POINTS, "1 1 1", "0 1 1 2", "2 7"), &["line 1", "offset 7", "correct"]);
    let unnamed = vtp(POINTS, "1 1 1", "0 1 2", "3").replace("\"Radius\"", "\"Flow\"");
    refuse("bad.vtp", unnamed, &["Flow", "--radius-array"]);
}

#[test]
fn an_output_that_cannot_be_written_is_refused_first() {
    let folder = folder();
    let missing = folder.path().join("missing");
    // The network does not exist either: the output is checked before anything is read.
    let network = folder.path().join("missing.vtp");
    let out = missing.join("out.vtu");
    let refused = mesh(&network, &out, &[]);
    assert_code(&refused, BAD_INPUT);
    assert_message(&refused, &out, &["cannot be written", "folder"]);
    let directory = folder.path().join("directory.vtu");
    fs::create_dir(&directory).expect("a folder");
    let refused = mesh(&network, &directory, &[]);
    assert_code(&refused, BAD_INPUT);
    assert_message(&refused, &directory, &["cannot be written", "directory"]);
    for name in ["out.stl", "out", ".vtu"] {
        let out = folder.path().join(name);
        let refused = mesh(&network, &out, &[]);
        assert_code(&refused, BAD_INPUT);
        assert_message(&refused, &out, &["extension", ".vtu, .pvtu, .msh"]);
    }
    let below_a_file = fixture("tree_30.vtp").join("out.vtu");
    let refused = mesh(&network, &below_a_file, &[]);
    assert_code(&refused, BAD_INPUT);
    assert_message(&refused, &below_a_file, &["cannot be written"]);
    assert_eq!(entries(folder.path()), ["directory.vtu"]);
}

// ---- Usage ----------------------------------------------------------------------------------------------------------

#[test]
fn options_that_make_no_sense() {
    let folder = folder();
    let out = folder.path().join("out.vtu");
    for bad in ["0", "-1", "nan", "inf"] {
        let refused = mesh(&fixture("tree_30.vtp"), &out, &["--rho", bad]);
        assert_code(&refused, USAGE);
        let said = stderr(&refused).to_lowercase();
        assert!(said.contains(&format!("rho = {bad} ")) && said.contains("at least"), "{said}");
    }
    for bad in [&["--rho", "fine"][..], &["--threads", "0"], &["--root", "first"], &["--finer"], &["--radius-array"]] {
        let refused = mesh(&fixture("tree_30.vtp"), &out, bad);
        assert_code(&refused, USAGE);
        assert!(stderr(&refused).contains(bad[0]), "{}", stderr(&refused));
    }
    // Node 1 of the fixture is a junction; there is no node 4000.
    for node in ["1", "4000"] {
        let refused = mesh(&fixture("tree_30.vtp"), &out, &["--root", node]);
        assert_code(&refused, USAGE);
        let said = stderr(&refused);
        assert!(said.contains(&format!("node {node} ")) && said.contains("terminal"), "{said}");
    }
    let refused = mesh(&fixture("tree_30.vtp"), &out, &["--radius-array", "Flow"]);
    assert_code(&refused, BAD_INPUT);
    assert_message(&refused, &fixture("tree_30.vtp"), &["'Flow'", "Radius"]);
    assert_eq!(entries(folder.path()), [""; 0]);
}

#[test]
fn verbs_help_and_version() {
    for options in [&["--help"][..], &["--version"], &["help"], &["help", "mesh"]] {
        let shown = run(options[0], &[], &options[1..]);
        assert_code(&shown, FINE);
        assert!(shown.stderr.is_empty() && stdout(&shown).contains("anastomesh"));
    }
    for verb in ["mesh", "tetrahedralize", "check", "info"] {
        let shown = run(verb, &[], &["--help"]);
        assert_code(&shown, FINE);
        assert!(stdout(&shown).contains("--json"));
        assert_code(&run(verb, &[], &[]), USAGE);
    }
    let unknown = run("weave", &[], &[]);
    assert_code(&unknown, USAGE);
    assert!(stderr(&unknown).contains("weave"));
    assert_code(&program().output().expect("the program runs"), USAGE);
    assert_code(&run("mesh", &[&fixture("tree_30.vtp")], &[]), USAGE);
}

// ---- Blocks that fail -----------------------------------------------------------------------------------------------

#[test]
fn a_block_that_fails_ends_the_run_with_its_input_kept() {
    let folder = folder();
    let (network, out) = (folder.path().join("hopeless.vtp"), folder.path().join("out.vtu"));
    fs::write(&network, HOPELESS).expect("a file");
    fs::write(&out, "precious").expect("a file");
    let failed = mesh(&network, &out, &["--quiet"]);
    assert_code(&failed, STAGE_FAILED);
    let said = stderr(&failed);
    assert!(
        said.contains(": cluster 2: ") && said.contains("(nodes 2 3 4 5)") && said.contains("--keep-going"),
        "{said}"
    );
    assert_eq!(fs::read(&out).expect("the file"), b"precious");
    assert_eq!(entries(folder.path()), ["hopeless.vtp", "out.vtu", "out.vtu.failed"]);
    let dumps = entries(&folder.path().join("out.vtu.failed"));
    assert!(!dumps.is_empty());
    let dump = fs::read(folder.path().join("out.vtu.failed").join(&dumps[0])).expect("the dump");
    assert!(serde_json::from_slice::<Value>(&dump).is_ok());
    let report = json(&mesh(&network, &out, &["--json"]));
    assert_eq!(report["run"]["failed"][0]["nodes"], serde_json::json!([2, 3, 4, 5]));
    assert!(report["check"].is_null());
}

#[test]
fn blocks_that_fail_are_left_out_on_request() {
    let folder = folder();
    let (network, out) = (folder.path().join("hopeless.vtp"), folder.path().join("out.vtu"));
    fs::write(&network, HOPELESS).expect("a file");
    let dumps = folder.path().join("dumps");
    let options = ["--keep-going", "--dump-dir", dumps.to_str().expect("text")];
    let failed = mesh(&network, &out, &options);
    assert_code(&failed, STAGE_FAILED);
    assert!(stderr(&failed).contains("FAILED cluster "), "{}", stderr(&failed));
    assert_eq!(entries(folder.path()), ["dumps", "hopeless.vtp", "out.vtu", "out_patches.csv"]);
    let checked = run("check", &[&out], &["-v"]);
    assert_code(&checked, GATE_NOT_MET);
    let said = stdout(&checked);
    assert!(
        said.contains("FAIL terminals and caps do not match at ")
            && said.contains("ok   every tetrahedron has positive volume"),
        "{said}"
    );
}

#[test]
fn the_root_of_an_swc_file_is_the_inlet() {
    let folder = folder();
    let network = folder.path().join("tree.swc");
    // The root is thinner than a leaf.
    fs::write(&network, "7 0 0 0 0 1 -1\n5 0 0 0 12 1 7\n1 0 0 7 24 1.3 5\n3 0 0 -7 24 1 5\n").expect("written");
    let out = folder.path().join("tree.vtu");
    let made = mesh(&network, &out, &[]);
    assert_code(&made, FINE);
    assert!(stderr(&made).contains("inlet: node 7 at 0 0 0, radius 1 (root in the file)"), "{}", stderr(&made));
    let patches = read_mesh(&out).expect("a mesh").volume.patches;
    let inlet = patches.iter().find(|p| p.name == "inlet").expect("an inlet");
    assert_eq!(inlet.cap.map(|c| c.node), Some(0));
}

// ---- Encodings of VTK files -----------------------------------------------------------------------------------------

#[test]
fn a_grid_of_tetrahedra_alone_has_its_boundary_beside_it() {
    let folder = folder();
    let out = folder.path().join("tree.vtu");
    let options = ["-q", "--cells", "tets", "--float32", "--compress", "none"];
    assert_code(&mesh(&fixture("tree_30.swc"), &out, &options), FINE);
    assert_eq!(entries(folder.path()), ["tree.vtu", "tree_boundary.vtp", "tree_patches.csv"]);
    let file = read_mesh(&out).expect("a mesh");
    assert!(!file.labelled && file.notes.expectation.is_some());
    let boundary = fs::read(folder.path().join("tree_boundary.vtp")).expect("a file");
    let head = String::from_utf8_lossy(&boundary[..4000]).into_owned();
    for words in ["type=\"PolyData\"", "Name=\"patch\"", "Name=\"patch_names\"", "type=\"Float32\" Name=\"Points\""] {
        assert!(head.contains(words), "'{words}' in {head}");
    }
    assert!(!head.contains("compressor"));
}

#[test]
fn what_is_known_of_the_vessels_stands_in_the_grid_on_request() {
    let folder = folder();
    let network = fixture("tree_30.swc");
    let data = ["-q", "--data", "radius,distance,branch,generation,strahler,node,ratio"];
    let out = folder.path().join("tree.vtu");
    assert_code(&mesh(&network, &out, &data), FINE);
    let bytes = fs::read(&out).expect("a mesh");
    let head = String::from_utf8_lossy(&bytes[..6000]).into_owned();
    for name in ["radius", "distance", "branch", "generation", "strahler", "node", "ratio"] {
        assert!(head.contains(&format!("Name=\"{name}\"")), "{name}: {head}");
    }
    assert_code(&run("check", &[&out], &[]), FINE);
    let pieces = folder.path().join("pieces.pvtu");
    assert_code(&mesh(&network, &pieces, &data), FINE);
    let index = fs::read_to_string(&pieces).expect("an index");
    assert!(index.contains("Name=\"radius\"") && index.contains("Name=\"ratio\""), "{index}");
    let bent = mesh(&network, &folder.path().join("a.vtu"), &["--data", "colour"]);
    assert_says(&bent, USAGE, &["colour", "generation"]);
    for (name, read_as_text) in [("a.msh", false), ("a.msh2", true)] {
        let out = folder.path().join(name);
        assert_code(&mesh(&network, &out, &data), FINE);
        let bytes = fs::read(&out).expect("a mesh");
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.contains("$NodeData\n1\n\"radius\"") && text.contains("$ElementData\n1\n\"ratio\""), "{name}");
        assert_eq!(std::str::from_utf8(&bytes).is_ok(), read_as_text);
        assert_code(&run("check", &[&out], &[]), FINE);
    }
    for name in ["a.mesh", "a.foam", "a.svmesh", "a.ele"] {
        let refused = mesh(&network, &folder.path().join(name), &["--data", "radius"]);
        assert_says(&refused, USAGE, &["--data", ".msh2"]);
    }
}

#[test]
fn coordinates_of_32_bits_are_checked_as_such() {
    let folder = folder();
    let out = folder.path().join("tree.vtu");
    assert_code(&mesh(&fixture("tree_30.swc"), &out, &["-q", "--float32"]), FINE);
    assert_code(&run("check", &[&out], &[]), FINE);
    assert_code(&run("check", &[&out], &["--memory", "1MiB"]), FINE);
}

#[test]
fn a_format_can_be_named() {
    let folder = folder();
    let (network, at) = (fixture("tree_30.swc"), |name: &str| folder.path().join(name));
    for (format, name, usual) in
        [("msh2", "a.msh", "b.msh2"), ("medit", "a.vtu", "b.mesh"), ("vtu", "a.grid", "b.vtu"), ("msh", "a", "b.msh")]
    {
        assert_code(&mesh(&network, &at(name), &["-q", "--format", format]), FINE);
        assert_code(&mesh(&network, &at(usual), &["-q"]), FINE);
        assert!(fs::read(at(name)).expect("a mesh") == fs::read(at(usual)).expect("a mesh"), "{format}");
        let bytes = fs::read(at(usual)).expect("a mesh");
        let converted = run("convert", &[&at(usual), Path::new("--output"), &at(name)], &["-q", "--format", format]);
        assert_code(&converted, FINE);
        assert!(fs::read(at(name)).expect("a mesh") == bytes, "{format}");
    }
    assert_code(&run("check", &[&at("a.msh")], &[]), FINE);
    assert_code(&mesh(&network, &at("case"), &["-q", "--format", "openfoam"]), FINE);
    assert!(at("case/constant/polyMesh/owner").is_file() && at("case_patches.csv").is_file());
    assert_code(&mesh(&network, &at("complete"), &["-q", "--format", "simvascular"]), FINE);
    assert!(at("complete/solver.xml").is_file());
    assert_says(&mesh(&network, &at("a.vtu"), &["--format", "stl"]), USAGE, &["stl", "simvascular"]);
    let network_as_mesh = run("convert", &[&network, Path::new("--output"), &at("c.vtu")], &["--format", "vtu"]);
    assert_says(&network_as_mesh, USAGE, &["anastomesh mesh"]);
    let data = mesh(&network, &at("c.vtu"), &["--format", "medit", "--data", "radius"]);
    assert_says(&data, USAGE, &["--data"]);
}

//! Command line tests of `NumPy` arrays and of progress lines: the interface for other programs.

use crate::common::fixture;
use crate::common::program::*;
use crate::common::surfaces::sphere;
use anastomesh::io::{NetworkOptions, read_mesh, read_network};
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// Writes an array in `NumPy` format.
fn save(folder: &Path, name: &str, descr: &str, shape: &str, items: &[u8]) {
    fs::create_dir_all(folder).expect("a folder");
    let head = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
    let length = (head.len() as u16).to_le_bytes();
    let bytes = [b"\x93NUMPY\x01\x00", &length[..], head.as_bytes(), items].concat();
    fs::write(folder.join(name), bytes).expect("a file");
}

fn floats(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn ints(values: &[i32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// Unit cube.
fn cube(folder: &Path) -> PathBuf {
    let path = folder.join("cube.npyd");
    let points: Vec<f64> = (0..24).map(|i| f64::from((i / 3) >> (i % 3) & 1)).collect();
    let squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles: Vec<i32> = squares.iter().flat_map(|[a, b, c, d]| [*a, *b, *c, *a, *c, *d]).collect();
    save(&path, "points.npy", "<f8", "(8, 3)", &floats(&points));
    save(&path, "triangles.npy", "<i4", "(12, 3)", &ints(&triangles));
    path
}

#[test]
fn a_mesh_as_arrays_is_the_mesh() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    for name in ["a.vtu", "a.npyd"] {
        assert_code(&mesh(&fixture("tree_30.vtp"), &at(name), &["-q"]), FINE);
    }
    let (grid, arrays) = (read_mesh(&at("a.vtu")).expect("a mesh"), read_mesh(&at("a.npyd")).expect("a mesh"));
    assert_eq!(arrays.volume, grid.volume);
    assert_eq!(arrays.notes, grid.notes);
    let checked = run("check", &[&at("a.npyd")], &["--json"]);
    assert_code(&checked, FINE);
    assert_eq!(stdout(&checked), stdout(&run("check", &[&at("a.vtu")], &["--json"])));
    for (from, to) in [("a.npyd", "b.vtu"), ("b.vtu", "b.npyd")] {
        assert_code(&run("convert", &[&at(from), Path::new("-o"), &at(to)], &["-q"]), FINE);
    }
    assert!(fs::read(at("a.vtu")).expect("a file") == fs::read(at("b.vtu")).expect("a file"));
    // A folder with a mesh only is replaced, one with other files is not.
    assert_code(&mesh(&fixture("tree_30.vtp"), &at("a.npyd"), &["-q", "--data", "radius,branch"]), FINE);
    assert!(at("a.npyd/point_radius.npy").exists() && at("a.npyd/tet_branch.npy").exists());
    fs::write(at("a.npyd/results.npy"), "").expect("a file");
    assert_says(&mesh(&fixture("tree_30.vtp"), &at("a.npyd"), &["-q"]), BAD_INPUT, &["also holds results.npy"]);
}

#[test]
fn a_network_as_arrays_is_the_network() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    assert_code(&run("convert", &[&fixture("tree_30.vtp"), Path::new("-o"), &at("a.npyd")], &["-q"]), FINE);
    let read = |path: &Path| read_network(path, &NetworkOptions::default()).expect("a network").skeleton;
    assert_eq!(read(&at("a.npyd")).edges.len(), read(&fixture("tree_30.vtp")).edges.len());
    for (input, out) in [(fixture("tree_30.vtp"), "of_file.vtu"), (at("a.npyd"), "of_arrays.vtu")] {
        assert_code(&mesh(&input, &at(out), &["-q", "--root", "0"]), FINE);
    }
    assert_eq!(
        read_mesh(&at("of_file.vtu")).expect("a mesh").volume,
        read_mesh(&at("of_arrays.vtu")).expect("a mesh").volume
    );
    assert_code(&run("refine", &[&at("a.npyd"), Path::new("-o"), &at("b.npyd")], &["-q"]), FINE);
    assert!(at("b.npyd/original_node.npy").exists() && at("b.npyd/displacement.npy").exists());
    assert_code(&run("info", &[&at("b.npyd")], &[]), FINE);
}

#[test]
fn a_complex_as_arrays_has_markers_and_bounded_regions() {
    let folder = folder();
    let (input, out) = (cube(folder.path()), folder.path().join("out.npyd"));
    save(&input, "markers.npy", "<i4", "(12,)", &ints(&[5, 5, 6, 6, 7, 7, 8, 8, 9, 9, 10, 10]));
    save(&input, "regions.npy", "<f8", "(1, 5)", &floats(&[0.5, 0.5, 0.5, 3.0, 0.0]));
    assert_code(&fill(&input, &out, &["--plc", "-q"]), FINE);
    let file = read_mesh(&out).expect("a mesh");
    let mut markers = file.volume.boundary_patch.clone();
    markers.dedup();
    assert_eq!(markers, [5, 6, 7, 8, 9, 10]);
    assert!(file.volume.tet_block.iter().all(|&region| region == 3));
    // Input arrays that do not belong to a mesh prevent replacement of the folder.
    assert_says(&fill(&input, &input, &[]), BAD_INPUT, &["also holds"]);
    for name in ["markers.npy", "regions.npy"] {
        fs::remove_file(input.join(name)).expect("a file");
    }
    assert_says(&fill(&input, &input, &[]), USAGE, &["is the input and would be overwritten"]);
}

#[test]
fn a_bound_on_a_region_is_enough_to_refine() {
    let folder = folder();
    let ball = sphere(8);
    let path = folder.path().join("ball.npyd");
    let points: Vec<f64> = ball.points.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
    let corners: Vec<i32> = ball.triangles.as_flattened().iter().map(|&v| v as i32).collect();
    save(&path, "points.npy", "<f8", &format!("({}, 3)", ball.points.len()), &floats(&points));
    save(&path, "triangles.npy", "<i4", &format!("({}, 3)", ball.triangles.len()), &ints(&corners));
    let tets = |volume: f64| {
        save(&path, "regions.npy", "<f8", "(1, 5)", &floats(&[0.0, 0.0, 0.0, 3.0, volume]));
        let out = folder.path().join("out.npyd");
        assert_code(&fill(&path, &out, &["--plc", "-q"]), FINE);
        read_mesh(&out).expect("a mesh").volume.mesh.tets.len()
    };
    let usual = tets(0.0);
    let volume = 4.0 / usual as f64;
    assert!(tets(0.5 * volume) > usual * 3 / 2);
}

#[test]
fn arrays_at_fault_are_named() {
    let folder = folder();
    let (input, out) = (cube(folder.path()), folder.path().join("out.vtu"));
    save(&input, "triangles.npy", "<i4", "(2, 3)", &ints(&[0, 1, 2, 0, 8, 2]));
    let said = fill(&input, &out, &[]);
    assert_message(&said, &input, &["triangles.npy: row 1 refers to 8, but points.npy has 8 rows, numbered from 0"]);
    assert_code(&said, BAD_INPUT);
    save(&input, "triangles.npy", "<i4", "(200000000000, 3)", &ints(&[0, 1, 2]));
    assert_message(&fill(&input, &out, &[]), &input, &["announce 2400000000000 bytes, it has 12"]);
    fs::remove_file(input.join("points.npy")).expect("a file");
    assert_message(&fill(&input, &out, &[]), &input, &["points.npy: is missing"]);
    let nowhere = folder.path().join("nowhere.npyd");
    assert_message(&fill(&nowhere, &out, &[]), &nowhere, &["cannot be read: No such file"]);
    assert_says(&fill(Path::new("-"), &out, &["--from", "npyd"]), USAGE, &["give its path"]);
    assert!(!out.exists());
}

#[test]
fn progress_is_told_in_lines() {
    let folder = folder();
    let out = folder.path().join("a.vtu");
    let said = stderr(&mesh(&fixture("tree_30.vtp"), &out, &["-q", "--progress", "json"]));
    let lines: Vec<serde_json::Value> = said.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let stages: Vec<&str> = lines.iter().filter_map(|line| line["progress"]["stage"].as_str()).collect();
    assert_eq!(stages.len(), lines.len());
    for stage in ["prepare", "partition", "blocks", "check", "write"] {
        assert!(stages.contains(&stage), "{stage} in {stages:?}");
    }
    let blocks = lines.iter().map(|line| &line["progress"]).rfind(|told| told["stage"] == "blocks").expect("blocks");
    assert_eq!(blocks["done"], blocks["total"]);
    let filled = stderr(&fill(&fixture("torus.off"), &out, &["-q", "--progress", "json"]));
    assert!(filled.contains(r#""stage":"delaunay""#) && filled.contains(r#""stage":"write""#), "{filled}");
}

#[test]
fn a_run_whose_lines_nobody_reads_ends() {
    let folder = folder();
    let out = folder.path().join("a.vtu");
    let paths = [&*fixture("tree_30.vtp"), Path::new("-o"), &out];
    let mut command = program();
    command.arg("mesh").args(paths).args(["-q", "--progress", "json", "--rho", "12", "-j", "1"]);
    let mut child = command.stderr(Stdio::piped()).spawn().expect("the program runs");
    let mut lines = BufReader::new(child.stderr.take().expect("lines")).lines();
    assert!(lines.any(|line| line.is_ok_and(|line| line.contains("blocks"))));
    drop(lines);
    assert_ne!(child.wait().expect("it ends").code(), Some(FINE));
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 0);
}

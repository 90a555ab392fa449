//! `anastomesh tetrahedralize` as it is run: formats, switches, exit codes, messages, files.

mod common;

use anastomesh::io::{MeshFormat, read_mesh, read_mesh_from, write_surface};
use anastomesh::{Point3, TriMesh};
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

const FINE: i32 = 0;
const USAGE: i32 = 2;
const BAD_INPUT: i32 = 3;

fn command(input: &Path, out: Option<&Path>, options: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_anastomesh"));
    command.arg("tetrahedralize").arg(input);
    if let Some(out) = out {
        command.arg("--output").arg(out);
    }
    command.args(options);
    command
}

fn fill(input: &Path, out: &Path, options: &[&str]) -> Output {
    command(input, Some(out), options).output().expect("the program runs")
}

fn check(mesh: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_anastomesh")).arg("check").arg(mesh).output().expect("the program runs")
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("text")
}

#[track_caller]
fn assert_code(output: &Output, expected: i32) {
    let out = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(expected), "{out}\n{}", stderr(output));
}

/// The report of a run that ends well.
#[track_caller]
fn report(input: &Path, out: &Path, options: &[&str]) -> Value {
    let mut all = vec!["--json"];
    all.extend(options);
    let output = fill(input, out, &all);
    assert_code(&output, FINE);
    assert!(output.stderr.is_empty(), "{}", stderr(&output));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

fn folder() -> TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn entries(folder: &Path) -> Vec<String> {
    let list = fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> =
        list.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort_unstable();
    names
}

// ---- Inputs ---------------------------------------------------------------------------------------------------------

/// The quadrilaterals of a box whose corner `i` has x, y, z from the bits of `i`, outwards.
const SIDES: [[u32; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];

fn corners(low: f64, high: f64) -> Vec<Point3> {
    let end = |bit: usize| if bit == 0 { low } else { high };
    (0..8).map(|i: usize| Point3::new(end(i & 1), end((i >> 1) & 1), end(i >> 2))).collect()
}

/// The unit cube.
fn cube() -> TriMesh {
    let triangles = SIDES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriMesh { points: corners(0.0, 1.0), triangles }
}

/// A sphere of so many rings, as a surface with some more triangles.
fn sphere(rings: u32) -> TriMesh {
    let around = 2 * rings;
    let mut mesh = TriMesh::default();
    let angle = |part: u32, of: u32| std::f64::consts::PI * f64::from(part) / f64::from(of);
    for ring in 1..rings {
        let (sin, cos) = angle(ring, rings).sin_cos();
        for i in 0..around {
            let (y, x) = angle(2 * i, around).sin_cos();
            mesh.points.push(Point3::new(sin * x, sin * y, cos));
        }
    }
    let (north, south) = (mesh.points.len() as u32, mesh.points.len() as u32 + 1);
    mesh.points.extend([Point3::new(0.0, 0.0, 1.0), Point3::new(0.0, 0.0, -1.0)]);
    let at = |ring: u32, i: u32| (ring - 1) * around + i % around;
    for i in 0..around {
        mesh.triangles.push([north, at(1, i), at(1, i + 1)]);
        mesh.triangles.push([south, at(rings - 1, i + 1), at(rings - 1, i)]);
        for ring in 1..rings - 1 {
            let [a, b, c, d] = [at(ring, i), at(ring + 1, i), at(ring + 1, i + 1), at(ring, i + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

fn save(folder: &TempDir, name: &str, mesh: &TriMesh) -> PathBuf {
    let path = folder.path().join(name);
    write_surface(&path, mesh).expect("a file");
    path
}

fn text(folder: &TempDir, name: &str, content: &str) -> PathBuf {
    let path = folder.path().join(name);
    fs::write(&path, content).expect("a file");
    path
}

/// Points as a section of TetGen's files, counted from `first`.
fn node_list(points: &[Point3], first: usize) -> String {
    let mut out = format!("{} 3 0 0\n", points.len());
    for (i, p) in points.iter().enumerate() {
        let _ = writeln!(out, "{} {} {} {}", i + first, p.x, p.y, p.z);
    }
    out
}

/// The cube with six square facets, as a `.smesh` counted from 1; facet `i` has the marker 10 + i.
fn cube_smesh() -> String {
    let mut out = node_list(&cube().points, 1) + "6 1\n";
    for (i, side) in SIDES.iter().enumerate() {
        let [a, b, c, d] = side.map(|v| v + 1);
        let _ = writeln!(out, "4 {a} {b} {c} {d} {}", 10 + i);
    }
    out + "0\n0\n"
}

/// A box of 2 × 1 × 1 with a wall across it, in which there is a window with a mullion; regions on both sides, which the
/// window joins when it is open.
fn rooms(window_is_open: bool) -> String {
    let mut points = Vec::new();
    for x in [0.0, 1.0, 2.0] {
        points.extend([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(y, z)| Point3::new(x, y, z)));
    }
    points.extend([(0.25, 0.25), (0.75, 0.25), (0.75, 0.75), (0.25, 0.75)].map(|(y, z)| Point3::new(1.0, y, z)));
    let mut out = node_list(&points, 0) + "11 1\n";
    let _ = writeln!(out, "1 0 1\n4 0 3 2 1\n1 0 1\n4 8 9 10 11");
    for (i, j) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
        for base in [0, 4] {
            let _ = writeln!(out, "1 0 2\n4 {} {} {} {}", base + i, base + j, base + j + 4, base + i + 4);
        }
    }
    let hole = if window_is_open { "1 1 0.5 0.4\n" } else { "" };
    let _ = writeln!(out, "2 {} 3\n4 4 5 6 7\n4 12 13 14 15\n{hole}0", u32::from(window_is_open));
    out + "2\n0 0.5 0.5 0.5 7 0.01\n1 1.5 0.5 0.5 -9 0.05\n"
}

// ---- What works -----------------------------------------------------------------------------------------------------

#[test]
fn every_format_of_surfaces_is_read() {
    let folder = folder();
    let mut inputs: Vec<PathBuf> =
        ["c.off", "c.ply", "c.stl", "c.obj"].iter().map(|name| save(&folder, name, &cube())).collect();
    inputs.push(text(&folder, "c.smesh", &cube_smesh()));
    inputs.push(text(
        &folder,
        "d.poly",
        &(node_list(&cube().points, 0)
            + "6 0\n"
            + &SIDES.map(|[a, b, c, d]| format!("1\n4 {a} {b} {c} {d}\n")).concat()
            + "0\n0\n"),
    ));
    let third = cube().points.iter().map(|p| p.map(|x| x / 3.0)).collect();
    inputs.push(save(&folder, "text.stl", &TriMesh { points: third, ..cube() }));
    for input in &inputs {
        let out = folder.path().join("out.vtu");
        for options in [&["--no-refine"][..], &[]] {
            let report = &report(input, &out, options)["report"];
            assert_eq!(report["input"]["triangles"], 12, "{}", input.display());
            let side = if input.ends_with("text.stl") { 1.0 / 3.0_f64 } else { 1.0 };
            let volume = report["mesh"]["volume"].as_f64().expect("a volume");
            assert!((volume - side.powi(3)).abs() < 1e-12);
            assert_eq!(report["mesh"]["faces"], 12);
            assert_code(&check(&out), FINE);
        }
    }
}

#[test]
fn every_format_of_meshes_is_written_whole() {
    let folder = folder();
    let input = save(&folder, "s.ply", &sphere(6));
    let mut meshes = Vec::new();
    for name in ["a.vtu", "a.msh", "a.mesh", "a.1.ele"] {
        let out = folder.path().join(name);
        let made = fill(&input, &out, &[]);
        assert_code(&made, FINE);
        assert!(made.stdout.is_empty() && stderr(&made).contains("tetrahedra"), "{}", stderr(&made));
        assert_code(&check(&out), FINE);
        meshes.push(read_mesh(&out).expect("a mesh").volume);
    }
    for mesh in &meshes {
        assert_eq!(mesh.mesh, meshes[0].mesh);
        assert_eq!(mesh.boundary.len(), sphere(6).triangles.len());
        assert!(mesh.boundary_patch.iter().all(|&patch| patch == 1));
    }
    let family = ["a.1.edge", "a.1.ele", "a.1.face", "a.1.neigh", "a.1.node"];
    let mut expected: Vec<&str> = family.into_iter().chain(["a.mesh", "a.msh", "a.vtu", "s.ply"]).collect();
    expected.sort_unstable();
    assert_eq!(entries(folder.path()), expected);
}

#[test]
fn points_alone_are_filled_up_to_their_hull() {
    let folder = folder();
    let mut points = corners(0.0, 1.0);
    points.extend(corners(0.3, 0.6));
    let input = text(&folder, "a.node", &node_list(&points, 1));
    let out = folder.path().join("a.1.ele");
    let report = &report(&input, &out, &[])["report"];
    assert!((report["mesh"]["volume"].as_f64().expect("a volume") - 1.0).abs() < 1e-12);
    assert_eq!((&report["mesh"]["points"], &report["mesh"]["added_points"]), (&16.into(), &0.into()));
    assert_code(&check(&out), FINE);
    // Counted as the input, or from 0 on demand.
    let first_number = || fs::read_to_string(&out).expect("text").lines().nth(1).expect("a row")[..2].to_owned();
    assert_eq!(first_number(), "1 ");
    assert_code(&fill(&input, &out, &["--tetgen", "z"]), FINE);
    assert_eq!(first_number(), "0 ");
}

#[test]
fn standard_streams() {
    let folder = folder();
    let input = fs::read(save(&folder, "c.off", &cube())).expect("a file");
    let mut child = command(Path::new("-"), Some(Path::new("-")), &["--from", "off", "--to", "msh", "-q"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program runs");
    child.stdin.take().expect("a pipe").write_all(&input).expect("written");
    let output = child.wait_with_output().expect("an end");
    assert_code(&output, FINE);
    assert!(output.stderr.is_empty());
    let mesh = read_mesh_from(&output.stdout, MeshFormat::Msh).expect("a mesh");
    assert_eq!(mesh.volume.boundary.len(), 12);
    for options in [&["--to", "msh"][..], &["--from", "off"], &["--from", "off", "--to", "vtu", "--json"]] {
        assert_code(&fill(Path::new("-"), Path::new("-"), options), USAGE);
    }
}

#[test]
fn facets_regions_and_markers() {
    let folder = folder();
    let closed = text(&folder, "closed.poly", &rooms(false));
    let open = text(&folder, "open.poly", &rooms(true));
    for name in ["out.msh", "out.ele"] {
        let out = folder.path().join(name);
        let made = &report(&closed, &out, &["--no-refine"])["report"];
        assert_eq!(made["input"]["facets"], 11);
        let regions = made["regions"].as_array().expect("a list");
        assert_eq!(regions.iter().map(|r| r["id"].as_i64()).collect::<Vec<_>>(), [Some(-9), Some(7)]);
        assert!(regions.iter().all(|r| (r["volume"].as_f64().expect("a number") - 1.0).abs() < 1e-12));
        let mesh = read_mesh(&out).expect("a mesh").volume;
        let with = |marker: i32| mesh.boundary_patch.iter().filter(|&&patch| patch == marker).count();
        assert_eq!((with(1), with(2)), (4, 16));
        // The wall: 8 points in the plane, the window filled.
        assert_eq!(with(3), 10);
        if name == "out.ele" {
            let mut blocks = mesh.tet_block.clone();
            blocks.sort_unstable();
            blocks.dedup();
            assert_eq!(blocks, [-9, 7]);
        }
        assert_code(&check(&out), FINE);
    }
    let made = fill(&open, &folder.path().join("open.ele"), &["--no-refine"]);
    // Both seeds are in one region: one id for it cannot be told.
    assert!(made.status.code() != Some(70), "{}", stderr(&made));
    let unlabelled = rooms(true).replace("2\n0 0.5 0.5 0.5 7 0.01\n1 1.5 0.5 0.5 -9 0.05\n", "0\n");
    let open = text(&folder, "open.poly", &unlabelled);
    let out = folder.path().join("open.ele");
    let made = &report(&open, &out, &["--no-refine"])["report"];
    assert!((made["mesh"]["volume"].as_f64().expect("a number") - 2.0).abs() < 1e-12);
    assert_eq!(made["mesh"]["interior_faces"], 8);
    assert_code(&check(&out), FINE);
}

#[test]
fn a_dangling_segment_and_point_attributes_are_kept() {
    let folder = folder();
    let mut points = cube().points;
    points.extend([Point3::new(0.4, 0.4, 0.3), Point3::new(0.6, 0.7, 0.6)]);
    let mut poly = format!("{} 3 1 1\n", points.len());
    for (i, p) in points.iter().enumerate() {
        let _ = writeln!(poly, "{i} {} {} {} {}.5 {}", p.x, p.y, p.z, i, 100 + i);
    }
    poly += "7 1\n1 0 5\n2 8 9\n";
    for [a, b, c, d] in SIDES {
        let _ = writeln!(poly, "1 0 6\n4 {a} {b} {c} {d}");
    }
    let input = text(&folder, "a.poly", &(poly + "0\n0\n"));
    let out = folder.path().join("b.ele");
    let report = report(&input, &out, &[]);
    assert_eq!(report["report"]["input"]["segments"], 1);
    let nodes = fs::read_to_string(out.with_extension("node")).expect("text");
    let row: Vec<&str> = nodes.lines().nth(4).expect("a row").split(' ').collect();
    assert_eq!((row[4], row[5]), ("3.5", "103"));
    let edges = fs::read_to_string(out.with_extension("edge")).expect("text");
    assert!(edges.lines().any(|line| line.ends_with(" 8 9 -1")), "{edges}");
    let mesh = read_mesh(&out).expect("a mesh").volume.mesh;
    assert!(mesh.tets.iter().any(|t| t.contains(&8) && t.contains(&9)));
}

#[test]
fn the_bytes_depend_on_the_input_alone() {
    let folder = folder();
    let input = save(&folder, "s.off", &sphere(9));
    let made: Vec<Vec<Vec<u8>>> = ["1", "2", "7"]
        .iter()
        .map(|threads| {
            let outs = ["s.vtu", "s.msh", "s.mesh", "s.1.ele"].map(|name| folder.path().join(name));
            for out in &outs {
                assert_code(&fill(&input, out, &["-j", threads, "-q"]), FINE);
            }
            outs.iter().map(|out| fs::read(out).expect("a file")).collect()
        })
        .collect();
    assert!(made[0] == made[1] && made[0] == made[2]);
}

#[test]
fn tetgen_reads_what_we_write() {
    let Some(tetgen) = common::oracle::tetgen() else { return };
    let folder = folder();
    for (input, options) in
        [(save(&folder, "s.off", &sphere(7)), "--tetgen=pY"), (text(&folder, "r.poly", &rooms(false)), "--no-refine")]
    {
        let out = folder.path().join("mesh.ele");
        assert_code(&fill(&input, &out, &[options, "-q"]), FINE);
        let read = Command::new(&tetgen).args(["-rQ", "mesh"]).current_dir(&folder).output().expect("tetgen runs");
        assert!(read.status.success(), "{}", String::from_utf8_lossy(&read.stdout));
        let count = |name: &str| {
            let text = fs::read_to_string(folder.path().join(name)).expect("a file");
            text.split_whitespace().next().expect("a count").parse::<usize>().expect("a number")
        };
        assert_eq!(count("mesh.1.ele"), count("mesh.ele"));
        assert_eq!(count("mesh.1.node"), count("mesh.node"));
    }
}

// ---- Switches -------------------------------------------------------------------------------------------------------

#[test]
fn switches_choose_the_files() {
    let folder = folder();
    let input = save(&folder, "s.off", &sphere(5));
    let out = folder.path().join("m.ele");
    let made = |switches: &str| {
        for name in entries(folder.path()).iter().filter(|name| name.starts_with("m.")) {
            fs::remove_file(folder.path().join(name)).expect("removed");
        }
        assert_code(&fill(&input, &out, &["--tetgen", switches]), FINE);
        entries(folder.path()).into_iter().filter(|name| name.starts_with("m.")).collect::<Vec<_>>()
    };
    assert_eq!(made("-pYQ"), ["m.edge", "m.ele", "m.face", "m.node"]);
    let rows = |name: &str| fs::read_to_string(folder.path().join(name)).expect("text").lines().count();
    let (faces, edges) = (rows("m.face"), rows("m.edge"));
    assert_eq!(made("pYnfe"), ["m.edge", "m.ele", "m.face", "m.neigh", "m.node"]);
    assert!(rows("m.face") > faces && rows("m.edge") > edges);
    assert_eq!(made("pYF"), ["m.ele", "m.node"]);
    let said = stderr(&fill(&input, &out, &["--tetgen", "pYC"]));
    assert!(said.contains("'C'"), "{said}");
}

#[test]
fn switches_and_options_that_make_no_sense() {
    let folder = folder();
    let input = save(&folder, "s.off", &cube());
    let out = folder.path().join("m.vtu");
    let refused = |options: &[&str], parts: &[&str]| {
        let output = fill(&input, &out, options);
        assert_code(&output, USAGE);
        let said = stderr(&output);
        assert!(parts.iter().all(|part| said.contains(part)), "{options:?}: {said}");
    };
    refused(&["--tetgen", "pr"], &["'r'", "surface of the mesh"]);
    refused(&["--tetgen", "pYq0.3"], &["'q'", "0.3"]);
    refused(&["--tetgen", "p%"], &["'%'", "pYq1.4a0.1"]);
    refused(&["--tetgen", "pw"], &["'w'", "weight"]);
    refused(&["--tetgen", "p", "--max-volume", "1"], &["--tetgen", "--max-volume"]);
    refused(&["--no-refine", "--min-dihedral", "5"], &["--no-refine"]);
    refused(&["--max-volume", "-1"], &["--max-volume", "above 0"]);
    refused(&["--size", "nan"], &["--size", "finite"]);
    refused(&["--min-dihedral", "80"], &["--min-dihedral", "70.5"]);
    refused(&["--min-dihedral", "70.53"], &["--min-dihedral", "70.53"]);
    let nowhere = command(&input, None, &[]).output().expect("the program runs");
    assert_code(&nowhere, USAGE);
    assert!(stderr(&nowhere).contains("-o MESH"));
    assert_eq!(entries(folder.path()), ["s.off"]);
}

#[test]
fn every_angle_that_is_not_refused_is_aimed_at() {
    let folder = folder();
    let input = save(&folder, "s.off", &sphere(3));
    for options in [["--min-dihedral", "65"], ["--tetgen", "pYq1.4/65"]] {
        assert_code(&fill(&input, &folder.path().join("m.vtu"), &options), FINE);
    }
}

#[test]
fn an_input_is_not_overwritten() {
    let folder = folder();
    let input = text(&folder, "a.node", &node_list(&corners(0.0, 1.0), 0));
    let before = fs::read(&input).expect("a file");
    let refused = fill(&input, &folder.path().join("a.ele"), &[]);
    assert_code(&refused, USAGE);
    assert!(stderr(&refused).contains("a.1.ele"), "{}", stderr(&refused));
    assert_eq!(fs::read(&input).expect("a file"), before);
    assert_eq!(entries(folder.path()), ["a.node"]);
}

// ---- Input that cannot be used ---------------------------------------------------------------------------------------

/// Exit 3, one message that names the file and has all parts, and nothing left behind.
#[track_caller]
fn refuse(name: &str, content: impl AsRef<[u8]>, options: &[&str], parts: &[&str]) {
    let folder = folder();
    let input = folder.path().join(name);
    fs::write(&input, content).expect("a file");
    for out in ["out.vtu", "out.ele"] {
        let output = fill(&input, &folder.path().join(out), options);
        assert_code(&output, BAD_INPUT);
        assert!(output.stdout.is_empty());
        let said = stderr(&output);
        assert_eq!(said.trim_end().lines().count(), 1, "{said}");
        assert!(said.starts_with(&format!("anastomesh: {}", input.display())), "{said}");
        for part in parts {
            assert!(said.to_lowercase().contains(&part.to_lowercase()), "no '{part}' in: {said}");
        }
        assert_eq!(entries(folder.path()), [name]);
    }
}

fn off(mesh: &TriMesh) -> String {
    let mut out = format!("OFF\n{} {} 0\n", mesh.points.len(), mesh.triangles.len());
    for p in &mesh.points {
        let _ = writeln!(out, "{:?} {:?} {:?}", p.x, p.y, p.z);
    }
    for [a, b, c] in &mesh.triangles {
        let _ = writeln!(out, "3 {a} {b} {c}");
    }
    out
}

#[test]
fn surfaces_that_bound_no_volume() {
    let mut open = cube();
    open.triangles.truncate(10);
    refuse("a.off", off(&open), &[], &["open", "triangles", "--plc"]);
    let mut fin = cube();
    fin.points.push(Point3::new(2.0, 2.0, 2.0));
    fin.triangles.extend([[0, 1, 8], [0, 8, 1]]);
    refuse("a.off", off(&fin), &[], &["triangle 12 is there twice (also as 13)", "--repair"]);
    fin.triangles.pop();
    refuse("a.off", off(&fin), &[], &["not manifold", "--plc"]);
    let mut turned = cube();
    turned.triangles[3].swap(0, 1);
    refuse("a.off", off(&turned), &[], &["orient", "--repair", "3"]);
    let mut through = cube();
    let second = corners(0.5, 1.5);
    through.points.extend(&second);
    through.triangles.extend(cube().triangles.iter().map(|t| t.map(|v| v + 8)));
    refuse("a.off", off(&through), &[], &["meets itself", "pairs", "separate or unite"]);
}

#[test]
fn triangles_and_points_that_make_no_sense() {
    let mut flat = cube();
    flat.points.push(Point3::new(0.5, 0.0, 0.0));
    // The edge 0 1 is split on one side only in name: a triangle without area fills the gap.
    flat.triangles.push([0, 8, 1]);
    flat.triangles.push([0, 1, 8]);
    refuse("a.off", off(&flat), &["--plc"], &["no area", "12"]);
    let mut twice = cube();
    twice.points.extend(corners(0.0, 1.0));
    let n = twice.triangles.len();
    for t in &mut twice.triangles[n / 2..] {
        *t = t.map(|v| v + 8);
    }
    refuse("a.off", off(&twice), &[], &["triangles"]);
    let mut coincident = cube();
    coincident.points.push(Point3::origin());
    refuse("a.off", off(&coincident), &[], &["repeat", "--repair"]);
    for bad in ["nan", "inf", "-Infinity"] {
        refuse("a.off", off(&cube()).replacen("1.0", bad, 1), &[], &["finite", "line"]);
    }
    for bad in ["1e300", "1e-300"] {
        refuse("a.off", off(&cube()).replacen("1.0", bad, 1), &[], &["range", "scale"]);
    }
    refuse("a.off", off(&cube()).replacen("3 0 2 3", "3 0 2 0", 1), &[], &["not distinct", "0"]);
    refuse("a.off", off(&cube()).replacen("3 0 2 3", "3 0 2 8", 1), &[], &["face 0", "8"]);
    let plane: Vec<Point3> = (0..9).map(|i| Point3::new(f64::from(i % 3), f64::from(i / 3), 0.0)).collect();
    refuse("a.node", node_list(&plane, 0), &[], &["one plane"]);
    refuse("a.node", node_list(&plane[..2], 0), &[], &["four points"]);
    refuse("a.node", node_list(&[corners(0.0, 1.0), corners(0.0, 1.0)].concat(), 0), &[], &["repeat", "8"]);
}

#[test]
fn facets_that_make_no_sense() {
    let crossing = cube_smesh().replace("4 1 3 4 2 10", "4 1 4 3 2 10");
    assert_ne!(crossing, cube_smesh());
    refuse("a.smesh", crossing, &[], &["facet 1", "cross", "count from 1"]);
    refuse("a.smesh", cube_smesh().replace("4 1 3 4 2 10", "4 1 3 1 3 10"), &[], &["facet 1", "no area"]);
    refuse("a.smesh", cube_smesh().replace("4 1 3 4 2 10", "4 1 3 4 9 10"), &[], &["facet 1", "9"]);
    let half = rooms(false).replace(" 7 0.01", " 7.5 0.01");
    refuse("a.poly", half, &[], &["region 0", "7.5", "integers"]);
    // Without its lid the box holds nothing.
    refuse("a.smesh", cube_smesh().replace("6 1\n4 1 3 4 2 10\n", "5 1\n"), &[], &["enclose"]);
}

#[test]
fn files_that_hold_nothing() {
    for name in ["a.off", "a.ply", "a.stl", "a.obj", "a.node", "a.poly", "a.smesh"] {
        refuse(name, "", &[], &["empty"]);
        refuse(name, " \n\n", &[], &["empty"]);
        refuse(name, "\u{1}\u{2} garbage\n of any kind 17\n", &[], &[]);
        let noise: Vec<u8> = (0..5000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
        refuse(name, noise, &[], &[]);
    }
    let mut cut = off(&cube());
    cut.truncate(cut.len() / 2);
    refuse("a.off", cut, &[], &["line"]);
    refuse("a.xyz", off(&cube()), &[], &["extension", ".off", "--from"]);
}

#[test]
fn paths_that_cannot_be_used() {
    let folder = folder();
    let out = folder.path().join("out.vtu");
    let refused = |input: &Path, out: &Path, part: &str| {
        let output = fill(input, out, &[]);
        assert_code(&output, BAD_INPUT);
        assert!(stderr(&output).contains(part), "{}", stderr(&output));
    };
    refused(&folder.path().join("missing.off"), &out, "cannot be read");
    let directory = folder.path().join("d.off");
    fs::create_dir(&directory).expect("a folder");
    refused(&directory, &out, "directory");
    let input = save(&folder, "c.off", &cube());
    refused(&input, &folder.path().join("missing/out.ele"), "cannot be written");
    refused(&input, &folder.path().join("out.stl"), ".mesh, .ele");
    assert_eq!(entries(folder.path()), ["c.off", "d.off"]);
}

// ---- Checking and repairing ------------------------------------------------------------------------------------------

#[test]
fn inputs_are_checked_without_meshing() {
    let folder = folder();
    let input = save(&folder, "s.off", &sphere(6));
    let fine = command(&input, None, &["--check-only"]).output().expect("the program runs");
    assert_code(&fine, FINE);
    assert!(stderr(&fine).contains("no fault found"));
    let mut open = sphere(6);
    open.triangles.pop();
    let input = save(&folder, "o.off", &open);
    for options in [&["--check-only"][..], &["--tetgen", "d"]] {
        let found = command(&input, None, options).output().expect("the program runs");
        assert!(found.status.code() == Some(BAD_INPUT) || options[0] == "--tetgen", "{}", stderr(&found));
    }
    assert_eq!(entries(folder.path()), ["o.off", "s.off"]);
}

#[test]
fn what_needs_no_choice_is_repaired() {
    let folder = folder();
    // Some triangles turned over, some there twice, and each with points of its own.
    let whole = sphere(5);
    let mut broken = TriMesh::default();
    for (i, t) in whole.triangles.iter().enumerate() {
        let at = broken.points.len() as u32;
        broken.points.extend(t.map(|v| whole.points[v as usize]));
        broken.triangles.push(if i % 3 == 0 { [at, at + 2, at + 1] } else { [at, at + 1, at + 2] });
        if i % 7 == 0 {
            broken.triangles.push([at, at + 1, at + 2]);
        }
    }
    let input = save(&folder, "b.off", &broken);
    let out = folder.path().join("b.vtu");
    assert_code(&fill(&input, &out, &[]), BAD_INPUT);
    let mended = report(&input, &out, &["--repair"]);
    let said = mended["report"]["repaired"].as_array().expect("a list");
    assert_eq!(said.len(), 3, "{said:?}");
    let plain = report(&save(&folder, "w.off", &whole), &folder.path().join("w.vtu"), &[]);
    let volume = |report: &Value| report["report"]["mesh"]["volume"].as_f64().expect("a volume");
    assert!((volume(&mended) - volume(&plain)).abs() < 1e-12);
    assert_code(&check(&out), FINE);
    // Facets keep their markers, points what belongs to them.
    let doubled = cube_smesh()
        .replace("8 3 0 0", "9 3 0 0")
        .replace("6 1\n", "9 1 1 0\n6 1\n")
        .replace("4 1 3 4 2 10", "4 1 3 9 2 10");
    let input = text(&folder, "d.smesh", &doubled);
    assert_code(&fill(&input, &out, &[]), BAD_INPUT);
    let out = folder.path().join("d.ele");
    assert_eq!(report(&input, &out, &["--repair"])["report"]["mesh"]["faces"], 12);
    let mut markers = read_mesh(&out).expect("a mesh").volume.boundary_patch;
    markers.sort_unstable();
    markers.dedup();
    assert_eq!(markers, [10, 11, 12, 13, 14, 15]);
}

// ---- What other programs write ---------------------------------------------------------------------------------------

/// The cube, counted from 1, with a square far off (facet 7), one that hangs on an edge outside (8), one inside (9), and
/// a segment outside (facet 10).
fn cube_with_things_outside() -> String {
    let mut points = cube().points;
    points.extend([(3., 0.), (3., 1.)].iter().flat_map(|&(x, y)| [0., 1.].map(|z| Point3::new(x, y, z))));
    points.extend([Point3::new(-1.0, 0.0, 0.0), Point3::new(-1.0, 0.0, 1.0)]);
    points.extend([(0.25, 0.25), (0.75, 0.25), (0.75, 0.75)].map(|(x, y)| Point3::new(x, y, 0.5)));
    points.extend([Point3::new(5.0, 0.0, 0.0), Point3::new(5.0, 1.0, 1.0)]);
    let mut out = node_list(&points, 1) + "10 1\n";
    let squares = [[8, 9, 11, 10], [0, 12, 13, 4]];
    for (i, side) in SIDES.iter().chain(&squares).enumerate() {
        let [a, b, c, d] = side.map(|v| v + 1);
        let _ = writeln!(out, "1 0 {}\n4 {a} {b} {c} {d}", 10 + i);
    }
    out + "1 0 20\n3 15 16 17\n1 0 21\n2 18 19\n0\n0\n"
}

#[test]
fn facets_outside_are_left_out_with_a_note() {
    let folder = folder();
    let input = text(&folder, "a.poly", &cube_with_things_outside());
    let out = folder.path().join("b.ele");
    for options in [&[][..], &["--no-refine"], &["--split"], &["--tetgen", "pYq"], &["--tetgen", "pq1.5a0.1"]] {
        let made = &report(&input, &out, options)["report"];
        let left_out = &made["left_out"];
        assert_eq!(left_out["triangles"], 4);
        assert_eq!(left_out["faces"], serde_json::json!([7, 8]));
        assert_eq!(left_out["segments"], serde_json::json!([[18, 19]]));
        assert_eq!((&left_out["counted_from"], &left_out["unused_points"]), (&1.into(), &8.into()));
        assert!((made["mesh"]["volume"].as_f64().expect("a number") - 1.0).abs() < 1e-9);
        assert!(made["mesh"]["interior_faces"].as_u64() >= Some(1));
        let mesh = read_mesh(&out).expect("a mesh").volume;
        let marked = |marker: i32| mesh.boundary_patch.contains(&marker);
        assert!(marked(20) && marked(10) && !marked(16) && !marked(17));
        // Points keep their numbers; what was left out is no edge.
        assert_eq!(mesh.mesh.points[8], Point3::new(3.0, 0.0, 0.0));
        let edges = fs::read_to_string(out.with_extension("edge")).expect("text");
        assert!(!edges.lines().any(|line| line.contains(" 18 19 ")), "{edges}");
    }
    let made = fill(&input, &out, &["--no-refine"]);
    assert_code(&made, FINE);
    let said = stderr(&made);
    assert!(
        said.contains("4 triangles of the facets 7, 8 (counted from 1)") && said.contains("1 segments 18-19"),
        "{said}"
    );
    assert!(said.contains("no tetrahedron has: 8"), "{said}");
    let quiet = fill(&input, &out, &["--quiet"]);
    assert!(quiet.stderr.is_empty());
}

#[test]
fn strict_refuses_what_would_be_left_out() {
    let all = cube_with_things_outside();
    let parts = ["4 triangles lie outside", "filled: 7, 8 (", "their facets", "count from 1", "--strict"];
    refuse("a.poly", &all, &["--strict"], &parts);
    refuse("a.poly", &all, &["--tetgen", "pY", "--strict"], &parts);
    let segment_only = all.replace("4 9 10 12 11", "2 18 19").replace("4 1 13 14 5", "2 18 19");
    refuse("a.poly", segment_only, &["--strict"], &["1 segments", "points 18-19 (points count from 1"]);
    // Facets that repeat others are named, by their numbers.
    refuse(
        "a.poly",
        all.replace("4 9 10 12 11", "3 15 16 17"),
        &["--strict"],
        &["triangle 7 is there twice (also as 9)", "--repair"],
    );
}

/// The triangles as a binary STL file.
fn binary_stl(mesh: &TriMesh) -> Vec<u8> {
    let folder = folder();
    fs::read(save(&folder, "a.stl", mesh)).expect("a file")
}

#[test]
fn bytes_behind_a_binary_stl_are_a_warning() {
    let folder = folder();
    let whole = binary_stl(&cube());
    let longer = [whole.as_slice(), b"made by hand"].concat();
    let input = folder.path().join("a.stl");
    fs::write(&input, &longer).expect("a file");
    let out = folder.path().join("a.vtu");
    let made = fill(&input, &out, &[]);
    assert_code(&made, FINE);
    let said = stderr(&made);
    assert!(said.starts_with("warning: ") && said.contains("12 bytes") && said.contains("12 triangles"), "{said}");
    assert!(fill(&input, &out, &["--quiet"]).stderr.is_empty());
    let json = fill(&input, &out, &["--json"]);
    let json: Value = serde_json::from_slice(&json.stdout).expect("JSON");
    assert_eq!(json["report"]["notes"].as_array().map(Vec::len), Some(1));
    refuse("a.stl", &longer, &["--strict"], &["12 bytes", "--strict"]);
    refuse("a.stl", &whole[..whole.len() - 1], &[], &["684 bytes", "683"]);
}

#[test]
fn triangles_that_are_there_twice_are_named_and_joined() {
    let folder = folder();
    let out = folder.path().join("a.vtu");
    let [a, b, c] = cube().triangles[5];
    for again in [[b, c, a], [b, a, c]] {
        let mut twice = cube();
        twice.triangles.push(again);
        let bytes = binary_stl(&twice);
        refuse("a.stl", &bytes, &[], &["triangle 5 is there twice (also as 12)", "count from 0", "--repair"]);
        refuse("a.stl", &bytes, &["--plc"], &["triangle 5 is there twice (also as 12)", "--repair"]);
        for options in [&["--repair"][..], &["--repair", "--plc"]] {
            let made = report(&save(&folder, "a.stl", &twice), &out, options);
            assert_eq!(made["report"]["mesh"]["faces"], 12);
            assert_code(&check(&out), FINE);
        }
    }
    // A sheet inside: it encloses nothing, but is a facet.
    let mut sheet = cube();
    sheet.triangles.extend([[0, 1, 7], [1, 0, 7]]);
    let input = save(&folder, "s.stl", &sheet);
    assert_eq!(report(&input, &out, &["--repair"])["report"]["mesh"]["faces"], 12);
    assert_code(&check(&out), FINE);
    assert_eq!(report(&input, &out, &["--repair", "--plc"])["report"]["mesh"]["interior_faces"], 1);
}

#[test]
fn corners_that_are_not_shared_are_said_to_be_so_and_joined() {
    let folder = folder();
    let whole = cube();
    let points: Vec<Point3> = SIDES.iter().flatten().map(|&v| whole.points[v as usize]).collect();
    let line = |p: &Point3| format!("{} {} {}\n", p.x, p.y, p.z);
    let listed: String = points.iter().map(line).collect();
    let faces = |first: usize| {
        let row = |i: usize| (0..4).map(|k| format!(" {}", 4 * i + k + first)).collect::<String>();
        (0..6).map(row).collect::<Vec<_>>()
    };
    let quads = |lead: &str, first: usize| faces(first).iter().map(|row| format!("{lead}{row}\n")).collect::<String>();
    let head = "ply\nformat ascii 1.0\nelement vertex 24\nproperty float x\nproperty float y\nproperty float z\n\
        element face 6\nproperty list uchar int vertex_indices\nend_header\n";
    let vertices: String = points.iter().map(|p| format!("v {}", line(p))).collect();
    for (name, content, base) in [
        ("a.ply", format!("{head}{listed}{}", quads("4", 0)), "count from 0"),
        ("a.off", format!("OFF\n24 6 0\n{listed}{}", quads("4", 0)), "count from 0"),
        ("a.obj", format!("{vertices}{}", quads("f", 1)), "count from 1"),
    ] {
        refuse(name, &content, &[], &["corners are not shared", base, "--repair joins those at the same place"]);
        let out = folder.path().join("a.vtu");
        let made = report(&text(&folder, name, &content), &out, &["--repair"]);
        assert_eq!((&made["report"]["mesh"]["points"], &made["report"]["mesh"]["faces"]), (&8.into(), &12.into()));
        assert_code(&check(&out), FINE);
    }
}

#[test]
fn numbers_are_those_of_the_file() {
    // The last face, which has four corners as the others, is missing: so its neighbours are open.
    let whole = cube();
    let vertices: String = whole.points.iter().map(|p| format!("v {} {} {}\n", p.x, p.y, p.z)).collect();
    let faces: String =
        SIDES[..5].iter().map(|side| format!("f {}\n", side.map(|v| (v + 1).to_string()).join(" "))).collect();
    let said = "open: 4 triangles have an edge of their own: 1, 2, 3, 4; one is [2, 4] from {1, 0, 0} to {1, 1, 0} \
        (triangles have the numbers of their faces; faces and points count from 1, as in the file)";
    refuse("a.obj", vertices + &faces, &[], &[said]);
    // After a repair that drops the first two triangles and joins points the others are still called what they were.
    let mut holed = whole.clone();
    holed.triangles.splice(0..0, [[0, 0, 1], [8, 8, 8]]);
    holed.triangles.pop();
    holed.points.insert(0, whole.points[7]);
    for t in &mut holed.triangles {
        *t = t.map(|v| v + 1);
    }
    holed.triangles[1] = [0, 8, 0];
    let said = "3 triangles have an edge of their own: 4, 6, 12; one is [0, 2] from {1, 1, 1} to {1, 0, 0}";
    refuse("a.off", off(&holed), &["--repair"], &[said, "count from 0, as in the file"]);
}

#[test]
fn a_length_that_the_boundary_does_not_allow_is_told() {
    let dir = folder();
    let input = save(&dir, "cube.off", &cube());
    let out = dir.path().join("cube.vtu");
    let output = fill(&input, &out, &["--size", "0.2"]);
    assert_code(&output, FINE);
    let said = stderr(&output);
    assert!(said.contains("18 of 18 edges of the input are longer") && said.contains("--split lets them"), "{said}");
    let told = report(&input, &out, &["--size", "0.2"]);
    let unmet = &told["report"]["size_unmet"];
    assert_eq!((&unmet["longer"], &unmet["edges"]), (&18.into(), &18.into()));
    assert_eq!(told["report"]["to_split"], "--split");
    // What can be met, and what may be split, is not told.
    for options in [&["--size", "2"][..], &["--size", "0.3", "--split"]] {
        let output = fill(&input, &out, options);
        assert_code(&output, FINE);
        assert!(!stderr(&output).contains("the input stay"), "{}", stderr(&output));
        assert!(report(&input, &out, options)["report"]["size_unmet"].is_null());
    }
    // Bounds on tetrahedra say how many stand on what stays.
    let output = fill(&input, &out, &["--tetgen", "pYq1.4/46"]);
    let said = stderr(&output);
    assert!(said.contains("of them on triangles of the input") && said.contains("leaving out Y lets them"), "{said}");
}

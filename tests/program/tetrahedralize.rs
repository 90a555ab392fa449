//! Command line tests of `tetrahedralize`: formats, switches, files.

use crate::common;
use anastomesh::io::read_mesh;

use crate::common::program::*;
use crate::common::surfaces::*;
use anastomesh::testing::{MeshFormat, read_mesh_from};
use anastomesh::{Point3, TriMesh};
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

fn check(mesh: &Path) -> Output {
    run("check", &[mesh], &[])
}

// ---- Successful runs ------------------------------------------------------------------------------------------------

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
    // Counted like the input, or from 0 on demand.
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
        // The wall: 8 points in the plane, with the window filled.
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
    // Both seeds are in one region, which gets the id of the first.
    assert!(stderr(&made).contains("region point 1 lies in the region of point 0: ignored"), "{}", stderr(&made));
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

#[test]
fn named_parts_become_patches_and_choose_the_layers() {
    let folder = folder();
    // The last two sides of the cube are the ends.
    let mut obj: String =
        cube().points.iter().fold(String::new(), |text, p| text + &format!("v {} {} {}\n", p.x, p.y, p.z));
    for (i, side) in SIDES.iter().enumerate() {
        let _ = writeln!(obj, "g {}", ["wall", "wall", "wall", "wall", "foot", "head"][i]);
        let _ = writeln!(obj, "f {} {} {} {}", side[0] + 1, side[1] + 1, side[2] + 1, side[3] + 1);
    }
    let input = text(&folder, "bar.obj", &obj);
    let out = folder.path().join("out.vtu");
    let report = &report(&input, &out, &["--layers", "2", "--layers-on", "wall"])["report"];
    assert_eq!(report["layers"]["tets"], 2 * 3 * 8);
    assert_eq!((&report["layers"]["shrunk_caps"], &report["layers"]["kept_caps"]), (&2.into(), &0.into()));
    assert_code(&check(&out), FINE);
    let mesh = read_mesh(&out).expect("a mesh").volume;
    assert_eq!(mesh.patches.iter().map(|p| p.name.as_str()).collect::<Vec<_>>(), ["wall", "foot", "head"]);
    let with = |patch: i32| mesh.boundary_patch.iter().filter(|&&id| id == patch).count();
    assert_eq!([1, 2, 3].map(with), [8, 2 + 4 * 2 * 2, 2 + 4 * 2 * 2]);
    assert_says(&fill(&input, &out, &["--layers", "2", "--layers-on", "lid"]), USAGE, &["'lid'", "wall, foot, head"]);
    let plain = save(&folder, "c.off", &cube());
    assert_says(&fill(&plain, &out, &["--layers", "2", "--layers-on", "1"]), USAGE, &["has none"]);
}

#[test]
fn several_surfaces_are_one_complex_with_regions() {
    let folder = folder();
    let outer = save(&folder, "box.stl", &scaled(&cube(), 4.0));
    let inner = save(&folder, "core.off", &scaled(&cube(), 1.0));
    let out = folder.path().join("out.msh");
    let options = ["--region", "0.1,0.2,0.1:id=7", "--region", "3,3,3"];
    let output = run(
        "tetrahedralize",
        &[&outer, &inner],
        &[&["-o", out.to_str().expect("text"), "--json"][..], &options].concat(),
    );
    assert_code(&output, FINE);
    let regions = json(&output)["report"]["regions"].as_array().expect("a list").clone();
    assert_eq!(regions.iter().map(|r| r["id"].as_i64()).collect::<Vec<_>>(), [Some(2), Some(7)]);
    let volume = regions[1]["volume"].as_f64().expect("a number");
    assert!((volume - 1.0).abs() < 1e-12, "{volume}");
    let mesh = read_mesh(&out).expect("a mesh").volume;
    assert_eq!(mesh.patches.iter().map(|p| p.name.as_str()).collect::<Vec<_>>(), ["box", "core"]);
    assert_code(&check(&out), FINE);
    let hole = ["-o", out.to_str().expect("text"), "--json", "--hole", "0.5,0.5,0.4"];
    let report = &json(&run("tetrahedralize", &[&outer, &inner], &hole))["report"];
    assert!((report["mesh"]["volume"].as_f64().expect("a number") - 63.0).abs() < 1e-9);
    let points = text(&folder, "a.node", "1 3 0 0\n0 0 0 0\n");
    let mixed = run("tetrahedralize", &[&outer, &points], &["-o", out.to_str().expect("text")]);
    assert_says(&mixed, USAGE, &["a.node is not a surface"]);
    assert_says(&fill(&outer, &out, &["--hole", "1,1,1"]), USAGE, &["--plc"]);
    assert_says(&fill(&outer, &out, &["--region", "1,1"]), USAGE, &["X,Y,Z"]);
}

#[test]
fn layers_lie_on_both_sides_of_facets_or_in_the_regions_chosen() {
    let folder = folder();
    let outer = save(&folder, "tissue.stl", &scaled(&cube(), 4.0));
    let inner = save(&folder, "fluid.off", &scaled(&cube(), 1.0));
    let out = folder.path().join("out.vtu");
    let made = |options: &[&str]| {
        let general = ["-o", out.to_str().expect("text"), "--json", "--layers", "2", "--layer-thickness", "0.3"];
        let seeds = ["--region", "0.1,0.2,0.1:id=7", "--region", "2.5,2.5,2.5:id=3"];
        run("tetrahedralize", &[&outer, &inner], &[&general[..], &seeds, options].concat())
    };
    for (options, triangles, regions) in [
        (&[][..], 12 + 2 * 12, 2),
        (&["--layers-on", "fluid"], 2 * 12, 2),
        (&["--layers-on", "fluid", "--layers-in", "7"], 12, 1),
        (&["--layers-in", "7,3", "--layers-on", "tissue"], 12, 1),
    ] {
        let output = made(options);
        assert_code(&output, FINE);
        let report = &json(&output)["report"];
        let layers = &report["layers"];
        assert_eq!(
            (&layers["tets"], &layers["regions"]),
            (&(2 * 3 * triangles).into(), &regions.into()),
            "{options:?}"
        );
        let volume = report["regions"][1]["volume"].as_f64().expect("a number");
        assert!((volume - 1.0).abs() < 1e-12, "{volume}");
        assert_code(&check(&out), FINE);
    }
    assert_says(&made(&["--layers-in", "4"]), USAGE, &["--layers-in", "number 4"]);
    assert_says(&made(&["--layers-in", "7", "--layers-on", "tissue"]), USAGE, &["none of their facets bounds"]);
}

/// Cube with a corner at the origin moved by a fourth of its size, scaled.
fn scaled(cube: &TriMesh, factor: f64) -> TriMesh {
    let shift = if factor > 1.0 { -1.0 } else { 0.0 };
    let points = cube.points.iter().map(|p| p.map(|x| x * factor + shift)).collect();
    TriMesh { points, triangles: cube.triangles.clone() }
}

#[test]
fn attributes_of_regions_may_be_real() {
    let folder = folder();
    let real = rooms(false).replace("0.5 7 0.01", "0.5 0.25 0.01").replace("0.5 -9 0.05", "0.5 1.5 0.05");
    let input = text(&folder, "real.poly", &real);
    let out = folder.path().join("real.1.ele");
    let made = fill(&input, &out, &["--no-refine"]);
    assert_code(&made, FINE);
    assert!(stderr(&made).contains("numbered from 1"), "{}", stderr(&made));
    let file = fs::read_to_string(&out).expect("a file");
    let mut last: Vec<&str> =
        file.lines().skip(1).filter(|l| !l.starts_with('#')).filter_map(|l| l.split(' ').next_back()).collect();
    last.sort_unstable();
    last.dedup();
    assert_eq!(last, ["0.25", "1.5"]);
}

#[test]
fn layers_are_made_and_what_cannot_be_is_refused() {
    let folder = folder();
    let input = save(&folder, "c.off", &cube());
    let out = folder.path().join("out.vtu");
    let report = &report(&input, &out, &["--layers", "2", "--layer-growth", "2", "--layer-thickness", "0.3"])["report"];
    assert_eq!(report["layers"]["tets"], 2 * 3 * 12);
    assert_eq!(report["layers"]["without"], serde_json::json!([]));
    assert_code(&check(&out), FINE);
    for (options, words) in [
        (&["--layers", "0"][..], &["1 to 30"][..]),
        (&["--layers", "3", "--layer-growth", "-1"], &["0.2 to 5"]),
        (&["--layers", "3", "--layer-thickness", "1.5"], &["0.001 to 0.8"]),
        (&["--layers", "29", "--layer-growth", "3"], &["give fewer or thicker layers"]),
        (&["--layers", "3", "--split"], &["the boundary may be split"]),
        (&["--layers", "3", "--layers-in", "2"], &["--layers-in", "number 2"]),
        (&["--layers-in", "2"], &["--layers"]),
        (&["--layer-growth", "2"], &["--layers"]),
    ] {
        assert_says(
            &run("tetrahedralize", &[&input], &[&["-o", out.to_str().expect("text")], options].concat()),
            USAGE,
            words,
        );
    }
}

#[test]
fn needles_of_a_surface_are_remeshed_on_request() {
    let folder = folder();
    let input = save(&folder, "s.off", &sphere(30));
    let out = folder.path().join("out.vtu");
    let report = &report(&input, &out, &["--remesh-surface=0.01", "--layers", "2"])["report"];
    let change = &report["remeshed"];
    let pair = |name: &str| [0, 1].map(|i| change[name][i].as_f64().expect("a number"));
    let [before, after] = pair("smallest_angle");
    assert!(before < 6.0 && after > 20.0, "{change}");
    assert!(change["distance"].as_f64() <= Some(0.01) && change["tolerance"] == 0.01, "{change}");
    assert_eq!(report["mesh"]["faces"], change["triangles"][1]);
    assert_eq!(report["input"]["triangles"], change["triangles"][0]);
    assert_code(&check(&out), FINE);
    let said = run("tetrahedralize", &[&input], &["-o", out.to_str().expect("text"), "--remesh-surface"]);
    assert_code(&said, FINE);
    assert!(stderr(&said).contains("remeshed") && stderr(&said).contains("max distance"), "{}", stderr(&said));
    let points = text(&folder, "p.node", "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n");
    for (input, options, words) in [
        (&input, &["--remesh-surface=0"][..], &["above zero"][..]),
        (&input, &["--remesh-surface", "--split"], &["--split"]),
        (&input, &["--remesh-surface", "--tetgen", "pY"], &["--tetgen"]),
        (&points, &["--remesh-surface"], &["only points"]),
    ] {
        let out = ["-o", out.to_str().expect("text")];
        assert_says(&run("tetrahedralize", &[input], &[&out, options].concat()), USAGE, words);
    }
}

#[test]
fn segments_and_markers_outlive_remeshing() {
    let folder = folder();
    let input = text(&folder, "c.smesh", &cube_smesh());
    let out = folder.path().join("out.ele");
    let report = &report(&input, &out, &["--remesh-surface", "--size", "0.3"])["report"];
    assert!(report["mesh"]["faces"].as_u64() > Some(12), "{report}");
    assert!(report["mesh"]["volume"].as_f64().is_some_and(|volume| volume > 0.0));
}

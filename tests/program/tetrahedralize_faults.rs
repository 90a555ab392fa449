//! Command line tests of `tetrahedralize` on faulty input: messages, exit codes, repairs, omissions.

use crate::common::program::*;
use crate::common::surfaces::*;
use anastomesh::Point3;
use anastomesh::TriMesh;
use anastomesh::io::read_mesh;
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Output;

fn check(mesh: &Path) -> Output {
    run("check", &[mesh], &[])
}

// ---- Input that cannot be used --------------------------------------------------------------------------------------

/// Asserts exit code 3, one message with the file name and all parts, and no output files.
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

#[test]
fn surfaces_that_bound_no_volume() {
    let mut open = cube();
    open.triangles.truncate(10);
    refuse("a.off", off(&open), &[], &["open", "triangles", "--plc"]);
    let mut fin = cube();
    fin.points.push(Point3::new(2.0, 2.0, 2.0));
    fin.triangles.extend([[0, 1, 8], [0, 8, 1]]);
    refuse("a.off", off(&fin), &[], &["triangle 12 is duplicated by 13", "--repair"]);
    fin.triangles.pop();
    refuse("a.off", off(&fin), &[], &["not manifold", "--plc"]);
    let mut turned = cube();
    turned.triangles[3].swap(0, 1);
    refuse("a.off", off(&turned), &[], &["orient", "--repair", "3"]);
    let mut through = cube();
    let second = corners(0.5, 1.5);
    through.points.extend(&second);
    through.triangles.extend(cube().triangles.iter().map(|t| t.map(|v| v + 8)));
    refuse("a.off", off(&through), &[], &["intersects itself", "pair", "separate or unite"]);
}

#[test]
fn triangles_and_points_that_make_no_sense() {
    let mut flat = cube();
    flat.points.push(Point3::new(0.5, 0.0, 0.0));
    // Point 8 lies on edge 0 1. Two degenerate triangles close the gap between the edge and the point.
    flat.triangles.push([0, 8, 1]);
    flat.triangles.push([0, 1, 8]);
    refuse("a.off", off(&flat), &["--plc"], &["without area", "12"]);
    let mut twice = cube();
    twice.points.extend(corners(0.0, 1.0));
    let n = twice.triangles.len();
    for t in &mut twice.triangles[n / 2..] {
        *t = t.map(|v| v + 8);
    }
    refuse("a.off", off(&twice), &[], &["triangles"]);
    let mut coincident = cube();
    coincident.points.push(Point3::origin());
    refuse("a.off", off(&coincident), &[], &["1 duplicate point:", "--repair"]);
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
    refuse("a.node", node_list(&[corners(0.0, 1.0), corners(0.0, 1.0)].concat(), 0), &[], &["8 duplicate points"]);
}

#[test]
fn facets_that_make_no_sense() {
    let crossing = cube_smesh().replace("4 1 3 4 2 10", "4 1 4 3 2 10");
    assert_ne!(crossing, cube_smesh());
    refuse("a.smesh", crossing, &[], &["facet 1", "cross", "count from 1"]);
    refuse("a.smesh", cube_smesh().replace("4 1 3 4 2 10", "4 1 3 1 3 10"), &[], &["facet 1", "no area"]);
    refuse("a.smesh", cube_smesh().replace("4 1 3 4 2 10", "4 1 3 4 9 10"), &[], &["facet 1", "9"]);
    // Without its lid the box encloses nothing.
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
    refused(&input, &folder.path().join("out.stl"), ".mesh, .foam, .svmesh, .npyd, .ele");
    assert_eq!(entries(folder.path()), ["c.off", "d.off"]);
}

// ---- Checking and repairing -----------------------------------------------------------------------------------------

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
    // Some triangles inverted, some duplicated, all with separate points.
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
    // Facets keep their markers, and points their attributes.
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

// ---- Files of other programs ----------------------------------------------------------------------------------------

/// The cube, counted from 1, with facets and a segment outside or inside. Facet 7 is a distant square, 8 hangs on an
/// outer edge, 9 is inside, and 10 holds the segment.
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
        // Points keep their numbers; omitted elements have no edges.
        assert_eq!(mesh.mesh.points[8], Point3::new(3.0, 0.0, 0.0));
        let edges = fs::read_to_string(out.with_extension("edge")).expect("text");
        assert!(!edges.lines().any(|line| line.contains(" 18 19 ")), "{edges}");
    }
    let made = fill(&input, &out, &["--no-refine"]);
    assert_code(&made, FINE);
    let said = stderr(&made);
    assert!(
        said.contains(
            "omitted: 4 triangles of the facets outside the filled region, or in a hole (--strict refuses this): 7, 8 ("
        ) && said.contains("omitted: 1 segment outside")
            && said.contains(": 18-19 ("),
        "{said}"
    );
    assert!(said.contains("unused: 8 input points without tetrahedra"), "{said}");
    let quiet = fill(&input, &out, &["--quiet"]);
    assert!(quiet.stderr.is_empty());
}

#[test]
fn strict_refuses_what_would_be_left_out() {
    let all = cube_with_things_outside();
    let parts = ["4 triangles outside", "filled region: 7, 8 (", "their facets", "count from 1", "--strict"];
    refuse("a.poly", &all, &["--strict"], &parts);
    refuse("a.poly", &all, &["--tetgen", "pY", "--strict"], &parts);
    let segment_only = all.replace("4 9 10 12 11", "2 18 19").replace("4 1 13 14 5", "2 18 19");
    refuse("a.poly", segment_only, &["--strict"], &["1 segment outside", "points 18-19 (points count from 1"]);
    // Duplicate facets are listed by their numbers.
    refuse(
        "a.poly",
        all.replace("4 9 10 12 11", "3 15 16 17"),
        &["--strict"],
        &["triangle 7 is duplicated by 9", "--repair"],
    );
}

/// Triangles as a binary STL file.
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
        refuse("a.stl", &bytes, &[], &["triangle 5 is duplicated by 12", "count from 0", "--repair"]);
        refuse("a.stl", &bytes, &["--plc"], &["triangle 5 is duplicated by 12", "--repair"]);
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
        refuse(name, &content, &[], &["vertices are not merged", base, "merge them, or give --repair"]);
        let out = folder.path().join("a.vtu");
        let made = report(&text(&folder, name, &content), &out, &["--repair", "--no-refine"]);
        assert_eq!((&made["report"]["mesh"]["points"], &made["report"]["mesh"]["faces"]), (&8.into(), &12.into()));
        assert_code(&check(&out), FINE);
    }
}

#[test]
fn numbers_are_those_of_the_file() {
    // The last quadrilateral face is missing, so its neighbours have open edges.
    let whole = cube();
    let vertices: String = whole.points.iter().map(|p| format!("v {} {} {}\n", p.x, p.y, p.z)).collect();
    let faces: String =
        SIDES[..5].iter().map(|side| format!("f {}\n", side.map(|v| (v + 1).to_string()).join(" "))).collect();
    let said = "open: 4 triangles with an unshared edge: 1, 2, 3, 4; one edge is [2, 4] from {1, 0, 0} to {1, 1, 0} \
        (triangles have the numbers of their faces; faces and points count from 1, as in the file)";
    refuse("a.obj", vertices + &faces, &[], &[said]);
    // After a repair that removes two triangles and merges points, the others keep their numbers.
    let mut holed = whole.clone();
    holed.triangles.splice(0..0, [[0, 0, 1], [8, 8, 8]]);
    holed.triangles.pop();
    holed.points.insert(0, whole.points[7]);
    for t in &mut holed.triangles {
        *t = t.map(|v| v + 1);
    }
    holed.triangles[1] = [0, 8, 0];
    let said = "3 triangles with an unshared edge: 4, 6, 12; one edge is [0, 2] from {1, 1, 1} to {1, 0, 0}";
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
    assert!(said.contains("by 18 of 18 input edges") && said.contains("--split allows splitting them"), "{said}");
    let told = report(&input, &out, &["--size", "0.2"]);
    let unmet = &told["report"]["size_unmet"];
    assert_eq!((&unmet["longer"], &unmet["edges"]), (&18.into(), &18.into()));
    assert_eq!(told["report"]["to_split"], "--split");
    // Satisfiable requests and splittable input cause no message.
    for options in [&["--size", "2"][..], &["--size", "0.3", "--split"]] {
        let output = fill(&input, &out, options);
        assert_code(&output, FINE);
        assert!(!stderr(&output).contains("input triangles are fixed"), "{}", stderr(&output));
        assert!(report(&input, &out, options)["report"]["size_unmet"].is_null());
    }
    // Violated bounds report the number of tetrahedra at fixed faces.
    let output = fill(&input, &out, &["--tetgen", "pYq1.4/46"]);
    let said = stderr(&output);
    assert!(
        said.contains("at fixed input triangles") && said.contains("leaving out Y allows splitting them"),
        "{said}"
    );
}

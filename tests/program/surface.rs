//! Command line tests of `surface`: the wall of a network in every format, as read by other programs.

use crate::common::oracle::missing;
use crate::common::program::*;
use crate::common::{fixture, shared};
use anastomesh::TriMesh;
use anastomesh::io::read_surface;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

const FORMATS: [&str; 7] = ["stl", "ply", "obj", "off", "glb", "3mf", "vtp"];

fn surface(network: &Path, out: &Path, options: &[&str]) -> std::process::Output {
    run("surface", &[network, Path::new("--output"), out], options)
}

/// Number of edges without an opposite partner.
fn open_edges(mesh: &TriMesh) -> usize {
    let mut edges: BTreeMap<[u32; 2], i32> = BTreeMap::new();
    for &[a, b, c] in &mesh.triangles {
        for [a, b] in [[a, b], [b, c], [c, a]] {
            *edges.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
        }
    }
    edges.values().filter(|&&sum| sum != 0).count()
}

#[test]
fn the_wall_is_written_in_every_format() {
    let folder = folder();
    for format in FORMATS {
        let out = folder.path().join("wall").with_extension(format);
        let made = surface(&fixture("tree_30.swc"), &out, &[]);
        assert_code(&made, FINE);
        assert!(made.stdout.is_empty() && stderr(&made).ends_with("\nvalid\n"), "{}", stderr(&made));
        assert!(!stderr(&made).contains("tetrahedra"), "{}", stderr(&made));
        if ["stl", "ply", "obj", "off"].contains(&format) {
            let wall = read_surface(&out).expect("a surface");
            assert!(wall.triangles.len() > 1000 && open_edges(&wall) == 0);
        }
    }
    assert_eq!(entries(folder.path()).len(), FORMATS.len());
    let open = folder.path().join("open.ply");
    assert_code(&surface(&fixture("tree_30.swc"), &open, &["--no-caps", "-q"]), FINE);
    assert!(open_edges(&read_surface(&open).expect("a surface")) > 0);
}

#[test]
fn it_is_the_boundary_of_the_mesh() {
    let folder = folder();
    let (mesh_path, wall_path) = (folder.path().join("tree.vtu"), folder.path().join("wall.ply"));
    assert_code(&mesh(&fixture("tree_30.swc"), &mesh_path, &["-q"]), FINE);
    let made = surface(&fixture("tree_30.swc"), &wall_path, &["--json"]);
    assert_code(&made, FINE);
    let volume = anastomesh::io::read_mesh(&mesh_path).expect("a mesh").volume;
    let wall = read_surface(&wall_path).expect("a surface");
    let report = json(&made);
    assert_eq!(report["check"]["counts"]["boundary_faces"], volume.boundary.len());
    let sorted = |points: &[anastomesh::Point3], faces: &[[u32; 3]]| {
        let mut all: Vec<[[u64; 3]; 3]> = faces
            .iter()
            .map(|face| {
                let mut corners = face.map(|v| <[f64; 3]>::from(points[v as usize].coords).map(f64::to_bits));
                corners.sort_unstable();
                corners
            })
            .collect();
        all.sort_unstable();
        all
    };
    assert_eq!(sorted(&wall.points, &wall.triangles), sorted(&volume.mesh.points, &volume.boundary));
}

#[test]
fn the_bytes_do_not_depend_on_the_threads() {
    let folder = folder();
    for format in FORMATS {
        let [one, two] = ["1", "2"].map(|threads| {
            let out = folder.path().join(threads).with_extension(format);
            assert_code(&surface(&fixture("tree_30.swc"), &out, &["-q", "-j", threads]), FINE);
            fs::read(out).expect("a file")
        });
        assert!(one == two, "{format}");
    }
}

#[test]
fn what_cannot_be_written_is_refused_before_any_work() {
    let folder = folder();
    let network = fixture("tree_30.swc");
    assert_says(&surface(&network, &folder.path().join("wall.vtu"), &[]), BAD_INPUT, &["wall.vtu", ".glb"]);
    assert_says(&surface(&network, &folder.path().join("wall.stl"), &["--rho", "1"]), USAGE, &["rho"]);
    let hopeless = folder.path().join("hopeless.vtp");
    fs::write(&hopeless, HOPELESS).expect("written");
    assert_says(&surface(&hopeless, &folder.path().join("wall.stl"), &[]), STAGE_FAILED, &["FAILED", "--keep-going"]);
    assert_eq!(entries(folder.path()), ["hopeless.vtp"]);
}

#[test]
fn slicers_accept_it() {
    let Some(shared) = shared() else { return };
    if Command::new("admesh").arg("--version").output().is_err() {
        return missing("admesh is not there (apt-get install admesh)");
    }
    let folder = folder();
    let out = folder.path().join("wall.stl");
    let made = surface(&shared.join("data/kidney/subtree_289_clear.vtp"), &out, &["-q"]);
    assert_code(&made, FINE);
    let said = Command::new("admesh").arg(&out).output().expect("admesh runs");
    // Behind the header of 80 bytes it prints whatever follows in its memory.
    let said = String::from_utf8_lossy(&said.stdout);
    // Repairs that it would report.
    for line in
        ["Edges fixed", "Facets removed", "Facets added", "Facets reversed", "Backwards edges", "Degenerate facets"]
    {
        let found = said.lines().find(|l| l.contains(line)).unwrap_or_else(|| panic!("'{line}' in {said}"));
        let count = found.split(':').nth(1).and_then(|rest| rest.split_whitespace().next());
        assert_eq!(count, Some("0"), "{said}");
    }
}

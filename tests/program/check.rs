//! Command line tests of `check`: files that are not meshes, and invalid meshes.

use crate::common::fixture;
use crate::common::program::*;
use anastomesh::io::{MeshNotes, read_mesh, write_mesh};
use anastomesh::mesh::shapes::walled_channel;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Mesh of the fixture, created once per test.
fn tree_mesh(folder: &TempDir, name: &str) -> PathBuf {
    let out = folder.path().join(name);
    assert_code(&mesh(&fixture("tree_30.vtp"), &out, &["-q", "--rho", "2.5"]), FINE);
    out
}

#[test]
fn check_refuses_what_is_no_mesh() {
    let folder = folder();
    let refused = |path: &Path, needles: &[&str]| {
        let output = run("check", &[path], &["--json"]);
        assert_code(&output, BAD_INPUT);
        assert_message(&output, path, needles);
    };
    refused(&folder.path().join("missing.vtu"), &["No such file"]);
    refused(folder.path(), &["directory"]);
    for name in ["mesh.vtu", "mesh.msh"] {
        let path = tree_mesh(&folder, name);
        let whole = fs::read(&path).expect("the mesh");
        let end = whole.trim_ascii_end().len();
        for length in [1, end / 100, end / 10, end / 2, end * 9 / 10, end * 99 / 100] {
            fs::write(&path, &whole[..length]).expect("a file");
            refused(&path, &[]);
        }
        fs::write(&path, "").expect("a file");
        refused(&path, &["empty"]);
        fs::write(&path, "It was the best of times.\n").expect("a file");
        refused(&path, &[]);
        let noise: Vec<u8> = (0..4096_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
        fs::write(&path, noise).expect("a file");
        refused(&path, &[]);
    }
    let path = folder.path().join("mesh.stl");
    fs::write(&path, "solid\n").expect("a file");
    refused(&path, &["extension", ".vtu, .pvtu, .msh"]);
    // A network is not a mesh.
    let network = folder.path().join("network.vtu");
    fs::copy(fixture("tree_30.vtp"), &network).expect("a copy");
    refused(&network, &["PolyData", "UnstructuredGrid"]);
}

#[test]
fn check_finds_what_is_broken() {
    let folder = folder();
    let path = tree_mesh(&folder, "mesh.vtu");
    let sound = read_mesh(&path).expect("a mesh");
    let fails = |broken: &anastomesh::VolumeMesh, statement: &str| {
        for name in ["broken.vtu", "broken.msh"] {
            let path = folder.path().join(name);
            write_mesh(&path, broken, &sound.notes).expect("a file");
            let output = run("check", &[&path], &[]);
            assert_code(&output, GATE_NOT_MET);
            let said = stdout(&output);
            assert!(
                said.contains(&format!("FAIL {statement}\n"))
                    && said.lines().last().is_some_and(|line| line.starts_with("NOT valid: ")),
                "{said}"
            );
            let verdict = &json(&run("check", &[&path], &["--json"]))["verdict"];
            assert_eq!(verdict, "invalid");
        }
    };
    let mut inverted = sound.volume.clone();
    inverted.mesh.tets[100].swap(0, 1);
    fails(&inverted, "1 tetrahedron is inverted or flat");
    let mut holed = sound.volume.clone();
    holed.mesh.tets.remove(100);
    holed.tet_block.remove(100);
    fails(&holed, "the labelled triangles differ from the boundary faces at 4 places");
    let mut mislabelled = sound.volume.clone();
    let cap = mislabelled.boundary_patch.iter().position(|&p| p == 2).expect("an inlet");
    mislabelled.boundary_patch[cap] = 3;
    fails(&mislabelled, "2 caps are not discs");
}

#[test]
fn regions_are_checked_and_listed() {
    let folder = folder();
    let (volume, regions) = walled_channel(1);
    let notes = MeshNotes { regions, ..MeshNotes::default() };
    for name in ["organ.vtu", "organ.msh", "organ.mesh", "organ.ele", "organ.npyd"] {
        let path = folder.path().join(name);
        write_mesh(&path, &volume, &notes).expect("a file");
        let output = run("check", &[&path], &[]);
        assert_code(&output, FINE);
        let second = if name == "organ.ele" { "region_2" } else { "wall" };
        let line = format!("region   {second}: 240 tetrahedra, 1 component, 192 boundary faces, volume 0.32000\n");
        assert!(stdout(&output).contains(&line), "{}", stdout(&output));
    }
    let mut broken = volume.clone();
    let face = broken.boundary_patch.iter().position(|&patch| patch == 4).expect("an interface");
    broken.boundary_patch[face] = 5;
    let path = folder.path().join("broken.vtu");
    write_mesh(&path, &broken, &notes).expect("a file");
    let output = run("check", &[&path], &["--json"]);
    assert_code(&output, GATE_NOT_MET);
    let report = json(&output);
    assert_eq!(report["regions"][2]["name"], "tissue");
    let failed: Vec<_> = report["lines"].as_array().expect("lines").iter().filter(|l| l["outcome"] == "fail").collect();
    assert_eq!(failed.len(), 1);
    assert_eq!(failed[0]["line"], "interface_sides");
}

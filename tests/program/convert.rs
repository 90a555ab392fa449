//! Command line tests of `convert`: contents are preserved in other formats.

use crate::common::fixture;
use crate::common::program::*;
use anastomesh::io::{MeshNotes, NetworkOptions, read_mesh, read_network, read_surface, write_mesh};
use anastomesh::mesh::shapes::walled_channel;
use std::fs;
use std::path::Path;

fn convert(input: &Path, out: &Path, options: &[&str]) -> std::process::Output {
    run("convert", &[input, Path::new("--output"), out], options)
}

#[test]
fn meshes_become_each_other() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    assert_code(&mesh(&fixture("tree_30.swc"), &at("tree.vtu"), &["-q"]), FINE);
    let expected = read_mesh(&at("tree.vtu")).expect("a mesh");
    for name in ["a.pvtu", "a.msh", "a.msh2", "a.mesh", "a.ele", "a.vtu"] {
        let made = convert(&at("tree.vtu"), &at(name), &[]);
        assert_code(&made, FINE);
        assert!(stderr(&made).replace(',', "").contains(&format!("{} tetrahedra", expected.volume.mesh.tets.len())));
        let back = at(&format!("back_{}.vtu", name.replace('.', "_")));
        assert_code(&convert(&at(name), &back, &["-q"]), FINE);
        let file = read_mesh(&back).expect("a mesh");
        assert_eq!(file.volume.mesh.tets.len(), expected.volume.mesh.tets.len(), "{name}");
        assert_eq!(file.volume.boundary.len(), expected.volume.boundary.len(), "{name}");
    }
    assert!(fs::read(at("a.vtu")).expect("a file") == fs::read(at("tree.vtu")).expect("a file"));
    // Blockwise conversion gives equal results.
    let pieces = convert(&at("tree.vtu"), &at("pieces.vtu"), &["--memory", "1MiB"]);
    assert_code(&pieces, FINE);
    assert!(!stderr(&pieces).contains("loaded completely"), "{}", stderr(&pieces));
    assert_eq!(read_mesh(&at("pieces.vtu")).expect("a mesh"), expected);
}

#[test]
fn regions_are_split() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let (volume, regions) = walled_channel(2);
    let notes = MeshNotes { regions, ..MeshNotes::default() };
    write_mesh(&at("organ.vtu"), &volume, &notes).expect("a file");
    let made = convert(&at("organ.vtu"), &at("parts.msh"), &["--split-regions"]);
    assert_code(&made, FINE);
    assert_eq!(read_mesh(&at("parts.msh")).expect("a mesh").volume, volume);
    for name in ["parts_lumen.vtu", "parts_wall.vtu", "parts_tissue.vtu"] {
        assert!(stderr(&made).contains(name), "{}", stderr(&made));
        let checked = run("check", &[&at(name)], &[]);
        assert_code(&checked, FINE);
        assert!(!stdout(&checked).contains("FAIL"), "{}", stdout(&checked));
    }
    let split = convert(&at("organ.vtu"), &at("organ.stl"), &["--split-regions"]);
    assert_code(&split, USAGE);
    // A mesh without regions.
    write_mesh(&at("plain.vtu"), &volume, &MeshNotes::default()).expect("a file");
    let split = convert(&at("plain.vtu"), &at("b.vtu"), &["--split-regions"]);
    assert_code(&split, BAD_INPUT);
    assert!(stderr(&split).contains("the mesh has no regions to split"), "{}", stderr(&split));
    assert!(!at("b.vtu").exists());
}

#[test]
fn a_mesh_has_a_boundary() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    assert_code(&mesh(&fixture("tree_30.swc"), &at("tree.vtu"), &["-q"]), FINE);
    let volume = read_mesh(&at("tree.vtu")).expect("a mesh").volume;
    for name in ["a.stl", "a.ply", "a.obj", "a.off", "a.glb", "a.3mf", "a.vtp"] {
        assert_code(&convert(&at("tree.vtu"), &at(name), &["-q"]), FINE);
    }
    let whole = read_surface(&at("a.ply")).expect("a surface");
    assert_eq!(whole.triangles.len(), volume.boundary.len());
    assert_code(&convert(&at("tree.vtu"), &at("wall.ply"), &["-q", "--no-caps"]), FINE);
    let wall = read_surface(&at("wall.ply")).expect("a surface");
    assert_eq!(wall.triangles.len(), volume.boundary_patch.iter().filter(|&&p| p == 1).count());
    // Without labels the boundary consists of faces with a single tetrahedron.
    assert_code(&mesh(&fixture("tree_30.swc"), &at("alone.vtu"), &["-q", "--cells", "tets"]), FINE);
    assert_code(&convert(&at("alone.vtu"), &at("alone.off"), &["-q"]), FINE);
    assert_eq!(read_surface(&at("alone.off")).expect("a surface").triangles.len(), volume.boundary.len());
}

#[test]
fn surfaces_and_networks_become_each_other() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let torus = read_surface(&fixture("torus.off")).expect("a surface");
    for name in ["a.ply", "a.obj", "a.stl", "a.off", "a.glb", "a.3mf", "a.vtp"] {
        let made = convert(&fixture("torus.off"), &at(name), &["--json"]);
        assert_code(&made, FINE);
        assert_eq!(json(&made)["triangles"], torus.triangles.len());
    }
    assert_eq!(read_surface(&at("a.ply")).expect("a surface"), torus);
    let read = |path: &Path| read_network(path, &NetworkOptions::default()).expect("a network").skeleton;
    let tree = read(&fixture("tree_30.vtp"));
    assert_code(&convert(&fixture("tree_30.vtp"), &at("tree.swc"), &["-q"]), FINE);
    assert_code(&convert(&at("tree.swc"), &at("tree.vtp"), &["-q"]), FINE);
    for name in ["tree.swc", "tree.vtp"] {
        let back = read(&at(name));
        let places = |network: &anastomesh::network::Skeleton| -> Vec<[u64; 3]> {
            network.nodes.iter().map(|n| <[f64; 3]>::from(n.position.coords).map(f64::to_bits)).collect()
        };
        assert_eq!((places(&back), back.edges.len()), (places(&tree), tree.edges.len()), "{name}");
    }
}

#[test]
fn kinds_that_do_not_fit_are_named_before_any_work() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let network = fixture("tree_30.swc");
    assert_says(&convert(&network, &at("a.vtu"), &[]), USAGE, &["a network", "a volume mesh", "anastomesh mesh"]);
    assert_says(&convert(&network, &at("a.stl"), &[]), USAGE, &["a network", "a surface", "anastomesh surface"]);
    assert_says(&convert(&fixture("torus.off"), &at("a.msh"), &[]), USAGE, &["a surface", "tetrahedralize"]);
    assert_says(&convert(&at("none.vtu"), &at("a.swc"), &[]), BAD_INPUT, &["a.swc", ".glb"]);
    assert_says(&convert(&at("none.vtu"), &at("a.msh"), &[]), BAD_INPUT, &["none.vtu", "cannot be read"]);
    assert_says(&convert(&at("none.xyz"), &at("a.msh"), &[]), BAD_INPUT, &["none.xyz", "--help"]);
    assert_says(&convert(&network, &at("a.xyz"), &[]), BAD_INPUT, &["a.xyz"]);
    assert!(entries(folder.path()).is_empty());
}

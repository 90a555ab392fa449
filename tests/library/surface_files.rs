//! Real OFF surfaces, converted to every other format and back.

use crate::common;
use anastomesh::TriMesh;
use anastomesh::io::{read_surface, write_surface};

/// Corner coordinate bits of the triangles (−0 as 0): the information that STL preserves.
fn places(mesh: &TriMesh) -> Vec<[[u64; 3]; 3]> {
    let bits = |v: u32| mesh.points[v as usize].coords.map(|x| (x + 0.0).to_bits()).into();
    mesh.triangles.iter().map(|t| t.map(bits)).collect()
}

#[test]
fn real_surfaces_are_read_and_keep_every_bit() {
    let Some(shared) = common::shared() else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut paths: Vec<_> =
        std::fs::read_dir(shared.join("data/surfaces")).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "off"));
    paths.sort();
    assert!(paths.len() >= 47, "only {} surfaces", paths.len());
    for path in paths {
        let mesh = read_surface(&path).unwrap_or_else(|e| panic!("{e}"));
        let text = std::fs::read_to_string(&path).unwrap();
        let counts: Vec<usize> = text.split_whitespace().skip(1).take(2).map(|w| w.parse().unwrap()).collect();
        assert_eq!(counts, [mesh.points.len(), mesh.triangles.len()], "{}", path.display());
        if mesh.triangles.len() > 20_000 {
            continue;
        }
        for extension in ["off", "ply", "stl", "obj"] {
            let copy = folder.path().join(format!("copy.{extension}"));
            write_surface(&copy, &mesh).unwrap();
            let back = read_surface(&copy).unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(places(&back), places(&mesh), "{} as {extension}", path.display());
            assert!(extension == "stl" || back == mesh, "{} as {extension}", path.display());
        }
    }
}

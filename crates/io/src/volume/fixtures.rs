//! Meshes for the tests of all formats.

use super::content::MeshNotes;
use anastomesh_mesh::adjacency::boundary_faces;
use anastomesh_mesh::check::Expectation;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::shapes::tube_lattice;
use anastomesh_mesh::{Cap, Patch, VolumeMesh, WALL};

/// A tube with its foot labelled as inlet; every second tetrahedron is in block 1.
pub fn labelled_tube(layers: u32) -> (VolumeMesh, MeshNotes) {
    let mesh = tube_lattice(3, layers, 0.3);
    let boundary = boundary_faces(&mesh);
    let foot = |f: &[u32; 3]| f.iter().all(|&v| mesh.points[v as usize].z < 0.1);
    let cap = Cap { node: 4_000_000_000, center: Point3::new(0.1, 1e-17, 0.0), normal: -Vec3::z(), radius: 1.25 };
    let volume = VolumeMesh {
        tet_block: (0..mesh.tets.len() as i32).map(|i| i % 2).collect(),
        boundary_block: (0..boundary.len() as i32).map(|i| i % 3).collect(),
        boundary_patch: boundary.iter().map(|f| if foot(f) { 3 } else { WALL }).collect(),
        patches: vec![
            Patch { id: WALL, name: "wall".into(), cap: None },
            Patch { id: 3, name: "outlet_0".into(), cap: Some(cap) },
        ],
        boundary,
        mesh,
    };
    let notes = MeshNotes {
        expectation: Some(Expectation { loops: vec![0, 2], terminals: vec![7, 4_000_000_000] }),
        generator: "anastomesh 0.1.0".into(),
        options: "rho = 3 # größer".into(),
        regions: false,
        flow: None,
    };
    (volume, notes)
}

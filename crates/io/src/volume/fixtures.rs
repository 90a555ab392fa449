//! Meshes for tests of all formats.

use super::content::MeshNotes;
use anastomesh_mesh::adjacency::boundary_faces;
use anastomesh_mesh::check::Expectation;
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::shapes::tube_lattice;
use anastomesh_mesh::{Cap, Patch, TET_FACES, TetMesh, VolumeMesh, WALL, face_key};

/// Tube with its foot labelled as inlet; every second tetrahedron is in block 1.
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
        regions: Vec::new(),
        flow: None,
    };
    (volume, notes)
}

/// Two layers below a unit square of two wall triangles: four prisms. One side is an inlet, the bottom an outlet.
pub fn slab() -> VolumeMesh {
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let points = (0..3).flat_map(|layer| corners.map(|[x, y]| Point3::new(x, y, -f64::from(layer)))).collect();
    let prism = |[a, b, c]: [u32; 3], layer: u32, turned: bool| {
        let (o, i) = (|v: u32| v + 4 * layer, |v: u32| v + 4 * layer + 4);
        let tets = [[o(b), o(a), o(c), i(c)], [o(a), o(b), i(b), i(c)], [i(a), o(a), i(b), i(c)]];
        tets.map(|[p, q, r, s]| if turned { [q, p, r, s] } else { [p, q, r, s] })
    };
    let tets: Vec<[u32; 4]> = [([0, 1, 2], false), ([1, 2, 3], true)]
        .into_iter()
        .flat_map(|(triangle, turned)| [0, 1].map(|layer| prism(triangle, layer, turned)))
        .flatten()
        .collect();
    let sides: Vec<[u32; 3]> = tets.iter().flat_map(|tet| TET_FACES.map(|face| face.map(|i| tet[i]))).collect();
    let is_outer = |face: &&[u32; 3]| sides.iter().filter(|other| face_key(**other) == face_key(**face)).count() == 1;
    let boundary: Vec<[u32; 3]> = sides.iter().filter(is_outer).copied().collect();
    // No prism has two sides on a patch.
    let all = |face: &[u32; 3], is: fn(u32) -> bool| face.iter().all(|&v| is(v));
    let patch = |face: &[u32; 3]| match face {
        face if all(face, |v| v < 4) => 1,
        face if all(face, |v| v >= 8) => 3,
        face if all(face, |v| v % 4 >= 2) => 2,
        face if all(face, |v| v % 4 < 2) => 4,
        _ => 5,
    };
    let cap = Cap { node: 0, center: Point3::new(0.5, 1.0, -1.0), normal: [0.0, 1.0, 0.0].into(), radius: 2.0 };
    let names =
        [(1, "wall", None), (2, "inlet", Some(cap)), (3, "outlet_0", None), (4, "opposite", None), (5, "beside", None)];
    VolumeMesh {
        boundary_patch: boundary.iter().map(patch).collect(),
        boundary,
        mesh: TetMesh { points, tets },
        patches: names.map(|(id, name, cap)| Patch { id, name: name.into(), cap }).to_vec(),
        ..VolumeMesh::default()
    }
}

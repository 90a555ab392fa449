//! Position of points in a mesh: the tetrahedra around vertices, and those that contain the nodes of a network.

use anastomesh_mesh::TetMesh;
use anastomesh_mesh::geometry::predicates::orient3d;
use anastomesh_mesh::geometry::{Aabb, Bvh, Point3};
use anastomesh_skeleton::Skeleton;
use rayon::prelude::*;

/// Tetrahedra around each vertex, ascending.
#[derive(Debug)]
pub struct Stars {
    /// First tetrahedron of each vertex in `tets`.
    first: Vec<u32>,
    tets: Vec<u32>,
}

impl Stars {
    pub fn of(mesh: &TetMesh) -> Self {
        let mut first = vec![0; mesh.points.len() + 1];
        mesh.tets.as_flattened().iter().for_each(|&v| first[v as usize + 1] += 1);
        for v in 1..first.len() {
            first[v] += first[v - 1];
        }
        let (mut next, mut tets) = (first.clone(), vec![0; 4 * mesh.tets.len()]);
        for (id, tet) in (0..).zip(&mesh.tets) {
            for &v in tet {
                tets[next[v as usize] as usize] = id;
                next[v as usize] += 1;
            }
        }
        Self { first, tets }
    }

    /// Tetrahedra with a vertex.
    pub fn of_vertex(&self, v: u32) -> &[u32] {
        &self.tets[self.first[v as usize] as usize..self.first[v as usize + 1] as usize]
    }
}

/// Corners of a tetrahedron.
pub fn corners(mesh: &TetMesh, tet: u32) -> [&Point3; 4] {
    mesh.tets[tet as usize].map(|v| &mesh.points[v as usize])
}

/// Side of a point relative to the face opposite to a corner: positive on the side of the corner.
pub fn side([a, b, c, d]: [&Point3; 4], corner: usize, p: &Point3) -> f64 {
    match corner {
        0 => orient3d(p, b, c, d),
        1 => orient3d(a, p, c, d),
        2 => orient3d(a, b, p, d),
        _ => orient3d(a, b, c, p),
    }
}

/// First tetrahedron that contains each node of a network; `u32::MAX` for nodes outside. Tetrahedra are closed.
pub fn tets_of_nodes(mesh: &TetMesh, network: &Skeleton) -> Vec<u32> {
    let points = || network.nodes.iter().map(|node| &node.position);
    let tree = Bvh::of(points().map(|p| Aabb::of_points([p])).collect());
    let holds = |tet: u32| {
        let corners = corners(mesh, tet);
        let mut found = Vec::new();
        tree.query(&Aabb::of_points(corners), |node| {
            let p = &network.nodes[node as usize].position;
            if (0..4).all(|corner| side(corners, corner, p) >= 0.0) {
                found.push((node, tet));
            }
        });
        found
    };
    let pairs: Vec<(u32, u32)> = (0..mesh.tets.len() as u32).into_par_iter().flat_map_iter(holds).collect();
    let mut tets = vec![u32::MAX; network.nodes.len()];
    for (node, tet) in pairs {
        let first = &mut tets[node as usize];
        *first = tet.min(*first);
    }
    tets
}

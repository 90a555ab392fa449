//! Midpoints of the edges of a mesh, and node numbers of its elements.

use super::edges::{Edges, FACE_EDGES, TET_EDGES};
use crate::VolumeMesh;
use crate::geometry::Point3;

use rayon::prelude::*;

/// Midpoints of the edges of a mesh.
///
/// ```
/// use anastomesh_mesh::adjacency::boundary_faces;
/// use anastomesh_mesh::second_order::{SecondOrder, check_jacobians};
/// use anastomesh_mesh::shapes::tube_lattice;
/// use anastomesh_mesh::{VolumeMesh, WALL};
///
/// let mesh = tube_lattice(2, 3, 0.5);
/// let boundary = boundary_faces(&mesh);
/// let volume = VolumeMesh { boundary_patch: vec![WALL; boundary.len()], boundary, mesh, ..VolumeMesh::default() };
/// let (second, curving) = SecondOrder::curved(&volume);
/// assert_eq!(curving.pulled, 0);
/// assert!(check_jacobians(&volume.mesh, &second).is_valid());
/// // The midpoints of the rim lie on the circle of radius 1.
/// let [a, b] = [7, 8];
/// let middle = second.middles()[second.edge_between(a, b).unwrap() as usize];
/// assert!((middle.coords.xy().norm() - 1.0).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SecondOrder {
    pub(super) edges: Edges,
    pub(super) middles: Vec<Point3>,
    /// Edges with several midpoints in the file they come from.
    pub(super) split: Vec<u32>,
}

impl SecondOrder {
    /// Midpoints of a mesh, all in the middle of their corners.
    pub fn straight(volume: &VolumeMesh) -> Self {
        let edges = Edges::of_cells(&volume.mesh.tets, &volume.boundary, volume.mesh.points.len());
        Self::straight_with(&volume.mesh.points, edges)
    }

    pub(super) fn straight_with(points: &[Point3], edges: Edges) -> Self {
        let middle = |ends: &[u32; 2]| nalgebra::center(&points[ends[0] as usize], &points[ends[1] as usize]);
        Self { middles: edges.list().par_iter().map(middle).collect(), split: Vec::new(), edges }
    }

    /// Number of corners: vertices of the mesh. Midpoints are numbered after them.
    pub fn corners(&self) -> usize {
        self.edges.vertices()
    }

    /// Distinct edges, ascending, with their ends in ascending order.
    pub fn edges(&self) -> &[[u32; 2]] {
        self.edges.list()
    }

    /// Midpoint of each edge.
    pub fn middles(&self) -> &[Point3] {
        &self.middles
    }

    /// Edges that had several midpoints in the file, ascending. The first of these midpoints is kept. Elements at such an edge do not fit
    /// together.
    pub fn split_edges(&self) -> &[u32] {
        &self.split
    }

    /// Number of the edge between two vertices.
    pub fn edge_between(&self, a: u32, b: u32) -> Option<u32> {
        self.edges.find(a, b)
    }

    /// Numbers of the edges of a tetrahedron of the mesh, in the order of [`TET_EDGES`].
    pub(super) fn edges_of(&self, tet: [u32; 4]) -> [u32; 6] {
        TET_EDGES.map(|[i, j]| self.listed(tet[i], tet[j]))
    }

    pub(super) fn listed(&self, a: u32, b: u32) -> u32 {
        self.edges.find(a, b).expect("the edges of all cells of the mesh are listed")
    }

    /// Node numbers of an element: those of the corners, and midpoints in the order of [`TET_EDGES`].
    ///
    /// # Panics
    /// If the mesh has no such tetrahedron.
    pub fn tet_nodes(&self, tet: [u32; 4]) -> [u32; 10] {
        let mut nodes = [0; 10];
        nodes[..4].copy_from_slice(&tet);
        nodes[4..].copy_from_slice(&self.edges_of(tet).map(|edge| self.corners() as u32 + edge));
        nodes
    }

    /// Node numbers of a boundary face: those of the corners, and midpoints in the order of [`FACE_EDGES`].
    ///
    /// # Panics
    /// If the mesh has no such face.
    pub fn face_nodes(&self, face: [u32; 3]) -> [u32; 6] {
        let mut nodes = [0; 6];
        nodes[..3].copy_from_slice(&face);
        let middles = FACE_EDGES.map(|[i, j]| self.corners() as u32 + self.listed(face[i], face[j]));
        nodes[3..].copy_from_slice(&middles);
        nodes
    }

    /// Positions of the nodes of an element. `points` are the vertices of the mesh.
    ///
    /// # Panics
    /// If the mesh has no such tetrahedron.
    pub fn nodes(&self, points: &[Point3], tet: [u32; 4]) -> [Point3; 10] {
        let mut nodes = [Point3::origin(); 10];
        nodes[..4].copy_from_slice(&tet.map(|v| points[v as usize]));
        nodes[4..].copy_from_slice(&self.edges_of(tet).map(|edge| self.middles[edge as usize]));
        nodes
    }

    /// True if an element has the middles of its corners as midpoints.
    pub(super) fn is_straight(points: &[Point3], tet: [u32; 4], nodes: &[Point3; 10]) -> bool {
        let middle = |[i, j]: [usize; 2]| nalgebra::center(&points[tet[i] as usize], &points[tet[j] as usize]);
        TET_EDGES.iter().zip(&nodes[4..]).all(|(&ends, node)| middle(ends) == *node)
    }
}

//! Tube filled with tetrahedra.

use crate::block::hull::hull;
use crate::block::topology::Topology;
use anastomesh_mesh::TetMesh;
use std::sync::Arc;

/// Tube filled with tetrahedra.
#[derive(Clone, Debug, PartialEq)]
pub struct FilledTube {
    /// Points and tetrahedra; the points begin with those of the two discs.
    pub mesh: TetMesh,
    /// Number of points of each disc.
    pub disc: u32,
    /// Triangles of the two discs, facing outwards.
    pub ends: [Vec<[u32; 3]>; 2],
    /// Triangles of the wall, facing outwards.
    pub wall: Vec<[u32; 3]>,
    /// Number of rings between the rims.
    pub rings: u32,
    /// Topology of the tetrahedra, with both discs.
    pub topology: Arc<Topology>,
}

impl FilledTube {
    /// Returns points and tetrahedra, or points and closed surface if `hollow`. The points begin with those of the two
    /// discs.
    pub fn kept(self, hollow: bool) -> (TetMesh, Vec<[u32; 3]>) {
        if !hollow {
            return (self.mesh, Vec::new());
        }
        let (mesh, triangles, _) = hull(&self.mesh.points, &self.ends, &self.wall);
        (mesh, triangles)
    }
}

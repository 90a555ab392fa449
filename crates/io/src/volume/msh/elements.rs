//! Nodes of the elements of a mesh, in Gmsh's order.

use super::names::{MSH_TETRA, MSH_TETRA_10, MSH_TRIANGLE, MSH_TRIANGLE_6, TETRA_10_ORDER};
use anastomesh_mesh::second_order::SecondOrder;
use std::io;

/// Types and nodes of linear or second-order elements.
#[derive(Clone, Copy)]
pub(super) struct ElementNodes<'a>(Option<&'a SecondOrder>);

impl<'a> ElementNodes<'a> {
    /// Second-order elements with these midpoints, or linear ones.
    pub(super) fn of(second: Option<&'a SecondOrder>) -> Self {
        Self(second)
    }

    /// Type of tetrahedra.
    pub(super) fn tet_kind(self) -> i32 {
        if self.0.is_some() { MSH_TETRA_10 } else { MSH_TETRA }
    }

    /// Type of boundary faces.
    pub(super) fn face_kind(self) -> i32 {
        if self.0.is_some() { MSH_TRIANGLE_6 } else { MSH_TRIANGLE }
    }

    /// Passes the type and the nodes of a tetrahedron to `write`.
    pub(super) fn tet(self, tet: [u32; 4], write: impl FnOnce(i32, &[u32]) -> io::Result<()>) -> io::Result<()> {
        let Some(second) = self.0 else { return write(MSH_TETRA, &tet) };
        let nodes = second.tet_nodes(tet);
        write(MSH_TETRA_10, &TETRA_10_ORDER.map(|place| nodes[place]))
    }

    /// Passes the type and the nodes of a boundary face to `write`.
    pub(super) fn face(self, face: [u32; 3], write: impl FnOnce(i32, &[u32]) -> io::Result<()>) -> io::Result<()> {
        match self.0 {
            Some(second) => write(MSH_TRIANGLE_6, &second.face_nodes(face)),
            None => write(MSH_TRIANGLE, &face),
        }
    }
}

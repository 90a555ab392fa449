//! Second-order meshes in writers: midpoints follow the points, and cells have further nodes.

use anastomesh_mesh::second_order::SecondOrder;
use anastomesh_mesh::source::{FacePiece, MeshSource, SourceCounts, TetPiece};
use anastomesh_mesh::{Patch, Point3};
use std::borrow::Cow;
use std::io;

/// Mesh whose points are followed by the midpoints of its edges. The cells are those of the mesh, with corners only.
pub(super) struct WithMiddles<'a> {
    pub mesh: &'a dyn MeshSource,
    pub second: &'a SecondOrder,
}

impl MeshSource for WithMiddles<'_> {
    fn counts(&self) -> SourceCounts {
        let counts = self.mesh.counts();
        SourceCounts { points: counts.points + self.second.middles().len(), ..counts }
    }

    fn patches(&self) -> &[Patch] {
        self.mesh.patches()
    }

    fn parts(&self) -> u32 {
        self.mesh.parts() + 1
    }

    fn points(&self, part: u32) -> io::Result<Cow<'_, [Point3]>> {
        if part == self.mesh.parts() { Ok(Cow::Borrowed(self.second.middles())) } else { self.mesh.points(part) }
    }

    fn tets(&self, part: u32) -> io::Result<TetPiece<'_>> {
        if part == self.mesh.parts() { Ok(TetPiece::default()) } else { self.mesh.tets(part) }
    }

    fn boundary(&self, part: u32) -> io::Result<FacePiece<'_>> {
        if part == self.mesh.parts() { Ok(FacePiece::default()) } else { self.mesh.boundary(part) }
    }
}

/// Nodes of cells: the corners, and in a second-order mesh the midpoints in VTK's order.
#[derive(Clone, Copy, Default)]
pub(super) struct CellNodes<'a>(pub Option<&'a SecondOrder>);

impl CellNodes<'_> {
    /// Number of nodes of a tetrahedron.
    pub(super) fn per_tet(self) -> usize {
        if self.0.is_some() { 10 } else { 4 }
    }

    /// Number of nodes of a boundary face.
    pub(super) fn per_face(self) -> usize {
        if self.0.is_some() { 6 } else { 3 }
    }

    /// Nodes of consecutive tetrahedra.
    pub(super) fn of_tets(self, tets: &[[u32; 4]]) -> Cow<'_, [u32]> {
        match self.0 {
            Some(second) => tets.iter().flat_map(|&tet| second.tet_nodes(tet)).collect(),
            None => Cow::Borrowed(tets.as_flattened()),
        }
    }

    /// Nodes of consecutive boundary faces.
    pub(super) fn of_faces(self, faces: &[[u32; 3]]) -> Cow<'_, [u32]> {
        match self.0 {
            Some(second) => faces.iter().flat_map(|&face| second.face_nodes(face)).collect(),
            None => Cow::Borrowed(faces.as_flattened()),
        }
    }
}

/// Compares the number of points with that of the corners of a second-order mesh.
///
/// # Errors
/// `InvalidInput` if the number of corners is not that of the points.
pub(super) fn ensure_fits(mesh: &dyn MeshSource, second: &SecondOrder) -> io::Result<()> {
    if mesh.counts().points == second.corners() {
        return Ok(());
    }
    Err(io::Error::new(io::ErrorKind::InvalidInput, "the midpoints belong to a mesh with another number of points"))
}

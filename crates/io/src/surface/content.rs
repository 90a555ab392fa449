//! What a surface file holds: the surface, and how the file counts.

use anastomesh_mesh::TriMesh;

/// Bytes of a triangle of a binary STL file.
const RECORD: u64 = 50;

/// A surface as it was read, with what its file says beside it.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct SurfaceContent {
    /// The surface.
    pub mesh: TriMesh,
    /// Number of the first face and the first point in the file: 1 in OBJ, else 0.
    pub first: u32,
    /// The face that each triangle is a piece of, counted from 0; empty when each is the face of the same number.
    pub face_of: Vec<u32>,
    /// Where points are joined (STL): the first of the corners that each is, counted from 0 through all faces. Otherwise
    /// empty.
    pub corner_of: Vec<u32>,
    /// What a reader should know about the file, although it could be read.
    pub notes: Vec<SurfaceNote>,
}

/// What is odd about a file that could be read all the same.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceNote {
    /// Bytes that its count of triangles does not cover.
    #[error(
        "what follows the last of its {triangles} triangles is not read: {bytes} bytes{}",
        if *bytes < RECORD { "" } else { ", room for more triangles, so that its count may be wrong" }
    )]
    Surplus {
        /// How many bytes.
        bytes: u64,
        /// How many triangles are announced.
        triangles: usize,
    },
}

impl From<TriMesh> for SurfaceContent {
    fn from(mesh: TriMesh) -> Self {
        Self { mesh, ..Self::default() }
    }
}

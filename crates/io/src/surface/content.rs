//! Contents of a surface file: the surface and the numbering of the file.

use anastomesh_mesh::TriMesh;

/// Bytes per triangle in a binary STL file.
const RECORD: u64 = 50;

/// Surface from a file, with additional information.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct SurfaceContent {
    /// The surface.
    pub mesh: TriMesh,
    /// Number of the first face and the first point in the file: 1 in OBJ, else 0.
    pub first: u32,
    /// Original face of each triangle, from 0; empty if triangles and faces coincide.
    pub face_of: Vec<u32>,
    /// First corner at each point, counted from 0 through all faces, if corners were merged (STL); otherwise empty.
    pub corner_of: Vec<u32>,
    /// Anomalies of the file that did not prevent reading.
    pub notes: Vec<SurfaceNote>,
}

/// Anomaly of a readable file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceNote {
    /// The file is longer than its triangle count implies.
    #[error(
        "{bytes} bytes after the last of {triangles} triangles ignored{}",
        if *bytes < RECORD { "" } else { ", enough for more triangles: the count may be wrong" }
    )]
    Surplus {
        /// Number of surplus bytes.
        bytes: u64,
        /// Announced number of triangles.
        triangles: usize,
    },
}

impl From<TriMesh> for SurfaceContent {
    fn from(mesh: TriMesh) -> Self {
        Self { mesh, ..Self::default() }
    }
}

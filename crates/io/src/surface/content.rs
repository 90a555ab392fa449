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
    /// Marker of each triangle; empty if the file has none.
    pub markers: Vec<i32>,
    /// Names of markers, ascending.
    pub names: Vec<(i32, String)>,
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

impl SurfaceContent {
    /// Sets the markers of the faces of the file.
    pub(super) fn marked(mut self, of_faces: Vec<i32>) -> Self {
        self.markers = match self.face_of.as_slice() {
            _ if of_faces.is_empty() => of_faces,
            [] => of_faces,
            face_of => face_of.iter().map(|&face| of_faces.get(face as usize).copied().unwrap_or(0)).collect(),
        };
        self
    }

    /// Sets the groups of the faces of the file as markers, from 1 in the order of first use. One group is none.
    pub(super) fn grouped(mut self, of_faces: &[u32], names: &[String]) -> Self {
        let mut markers: Vec<Option<i32>> = vec![None; names.len()];
        let marker = |&group: &u32| {
            let next = self.names.len() as i32 + 1;
            *markers[group as usize].get_or_insert_with(|| {
                self.names.push((next, names[group as usize].clone()));
                next
            })
        };
        let of_faces: Vec<i32> = of_faces.iter().map(marker).collect();
        if self.names.len() > 1 { self.marked(of_faces) } else { Self { names: Vec::new(), ..self } }
    }
}

impl From<TriMesh> for SurfaceContent {
    fn from(mesh: TriMesh) -> Self {
        Self { mesh, ..Self::default() }
    }
}

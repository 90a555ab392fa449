//! What a file holds: a volume mesh, a surface or a network; and how a volume mesh of any size is opened.

use std::fmt;
use std::path::Path;

use serde::Serialize;

use super::exit::Failure;
use super::log;
use crate::pipeline::LeftWhole;
use anastomesh_io::network::NetworkFormat;
use anastomesh_io::npy;
use anastomesh_io::surface::SurfaceFormat;
use anastomesh_io::volume::{MeshFile, MeshFormat, MeshNotes, VtuPieces, VtuPiecesError, read_mesh};
use anastomesh_mesh::adjacency::boundary_faces;
use anastomesh_mesh::source::MeshSource;
use anastomesh_mesh::{Patch, TetMesh, TriMesh, VolumeMesh, WALL};

/// Bytes of memory that a mesh takes for each byte of its file while it is held as a whole.
const MEMORY_PER_BYTE: u64 = 4;

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FileKind {
    Mesh,
    Surface,
    Network,
}

impl fmt::Display for FileKind {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Mesh => "a volume mesh",
            Self::Surface => "a surface",
            Self::Network => "a network",
        })
    }
}

impl FileKind {
    /// What a file to be read by `verb` holds, by its extension.
    pub fn of(path: &Path, verb: &str) -> Result<Self, Failure> {
        if SurfaceFormat::of(path).is_ok() {
            return Ok(Self::Surface);
        }
        // Of a folder of arrays these tell.
        if npy::holds(path, "tets") {
            return Ok(Self::Mesh);
        }
        if NetworkFormat::of(path).is_ok() {
            return Ok(Self::Network);
        }
        MeshFormat::of(path).map(|_| Self::Mesh).map_err(|_| {
            Failure::input(format!(
                "{}: no extension of a volume mesh, a surface or a network; `{verb} --help` lists them",
                path.display()
            ))
        })
    }
}

/// A volume mesh in a file.
pub enum OpenedMesh {
    /// Too large to be held: read by its blocks.
    Pieces(VtuPieces),
    /// Held.
    Whole(MeshFile),
}

impl OpenedMesh {
    /// Opens a file: a VTU of the verb mesh by its blocks where it would need more than `memory`, all others as wholes.
    pub fn open(path: &Path, memory: u64) -> Result<Self, Failure> {
        if let Some(pieces) = in_pieces(path, memory)? {
            return Ok(Self::Pieces(pieces));
        }
        read_mesh(path).map(Self::Whole).map_err(|e| Failure::input(e.to_string()))
    }

    /// As wall, what no file labels.
    pub fn label_boundary(&mut self) {
        if let Self::Whole(MeshFile { volume, labelled: false, .. }) = self {
            volume.boundary = boundary_faces(&volume.mesh);
            volume.boundary_patch = vec![WALL; volume.boundary.len()];
        }
    }

    /// The mesh.
    pub fn source(&self) -> &dyn MeshSource {
        match self {
            Self::Pieces(pieces) => pieces,
            Self::Whole(file) => &file.volume,
        }
    }

    /// What its file says beside it.
    pub fn notes(&self) -> &MeshNotes {
        match self {
            Self::Pieces(pieces) => pieces.notes(),
            Self::Whole(file) => &file.notes,
        }
    }
}

/// A file that is too large to be held; none when it is not, or has to be.
fn in_pieces(input: &Path, memory: u64) -> Result<Option<VtuPieces>, Failure> {
    let length = std::fs::metadata(input).map_or(0, |data| data.len());
    if length.saturating_mul(MEMORY_PER_BYTE) <= memory || MeshFormat::of(input).ok() != Some(MeshFormat::Vtu) {
        return Ok(None);
    }
    match VtuPieces::open(input, (memory / 4) as usize) {
        Ok(pieces) => Ok(Some(pieces)),
        Err(VtuPiecesError::Read(source)) => Err(unreadable(input, &source)),
        Err(why) => {
            held(input, &why);
            Ok(None)
        }
    }
}

/// Says that a mesh takes more memory than it might.
pub fn held(path: &Path, why: &dyn fmt::Display) {
    log::warning(&format!("{} is held as a whole, which may need more than --memory: {why}", path.display()));
}

/// A file that breaks off, or is none.
pub fn unreadable(path: &Path, why: &dyn fmt::Display) -> Failure {
    Failure::input(format!("{}: cannot be read: {why}; write or copy it again", path.display()))
}

/// The mesh that a run has left in a work directory; none where the path is none.
pub fn left_in(folder: &Path) -> Result<Option<LeftWhole>, Failure> {
    if !LeftWhole::may_be_in(folder) {
        return Ok(None);
    }
    LeftWhole::open(folder).map(Some).ok_or_else(|| {
        Failure::input(format!(
            "{}: no run has come to the end of its blocks in this work directory; start the command that began it again, \
             which goes on there",
            folder.display()
        ))
    })
}

/// A mesh of nothing but this boundary.
pub fn boundary_of(surface: TriMesh) -> VolumeMesh {
    let TriMesh { points, triangles } = surface;
    VolumeMesh {
        mesh: TetMesh { points, tets: Vec::new() },
        boundary_patch: vec![WALL; triangles.len()],
        boundary_block: vec![0; triangles.len()],
        boundary: triangles,
        patches: vec![Patch { id: WALL, name: "wall".into(), cap: None }],
        ..VolumeMesh::default()
    }
}

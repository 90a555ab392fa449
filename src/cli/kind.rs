//! Kinds of files (volume mesh, surface, network), and opening of volume meshes of any size.

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
use anastomesh_mesh::second_order::SecondOrder;
use anastomesh_mesh::source::MeshSource;
use anastomesh_mesh::{Patch, TetMesh, TriMesh, VolumeMesh, WALL};

/// Help on the input of the verbs that draw.
pub const DRAWN: &str = "Volume mesh (.vtu, .pvtu, .msh, .mesh, .ele), surface (.stl, .ply, .obj, .off), network (see `mesh`), or \
     work directory of `mesh`";

/// Memory of a loaded mesh per byte of its file, in bytes.
const MEMORY_PER_BYTE: u64 = 4;

/// Kind of the contents of a file.
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
    /// Determines the kind of a file by its extension; `verb` is the command that reads it.
    pub fn of(path: &Path, verb: &str) -> Result<Self, Failure> {
        if SurfaceFormat::of(path).is_ok() {
            return Ok(Self::Surface);
        }
        // A folder of arrays is a mesh if it contains tetrahedra.
        if npy::holds(path, "tets") {
            return Ok(Self::Mesh);
        }
        // Grids may hold lines, but `mesh` writes them with tetrahedra.
        if NetworkFormat::of(path).is_ok_and(|format| format != NetworkFormat::Vtu) {
            return Ok(Self::Network);
        }
        MeshFormat::of(path).map(|_| Self::Mesh).map_err(|_| {
            Failure::input(format!(
                "{}: unrecognised extension; `{verb} --help` lists the extensions of meshes, surfaces and networks",
                path.display()
            ))
        })
    }
}

/// A volume mesh in a file.
pub enum OpenedMesh {
    /// Large mesh that is read block by block.
    Pieces(VtuPieces),
    /// Loaded mesh.
    Whole(MeshFile),
}

impl OpenedMesh {
    /// Opens a file: a VTU file of `mesh` block by block if it would exceed `memory`; others are loaded.
    pub fn open(path: &Path, memory: u64) -> Result<Self, Failure> {
        if let Some(pieces) = in_pieces(path, memory)? {
            return Ok(Self::Pieces(pieces));
        }
        read_mesh(path).map(Self::Whole).map_err(|e| Failure::input(e.to_string()))
    }

    /// Labels the boundary of an unlabelled mesh as wall.
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

    /// Midpoints of a second-order mesh.
    pub fn second_order(&self) -> Option<&SecondOrder> {
        match self {
            Self::Pieces(_) => None,
            Self::Whole(file) => file.second_order.as_ref(),
        }
    }

    /// Notes in the file.
    pub fn notes(&self) -> &MeshNotes {
        match self {
            Self::Pieces(pieces) => pieces.notes(),
            Self::Whole(file) => &file.notes,
        }
    }
}

/// Opens a large file block by block; `None` if it is small or must be loaded.
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

/// Warns that a mesh is loaded although it may exceed the memory limit.
pub fn held(path: &Path, why: &dyn fmt::Display) {
    log::warning(&format!("{} is loaded completely, which may exceed --memory: {why}", path.display()));
}

/// Failure of reading a truncated or invalid file.
pub fn unreadable(path: &Path, why: &dyn fmt::Display) -> Failure {
    Failure::input(format!("{}: cannot be read: {why}; copy it again", path.display()))
}

/// Mesh in a work directory; `None` if the path is not one.
pub fn left_in(folder: &Path) -> Result<Option<LeftWhole>, Failure> {
    if !LeftWhole::may_be_in(folder) {
        return Ok(None);
    }
    LeftWhole::open(folder).map(Some).ok_or_else(|| {
        Failure::input(format!(
            "{}: the run in this work directory is not finished; run its command again to continue",
            folder.display()
        ))
    })
}

/// Mesh without tetrahedra that has this boundary.
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

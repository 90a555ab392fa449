//! Why a mesh file could not be read or written.

use super::medit::MeditFault;
use super::msh::MshFault;
use super::pvtu::PvtuFault;
use super::vtu::VtuFault;
use crate::file::FileError;
use crate::npy::NpyError;
use crate::tetgen::TetgenFault;

/// Why a mesh file could not be read or written.
pub type MeshFileError = FileError<MeshFault>;

/// Why the content of a file is no mesh.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshFault {
    /// It is no unstructured grid of VTK's.
    #[error(transparent)]
    Vtu(#[from] VtuFault),
    /// It is no unstructured grid of VTK's in pieces.
    #[error(transparent)]
    Pvtu(#[from] PvtuFault),
    /// It is no mesh of Gmsh's.
    #[error(transparent)]
    Msh(#[from] MshFault),
    /// It is no mesh of Medit's.
    #[error(transparent)]
    Medit(#[from] MeditFault),
    /// It is no mesh of `TetGen`'s.
    #[error(transparent)]
    Tetgen(#[from] TetgenFault),
    /// Arrays are missing or wrong.
    #[error(transparent)]
    Npy(#[from] NpyError),
    /// Meshes of this format are written alone.
    #[error("cases of solvers are written, not read: name the same mesh as .vtu or .msh")]
    NotRead,
    /// The format spreads a mesh over several files.
    #[error("a mesh of this format is several files: name the path of its .ele or .pvtu file, or of its folder .npyd")]
    SeveralFiles,
}

//! Errors of reading and writing mesh files.

use super::medit::MeditFault;
use super::msh::MshFault;
use super::pvtu::PvtuFault;
use super::vtu::VtuFault;
use crate::file::FileError;
use crate::npy::NpyError;
use crate::tetgen::TetgenFault;

/// Errors of reading and writing a mesh file.
pub type MeshFileError = FileError<MeshFault>;

/// Content errors of a mesh file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshFault {
    /// The VTK unstructured grid is invalid.
    #[error(transparent)]
    Vtu(#[from] VtuFault),
    /// The VTK unstructured grid in pieces is invalid.
    #[error(transparent)]
    Pvtu(#[from] PvtuFault),
    /// The Gmsh mesh is invalid.
    #[error(transparent)]
    Msh(#[from] MshFault),
    /// The Medit mesh is invalid.
    #[error(transparent)]
    Medit(#[from] MeditFault),
    /// The `TetGen` mesh is invalid.
    #[error(transparent)]
    Tetgen(#[from] TetgenFault),
    /// Arrays are missing or invalid.
    #[error(transparent)]
    Npy(#[from] NpyError),
    /// The format can be written only.
    #[error("solver cases can be written but not read: give the mesh as .vtu or .msh")]
    NotRead,
    /// The format consists of several files.
    #[error("this format has several files: give the path of the .ele or .pvtu file, or of the .npyd folder")]
    SeveralFiles,
}

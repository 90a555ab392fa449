//! Reader for all mesh formats.

use super::content::MeshFile;
use super::error::{MeshFault, MeshFileError};
use super::format::MeshFormat;
use super::{medit, msh, npy, pvtu, vtu};
use crate::file::{FileError, read_bytes};
use crate::tetgen;
use std::io;
use std::path::Path;

/// Reads a mesh from a file (or several: `.pvtu`, `.ele`) in the format of its extension.
///
/// # Errors
/// `UnknownFormat`, `Read` with the error of the operating system, `Empty`, or `Content` with the fault.
pub fn read_mesh(path: &Path) -> Result<MeshFile, MeshFileError> {
    if path.is_dir() && !MeshFormat::of(path).is_ok_and(MeshFormat::is_folder) {
        return Err(FileError::read(path)(io::ErrorKind::IsADirectory.into()));
    }
    match MeshFormat::of(path)? {
        MeshFormat::Tetgen => tetgen::read_mesh(path).map(MeshFile::from).map_err(FileError::widen),
        MeshFormat::Npy => npy::read(path).map_err(FileError::widen),
        MeshFormat::Pvtu => pvtu::read(path).map_err(FileError::widen),
        format if format.is_folder() => Err(FileError::content(path)(MeshFault::NotRead)),
        format => read_mesh_from(&read_bytes(path)?, format).map_err(FileError::content(path)),
    }
}

/// Reads a mesh from the bytes of a file.
///
/// # Errors
/// The bytes violate the format, or are incomplete.
pub fn read_mesh_from(bytes: &[u8], format: MeshFormat) -> Result<MeshFile, MeshFault> {
    match format {
        MeshFormat::Vtu => Ok(vtu::read(bytes)?),
        // The file contains its version.
        MeshFormat::Msh | MeshFormat::Msh2 => Ok(msh::read(bytes)?),
        MeshFormat::Medit => Ok(medit::read(bytes)?),
        MeshFormat::OpenFoam | MeshFormat::SimVascular => Err(MeshFault::NotRead),
        MeshFormat::Tetgen | MeshFormat::Pvtu | MeshFormat::Npy => Err(MeshFault::SeveralFiles),
    }
}

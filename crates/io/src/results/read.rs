//! Reader for all results.

use super::content::FlowResult;
use super::error::ResultError;
use super::{openfoam, vtu};
use crate::file::{FileError, by_extension, read_bytes};
use std::io;
use std::path::Path;

/// Format of a result.
#[derive(Clone, Copy)]
enum ResultFormat {
    OpenFoam,
    Vtu,
}

const EXTENSIONS: [(&str, ResultFormat); 2] = [("foam", ResultFormat::OpenFoam), ("vtu", ResultFormat::Vtu)];

/// Reads a result: the latest time step of an `OpenFOAM` case (`.foam`, a folder), or a file of `svMultiPhysics` (`.vtu`).
///
/// # Errors
/// The extension is unknown, a file cannot be read, or its contents do not fit the mesh.
pub fn read_result(path: &Path) -> Result<FlowResult, ResultError> {
    // `case.foam` within a case marks it.
    let folder = path.parent().filter(|_| path.is_file()).unwrap_or(path);
    let unknown = || FileError::UnknownFormat { path: path.to_path_buf(), kind: "result", known: ".foam, .vtu" };
    match by_extension(path, &EXTENSIONS) {
        Some(ResultFormat::OpenFoam) => openfoam::read(folder),
        None if path.join("constant/polyMesh").is_dir() => openfoam::read(path),
        Some(ResultFormat::Vtu) => Ok(vtu::read(&read_bytes(path)?, &name(path)).map_err(FileError::content(path))?),
        None if !path.exists() => Err(FileError::read(path)(io::ErrorKind::NotFound.into()).into()),
        None => Err(unknown().into()),
    }
}

fn name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

//! Reads a surface in any format.

use super::content::SurfaceContent;
use super::error::{SurfaceFault, SurfaceFileError};
use super::format::SurfaceFormat;
use super::{obj, off, ply, stl};
use crate::io::file::{FileError, read_bytes};
use crate::mesh::TriMesh;
use std::path::Path;

/// Reads a surface from a file, in the format that its extension names. Triangles and points keep their order; nothing
/// is joined, dropped or turned over (only STL, which stores no common points, has its equal corners joined). A face with
/// more than three corners becomes triangles in its place.
///
/// # Errors
/// `UnknownFormat`, `Read` with the system's reason, `Empty`, or `Content` with what is wrong.
pub fn read_surface(path: &Path) -> Result<TriMesh, SurfaceFileError> {
    Ok(read_content_as(path, SurfaceFormat::of(path)?)?.mesh)
}

/// As [`read_surface`] in this format, whatever the extension, with what the file says beside the surface.
///
/// # Errors
/// As [`read_surface`].
pub fn read_content_as(path: &Path, format: SurfaceFormat) -> Result<SurfaceContent, SurfaceFileError> {
    read_content_from(&read_bytes(path)?, format).map_err(FileError::content(path))
}

/// Reads a surface from the bytes of a file.
///
/// # Errors
/// When the bytes are no such file, or it is incomplete.
pub fn read_surface_from(bytes: &[u8], format: SurfaceFormat) -> Result<TriMesh, SurfaceFault> {
    Ok(read_content_from(bytes, format)?.mesh)
}

/// As [`read_surface_from`], with what the file says beside the surface.
///
/// # Errors
/// As [`read_surface_from`].
pub fn read_content_from(bytes: &[u8], format: SurfaceFormat) -> Result<SurfaceContent, SurfaceFault> {
    let content = match format {
        SurfaceFormat::Off => off::read(bytes)?,
        SurfaceFormat::Ply => ply::read(bytes)?,
        SurfaceFormat::Stl => stl::read(bytes)?,
        SurfaceFormat::Obj => obj::read(bytes)?,
    };
    if content.mesh.triangles.is_empty() {
        return Err(SurfaceFault::NoFaces { points: content.mesh.points.len() });
    }
    Ok(content)
}

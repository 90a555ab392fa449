//! Reader for all surface formats.

use super::content::SurfaceContent;
use super::error::{SurfaceFault, SurfaceFileError};
use super::format::SurfaceFormat;
use super::{obj, off, ply, stl, vtp};
use crate::file::{FileError, read_bytes};
use anastomesh_mesh::TriMesh;
use std::path::Path;

/// Reads a surface file in the format of its extension. Points and triangles keep order and orientation; nothing is
/// merged or dropped. Only STL, which has no shared points, has its equal corners merged. Faces with more than three
/// corners are triangulated in place.
///
/// ```
/// let torus = anastomesh_io::read_surface("../../fixtures/torus.off".as_ref())?;
/// assert_eq!(torus.triangles.len(), 2 * torus.points.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// `UnknownFormat`, `Read` with the error of the operating system, `Empty`, or `Content` with the fault.
pub fn read_surface(path: &Path) -> Result<TriMesh, SurfaceFileError> {
    Ok(read_content_as(path, SurfaceFormat::of(path)?)?.mesh)
}

/// Reads a surface like [`read_surface`], in this format and with additional information of the file.
///
/// # Errors
/// See [`read_surface`].
pub fn read_content_as(path: &Path, format: SurfaceFormat) -> Result<SurfaceContent, SurfaceFileError> {
    read_content_from(&read_bytes(path)?, format).map_err(FileError::content(path))
}

/// Reads a surface from the bytes of a file.
///
/// ```
/// use anastomesh_io::surface::{SurfaceFormat, read_surface_from};
///
/// let off = b"OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n3 0 1 2\n";
/// assert_eq!(read_surface_from(off, SurfaceFormat::Off)?.triangles.len(), 3, "the square is cut in two");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The bytes violate the format, or are incomplete.
pub fn read_surface_from(bytes: &[u8], format: SurfaceFormat) -> Result<TriMesh, SurfaceFault> {
    Ok(read_content_from(bytes, format)?.mesh)
}

/// Reads a surface like [`read_surface_from`], with additional information of the file.
///
/// # Errors
/// See [`read_surface_from`].
pub fn read_content_from(bytes: &[u8], format: SurfaceFormat) -> Result<SurfaceContent, SurfaceFault> {
    let content = match format {
        SurfaceFormat::Off => off::read(bytes)?,
        SurfaceFormat::Ply => ply::read(bytes)?,
        SurfaceFormat::Stl => stl::read(bytes)?,
        SurfaceFormat::Obj => obj::read(bytes)?,
        SurfaceFormat::Vtp => vtp::read(bytes)?,
    };
    if content.mesh.triangles.is_empty() {
        return Err(SurfaceFault::NoFaces { points: content.mesh.points.len() });
    }
    Ok(content)
}

//! Writer for all surface formats.

use super::error::SurfaceFileError;
use super::format::SurfaceFormat;
use super::{obj, off, ply, stl};
use crate::file::{FileError, ensure_sound, write_whole};
use anastomesh_mesh::TriMesh;
use std::io::{self, Write};
use std::path::Path;

/// Writes a surface atomically, in the format of the file extension. Coordinates are preserved bit for bit: PLY is
/// binary with doubles. STL is binary only if all coordinates are exact in 32 bits, otherwise text.
///
/// ```
/// use anastomesh_io::{read_surface, write_surface};
///
/// let torus = read_surface("../../fixtures/torus.off".as_ref())?;
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("torus.ply");
/// write_surface(&path, &torus)?;
/// assert_eq!(read_surface(&path)?, torus);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// `UnknownFormat`, `BadMesh` if a triangle refers to a missing point, or `Write` with the reason.
pub fn write_surface(path: &Path, mesh: &TriMesh) -> Result<(), SurfaceFileError> {
    let format = SurfaceFormat::of(path)?;
    ensure_sound(path, &mesh.triangles, mesh.points.len())?;
    write_whole(path, |file| write_format(file, format, mesh)).map_err(FileError::write(path))
}

/// Writes a surface with valid point indices.
pub(super) fn write_format(out: &mut impl Write, format: SurfaceFormat, mesh: &TriMesh) -> io::Result<()> {
    match format {
        SurfaceFormat::Off => off::write(out, mesh),
        SurfaceFormat::Ply => ply::write(out, mesh),
        SurfaceFormat::Stl => stl::write(out, mesh),
        SurfaceFormat::Obj => obj::write(out, mesh),
        // No path has this format, and boundaries have a writer of their own.
        SurfaceFormat::Vtp => Err(io::ErrorKind::Unsupported.into()),
    }
}

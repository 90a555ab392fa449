//! Writes a surface in any format.

use super::error::SurfaceFileError;
use super::format::SurfaceFormat;
use super::{obj, off, ply, stl};
use crate::file::{FileError, ensure_sound, write_whole};
use anastomesh_mesh::TriMesh;
use std::io::{self, Write};
use std::path::Path;

/// Writes a surface to a file, in the format that its extension names; the file appears whole or not at all. Every
/// coordinate comes back bit for bit: PLY is written in binary with doubles, and STL in binary only when every
/// coordinate fits into the 32-bit floats of that variant, otherwise as text.
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
/// `UnknownFormat`, `BadMesh` when a triangle names a point that does not exist, or `Write` with the reason.
pub fn write_surface(path: &Path, mesh: &TriMesh) -> Result<(), SurfaceFileError> {
    let format = SurfaceFormat::of(path)?;
    ensure_sound(path, &mesh.triangles, mesh.points.len())?;
    write_whole(path, |file| write_format(file, format, mesh)).map_err(FileError::write(path))
}

/// Writes a surface whose triangles name existing points.
pub(super) fn write_format(out: &mut impl Write, format: SurfaceFormat, mesh: &TriMesh) -> io::Result<()> {
    match format {
        SurfaceFormat::Off => off::write(out, mesh),
        SurfaceFormat::Ply => ply::write(out, mesh),
        SurfaceFormat::Stl => stl::write(out, mesh),
        SurfaceFormat::Obj => obj::write(out, mesh),
    }
}

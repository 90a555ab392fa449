//! Multi-pass writer of mesh boundaries: surface formats, and formats for rendering and 3D printing.

use super::error::SurfaceFileError;
use super::{glb, obj, off, ply, stl, three_mf};
use crate::file::{Asked, AtomicFile, FileError, by_extension, write_whole};
use crate::volume::{GridOptions, MeshNotes, write_poly_data};
use anastomesh_mesh::boundary::BoundarySurface;
use anastomesh_mesh::progress::Progress;
use std::io::{self, Seek, Write};
use std::path::Path;

/// Output format of boundaries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BoundaryFormat {
    /// `.stl`, binary.
    Stl,
    /// `.ply`, binary with doubles.
    Ply,
    /// `.obj`.
    Obj,
    /// `.off`.
    Off,
    /// Binary glTF, `.glb`.
    Glb,
    /// `.3mf`.
    ThreeMf,
    /// VTK poly data with patches, `.vtp`.
    Vtp,
}

/// Extensions in lower case.
const EXTENSIONS: [(&str, BoundaryFormat); 7] = [
    ("stl", BoundaryFormat::Stl),
    ("ply", BoundaryFormat::Ply),
    ("obj", BoundaryFormat::Obj),
    ("off", BoundaryFormat::Off),
    ("glb", BoundaryFormat::Glb),
    ("3mf", BoundaryFormat::ThreeMf),
    ("vtp", BoundaryFormat::Vtp),
];

impl BoundaryFormat {
    /// Format of a file name, by its extension.
    ///
    /// # Errors
    /// `UnknownFormat` if no format has the extension.
    pub fn of(path: &Path) -> Result<Self, SurfaceFileError> {
        let (kind, known) = ("surface", ".stl, .ply, .obj, .off, .glb, .3mf, .vtp");
        let unknown = || FileError::UnknownFormat { path: path.to_path_buf(), kind, known };
        by_extension(path, &EXTENSIONS).ok_or_else(unknown)
    }
}

/// Checks in advance that a boundary can be written to `path`, without side effects.
///
/// # Errors
/// `UnknownFormat`, or `Write` with the reason.
pub fn ensure_boundary_writable(path: &Path) -> Result<(), SurfaceFileError> {
    BoundaryFormat::of(path)?;
    AtomicFile::create(path).map(drop).map_err(FileError::write(path))
}

/// Writes a boundary atomically, in the format of the file extension. STL and GLB round coordinates to 32 bits.
///
/// ```
/// use anastomesh_io::{BoundaryPart, BoundarySurface, MeshNotes, read_surface, write_boundary};
/// use anastomesh_mesh::{Patch, Point3, TetMesh, VolumeMesh, WALL};
///
/// let points = vec![Point3::origin(), Point3::new(1., 0., 0.), Point3::new(0., 1., 0.), Point3::new(0., 0., 1.)];
/// let volume = VolumeMesh {
///     mesh: TetMesh { points, tets: vec![[0, 1, 2, 3]] },
///     tet_block: vec![0],
///     boundary: vec![[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]],
///     boundary_block: vec![0; 4],
///     boundary_patch: vec![WALL; 4],
///     patches: vec![Patch { id: WALL, name: "wall".into(), cap: None }],
/// };
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("wall.ply");
/// write_boundary(&path, &BoundarySurface::new(&volume, BoundaryPart::Whole)?, &MeshNotes::default())?;
/// assert_eq!(read_surface(&path)?.triangles.len(), 4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// `UnknownFormat`, or `Write` with the reason.
pub fn write_boundary(path: &Path, surface: &BoundarySurface, notes: &MeshNotes) -> Result<(), SurfaceFileError> {
    write_boundary_watched(path, surface, notes, &())
}

/// Writes a boundary like [`write_boundary`], with cancellation. A cancelled file does not appear.
///
/// # Errors
/// See [`write_boundary`].
pub fn write_boundary_watched(
    path: &Path,
    surface: &BoundarySurface,
    notes: &MeshNotes,
    progress: &dyn Progress,
) -> Result<(), SurfaceFileError> {
    let format = BoundaryFormat::of(path)?;
    let write = |out: &mut AtomicFile| write_format(&mut Asked { out, progress }, format, surface, notes);
    write_whole(path, write).map_err(FileError::write(path))
}

fn write_format(
    out: &mut (impl Write + Seek),
    format: BoundaryFormat,
    surface: &BoundarySurface,
    notes: &MeshNotes,
) -> io::Result<()> {
    match format {
        BoundaryFormat::Stl => stl::write_boundary(out, surface),
        BoundaryFormat::Ply => ply::write_boundary(out, surface),
        BoundaryFormat::Obj => obj::write_boundary(out, surface),
        BoundaryFormat::Off => off::write_boundary(out, surface),
        BoundaryFormat::Glb => glb::write_boundary(out, surface),
        BoundaryFormat::ThreeMf => three_mf::write_boundary(out, surface),
        BoundaryFormat::Vtp => write_poly_data(out, surface, notes, GridOptions::default()),
    }
}

#[cfg(test)]
#[path = "boundary_tests.rs"]
mod tests;

//! Writer for all mesh formats.

use super::content::MeshNotes;
use super::error::MeshFileError;
use super::format::MeshFormat;
use super::options::{GridOptions, WriteOptions, boundary_beside};
use super::parts::PartsError;
use super::pvtu::{PieceFolder, Pieces};
use super::vtu::MixedGrid;
use super::{medit, msh, npy, openfoam, pvtu, second, simvascular, vtu};
use crate::file::{Asked, AtomicFile, FileError, OutputSet, stage_whole};
use crate::tetgen::MeshFamily;
use anastomesh_mesh::boundary::{BoundaryPart, BoundarySurface};
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::source::{MeshSource, gather};
use anastomesh_mesh::stacks::MixedMesh;
use std::borrow::Cow;
use std::io::{self, Cursor, Seek, Write};
use std::path::Path;

/// Checks in advance that a mesh can be written to `path`: the format is known, and a file can be created in its
/// folder. Has no side effects.
///
/// # Errors
/// `UnknownFormat`, or `Write` with the reason.
pub fn ensure_writable(path: &Path) -> Result<(), MeshFileError> {
    ensure_writable_as(MeshFormat::of(path)?, path)
}

/// Checks like [`ensure_writable`], for this format.
///
/// # Errors
/// `Write` with the reason.
pub fn ensure_writable_as(format: MeshFormat, path: &Path) -> Result<(), MeshFileError> {
    let file = || AtomicFile::create(path).map(drop);
    match format {
        MeshFormat::OpenFoam => openfoam::ensure_writable(path),
        MeshFormat::SimVascular => simvascular::ensure_writable(path),
        MeshFormat::Npy => npy::ensure_writable(path),
        MeshFormat::Pvtu => file().and_then(|()| PieceFolder::ensure_replaceable(path)),
        _ => file(),
    }
    .map_err(FileError::write(path))
}

/// Writes a mesh atomically, in the format of the file extension. The bytes depend only on the mesh and the notes. All
/// formats except `TetGen`'s stream multi-pass sources; see the writer of each.
///
/// ```
/// use anastomesh_io::{MeshNotes, read_mesh, write_mesh};
/// use anastomesh_mesh::{Point3, TetMesh, VolumeMesh};
///
/// let points = vec![Point3::origin(), Point3::new(1., 0., 0.), Point3::new(0., 1., 0.), Point3::new(0., 0., 1.)];
/// let mesh = TetMesh { points, tets: vec![[0, 1, 2, 3]] };
/// let volume = VolumeMesh { mesh, tet_block: vec![0], ..VolumeMesh::default() };
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("one.vtu");
/// write_mesh(&path, &volume, &MeshNotes::default())?;
/// assert_eq!(read_mesh(&path)?.volume.mesh, volume.mesh);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// `UnknownFormat`, or `Write` with the reason.
pub fn write_mesh(path: &Path, mesh: &dyn MeshSource, notes: &MeshNotes) -> Result<(), MeshFileError> {
    write_mesh_with(&WriteOptions::default(), path, mesh, notes, &())
}

/// Writes a mesh like [`write_mesh`], with options and cancellation. A cancelled file does not appear.
///
/// # Errors
/// `UnknownFormat`, or `Write` with the reason.
pub fn write_mesh_with(
    options: &WriteOptions,
    path: &Path,
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
    progress: &dyn Progress,
) -> Result<(), MeshFileError> {
    Ok(stage_mesh(options, path, mesh, notes, progress)?.place()?)
}

/// Writes a mesh like [`write_mesh_with`] under temporary names. [`OutputSet::place`] moves its files to their paths.
///
/// # Errors
/// `UnknownFormat`, or `Write` with the reason.
pub fn stage_mesh(
    options: &WriteOptions,
    path: &Path,
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
    progress: &dyn Progress,
) -> Result<OutputSet, MeshFileError> {
    let grid = options.grid;
    let format = options.format.map_or_else(|| MeshFormat::of(path), Ok)?;
    if options.parts.is_some() && !format.has_parts() {
        return Err(FileError::write(path)(PartsError::Format.into()));
    }
    if options.parts.is_some() && options.prisms {
        let error = PartsError::Content { what: "prisms", instead: "write tetrahedra, or an OpenFOAM case" };
        return Err(FileError::write(path)(error.into()));
    }
    if let Some(second) = options.second_order {
        let is_plain = format.has_second_order() && options.parts.is_none() && !options.prisms;
        let fits = if is_plain { second::ensure_fits(mesh, second) } else { Err(no_second_order()) };
        fits.map_err(FileError::write(path))?;
    }
    let stage = || match format {
        MeshFormat::Vtu | MeshFormat::Msh | MeshFormat::Msh2 if options.prisms => {
            stage_prisms(path, format, mesh, notes, grid, progress)
        }
        MeshFormat::Pvtu if options.prisms => {
            pvtu::stage_mixed(path, mesh, notes, Pieces { grid, ..Pieces::default() }, progress)
        }
        _ if options.prisms => Err(io::Error::new(
            io::ErrorKind::Unsupported,
            "prisms are written to .vtu, .pvtu and .msh; OpenFOAM cases have them in any case",
        )),
        MeshFormat::Pvtu => {
            let usual = Pieces::default();
            let memory = options.memory.unwrap_or(usual.memory);
            let pieces = Pieces { memory, grid, values: options.values, layers: options.layers, ..usual };
            match options.parts {
                Some(parts) => pvtu::stage_parts(path, mesh, notes, (parts, pieces), progress),
                None => pvtu::stage(path, mesh, notes, pieces, progress),
            }
        }
        MeshFormat::OpenFoam => {
            openfoam::stage(path, mesh, notes, options.parts, options.remark.unwrap_or(&|_| ()), progress)
        }
        MeshFormat::Npy => npy::stage(path, mesh, notes, options, progress),
        MeshFormat::SimVascular => simvascular::stage(path, mesh, options.second_order, notes, progress),
        MeshFormat::Vtu => stage_whole(path, |out| vtu::write(&mut Asked { out, progress }, mesh, notes, options)),
        MeshFormat::Msh => stage_whole(path, |out| {
            let out = &mut Asked { out, progress };
            match options.parts {
                Some(_) if options.values.is_some() => {
                    Err(PartsError::Content { what: "values", instead: "write .pvtu" }.into())
                }
                Some(parts) => msh::write_parts(out, mesh, notes, parts),
                None => msh::write(out, mesh, notes, (options.values, options.second_order)),
            }
        }),
        MeshFormat::Msh2 => {
            let beside = (options.values, options.second_order);
            stage_whole(path, |out| msh::write_2(&mut Asked { out, progress }, mesh, notes, beside))
        }
        format => stage_whole(path, |out| write_format(&mut Asked { out, progress }, format, mesh, notes)),
    };
    match format {
        MeshFormat::Tetgen => stage_family(path, mesh, progress),
        MeshFormat::Vtu | MeshFormat::Pvtu if grid.tets_alone => {
            let boundary = stage_boundary(path, mesh, notes, grid, progress)?;
            let mut outputs = stage().map_err(FileError::write(path))?;
            outputs.append(boundary);
            Ok(outputs)
        }
        _ => stage().map_err(FileError::write(path)),
    }
}

/// Error of a second-order mesh in another format.
fn no_second_order() -> io::Error {
    let text =
        "second-order meshes are written to .vtu, .msh, .msh2, .npyd and .svmesh, neither with prisms nor in parts";
    io::Error::new(io::ErrorKind::Unsupported, text)
}

/// Writes the prisms of layers as whole cells. The mesh is held in memory.
fn stage_prisms(
    path: &Path,
    format: MeshFormat,
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
    grid: GridOptions,
    progress: &dyn Progress,
) -> io::Result<OutputSet> {
    let volume = mesh.whole().map_or_else(|| gather(mesh).map(Cow::Owned), |volume| Ok(Cow::Borrowed(volume)))?;
    let mixed = MixedMesh::of(&volume);
    stage_whole(path, |out| {
        let out = &mut Asked { out, progress };
        match format {
            MeshFormat::Vtu => {
                let has_regions = !notes.regions.is_empty();
                let (points, notes) = (&volume.mesh.points, Some((&volume.patches[..], notes)));
                let grid = MixedGrid { points, mixed: &mixed, notes, has_regions, global_ids: None, options: grid };
                vtu::write_mixed(out, &grid)
            }
            MeshFormat::Msh2 => msh::write_mixed_2(out, &volume, &mixed, notes),
            _ => msh::write_mixed(out, &volume, &mixed, notes),
        }
    })
}

/// Writes the boundary file beside a tetrahedra-only grid.
fn stage_boundary(
    path: &Path,
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
    grid: GridOptions,
    progress: &dyn Progress,
) -> Result<OutputSet, MeshFileError> {
    let beside = boundary_beside(path);
    let staged = stage_whole(&beside, |out| {
        let surface = BoundarySurface::new(mesh, BoundaryPart::Whole)?;
        vtu::write_boundary(&mut Asked { out, progress }, &surface, notes, grid)
    });
    staged.map_err(FileError::write(&beside))
}

/// Writes a `TetGen` family, which needs the mesh in memory, as neighbours are not found in passes.
fn stage_family(path: &Path, mesh: &dyn MeshSource, progress: &dyn Progress) -> Result<OutputSet, MeshFileError> {
    let gathered;
    let volume = if let Some(volume) = mesh.whole() {
        volume
    } else {
        gathered = gather(mesh).map_err(FileError::write(path))?;
        &gathered
    };
    match MeshFamily::of_volume(volume).progress(progress).stage(path) {
        Ok((_, outputs)) => Ok(outputs),
        Err(FileError::BadMesh { path, cell }) => {
            let source = io::Error::new(io::ErrorKind::InvalidInput, format!("cell {cell} names no point"));
            Err(FileError::Write { path, source })
        }
        Err(error) => Err(error.widen()),
    }
}

/// Writes a mesh to a stream, such as standard output; the file is first built in memory.
///
/// ```
/// use anastomesh_io::MeshNotes;
/// use anastomesh_io::volume::{MeshFormat, read_mesh_from, write_mesh_to};
/// use anastomesh_mesh::{Point3, TetMesh, VolumeMesh};
///
/// let points = vec![Point3::origin(), Point3::new(1., 0., 0.), Point3::new(0., 1., 0.), Point3::new(0., 0., 1.)];
/// let mesh = TetMesh { points, tets: vec![[0, 1, 2, 3]] };
/// let volume = VolumeMesh { mesh, tet_block: vec![0], ..VolumeMesh::default() };
/// let mut bytes = Vec::new();
/// write_mesh_to(&mut bytes, MeshFormat::Msh, &volume, &MeshNotes::default())?;
/// assert_eq!(read_mesh_from(&bytes, MeshFormat::Msh)?.volume.mesh, volume.mesh);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The stream fails.
pub fn write_mesh_to(
    out: &mut impl Write,
    format: MeshFormat,
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
) -> io::Result<()> {
    let mut bytes = Cursor::new(Vec::new());
    write_format(&mut bytes, format, mesh, notes)?;
    out.write_all(bytes.get_ref())
}

/// Writes a mesh in a single-file format.
pub(super) fn write_format(
    out: &mut (impl Write + Seek),
    format: MeshFormat,
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
) -> io::Result<()> {
    match format {
        MeshFormat::Vtu => vtu::write(out, mesh, notes, &WriteOptions::default()),
        MeshFormat::Msh => msh::write(out, mesh, notes, (None, None)),
        MeshFormat::Msh2 => msh::write_2(out, mesh, notes, (None, None)),
        MeshFormat::Medit => medit::write(out, mesh, notes),
        MeshFormat::Tetgen | MeshFormat::Pvtu | MeshFormat::Npy | MeshFormat::OpenFoam | MeshFormat::SimVascular => {
            Err(io::Error::new(io::ErrorKind::Unsupported, "a mesh of this format is several files"))
        }
    }
}

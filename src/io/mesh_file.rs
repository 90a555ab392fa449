//! Meshes in files: which format, safe writing, and what goes into a file beside the mesh.

use super::atomic::AtomicFile;
use super::counted::Counted;
use super::file_error::{FileError, advice};
use super::medit::{self, MeditFault};
use super::pvtu::{self, Pieces};
use super::pvtu_folder::PieceFolder;
use super::tetgen::{self, MeshFamily, TetgenFault};
use super::vtk_xml::VtkError;
use super::{msh, vtu};
use crate::mesh::VolumeMesh;
use crate::mesh::check::Expectation;
use crate::mesh::source::{MeshSource, gather};
use std::io::{self, Cursor, Seek, Write};
use std::path::{Path, PathBuf};

/// A format of mesh files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum MeshFormat {
    /// VTK unstructured grid, `.vtu`.
    Vtu,
    /// VTK unstructured grid in pieces, `.pvtu` and a folder beside it.
    Pvtu,
    /// Gmsh 4.1, `.msh`.
    Msh,
    /// Medit's text format, `.mesh`.
    Medit,
    /// `TetGen`'s family of files, named by its `.ele` or `.node`.
    Tetgen,
}

impl MeshFormat {
    /// The format that a file name asks for by its extension.
    ///
    /// # Errors
    /// `UnknownFormat` when no format has the extension.
    pub fn of(path: &Path) -> Result<Self, MeshFileError> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        match extension.to_ascii_lowercase().as_str() {
            "vtu" => Ok(Self::Vtu),
            "pvtu" => Ok(Self::Pvtu),
            "msh" => Ok(Self::Msh),
            "mesh" => Ok(Self::Medit),
            "ele" | "node" => Ok(Self::Tetgen),
            _ => Err(MeshFileError::UnknownFormat { path: path.to_path_buf() }),
        }
    }

    /// Whether a mesh can be written without being held in memory as a whole.
    pub fn is_written_in_passes(self) -> bool {
        self != Self::Tetgen
    }
}

/// What a mesh file says beside the mesh itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshNotes {
    /// What a check has to find.
    pub expectation: Option<Expectation>,
    /// The program that made the mesh and its version.
    pub generator: String,
    /// The options it was made with.
    pub options: String,
    /// Whether the blocks of the tetrahedra are regions, which a format that groups cells is to keep apart.
    pub regions: bool,
}

/// A mesh as it was read from a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshFile {
    /// The mesh. Boundary and patches are empty when the file labels no boundary.
    pub volume: VolumeMesh,
    /// Whether the file labels a boundary.
    pub labelled: bool,
    /// What else the file says.
    pub notes: MeshNotes,
}

/// Why a mesh file could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshFileError {
    /// No format has this extension.
    #[error("{}: the extension names no known mesh format (known: .vtu, .pvtu, .msh, .mesh, .ele)", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The operating system refused to read.
    #[error("{}: cannot be read: {source}; check the path and its permissions", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Its reason.
        source: io::Error,
    },
    /// The operating system refused to write.
    #[error("{}: cannot be written: {source}; {}", path.display(), advice(source))]
    Write {
        /// The file.
        path: PathBuf,
        /// Its reason.
        source: io::Error,
    },
    /// There is nothing in it.
    #[error("{}: the file is empty: write or copy it again", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// What is in the file is no mesh.
    #[error("{}: {fault}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        #[source]
        fault: ContentFault,
    },
}

/// Why the content of a file is no mesh.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ContentFault {
    /// It is no sound VTK XML file.
    #[error(transparent)]
    Vtk(#[from] VtkError),
    /// It is no mesh of Medit's.
    #[error(transparent)]
    Medit(#[from] MeditFault),
    /// It is no mesh of `TetGen`'s.
    #[error(transparent)]
    Tetgen(#[from] TetgenFault),
    /// The format spreads a mesh over several files.
    #[error("a mesh of this format is several files: name the path of its .ele or .pvtu file")]
    SeveralFiles,
    /// Something that every such file has is not there.
    #[error("'{what}' is missing")]
    Missing {
        /// Name of the element, array or section.
        what: &'static str,
    },
    /// An array is as long as the others do not say.
    #[error("array '{array}' has {found} values instead of {expected}")]
    Length {
        /// Its name.
        array: String,
        /// How long it had to be.
        expected: usize,
        /// How long it is.
        found: usize,
    },
    /// The offsets of the cells do not ascend by their sizes.
    #[error("cell {cell} has another number of points than its type")]
    BadOffset {
        /// The first such cell.
        cell: usize,
    },
    /// Two pieces say of a point that they share that it is elsewhere.
    #[error("the pieces have different positions for the point {id}: they are not of one mesh; write them again")]
    PointsDiffer {
        /// Its global id.
        id: i64,
    },
    /// The file ends before it is complete.
    #[error("the file ends too early: it was not written or copied completely; write or copy it again")]
    CutShort,
    /// Something else stands where a number or name has to be.
    #[error("no number or name of the format before byte {byte}")]
    BadNumber {
        /// Where.
        byte: usize,
    },
    /// Two nodes have the same tag.
    #[error("two nodes have the tag {tag}")]
    RepeatedTag {
        /// The tag.
        tag: u64,
    },
    /// A version of the format that is not read.
    #[error("version {version} of the format is not supported; Gmsh writes 4.1 with -format msh41")]
    UnsupportedVersion {
        /// The version.
        version: String,
    },
    /// There are cells that are neither tetrahedra nor triangles.
    #[error("cell {cell} is of type {kind}; only linear tetrahedra and triangles are supported")]
    UnsupportedCell {
        /// Type of the cell, in the numbers of the format.
        kind: i64,
        /// The first such cell.
        cell: usize,
    },
}

impl<F> From<FileError<F>> for MeshFileError
where
    F: std::error::Error + 'static,
    ContentFault: From<F>,
{
    fn from(error: FileError<F>) -> Self {
        match error {
            FileError::UnknownFormat { path, .. } => Self::UnknownFormat { path },
            FileError::Read { path, source } => Self::Read { path, source },
            FileError::Write { path, source } => Self::Write { path, source },
            FileError::Empty { path } => Self::Empty { path },
            FileError::Content { path, fault } => Self::Content { path, fault: fault.into() },
            FileError::BadMesh { path, cell } => {
                let source = io::Error::new(io::ErrorKind::InvalidInput, format!("cell {cell} names no point"));
                Self::Write { path, source }
            }
        }
    }
}

/// Reads a mesh from a file (or several: `.pvtu`, `.ele`), in the format that its extension names.
///
/// # Errors
/// `UnknownFormat`, `Read` with the system's reason, `Empty`, or `Content` with what is wrong.
pub fn read_mesh(path: &Path) -> Result<MeshFile, MeshFileError> {
    let refused = |source| MeshFileError::Read { path: path.to_path_buf(), source };
    if path.is_dir() {
        return Err(refused(io::ErrorKind::IsADirectory.into()));
    }
    let format = MeshFormat::of(path)?;
    match format {
        MeshFormat::Tetgen => return Ok(unnoted(tetgen::read_mesh(path)?)),
        MeshFormat::Pvtu => return pvtu::read_pvtu(path),
        _ => {}
    }
    let bytes = std::fs::read(path).map_err(refused)?;
    if bytes.trim_ascii().is_empty() {
        return Err(MeshFileError::Empty { path: path.to_path_buf() });
    }
    read_mesh_from(&bytes, format).map_err(|fault| MeshFileError::Content { path: path.to_path_buf(), fault })
}

/// Reads a mesh from the bytes of a file.
///
/// # Errors
/// When the bytes are no such file, or it is incomplete.
pub fn read_mesh_from(bytes: &[u8], format: MeshFormat) -> Result<MeshFile, ContentFault> {
    match format {
        MeshFormat::Vtu => vtu::read_vtu(bytes),
        MeshFormat::Msh => msh::read_msh(bytes),
        MeshFormat::Medit => Ok(unnoted(medit::read_medit_from(bytes)?)),
        MeshFormat::Tetgen | MeshFormat::Pvtu => Err(ContentFault::SeveralFiles),
    }
}

/// A mesh from a format that has no place for notes.
fn unnoted(volume: VolumeMesh) -> MeshFile {
    let labelled = !volume.boundary.is_empty();
    MeshFile { volume, labelled, notes: MeshNotes::default() }
}

/// Makes sure, before any work is done, that a mesh can be written to `path`: the format is known, and a file can be
/// made in its folder. Leaves nothing behind.
///
/// # Errors
/// `UnknownFormat`, or `Write` with the reason.
pub fn ensure_writable(path: &Path) -> Result<(), MeshFileError> {
    let format = MeshFormat::of(path)?;
    let pieces = || if format == MeshFormat::Pvtu { PieceFolder::ensure_replaceable(path) } else { Ok(()) };
    let tried = AtomicFile::create(path).map(drop).and_then(|()| pieces());
    tried.map_err(|source| MeshFileError::Write { path: path.to_path_buf(), source })
}

/// Writes a mesh to a file, in the format that its extension names. The file appears whole or not at all. The bytes depend
/// on the mesh and the notes alone. No format but `TetGen`'s holds a mesh that is read in passes: see the writers of each.
///
/// # Errors
/// `UnknownFormat`, or `Write` with the reason.
pub fn write_mesh(path: &Path, mesh: &dyn MeshSource, notes: &MeshNotes) -> Result<(), MeshFileError> {
    write_mesh_within(Pieces::default().memory, path, mesh, notes)
}

/// As [`write_mesh`], holding about so many bytes of a mesh in pieces at a time; the other formats take less.
///
/// # Errors
/// `UnknownFormat`, or `Write` with the reason.
pub fn write_mesh_within(
    memory: usize,
    path: &Path,
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
) -> Result<(), MeshFileError> {
    let format = MeshFormat::of(path)?;
    if format == MeshFormat::Tetgen {
        return write_family(path, mesh);
    }
    let write = || {
        if format == MeshFormat::Pvtu {
            return pvtu::write_pvtu(path, mesh, notes, Pieces { memory, ..Pieces::default() });
        }
        let mut file = AtomicFile::create(path)?;
        write_format(&mut file, format, mesh, notes)?;
        file.commit()
    };
    write().map_err(|source| MeshFileError::Write { path: path.to_path_buf(), source })
}

/// The neighbours of tetrahedra are not found in passes: this format holds the mesh in memory.
fn write_family(path: &Path, mesh: &dyn MeshSource) -> Result<(), MeshFileError> {
    let gathered;
    let volume = if let Some(volume) = mesh.whole() {
        volume
    } else {
        gathered =
            gather(&Counted(mesh)).map_err(|source| MeshFileError::Write { path: path.to_path_buf(), source })?;
        &gathered
    };
    MeshFamily::of_volume(volume).write(path)?;
    Ok(())
}

/// Writes a mesh to a stream, such as standard output; the file is put together in memory first.
///
/// # Errors
/// What the stream reports.
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

pub(super) fn write_format(
    out: &mut (impl Write + Seek),
    format: MeshFormat,
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
) -> io::Result<()> {
    let mesh = &Counted(mesh);
    match format {
        MeshFormat::Vtu => vtu::write_vtu(out, mesh, notes),
        MeshFormat::Msh => msh::write_msh(out, mesh, notes),
        MeshFormat::Medit => medit::write_medit_to(out, mesh),
        MeshFormat::Tetgen | MeshFormat::Pvtu => {
            Err(io::Error::new(io::ErrorKind::Unsupported, "a mesh of this format is several files"))
        }
    }
}

//! What can go wrong between a path and its bytes, whatever the format.

use super::atomic::AtomicFile;
use std::error::Error;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Why a file could not be read or written; `F` tells what can be wrong with the content of its format.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError<F: Error + 'static> {
    /// No format has this extension.
    #[error("{}: the extension names no format that is known here (known: {known})", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// The extensions that are known.
        known: &'static str,
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
    /// What is in the file is not what its format asks for.
    #[error("{}: {fault}", path.display())]
    Content {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        #[source]
        fault: F,
    },
    /// A mesh that was to be written is no mesh: a cell names a point that does not exist.
    #[error("{}: not written: cell {cell} of the mesh names a point that does not exist", path.display())]
    BadMesh {
        /// The file.
        path: PathBuf,
        /// The first such cell.
        cell: usize,
    },
}

/// What to do when a file cannot be written.
pub(super) fn advice(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "the disk is full: free space or name a file on another disk; an earlier file of this name is as it was"
        }
        io::ErrorKind::AlreadyExists => "name another file",
        // Not the file is at fault, but the mesh.
        io::ErrorKind::InvalidData | io::ErrorKind::Other => "an earlier file of this name is as it was",
        _ => "name a file in a folder that exists and can be written to",
    }
}

/// The bytes of a file that is not empty.
pub(super) fn read_bytes<F: Error>(path: &Path) -> Result<Vec<u8>, FileError<F>> {
    let refused = |source| FileError::Read { path: path.to_path_buf(), source };
    if path.is_dir() {
        return Err(refused(io::ErrorKind::IsADirectory.into()));
    }
    let bytes = std::fs::read(path).map_err(refused)?;
    if bytes.trim_ascii().is_empty() {
        return Err(FileError::Empty { path: path.to_path_buf() });
    }
    Ok(bytes)
}

/// Writes a file that appears whole or not at all.
pub(super) fn write_whole<F: Error>(
    path: &Path,
    write: impl FnOnce(&mut AtomicFile) -> io::Result<()>,
) -> Result<(), FileError<F>> {
    let all = || {
        let mut file = AtomicFile::create(path)?;
        write(&mut file)?;
        file.commit()
    };
    all().map_err(|source| FileError::Write { path: path.to_path_buf(), source })
}

/// A file's path, and what writes what it holds.
pub(super) type Writing<'a> = (PathBuf, &'a dyn Fn(&mut dyn Write) -> io::Result<()>);

/// Writes several files that belong together: each is complete before the first of them appears, in the order given.
pub(super) fn write_all_whole<F: Error>(files: &[Writing]) -> Result<(), FileError<F>> {
    let mut complete = Vec::with_capacity(files.len());
    for (path, write) in files {
        let make = || {
            let mut file = AtomicFile::create(path)?;
            write(&mut file)?;
            file.complete()?;
            Ok(file)
        };
        complete.push(make().map_err(|source| FileError::Write { path: path.clone(), source })?);
    }
    for (file, (path, _)) in complete.into_iter().zip(files) {
        file.commit().map_err(|source| FileError::Write { path: path.clone(), source })?;
    }
    Ok(())
}

/// Makes sure that every cell names existing points.
pub(super) fn ensure_sound<F: Error, const N: usize>(
    path: &Path,
    cells: &[[u32; N]],
    points: usize,
) -> Result<(), FileError<F>> {
    match unsound(cells, points) {
        Some(cell) => Err(FileError::BadMesh { path: path.to_path_buf(), cell }),
        None => Ok(()),
    }
}

/// The first cell that names a point that does not exist.
pub(super) fn unsound<const N: usize>(cells: &[[u32; N]], points: usize) -> Option<usize> {
    cells.iter().position(|cell| cell.iter().any(|&v| v as usize >= points))
}

/// The extension of a path in lower case.
pub(super) fn extension(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}

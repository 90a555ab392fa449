//! What can go wrong between a path and its bytes, whatever the format.

use std::error::Error;
use std::io;
use std::path::{Path, PathBuf};

/// Why a file could not be read or written; `F` tells what can be wrong with the content of its format.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError<F: Error + 'static> {
    /// No format has this extension.
    #[error("{}: the extension names no {kind} (known: {known})", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
        /// What was looked for, such as a known mesh format.
        kind: &'static str,
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

impl<F: Error> FileError<F> {
    /// Tells of a path that it could not be read.
    pub fn read(path: &Path) -> impl FnOnce(io::Error) -> Self {
        |source| Self::Read { path: path.to_path_buf(), source }
    }

    /// Tells of a path that it could not be written.
    pub fn write(path: &Path) -> impl FnOnce(io::Error) -> Self {
        |source| Self::Write { path: path.to_path_buf(), source }
    }

    /// Tells of a path what is wrong with its content.
    pub fn content<G: Into<F>>(path: &Path) -> impl FnOnce(G) -> Self {
        |fault| Self::Content { path: path.to_path_buf(), fault: fault.into() }
    }

    /// The same of a format among others.
    pub fn widen<G: Error + From<F>>(self) -> FileError<G> {
        match self {
            Self::UnknownFormat { path, kind, known } => FileError::UnknownFormat { path, kind, known },
            Self::Read { path, source } => FileError::Read { path, source },
            Self::Write { path, source } => FileError::Write { path, source },
            Self::Empty { path } => FileError::Empty { path },
            Self::Content { path, fault } => FileError::Content { path, fault: fault.into() },
            Self::BadMesh { path, cell } => FileError::BadMesh { path, cell },
        }
    }
}

/// What to do when a file cannot be written.
fn advice(error: &io::Error) -> &'static str {
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

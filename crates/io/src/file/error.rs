//! Errors of file access for all formats.

use std::error::Error;
use std::io;
use std::path::{Path, PathBuf};

/// Errors of reading and writing a file; `F` is the content error of the format.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FileError<F: Error + 'static> {
    /// The extension is unknown.
    #[error("{}: {}; known: {known}", path.display(), unrecognised(path, kind))]
    UnknownFormat {
        /// Path of the file.
        path: PathBuf,
        /// Kind of file that was expected, such as `mesh`.
        kind: &'static str,
        /// Known extensions.
        known: &'static str,
    },
    /// The operating system reported a read error.
    #[error("{}: cannot be read: {source}; check the path and its permissions", path.display())]
    Read {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The operating system reported a write error.
    #[error("{}: cannot be written: {source}; {}", path.display(), advice(source))]
    Write {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The file is empty.
    #[error("{}: the file is empty: write or copy it again", path.display())]
    Empty {
        /// Path of the file.
        path: PathBuf,
    },
    /// The contents violate the format.
    #[error("{}: {fault}", path.display())]
    Content {
        /// Path of the file.
        path: PathBuf,
        /// Content error.
        #[source]
        fault: F,
    },
    /// A mesh to write is invalid: a cell refers to a missing point.
    #[error("{}: not written: cell {cell} of the mesh refers to a missing point", path.display())]
    BadMesh {
        /// Path of the file.
        path: PathBuf,
        /// First invalid cell.
        cell: usize,
    },
}

impl<F: Error> FileError<F> {
    /// Creates a read error for a path.
    pub fn read(path: &Path) -> impl FnOnce(io::Error) -> Self {
        |source| Self::Read { path: path.to_path_buf(), source }
    }

    /// Creates a write error for a path.
    pub fn write(path: &Path) -> impl FnOnce(io::Error) -> Self {
        |source| Self::Write { path: path.to_path_buf(), source }
    }

    /// Creates a content error for a path.
    pub fn content<G: Into<F>>(path: &Path) -> impl FnOnce(G) -> Self {
        |fault| Self::Content { path: path.to_path_buf(), fault: fault.into() }
    }

    /// Converts to the error of a more general format.
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

impl<F: Error> From<OutputError> for FileError<F> {
    fn from(OutputError { path, source }: OutputError) -> Self {
        Self::Write { path, source }
    }
}

/// Error of [`OutputSet::place`](super::OutputSet::place): an output cannot be moved to its path.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be written: {source}; {}", path.display(), advice(source))]
#[non_exhaustive]
pub struct OutputError {
    /// Path of the output.
    pub path: PathBuf,
    /// Error of the operating system. Its text also names earlier outputs that could not be restored.
    pub source: io::Error,
}

impl OutputError {
    /// Adds a sentence for each output that could not be restored.
    pub(super) fn with_unrestored(self, unrestored: &[String]) -> Self {
        if unrestored.is_empty() {
            return self;
        }
        let Self { path, source } = self;
        let text = format!("{source}; {}", unrestored.join("; "));
        Self { path, source: io::Error::new(source.kind(), text) }
    }
}

fn unrecognised(path: &Path, kind: &str) -> String {
    match path.extension() {
        Some(extension) => format!("unrecognised {kind} extension '.{}'", extension.to_string_lossy()),
        None => format!("missing {kind} extension"),
    }
}

/// Advice for a write error.
fn advice(error: &io::Error) -> &'static str {
    match error.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
            "the disk is full: free space or name a file on another disk; an earlier file of this name is as it was"
        }
        io::ErrorKind::AlreadyExists => "name another file",
        // The mesh is at fault, not the file.
        io::ErrorKind::InvalidData | io::ErrorKind::Other => "an earlier file of this name is as it was",
        _ => "name a file in a folder that exists and can be written to",
    }
}

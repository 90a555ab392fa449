//! Which formats of networks there are, and which of them a path asks for.

use super::error::NetworkFileError;
use crate::io::file::{FileError, by_extension};
use std::path::Path;

/// A format of network files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum NetworkFormat {
    /// Rows of id, type, x, y, z, radius, parent: `.swc`.
    Swc,
    /// VTK poly data with lines: `.vtp`.
    Vtp,
}

/// Extensions, in lower case.
const EXTENSIONS: [(&str, NetworkFormat); 2] = [("swc", NetworkFormat::Swc), ("vtp", NetworkFormat::Vtp)];

impl NetworkFormat {
    /// The format that a file name asks for by its extension.
    ///
    /// # Errors
    /// `UnknownFormat` when no format has the extension.
    pub fn of(path: &Path) -> Result<Self, NetworkFileError> {
        let (kind, known) = ("known network format", ".swc, .vtp");
        let unknown = || FileError::UnknownFormat { path: path.to_path_buf(), kind, known };
        Ok(by_extension(path, &EXTENSIONS).ok_or_else(unknown)?)
    }
}

//! Errors of meshes in parts.

use std::io;

/// Errors of writing a mesh in parts, inside the error of the operating system that writers return.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PartsError {
    /// The mesh has too few cells.
    #[error("{parts} parts need at least {parts} cells, and the mesh has {cells}; ask for fewer parts")]
    TooFewCells {
        /// Requested number of parts.
        parts: usize,
        /// Number of cells.
        cells: usize,
    },
    /// The format has no parts.
    #[error("this format has no parts; use .foam, .pvtu or .msh")]
    Format,
    /// The writer of this content has no parts.
    #[error("{what} cannot be written in parts; {instead}")]
    Content {
        /// Content of the mesh.
        what: &'static str,
        /// Remedy.
        instead: &'static str,
    },
    /// A part exceeds the memory limit.
    #[error(
        "a part of {cells} cells needs about {needed} MiB of memory, more than the limit of {limit} MiB for writing; ask for more \
         parts or more memory"
    )]
    Memory {
        /// Cells of the largest part.
        cells: usize,
        /// Estimate in MiB.
        needed: usize,
        /// Limit in MiB.
        limit: usize,
    },
}

impl From<PartsError> for io::Error {
    fn from(error: PartsError) -> Self {
        Self::other(error)
    }
}

//! Errors of Medit files.

use crate::text::TextFault;

/// Content errors of a Medit file. Cells are numbered from 0 within their list.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeditFault {
    /// A word is invalid.
    #[error(transparent)]
    Text(#[from] TextFault),
    /// The first line does not identify a Medit file.
    #[error("line {line}: expected MeshVersionFormatted, found '{found}'; is it a Medit text file?")]
    NotMedit {
        /// Line of the file, from 1.
        line: usize,
        /// Text found.
        found: String,
    },
    /// The points are not three-dimensional.
    #[error("line {line}: the mesh has dimension {dimension}, expected 3")]
    Dimension {
        /// Line of the file, from 1.
        line: usize,
        /// Dimension that was found.
        dimension: i64,
    },
    /// There are cells that are neither tetrahedra nor triangles.
    #[error("line {line}: {kind} are not supported, only tetrahedra and triangles")]
    UnsupportedCells {
        /// Line of the file, from 1.
        line: usize,
        /// Keyword of the list.
        kind: String,
    },
    /// A list occurs twice.
    #[error("line {line}: duplicate list of {kind}: merge the lists")]
    Repeated {
        /// Line of the file, from 1.
        line: usize,
        /// Keyword of the list.
        kind: &'static str,
    },
    /// A cell refers to a missing point.
    #[error("cell {cell} of {kind} refers to point {index}, but points are numbered from 1 to {points}: correct it")]
    BadIndex {
        /// List of the cell.
        kind: &'static str,
        /// The first such cell.
        cell: usize,
        /// Invalid index.
        index: i64,
        /// Number of points.
        points: usize,
    },
    /// A required list is missing.
    #[error("the list of {what} is missing: is the file truncated?")]
    Missing {
        /// Name of the list.
        what: &'static str,
    },
}

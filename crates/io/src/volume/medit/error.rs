//! What can be wrong with a Medit file.

use crate::text::TextFault;

/// Why the content of a file is no tetrahedral mesh of Medit's. Cells are numbered from 0 within their list.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeditFault {
    /// Its words are not those of the format.
    #[error(transparent)]
    Text(#[from] TextFault),
    /// The file does not begin as every such file does.
    #[error("line {line}: '{found}' stands where MeshVersionFormatted has to be; is it a Medit text file?")]
    NotMedit {
        /// Line of the file, from 1.
        line: usize,
        /// What is there.
        found: String,
    },
    /// Points are not in space.
    #[error("line {line}: the mesh has the dimension {dimension}; it has to be 3")]
    Dimension {
        /// Line of the file, from 1.
        line: usize,
        /// Dimension that was found.
        dimension: i64,
    },
    /// There are cells that are neither tetrahedra nor triangles.
    #[error("line {line}: there are {kind}; only tetrahedra and triangles are supported")]
    UnsupportedCells {
        /// Line of the file, from 1.
        line: usize,
        /// Their keyword.
        kind: String,
    },
    /// A list comes a second time.
    #[error("line {line}: a second list of {kind}; there may be one")]
    Repeated {
        /// Line of the file, from 1.
        line: usize,
        /// Its keyword.
        kind: &'static str,
    },
    /// A cell names a point that does not exist.
    #[error("{kind} {cell} names the point {index}, but the points are numbered from 1 to {points}: correct it")]
    BadIndex {
        /// The list of the cell.
        kind: &'static str,
        /// The first such cell.
        cell: usize,
        /// What it names.
        index: i64,
        /// How many points there are.
        points: usize,
    },
    /// Something that every mesh has is not there.
    #[error("the list of {what} is missing: was it written completely?")]
    Missing {
        /// The list.
        what: &'static str,
    },
}

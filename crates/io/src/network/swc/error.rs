//! Errors of SWC files.

use anastomesh_mesh::units::counted;
use anastomesh_skeleton::{LARGEST, SMALLEST};

/// Errors of an SWC file. Lines are numbered from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SwcError {
    /// A row has too few columns.
    #[error("line {line} has {}, but SWC needs 7: id, type, x, y, z, radius, parent", counted(*found, "column"))]
    TooFewColumns {
        /// Line of the file, from 1.
        line: usize,
        /// Number of columns found.
        found: usize,
    },
    /// A column does not contain a number.
    #[error("line {line}: the {column} is '{text}', not a number; columns are id, type, x, y, z, radius, parent")]
    NotANumber {
        /// Line of the file, from 1.
        line: usize,

        /// Column.
        column: &'static str,
        /// Text found.
        text: String,
    },
    /// A coordinate is infinite, NaN, or too large for computation.
    #[error(
        "line {line}: node {id} has the {column} {value:e}; coordinates must be finite and below {LARGEST:e}: correct it"
    )]
    BadCoordinate {
        /// Line of the file, from 1.
        line: usize,
        /// Node id.
        id: i64,

        /// Column.
        column: &'static str,
        /// Value found.
        value: f64,
    },
    /// A radius is zero, negative, infinite, NaN, or too small or large for computation.
    #[error(
        "line {line}: node {id} has the radius {radius:?}; radii must be positive, between {SMALLEST:e} and {LARGEST:e}: give the radius of the \
         vessel"
    )]
    BadRadius {
        /// Line of the file, from 1.
        line: usize,
        /// Node id.
        id: i64,
        /// Value found.
        radius: f64,
    },
    /// Two rows have an equal id.
    #[error("line {line}: duplicate node {id}, first defined in line {first}; ids must differ")]
    RepeatedId {
        /// Line of the file, from 1.
        line: usize,

        /// Id that was found.
        id: i64,
        /// Line of the first occurrence.
        first: usize,
    },
    /// A node is its own parent.
    #[error("line {line}: node {id} is its own parent; a root has the parent -1")]
    SelfParent {
        /// Line of the file, from 1.
        line: usize,
        /// Node id.
        id: i64,
    },
    /// The parent of a node does not exist.
    #[error("line {line}: node {id} has the unknown parent {parent}; a root has the parent -1")]
    UnknownParent {
        /// Line of the file, from 1.
        line: usize,
        /// Node id.
        id: i64,

        /// Id of the parent that was found.
        parent: i64,
    },
    /// The file contains no nodes.
    #[error("the file has no nodes; is it an SWC file?")]
    NoNodes,
}

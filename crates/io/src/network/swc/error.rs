//! What can be wrong with an SWC file.

use anastomesh_skeleton::LARGEST;

/// Why an SWC file could not be understood. Lines are numbered from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SwcError {
    /// A row has too few columns.
    #[error("line {line} has {found} columns; a row of an SWC file has seven: id, type, x, y, z, radius, parent")]
    TooFewColumns {
        line: usize,
        /// How many columns it has.
        found: usize,
    },
    /// A column holds no number.
    #[error("line {line}: the {column} is '{text}', not a number; columns are id, type, x, y, z, radius, parent")]
    NotANumber {
        line: usize,
        column: &'static str,
        /// What is there.
        text: String,
    },
    /// A coordinate is infinite or not a number, or too large to be computed with.
    #[error(
        "line {line}: node {id} has the {column} {value:e}; coordinates must be finite and below {LARGEST:e}: correct it"
    )]
    BadCoordinate {
        line: usize,
        /// The node's id.
        id: i64,
        column: &'static str,
        /// What is there.
        value: f64,
    },
    /// A radius is zero, negative, infinite or not a number.
    #[error(
        "line {line}: node {id} has the radius {radius}; radii must be finite and above zero: give it the radius of its vessel"
    )]
    BadRadius {
        line: usize,
        /// The node's id.
        id: i64,
        /// What is there.
        radius: f64,
    },
    /// Two rows have one id.
    #[error("line {line}: node {id} was given in line {first} already; ids must differ")]
    RepeatedId {
        line: usize,
        id: i64,
        /// The line that had it first.
        first: usize,
    },
    /// A node is its own parent.
    #[error("line {line}: node {id} is its own parent; a root has the parent -1")]
    SelfParent {
        line: usize,
        /// The node's id.
        id: i64,
    },
    /// A node's parent does not exist.
    #[error("line {line}: node {id} has the parent {parent}, which is in no row; a root has the parent -1")]
    UnknownParent {
        line: usize,
        /// The node's id.
        id: i64,
        parent: i64,
    },
    /// There are only comments.
    #[error("there is no row with a node in it; is it an SWC file?")]
    NoNodes,
}

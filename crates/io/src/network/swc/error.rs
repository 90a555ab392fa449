//! What can be wrong with an SWC file.

use anastomesh_skeleton::LARGEST;

/// Why an SWC file could not be understood. Lines are numbered from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SwcError {
    /// A row has too few columns.
    #[error("line {line} has {found} columns; a row of an SWC file has seven: id, type, x, y, z, radius, parent")]
    TooFewColumns {
        /// Line of the file, from 1.
        line: usize,
        /// How many columns it has.
        found: usize,
    },
    /// A column holds no number.
    #[error("line {line}: the {column} is '{text}', not a number; columns are id, type, x, y, z, radius, parent")]
    NotANumber {
        /// Line of the file, from 1.
        line: usize,

        /// Column.
        column: &'static str,
        /// What is there.
        text: String,
    },
    /// A coordinate is infinite or not a number, or too large to be computed with.
    #[error(
        "line {line}: node {id} has the {column} {value:e}; coordinates must be finite and below {LARGEST:e}: correct it"
    )]
    BadCoordinate {
        /// Line of the file, from 1.
        line: usize,
        /// The node's id.
        id: i64,

        /// Column.
        column: &'static str,
        /// What is there.
        value: f64,
    },
    /// A radius is zero, negative, infinite or not a number.
    #[error(
        "line {line}: node {id} has the radius {radius}; radii must be finite and above zero: give it the radius of its vessel"
    )]
    BadRadius {
        /// Line of the file, from 1.
        line: usize,
        /// The node's id.
        id: i64,
        /// What is there.
        radius: f64,
    },
    /// Two rows have one id.
    #[error("line {line}: node {id} was given in line {first} already; ids must differ")]
    RepeatedId {
        /// Line of the file, from 1.
        line: usize,

        /// Id that was found.
        id: i64,
        /// The line that had it first.
        first: usize,
    },
    /// A node is its own parent.
    #[error("line {line}: node {id} is its own parent; a root has the parent -1")]
    SelfParent {
        /// Line of the file, from 1.
        line: usize,
        /// The node's id.
        id: i64,
    },
    /// A node's parent does not exist.
    #[error("line {line}: node {id} has the parent {parent}, which is in no row; a root has the parent -1")]
    UnknownParent {
        /// Line of the file, from 1.
        line: usize,
        /// The node's id.
        id: i64,

        /// Id of the parent that was found.
        parent: i64,
    },
    /// There are only comments.
    #[error("there is no row with a node in it; is it an SWC file?")]
    NoNodes,
}

//! Errors of arrays.

use anastomesh_mesh::units::counted;

/// Error of an array folder, with the affected file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}: {fault}")]
pub struct NpyError {
    /// File in the folder.
    pub file: String,
    /// Fault of the file.
    pub fault: NpyFault,
}

/// Fault of an array. Rows count from 0.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NpyFault {
    /// A required array is missing.
    #[error("is missing: write it with numpy.save")]
    Missing,
    /// The file is not an array.
    #[error("is not an .npy file: write it with numpy.save")]
    NotNpy,
    /// The format version is not supported.
    #[error("has the unsupported format version {major}; use 1, 2 or 3")]
    Version {
        /// Major version.
        major: u8,
    },
    /// The header is truncated or malformed.
    #[error("has an invalid header ({what}): write it again with numpy.save")]
    Header {
        /// Fault of the header.
        what: &'static str,
    },
    /// The item type is not suitable.
    #[error("has items of type '{found}', expected {wanted}: convert it with astype")]
    Type {
        /// Type found, in `NumPy` notation.
        found: String,
        /// Expected type.
        wanted: &'static str,
    },
    /// The number of columns is wrong.
    #[error("has shape {}, expected {wanted}", shown(found))]
    Shape {
        /// Shape found.
        found: Vec<usize>,
        /// Expected shape.
        wanted: String,
    },
    /// The number of bytes does not match shape and type.
    #[error("its shape and type announce {announced} bytes, it has {found}: it was not written or copied completely")]
    Length {
        /// Announced number of bytes, saturated on overflow.
        announced: u64,
        /// Number of bytes found.
        found: u64,
    },
    /// The number of rows differs from another array.
    #[error("has {}, and {of} has {wanted}: give one row for each", counted(*found, "row"))]
    Rows {
        /// Number of rows found.
        found: usize,
        /// Name of the other array.
        of: &'static str,
        /// Number of rows of the other array.
        wanted: usize,
    },
    /// The number of rows exceeds the index range.
    #[error("has {found} rows, too many for 32-bit indices")]
    TooMany {
        /// Number of rows found.
        found: usize,
    },
    /// A row refers to a missing element.
    #[error("row {row} refers to {index}, but {of} has {}, numbered from 0", counted(*count, "row"))]
    Index {
        /// First such row.
        row: usize,
        /// Invalid index.
        index: i64,
        /// Array to which it refers.
        of: &'static str,
        /// Number of rows of that array.
        count: usize,
    },
    /// A number is infinite or NaN.
    #[error("row {row} has an infinite or NaN value: correct it")]
    NotFinite {
        /// First such row.
        row: usize,
    },
    /// A label is not a 32-bit integer.
    #[error("row {row} has {value}, not a 32-bit integer")]
    NoLabel {
        /// First such row.
        row: usize,
        /// Value found.
        value: String,
    },
    /// The additional JSON file is invalid.
    #[error("cannot be read: {reason}; write the mesh again, or remove this file")]
    Json {
        /// Reason of the failure.
        reason: String,
    },
}

impl NpyFault {
    /// Adds the file name.
    pub fn of(self, file: impl Into<String>) -> NpyError {
        NpyError { file: file.into(), fault: self }
    }
}

/// Shape in Python notation.
fn shown(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        several => format!("({})", several.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")),
    }
}

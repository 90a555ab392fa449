//! What can be wrong with arrays.

/// What is wrong in a folder of arrays, and with which of them.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{file}: {fault}")]
pub struct NpyError {
    /// The file in the folder.
    pub file: String,
    /// What is wrong.
    pub fault: NpyFault,
}

/// What is wrong with an array. Rows count from 0.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NpyFault {
    /// The array that has to be there is not.
    #[error("is missing: write it with numpy.save")]
    Missing,
    /// It does not begin as such files do.
    #[error("is no .npy file: write it with numpy.save")]
    NotNpy,
    /// A later version of the format.
    #[error("has version {major} of the format; 1, 2 and 3 are read")]
    Version {
        /// The version.
        major: u8,
    },
    /// The header is cut off or says something else than it has to.
    #[error("its header cannot be read ({what}): write it again with numpy.save")]
    Header {
        /// What is wrong.
        what: &'static str,
    },
    /// The items are no numbers of the kind that is needed.
    #[error("its items are of type '{found}', and {wanted} are needed: convert it with astype")]
    Type {
        /// What they are, as `NumPy` has it.
        found: String,
        /// What is needed.
        wanted: &'static str,
    },
    /// It has not as many columns as is needed.
    #[error("has the shape {}, and {wanted} is needed", shown(found))]
    Shape {
        /// What it has.
        found: Vec<usize>,
        /// What is needed.
        wanted: String,
    },
    /// Not as many bytes as shape and type say.
    #[error("its shape and type announce {announced} bytes, it has {found}: it was not written or copied completely")]
    Length {
        /// As many as they say; as many as can be said where there are more.
        announced: u64,
        /// As many as there are.
        found: u64,
    },
    /// Not as many rows as another array.
    #[error("has {found} rows, and {of} has {wanted}: there has to be one for each")]
    Rows {
        /// How many rows.
        found: usize,
        /// The other array.
        of: &'static str,
        /// How many that one has.
        wanted: usize,
    },
    /// More rows than can be numbered.
    #[error("has {found} rows, more than can be numbered with 32 bits")]
    TooMany {
        /// How many rows.
        found: usize,
    },
    /// A row names something that does not exist.
    #[error("row {row} names {index}, but {of} has {count} rows, the first is 0")]
    Index {
        /// The first such row.
        row: usize,
        /// What it names.
        index: i64,
        /// The array that is meant.
        of: &'static str,
        /// How many rows that one has.
        count: usize,
    },
    /// A number that is infinite or none.
    #[error("row {row} has a number that is infinite or not a number: correct it")]
    NotFinite {
        /// The first such row.
        row: usize,
    },
    /// A label that is none.
    #[error("row {row} has {value}, and an integer of 32 bits is needed")]
    NoLabel {
        /// The first such row.
        row: usize,
        /// What it has.
        value: String,
    },
    /// What stands beside the arrays is no JSON, or other than it has to be.
    #[error("cannot be read: {reason}; write the mesh again, or remove this file")]
    Json {
        /// What is wrong.
        reason: String,
    },
}

impl NpyFault {
    /// The same with the file that it is about.
    pub fn of(self, file: impl Into<String>) -> NpyError {
        NpyError { file: file.into(), fault: self }
    }
}

/// A shape as Python has it.
fn shown(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        several => format!("({})", several.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")),
    }
}

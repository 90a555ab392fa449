//! Errors of HDF5 networks.

use crate::network::radii::RadiusFault;

/// Errors of an HDF5 file.
#[derive(Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Hdf5Error {
    /// The file is not HDF5, or is damaged.
    #[error("the file is not a readable HDF5 file: {reason}")]
    File {
        /// Reason, from the decoder.
        reason: String,
    },
    /// The file has neither sections nor segments.
    #[error(
        "the file is no vascular network: it has neither the lists 'points' and 'structure' (sections of vascpy and \
         VessMorphoVis) nor a group in 'nodes' with 'start_x' (SONATA)"
    )]
    NotANetwork,
    /// A list cannot be read.
    #[error("the list '{list}' cannot be read: {reason}")]
    List {
        /// Path of the list.
        list: String,
        /// Reason.
        reason: String,
    },
    /// A list has too few columns, or another length than the others.
    #[error("the list '{list}' has the shape {found:?}; {expected} expected")]
    Shape {
        /// Path of the list.
        list: String,
        /// Its shape.
        found: Vec<u64>,
        /// Expected shape.
        expected: String,
    },
    /// A row refers to a missing point or section.
    #[error("row {row} of the list '{list}' refers to {what} {number}, but there are {count}")]
    Missing {
        /// Path of the list.
        list: &'static str,
        /// Row, from 0.
        row: usize,
        /// Point or section.
        what: &'static str,
        /// Its number, from 0.
        number: i64,
        /// Number of points or sections.
        count: usize,
    },
    /// The sections are those of a neuron.
    #[error("the list 'structure' has 3 columns: this is the morphology of a cell; networks have 2 columns")]
    Cell,
    /// There are no vessels.
    #[error("the file has no vessels")]
    Empty,
    /// The requested radius array does not exist.
    #[error(transparent)]
    Radius(#[from] RadiusFault),
    /// The number of nodes or edges exceeds the index range.
    #[error("too many nodes for 32-bit indices ({})", u32::MAX)]
    TooMany,
}

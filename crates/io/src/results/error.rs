//! Errors of reading results.

use crate::file::FileError;
use crate::volume::faults::MeshFault;
use crate::vtk_xml::VtkError;
use std::path::PathBuf;

/// Errors of reading a result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ResultError {
    /// A file cannot be read, has an unknown extension, or has invalid contents.
    #[error(transparent)]
    File(#[from] FileError<ResultFault>),
    /// The case has no results.
    #[error("{}: no time folder with U and p: run the solver{}", path.display(), if *decomposed { ", then reconstructPar -latestTime" } else { "" })]
    NoTime {
        /// Folder of the case.
        path: PathBuf,
        /// True if the case has folders of processors.
        decomposed: bool,
    },
}

/// Faults of the contents of a result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ResultFault {
    /// The file ends early.
    #[error("ends within {within}: is the file truncated? copy it again")]
    Truncated {
        /// Part of the file.
        within: String,
    },
    /// The syntax differs from that of the format.
    #[error("byte {at}: expected {expected}; correct the file, or run the solver again")]
    Syntax {
        /// Offset in the file.
        at: usize,
        /// Expected item.
        expected: &'static str,
    },
    /// A part is missing.
    #[error("'{what}' is missing; run the solver with this field")]
    Missing {
        /// Name of the part.
        what: String,
    },
    /// A list has another length than the mesh.
    #[error("{what} has length {found} instead of {expected}; give a result of this mesh")]
    Length {
        /// Name of the list.
        what: String,
        /// Number of values that the mesh needs.
        expected: usize,
        /// Number of values found.
        found: usize,
    },
    /// A list refers to a missing item.
    #[error("{what} refers to {index}, and there are {count}; copy the case again")]
    Astray {
        /// Name of the list.
        what: &'static str,
        /// Index.
        index: i64,
        /// Number of items.
        count: usize,
    },
    /// A value is infinite or NaN.
    #[error("{what} has a value that is not finite (number {number}); the solver diverged")]
    NotFinite {
        /// Name of the field.
        what: String,
        /// Number of the value, from 1.
        number: usize,
    },
    /// The file has no such array.
    #[error("there is no array '{array}'; the file has {}", if found.is_empty() { "none".to_owned() } else { found.join(", ") })]
    NoArray {
        /// Name of the array.
        array: String,
        /// Quoted names of those of the file.
        found: Vec<String>,
    },
    /// An array has several values for each point or cell.
    #[error("array '{array}' has {components} components; give one edge length per point or cell")]
    NotScalar {
        /// Name of the array.
        array: String,
        /// Number of components.
        components: usize,
    },
    /// A value is not an edge length.
    #[error("array '{array}' has the value {value} (number {number}); give finite lengths above zero")]
    NotALength {
        /// Name of the array.
        array: String,
        /// Number of the value, from 1.
        number: usize,
        /// The value.
        value: f64,
    },
    /// The boundary has no wall.
    #[error("the mesh has no wall: {found}; give a result with a patch of type wall")]
    NoWall {
        /// Patches or faces that were found.
        found: String,
    },
    /// The VTK file is invalid.
    #[error(transparent)]
    Vtk(#[from] VtkError),
    /// The mesh in the file is invalid.
    #[error(transparent)]
    Mesh(#[from] MeshFault),
}

impl ResultFault {
    /// Checks the length of a list.
    pub(super) fn ensure_length(what: &str, expected: usize, found: usize) -> Result<(), Self> {
        if expected == found { Ok(()) } else { Err(Self::Length { what: what.to_owned(), expected, found }) }
    }

    /// Checks that all values are finite.
    pub(super) fn ensure_finite(what: &str, values: &[f64]) -> Result<(), Self> {
        match values.iter().position(|value| !value.is_finite()) {
            Some(at) => Err(Self::NotFinite { what: what.to_owned(), number: at + 1 }),
            None => Ok(()),
        }
    }
}

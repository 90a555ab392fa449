//! What can be wrong with a surface file. The formats are words or bytes in the same few structures, and so their faults
//! are the same.

use crate::file::FileError;
use crate::npy::NpyError;
use crate::text::{Place, TextFault, shown};
use anastomesh_mesh::facets::FacetError;

/// Why a surface file could not be read or written.
pub type SurfaceFileError = FileError<SurfaceFault>;

/// Why the content of a file is no triangle surface. Faces are numbered as the format numbers points: from 1 in OBJ, else
/// from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceFault {
    /// Its words are not those of the format.
    #[error(transparent)]
    Text(#[from] TextFault),
    /// An array is missing or wrong.
    #[error(transparent)]
    Npy(#[from] NpyError),
    /// A face has too few corners, or in a format that knows only triangles too many.
    #[error("{place}: face {face} has {corners} corners, which make no triangle: correct or remove it")]
    NotATriangle {
        /// The first such face.
        face: usize,
        /// How many corners it has.
        corners: i64,
        /// Where it stands.
        place: Place,
    },
    /// A face with more than three corners has no triangulation.
    #[error("{place}: face {face} cannot be cut into triangles: {fault}")]
    Polygon {
        /// The first such face.
        face: usize,
        /// Where it stands.
        place: Place,
        /// Why.
        #[source]
        fault: FacetError,
    },
    /// A face names a point that does not exist.
    #[error("{place}: face {face} names the point {index}, but there are {points} points, the first is {first}")]
    BadIndex {
        /// The first such face.
        face: usize,
        /// What it names.
        index: i64,
        /// How many points there are.
        points: usize,
        /// The number of the first point in this format.
        first: u32,
        /// Where it stands.
        place: Place,
    },
    /// A coordinate of a binary file is infinite or not a number.
    #[error("byte {byte}: point {point} has a coordinate that is infinite or not a number: correct it")]
    NotFinite {
        /// The first such point.
        point: usize,
        /// Where it stands.
        byte: usize,
    },
    /// The file is of a kind of the format that is not read.
    #[error("{place}: '{found}' is a variant that is not read: save it as {instead}")]
    Variant {
        /// What is there.
        found: String,
        /// Where it stands.
        place: Place,
        /// What would be read.
        instead: &'static str,
    },
    /// A word of the format is missing.
    #[error("{place}: '{found}' stands where {expected} has to be: correct it, or give the file its right extension")]
    Unexpected {
        /// What is there.
        found: String,
        /// What had to be there.
        expected: &'static str,
        /// Where it stands.
        place: Place,
    },
    /// Something that every such file has is not there.
    #[error("{what} is missing: write the file again")]
    Missing {
        /// Missing or wrong item.
        what: &'static str,
    },
    /// A binary file does not have the length that its counts say.
    #[error(
        "the counts of the file announce at least {announced} bytes, it has {found}: \
         it was not written or copied completely, or its counts are wrong"
    )]
    Length {
        /// Number that the file announces.
        announced: u64,
        /// How long it is.
        found: u64,
    },
    /// There are no faces.
    #[error("there is no face in it, only {points} points: a surface is needed")]
    NoFaces {
        /// How many points there are.
        points: usize,
    },
}

impl SurfaceFault {
    /// A word stands where something else has to be.
    pub(super) fn unexpected(found: &[u8], expected: &'static str, place: Place) -> Self {
        Self::Unexpected { found: shown(found), expected, place }
    }
}

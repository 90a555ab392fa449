//! Errors of surface files, shared by all formats, as these have similar structures.

use crate::file::FileError;
use crate::npy::NpyError;
use crate::text::{Place, TextFault, shown};
use crate::vtk_xml::VtkError;
use anastomesh_mesh::facets::FacetError;
use anastomesh_mesh::units::counted;

/// Errors of reading and writing a surface file.
pub type SurfaceFileError = FileError<SurfaceFault>;

/// Content errors of a surface file. Faces are numbered like points in the format: from 1 in OBJ, else from 0.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SurfaceFault {
    /// A word is invalid.
    #[error(transparent)]
    Text(#[from] TextFault),
    /// An array is missing or invalid.
    #[error(transparent)]
    Npy(#[from] NpyError),
    /// The VTK file is damaged or of another type.
    #[error("{reason}")]
    Vtk {
        /// Reason.
        reason: String,
    },
    /// The length of an array differs from the counts of the file.
    #[error("array '{array}' has {found} values instead of {expected}: write or copy the file again")]
    ArrayLength {
        /// Array name.
        array: String,
        /// Expected length.
        expected: usize,
        /// Length found.
        found: usize,
    },
    /// The offsets of faces are not ascending or exceed the connectivity.
    #[error(
        "face {face} (from 0) ends at offset {offset}, which is out of order or beyond the {length} indices: \
         correct the offsets"
    )]
    BadOffset {
        /// The first such face.
        face: usize,
        /// Offset that was found.
        offset: i64,
        /// Number of indices.
        length: usize,
    },
    /// A face has too few corners, or too many in a triangle-only format.
    #[error("{place}: face {face} has {corners} corners, not a polygon: correct or remove it")]
    NotATriangle {
        /// The first such face.
        face: usize,
        /// Number of corners.
        corners: i64,
        /// Position in the file.
        place: Place,
    },
    /// A polygonal face cannot be triangulated.
    #[error("{place}: face {face} cannot be cut into triangles: {fault}")]
    Polygon {
        /// The first such face.
        face: usize,
        /// Position in the file.
        place: Place,
        /// Reason of the failure.
        #[source]
        fault: FacetError,
    },
    /// A face refers to a missing point.
    #[error("{place}: face {face} refers to point {index}, but the file has {}, numbered from {first}", counted(*points, "point"))]
    BadIndex {
        /// The first such face.
        face: usize,
        /// Invalid index.
        index: i64,
        /// Number of points.
        points: usize,
        /// Number of the first point in this format.
        first: u32,
        /// Position in the file.
        place: Place,
    },
    /// A coordinate of a binary file is infinite or NaN.
    #[error("byte {byte}: point {point} has an infinite or NaN coordinate: correct it")]
    NotFinite {
        /// The first such point.
        point: usize,
        /// Byte offset.
        byte: usize,
    },
    /// The variant of the format is not supported.
    #[error("{place}: unsupported variant '{found}': save it as {instead}")]
    Variant {
        /// Text found.
        found: String,
        /// Position in the file.
        place: Place,
        /// Supported variant.
        instead: &'static str,
    },
    /// A required word is missing.
    #[error("{place}: expected {expected}, found '{found}': correct it, or use the extension of the format")]
    Unexpected {
        /// Text found.
        found: String,
        /// Expected word.
        expected: &'static str,
        /// Position in the file.
        place: Place,
    },
    /// A required part is missing.
    #[error("{what} is missing: write the file again")]
    Missing {
        /// Missing or wrong item.
        what: &'static str,
    },
    /// The length of a binary file differs from its counts.
    #[error(
        "the counts of the file announce at least {announced} bytes, it has {found}: \
         it was not written or copied completely, or its counts are wrong"
    )]
    Length {
        /// Number that the file announces.
        announced: u64,
        /// Length found, in bytes.
        found: u64,
    },
    /// The file has no faces.
    #[error("the file has no faces, only {}: give a surface", counted(*points, "point"))]
    NoFaces {
        /// Number of points.
        points: usize,
    },
}

impl From<VtkError> for SurfaceFault {
    fn from(error: VtkError) -> Self {
        Self::Vtk { reason: error.to_string() }
    }
}

impl SurfaceFault {
    /// Error of an unexpected word.
    pub(super) fn unexpected(found: &[u8], expected: &'static str, place: Place) -> Self {
        Self::Unexpected { found: shown(found), expected, place }
    }
}

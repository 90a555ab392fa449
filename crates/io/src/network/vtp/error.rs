//! Errors of VTP files.

use crate::network::radii::{NodeArrayFault, RadiusFault};
use crate::vtk_xml::VtkError;
use anastomesh_mesh::units::counted;

/// Errors of a VTP network.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VtpError {
    /// The file is damaged or of another type.
    #[error(transparent)]
    File(#[from] VtkError),
    /// A required element is missing.
    #[error("the file has no <{element}>: is it truncated?")]
    MissingElement {
        /// Element.
        element: &'static str,
    },
    /// The points do not have three components.
    #[error("the points have {}, expected 3", counted(*components, "coordinate"))]
    BadPoints {
        /// Number of components.
        components: usize,
    },
    /// The length of an array differs from the number of points or cells.
    #[error("array '{array}' has {}, expected {expected}: is the file truncated?", counted(*found, "value"))]
    WrongLength {
        /// Name of the array.
        array: String,
        /// Expected number of values.
        expected: usize,
        /// Number of values found.
        found: usize,
    },
    /// Connectivity or offsets of the lines are not integers.
    #[error("line array '{array}' has no integer type: write it as Int64")]
    NotIntegers {
        /// Name of the array.
        array: &'static str,
    },
    /// The offsets of the lines are not ascending or exceed the connectivity.
    #[error(
        "line {line} (from 0) ends at offset {offset}, which is out of order or beyond the {length} indices: \
         correct the offsets"
    )]
    BadOffset {
        /// Line of the file, from 1.
        line: usize,

        /// Offset that was found.
        offset: i64,
        /// Number of indices.
        length: usize,
    },
    /// A line refers to a missing point.
    #[error(
        "line {line} (from 0) refers to point {point} (from 0), but the file has {}: correct the connectivity", counted(*points, "point")
    )]
    UnknownPoint {
        /// Line of the file, from 1.
        line: usize,
        /// Invalid point index.
        point: i64,
        /// Number of points.
        points: usize,
    },
    /// There are no lines.
    #[error(
        "the file has no lines ({polygons} polygons and strips, {vertices} vertices): \
         give a network, lines with radii, not a surface"
    )]
    NoLines {
        /// Number of polygons and strips.
        polygons: usize,
        /// Number of vertex cells.
        vertices: usize,
    },
    /// No array is usable as radius.
    #[error(transparent)]
    Radius(#[from] RadiusFault),
    /// The requested node array is not usable.
    #[error(transparent)]
    NodeArray(#[from] NodeArrayFault),
    /// The number of points or edges exceeds the index range.
    #[error("too many points for 32-bit indices ({})", u32::MAX)]
    TooMany,
}

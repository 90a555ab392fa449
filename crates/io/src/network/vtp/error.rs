//! Errors of VTP files.

use crate::network::radii::{NodeArrayFault, RadiusFault};
use crate::vtk_xml::VtkError;

/// Errors of a VTP network.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VtpError {
    /// The file is damaged or of another type.
    #[error(transparent)]
    File(#[from] VtkError),
    /// A required element is missing.
    #[error("there is no <{element}> in the file: was it written completely?")]
    MissingElement {
        /// Element.
        element: &'static str,
    },
    /// The points do not have three components.
    #[error("the points have {components} coordinates; three are needed")]
    BadPoints {
        /// Number of components.
        components: usize,
    },
    /// The length of an array differs from the number of points or cells.
    #[error("array '{array}' has {found} values, but the file announces {expected}: was it written completely?")]
    WrongLength {
        /// Name of the array.
        array: String,
        /// Expected number of values.
        expected: usize,
        /// Number of values found.
        found: usize,
    },
    /// Connectivity or offsets of the lines are not integers.
    #[error("array '{array}' of the lines holds no integers: write it as Int64")]
    NotIntegers {
        /// Name of the array.
        array: &'static str,
    },
    /// The offsets of the lines are not ascending or exceed the connectivity.
    #[error(
        "line {line} (from 0) ends at offset {offset}, which is out of order or beyond the {length} indices there are: \
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
        "line {line} (from 0) names point {point}, but there are only {points} points (from 0): correct the connectivity"
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
        "there are no lines in the file ({polygons} polygons and strips, {vertices} vertices): a network is needed, lines \
         with a radius, not a surface"
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
    #[error("there are more points than can be numbered ({})", u32::MAX)]
    TooMany,
}

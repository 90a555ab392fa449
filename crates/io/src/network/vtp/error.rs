//! What can be wrong with a VTP file.

use crate::network::radii::{NodeArrayFault, RadiusFault};
use crate::vtk_xml::VtkError;

/// Why a VTP file is no usable network.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VtpError {
    /// The file itself is damaged or of another kind.
    #[error(transparent)]
    File(#[from] VtkError),
    /// An element that every VTP file has is missing.
    #[error("there is no <{element}> in the file: was it written completely?")]
    MissingElement {
        /// Element.
        element: &'static str,
    },
    /// The points are no triples.
    #[error("the points have {components} coordinates; three are needed")]
    BadPoints {
        /// Number of coordinates of each.
        components: usize,
    },
    /// An array has not as many values as there are points or cells.
    #[error("array '{array}' has {found} values, but the file announces {expected}: was it written completely?")]
    WrongLength {
        /// Name of the array.
        array: String,
        /// How many values it should have.
        expected: usize,
        /// How many it has.
        found: usize,
    },
    /// Connectivity or offsets of the lines are no integers.
    #[error("array '{array}' of the lines holds no integers: write it as Int64")]
    NotIntegers {
        /// Name of the array.
        array: &'static str,
    },
    /// The offsets of the lines do not ascend, or go beyond the connectivity.
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
    /// A line names a point that does not exist.
    #[error(
        "line {line} (from 0) names point {point}, but there are only {points} points (from 0): correct the connectivity"
    )]
    UnknownPoint {
        /// Line of the file, from 1.
        line: usize,
        /// What it names.
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
    /// No array can be taken for the radius.
    #[error(transparent)]
    Radius(#[from] RadiusFault),
    /// There are no numbers of nodes under the name that was asked for.
    #[error(transparent)]
    NodeArray(#[from] NodeArrayFault),
    /// There are more points or edges than can be numbered.
    #[error("there are more points than can be numbered ({})", u32::MAX)]
    TooMany,
}

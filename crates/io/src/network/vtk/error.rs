//! Errors of legacy VTK files.

use crate::network::radii::{NodeArrayFault, RadiusFault};
use crate::text::Place;
use anastomesh_mesh::units::counted;

/// Errors of a legacy VTK network.
#[derive(Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VtkLegacyError {
    /// The first line does not identify a legacy VTK file.
    #[error("the first line is not '# vtk DataFile Version …': is it a legacy VTK file?")]
    NotVtk,
    /// The third line is neither ASCII nor BINARY.
    #[error("line 3: expected ASCII or BINARY, found '{found}': correct it")]
    UnknownEncoding {
        /// Text that was found.
        found: String,
    },
    /// The dataset type has no lines.
    #[error("unsupported dataset '{found}': save lines as POLYDATA or UNSTRUCTURED_GRID")]
    WrongDataset {
        /// Text that was found.
        found: String,
    },
    /// The keyword is unknown.
    #[error(
        "{place}: '{found}' is not a keyword of a legacy VTK file: the count before it is wrong, or the file is damaged"
    )]
    UnknownKeyword {
        /// Place in the file.
        place: Place,
        /// Text that was found.
        found: String,
    },
    /// A keyword line is incomplete or malformed.
    #[error("{place}: {keyword} needs {needed}: correct the line")]
    BadKeyword {
        /// Place in the file.
        place: Place,
        /// Keyword of the line.
        keyword: String,
        /// Missing part.
        needed: &'static str,
    },
    /// The value type is unknown.
    #[error("{place}: values of type '{kind}' are not supported; save numbers")]
    UnknownType {
        /// Place in the file.
        place: Place,
        /// Kind that was found.
        kind: String,
    },
    /// The array is shorter than announced.
    #[error(
        "{place}: the number of values of {array} is {count}, more than the rest of the file contains; \
         correct the count, or copy the file again if it is truncated"
    )]
    CutShort {
        /// Place in the file.
        place: Place,
        /// Array name.
        array: String,

        /// Number that was found.
        count: usize,
    },
    /// A word is not a number.
    #[error("{place}: value {index} (from 0) of {array} is '{text}', not a number of its type: correct it")]
    NotANumber {
        /// Place in the file.
        place: Place,
        /// Array name.
        array: String,

        /// Index that was found.
        index: usize,

        /// Text that was found.
        text: String,
    },
    /// A cell list is inconsistent.
    #[error("{place}: cell {cell} (from 0) of {list} exceeds the list, or offsets are not ascending: correct the list")]
    BadCells {
        /// Place in the file.
        place: Place,
        /// Keyword of the list.
        list: &'static str,

        /// Cell, from 0.
        cell: usize,
    },
    /// A required section is missing.
    #[error("the file has no section {section}: a network needs points and lines; is the file truncated?")]
    MissingSection {
        /// Section.
        section: &'static str,
    },
    /// The length of an array differs from the number of points or cells.
    #[error("array '{array}' has {}, expected {expected}: correct the file", counted(*found, "value"))]
    WrongLength {
        /// Name of the array.
        array: String,
        /// Expected number of values.
        expected: usize,
        /// Number of values found.
        found: usize,
    },
    /// A line refers to a missing point.
    #[error(
        "line cell {line} (from 0) refers to point {point} (from 0), but the file has {}: correct the list of cells", counted(*points, "point")
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
    #[error("the file has no lines ({}): give a network, lines with radii", counted(*others, "other cell"))]
    NoLines {
        /// Number of other cells.
        others: usize,
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

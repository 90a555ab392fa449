//! Errors of legacy VTK files.

use crate::network::radii::{NodeArrayFault, RadiusFault};
use crate::text::Place;

/// Errors of a legacy VTK network.
#[derive(Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VtkLegacyError {
    /// The first line does not identify a legacy VTK file.
    #[error("the first line is not '# vtk DataFile Version …': is it a legacy VTK file?")]
    NotVtk,
    /// The third line is neither ASCII nor BINARY.
    #[error("line 3 says '{found}' where ASCII or BINARY has to be: correct it")]
    UnknownEncoding {
        /// Text that was found.
        found: String,
    },
    /// The dataset type has no lines.
    #[error("a dataset of kind '{found}': save lines as POLYDATA or UNSTRUCTURED_GRID")]
    WrongDataset {
        /// Text that was found.
        found: String,
    },
    /// The keyword is unknown.
    #[error(
        "{place}: '{found}' is no keyword of a legacy VTK file: a count before it is wrong, or the file is damaged"
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
    #[error("{place}: values of type '{kind}' cannot be read; save the file with numbers")]
    UnknownType {
        /// Place in the file.
        place: Place,
        /// Kind that was found.
        kind: String,
    },
    /// The array is shorter than announced.
    #[error(
        "{place}: {array} is to have {count} values, more than the rest of the file holds; correct the count, or write \
         or copy the file again if it is cut short"
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
    #[error("{place}: value {index} (from 0) of {array} is '{text}', which is no number of its type: correct it")]
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
    #[error("{place}: cell {cell} (from 0) of {list} goes beyond its list, or offsets do not ascend: correct the list")]
    BadCells {
        /// Place in the file.
        place: Place,
        /// Keyword of the list.
        list: &'static str,

        /// Cell, from 0.
        cell: usize,
    },
    /// A required section is missing.
    #[error("there is no section {section} in the file: a network has points and lines; was it written completely?")]
    MissingSection {
        /// Section.
        section: &'static str,
    },
    /// The length of an array differs from the number of points or cells.
    #[error("array '{array}' has {found} values, but there are {expected} points or cells: correct the file")]
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
        "line cell {line} (from 0) names point {point}, but there are only {points} points (from 0): correct the list of cells"
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
    #[error("there are no lines in the file ({others} other cells): a network is needed, lines with a radius")]
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
    #[error("there are more points than can be numbered ({})", u32::MAX)]
    TooMany,
}

//! What can be wrong with a legacy VTK file.

use crate::network::radii::{NodeArrayFault, RadiusFault};
use crate::text::Place;

/// Why a legacy VTK file is no usable network.
#[derive(Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum VtkLegacyError {
    /// The first line is not that of a legacy VTK file.
    #[error("the first line is not '# vtk DataFile Version …': is it a legacy VTK file?")]
    NotVtk,
    /// The third line says neither ASCII nor BINARY.
    #[error("line 3 says '{found}' where ASCII or BINARY has to be: correct it")]
    UnknownEncoding {
        /// Text that was found.
        found: String,
    },
    /// The dataset is of a kind that has no lines.
    #[error("a dataset of kind '{found}': save lines as POLYDATA or UNSTRUCTURED_GRID")]
    WrongDataset {
        /// Text that was found.
        found: String,
    },
    /// A keyword that VTK's format does not have.
    #[error(
        "{place}: '{found}' is no keyword of a legacy VTK file: a count before it is wrong, or the file is damaged"
    )]
    UnknownKeyword {
        /// Place in the file.
        place: Place,
        /// Text that was found.
        found: String,
    },
    /// A line of keywords lacks something, or has something else in its place.
    #[error("{place}: {keyword} needs {needed}: correct the line")]
    BadKeyword {
        /// Place in the file.
        place: Place,
        /// The keyword of the line.
        keyword: String,
        /// What it needs.
        needed: &'static str,
    },
    /// A type of values that is not known.
    #[error("{place}: values of type '{kind}' cannot be read; save the file with numbers")]
    UnknownType {
        /// Place in the file.
        place: Place,
        /// Kind that was found.
        kind: String,
    },
    /// There are fewer values than announced.
    #[error(
        "{place}: {array} is to have {count} values, more than the rest of the file holds; correct the count, or write \
         or copy the file again if it is cut short"
    )]
    CutShort {
        /// Place in the file.
        place: Place,
        /// Which values.
        array: String,

        /// Number that was found.
        count: usize,
    },
    /// A word is no number.
    #[error("{place}: value {index} (from 0) of {array} is '{text}', which is no number of its type: correct it")]
    NotANumber {
        /// Place in the file.
        place: Place,
        /// Which values.
        array: String,

        /// Index that was found.
        index: usize,

        /// Text that was found.
        text: String,
    },
    /// A list of cells does not hold what it says.
    #[error("{place}: cell {cell} (from 0) of {list} goes beyond its list, or offsets do not ascend: correct the list")]
    BadCells {
        /// Place in the file.
        place: Place,
        /// The keyword of the list.
        list: &'static str,

        /// Cell, from 0.
        cell: usize,
    },
    /// A section that every such file has is missing.
    #[error("there is no section {section} in the file: a network has points and lines; was it written completely?")]
    MissingSection {
        /// Section.
        section: &'static str,
    },
    /// An array has not as many values as there are points or cells.
    #[error("array '{array}' has {found} values, but there are {expected} points or cells: correct the file")]
    WrongLength {
        /// Name of the array.
        array: String,
        /// How many values it should have.
        expected: usize,
        /// How many it has.
        found: usize,
    },
    /// A line names a point that does not exist.
    #[error(
        "line cell {line} (from 0) names point {point}, but there are only {points} points (from 0): correct the list of cells"
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
    #[error("there are no lines in the file ({others} other cells): a network is needed, lines with a radius")]
    NoLines {
        /// Number of other cells.
        others: usize,
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

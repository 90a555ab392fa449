//! What can be wrong with `TetGen`'s files.

use crate::file::FileError;
use crate::text::TextFault;

/// Why a file of `TetGen`'s could not be read or written.
pub type TetgenFileError = FileError<TetgenFault>;

/// Why the content of a file is not what `TetGen`'s format asks for. Facets are numbered as points are, from
/// 0 or 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TetgenFault {
    /// Its words are not those of the format.
    #[error(transparent)]
    Text(#[from] TextFault),
    /// Points are not in space.
    #[error("line {line}: the points have the dimension {dimension}; it has to be 3")]
    Dimension { line: usize, dimension: i64 },
    /// The numbers of the points do not run on from 0 or 1.
    #[error(
        "line {line}: the point has the number {found} instead of {expected}; points are numbered from 0 or from 1"
    )]
    BadNumber {
        line: usize,
        /// Its number.
        found: i64,
        /// The number it had to have.
        expected: i64,
    },
    /// A polygon names a point that does not exist.
    #[error("line {line}: facet {facet} names the point {index}, but there are {points} points, the first is {first}")]
    BadIndex {
        line: usize,
        facet: usize,
        /// What it names.
        index: i64,
        /// How many points there are.
        points: usize,
        /// Number of the first point.
        first: u32,
    },
    /// A polygon has no corners, or a facet no polygons.
    #[error("line {line}: facet {facet} has nothing in it: remove it")]
    EmptyFacet { line: usize, facet: usize },
    /// A tetrahedron or face of a mesh names a point that does not exist.
    #[error("line {line}: {kind} {cell} names the point {index}, but there are {points} points, the first is {first}")]
    BadCell {
        line: usize,
        /// What names it.
        kind: &'static str,
        /// Its number, from 0.
        cell: usize,
        /// What it names.
        index: i64,
        /// How many points there are.
        points: usize,
        /// Number of the first point.
        first: u32,
    },
    /// Tetrahedra have more points than their corners.
    #[error("line {line}: tetrahedra have {corners} points; only those of 4 are read: write the mesh without -o2")]
    Order {
        line: usize,
        /// How many points they have.
        corners: i64,
    },
    /// There are no points, neither here nor in the file beside.
    #[error("there are no points in it: is it the right file?")]
    NoPoints,
}

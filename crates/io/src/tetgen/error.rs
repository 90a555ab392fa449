//! Errors of `TetGen` files.

use crate::file::FileError;
use crate::text::TextFault;
use anastomesh_mesh::units::counted;

/// Errors of reading and writing `TetGen` files.
pub type TetgenFileError = FileError<TetgenFault>;

/// Content errors of a `TetGen` file. Facets are numbered like points, from 0 or 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TetgenFault {
    /// A word is invalid.
    #[error(transparent)]
    Text(#[from] TextFault),
    /// The points are not three-dimensional.
    #[error("line {line}: the points have dimension {dimension}, expected 3")]
    Dimension { line: usize, dimension: i64 },
    /// The points are not numbered consecutively from 0 or 1.
    #[error(
        "line {line}: the point has the number {found} instead of {expected}; points are numbered from 0 or from 1"
    )]
    BadNumber {
        line: usize,
        /// Number found.
        found: i64,
        /// Expected number.
        expected: i64,
    },
    /// A polygon refers to a missing point.
    #[error(
        "line {line}: facet {facet} refers to point {index}, but the file has {}, numbered from {first}", counted(*points, "point")
    )]
    BadIndex {
        line: usize,
        facet: usize,
        /// Invalid index.
        index: i64,
        /// Number of points.
        points: usize,
        /// Number of the first point.
        first: u32,
    },
    /// A polygon has no corners, or a facet no polygons.
    #[error("line {line}: facet {facet} is empty: remove it")]
    EmptyFacet { line: usize, facet: usize },
    /// A tetrahedron or face of a mesh refers to a missing point.
    #[error(
        "line {line}: {kind} {cell} refers to point {index}, but the file has {}, numbered from {first}", counted(*points, "point")
    )]
    BadCell {
        line: usize,
        /// Kind of the cell.
        kind: &'static str,
        /// Cell index, from 0.
        cell: usize,
        /// Invalid index.
        index: i64,
        /// Number of points.
        points: usize,
        /// Number of the first point.
        first: u32,
    },
    /// The tetrahedra have additional points besides their corners.
    #[error("line {line}: tetrahedra with {corners} points are not supported: write the mesh without -o2")]
    Order {
        line: usize,
        /// Number of points per tetrahedron.
        corners: i64,
    },
    /// There are no points, neither in this file nor in the `.node` file.
    #[error("the file has no points: is it the right file?")]
    NoPoints,
}

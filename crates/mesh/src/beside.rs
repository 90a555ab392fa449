//! Values at the points and in the cells of a mesh, computed on demand.

use crate::geometry::Point3;

/// A column of values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name of the column.
    pub name: &'static str,
    /// True for values at points, false for values in cells.
    pub at_points: bool,
    /// True for integer values within 32 bits.
    pub is_integer: bool,
}

/// Values computed from the positions of points and cells.
pub trait Beside: Sync {
    /// Available columns.
    fn columns(&self) -> &[Column];

    /// Values of a point column at these points.
    fn at_points(&self, column: usize, points: &[Point3]) -> Vec<f64>;

    /// Values of a cell column in these tetrahedra.
    fn in_tets(&self, column: usize, tets: &[[Point3; 4]]) -> Vec<f64>;

    /// Values of a cell column in these faces.
    fn in_faces(&self, column: usize, faces: &[[Point3; 3]]) -> Vec<f64>;
}

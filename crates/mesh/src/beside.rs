//! Values beside a mesh: what is known at its points and in its cells, made when it is asked for.

use crate::geometry::Point3;

/// A column of values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// Name of the column.
    pub name: &'static str,
    /// Whether there is a value for each point, or else for each cell.
    pub at_points: bool,
    /// Whether values are whole numbers, within 32 bits.
    pub is_integer: bool,
}

/// Values that follow from where points and cells are.
pub trait Beside: Sync {
    /// What there is.
    fn columns(&self) -> &[Column];

    /// A column of points: the values at these.
    fn at_points(&self, column: usize, points: &[Point3]) -> Vec<f64>;

    /// A column of cells: the values in these tetrahedra.
    fn in_tets(&self, column: usize, tets: &[[Point3; 4]]) -> Vec<f64>;

    /// A column of cells: the values in these faces.
    fn in_faces(&self, column: usize, faces: &[[Point3; 3]]) -> Vec<f64>;
}

//! Sample points of an object, for its extent and orientation.

use anastomesh_mesh::geometry::{Point3, Vec3};
use nalgebra::{Matrix3, SymmetricEigen};

/// Maximum number of sample points.
const ENOUGH: usize = 400_000;

/// Sample points of an object: all points, or every n-th of a large number.
#[derive(Clone, Debug, Default)]
pub struct Outline {
    points: Vec<Point3>,
    step: usize,
    seen: usize,
}

impl Outline {
    /// Creates an empty outline of an object with this number of points.
    pub fn for_points(count: usize) -> Self {
        Self { points: Vec::new(), step: count.div_ceil(ENOUGH).max(1), seen: 0 }
    }

    /// Adds a point.
    pub fn add(&mut self, point: &Point3) {
        if self.seen.is_multiple_of(self.step) {
            self.points.push(*point);
        }
        self.seen += 1;
    }

    /// The sample points.
    pub fn points(&self) -> &[Point3] {
        &self.points
    }

    /// Range of the object along an axis; zero without points.
    pub fn range(&self, axis: Vec3) -> [f64; 2] {
        let along = self.points.iter().map(|p| p.coords.dot(&axis));
        let [low, high] = along.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], x| [l.min(x), h.max(x)]);
        if low <= high { [low, high] } else { [0.0; 2] }
    }

    /// Direction of least extent, and an up direction for which the longest axis is horizontal.
    pub fn broadside(&self) -> (Vec3, Vec3) {
        let count = self.points.len().max(1) as f64;
        let mean = self.points.iter().map(|p| p.coords).sum::<Vec3>() / count;
        let spread = |p: &Point3| (p.coords - mean) * (p.coords - mean).transpose();
        let eigen = SymmetricEigen::new(self.points.iter().map(spread).sum::<Matrix3<f64>>() / count);
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let [thin, middle, _] = order.map(|i| turned(eigen.eigenvectors.column(i).into_owned()));
        // A ball, or no points, has no principal axes.
        if thin.norm() > 0.5 && middle.norm() > 0.5 { (thin, middle) } else { (-Vec3::y(), Vec3::z()) }
    }
}

/// Normalizes the sign of an axis: the largest component becomes positive.
fn turned(axis: Vec3) -> Vec3 {
    let i = axis.iamax();
    if axis[i] < 0.0 { -axis } else { axis }
}

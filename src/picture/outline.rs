//! Some points of a thing, which tell how large it is and how it lies.

use anastomesh_mesh::geometry::{Point3, Vec3};
use nalgebra::{Matrix3, SymmetricEigen};

/// So many points are enough to tell.
const ENOUGH: usize = 400_000;

/// Points of a thing, each of some or, where there are very many, every so many-th.
#[derive(Clone, Debug, Default)]
pub struct Outline {
    points: Vec<Point3>,
    step: usize,
    seen: usize,
}

impl Outline {
    /// For a thing of so many points.
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

    /// The points that are kept.
    pub fn points(&self) -> &[Point3] {
        &self.points
    }

    /// From where to where it reaches along an axis; nowhere without points.
    pub fn range(&self, axis: Vec3) -> [f64; 2] {
        let along = self.points.iter().map(|p| p.coords.dot(&axis));
        let [low, high] = along.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], x| [l.min(x), h.max(x)]);
        if low <= high { [low, high] } else { [0.0; 2] }
    }

    /// The direction in which it is thinnest, and that which is to be up so that its longest axis lies across.
    pub fn broadside(&self) -> (Vec3, Vec3) {
        let count = self.points.len().max(1) as f64;
        let mean = self.points.iter().map(|p| p.coords).sum::<Vec3>() / count;
        let spread = |p: &Point3| (p.coords - mean) * (p.coords - mean).transpose();
        let eigen = SymmetricEigen::new(self.points.iter().map(spread).sum::<Matrix3<f64>>() / count);
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
        let [thin, middle, _] = order.map(|i| turned(eigen.eigenvectors.column(i).into_owned()));
        // A ball, or no points at all, has no axes of its own.
        if thin.norm() > 0.5 && middle.norm() > 0.5 { (thin, middle) } else { (-Vec3::y(), Vec3::z()) }
    }
}

/// An axis has no sign: its largest component is to be positive.
fn turned(axis: Vec3) -> Vec3 {
    let i = axis.iamax();
    if axis[i] < 0.0 { -axis } else { axis }
}

//! Rules for the tetrahedra that flips may make.

use crate::complex::Complex;
use anastomesh_mesh::geometry::predicates::orient3d;
use anastomesh_mesh::geometry::{Point3, Vec3};

/// Flatness tolerance of surface parts, in units in the last place of the largest coordinate. It covers rotated parts.
const UNITS: f64 = 64.0;

/// Flatness tolerance in single-precision units. They are coarse enough to affect thin parts.
const SINGLE_UNITS: f64 = 4.0;

/// Rule for the tetrahedra that flips may make.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Rule {
    /// All positive tetrahedra.
    Positive,
    /// Positive tetrahedra with a minimum height above this value. Points that are coplanar up to rounding then span no
    /// tetrahedra, as if exactly coplanar, so near misses of an edge count as crossings.
    Thick(f64),
}

impl Rule {
    /// True if a tetrahedron may be made.
    pub(crate) fn allows(self, c: &Complex, v: &[u32; 4]) -> bool {
        let corners @ [p, q, r, s] = v.map(|v| &c.points[v as usize]);
        let thick = |least| least_height(corners) > least;
        orient3d(p, q, r, s) > 0.0 && if let Self::Thick(least) = self { thick(least) } else { true }
    }
}

/// Thickness below which a part counts as flat.
pub(crate) fn flat_height(points: &[Point3]) -> f64 {
    UNITS * f64::EPSILON * largest(points)
}

/// Thickness below which a part counts as flat, if all coordinates have single precision.
pub(crate) fn flat_height_in_single(points: &[Point3]) -> Option<f64> {
    let single = points.iter().flat_map(|p| p.iter()).all(|&x| f64::from(x as f32) == x);
    single.then(|| coarse_height(points))
}

/// Thickness of flat parts that had single precision, or few decimals, before they were turned.
pub(crate) fn coarse_height(points: &[Point3]) -> f64 {
    SINGLE_UNITS * f64::from(f32::EPSILON) * largest(points)
}

fn largest(points: &[Point3]) -> f64 {
    points.iter().flat_map(|p| p.iter().map(|x| x.abs())).fold(0.0, f64::max)
}

/// Minimum height of a tetrahedron: six times its volume over twice the area of its largest face.
pub(super) fn least_height(corners: [&Point3; 4]) -> f64 {
    let [a, b, c] = [1, 2, 3].map(|i| corners[i] - corners[0]);
    let faces: [Vec3; 4] = [a.cross(&b), b.cross(&c), c.cross(&a), (b - a).cross(&(c - a))];
    let largest = faces.iter().map(Vec3::norm_squared).fold(f64::MIN_POSITIVE, f64::max).sqrt();
    a.cross(&b).dot(&c).abs() / largest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(corners: [[f64; 3]; 4]) -> [Point3; 4] {
        corners.map(Point3::from)
    }

    #[test]
    fn the_height_over_the_largest_face_is_the_least() {
        let p = points([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [1.0, 1.0, 1.0]]);
        for order in [[0, 1, 2, 3], [1, 2, 3, 0], [2, 3, 0, 1], [3, 0, 1, 2], [1, 0, 2, 3], [0, 3, 1, 2]] {
            let height = least_height(order.map(|i: usize| &p[i]));
            assert!((height - 1.0).abs() < 1e-15, "{order:?}: {height}");
        }
        assert_eq!(least_height([&p[0]; 4]), 0.0);
    }

    #[test]
    fn tetrahedra_must_be_positive_and_thick() {
        let c = Complex::new(points([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [1.0, 1.0, 1.0]]).to_vec());
        let allowed = |rule: Rule| [[0, 1, 2, 3], [1, 0, 2, 3], [0, 1, 2, 2]].map(|v| rule.allows(&c, &v));
        assert_eq!(allowed(Rule::Positive), [true, false, false]);
        assert_eq!(allowed(Rule::Thick(0.999)), [true, false, false]);
        assert_eq!(allowed(Rule::Thick(1.0)), [false; 3]);
    }

    #[test]
    fn flatness_is_relative_to_the_largest_coordinate() {
        let p = [[0.5, -3.0, 2.0], [1.0, 0.0, 2.5]].map(Point3::from);
        assert_eq!(flat_height(&p), 192.0 * f64::EPSILON);
        assert_eq!(coarse_height(&p), 12.0 * f64::from(f32::EPSILON));
        assert_eq!(flat_height_in_single(&p), Some(coarse_height(&p)));
        assert_eq!(flat_height_in_single(&[Point3::new(0.5, 0.1, 2.0)]), None);
    }
}

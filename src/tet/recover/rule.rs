//! Which tetrahedra flips may make.

use crate::geometry::predicates::orient3d;
use crate::geometry::{Point3, Vec3};
use crate::tet::complex::Complex;

/// Flat parts of a surface that were turned are flat to this many units in the last place of the largest coordinate, in
/// double precision and in single.
const UNITS: (f64, f64) = (64.0, 4.0);

/// Which tetrahedra flips may make.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::tet) enum Rule {
    /// All that are positive.
    Positive,
    /// Those whose least height is more than this, too. Where points lie in one plane but for rounding, the complex then
    /// has no tetrahedra among them, as if they lay in it: what crosses an edge by a hair's breadth crosses the edge.
    Thick(f64),
}

impl Rule {
    /// Tetrahedra that are thicker than what rounding leaves of flat parts.
    pub(in crate::tet) fn thick(points: &[Point3]) -> Self {
        Self::Thick(flat_height(points))
    }

    /// Whether `d` lies above the triangle `a, b, c`, from which it runs counter-clockwise, and far enough.
    pub(in crate::tet) fn above(self, [a, b, c]: [&Point3; 3], d: &Point3) -> bool {
        orient3d(a, b, c, d) > 0.0
            && match self {
                Self::Positive => true,
                Self::Thick(least) => least_height([a, b, c, d]) > least,
            }
    }

    /// Whether a tetrahedron may be made.
    pub(in crate::tet) fn allows(self, c: &Complex, v: &[u32; 4]) -> bool {
        let [p, q, r, s] = v.map(|v| &c.points[v as usize]);
        self.above([p, q, r], s)
    }
}

/// What is thinner than this is flat but for rounding: of numbers that all have single precision, to that.
pub(super) fn flat_height(points: &[Point3]) -> f64 {
    let largest = points.iter().flat_map(|p| p.iter().map(|x| x.abs())).fold(0.0, f64::max);
    let single = points.iter().flat_map(|p| p.iter()).all(|&x| f64::from(x as f32) == x);
    largest * if single { UNITS.1 * f64::from(f32::EPSILON) } else { UNITS.0 * f64::EPSILON }
}

/// The least height of a tetrahedron: six times its volume over twice the area of its largest face.
pub(super) fn least_height(corners: [&Point3; 4]) -> f64 {
    let [a, b, c] = [1, 2, 3].map(|i| corners[i] - corners[0]);
    let faces: [Vec3; 4] = [a.cross(&b), b.cross(&c), c.cross(&a), (b - a).cross(&(c - a))];
    let largest = faces.iter().map(Vec3::norm_squared).fold(f64::MIN_POSITIVE, f64::max).sqrt();
    a.cross(&b).dot(&c).abs() / largest
}

//! Where a new point lies: against the faces and against the sphere of a tetrahedron, from one evaluation.
//!
//! With the new point as origin, the determinants of three vertices each are the point's unscaled barycentric
//! coordinates, and their sum weighted with the vertices' squared distances is the in-sphere determinant. The roundoff
//! of all is bounded once, for the whole box of points; only what this static bound leaves open is looked at again.

use super::perturb;
use crate::geometry::Point3;
use crate::geometry::predicates::{INSPHERE_BOUND, ORIENT3D_BOUND, insphere_bound};

/// A point, and its number in the cavity being dug. One half of a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Site {
    pub(super) at: Point3,
    /// The insertion that numbered it last.
    pub(super) stamp: u32,
    /// Its number among the vertices of that insertion's cavity.
    pub(super) local: u32,
}

/// Roundoff of the determinants, whichever of the points they are taken of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    /// Of an orientation.
    pub(super) orient: f64,
    /// Of an in-sphere determinant.
    pub(super) sphere: f64,
}

impl Bounds {
    pub(super) fn of(points: &[Point3]) -> Self {
        let mut low = Point3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY);
        let mut high = -low;
        for p in points {
            low = low.inf(p);
            high = high.sup(p);
        }
        // Subtraction rounds monotonically: no difference of two coordinates exceeds the rounded one of the box.
        let size = high - low;
        let volume = size.x * size.y * size.z;
        Self { orient: ORIENT3D_BOUND * volume, sphere: INSPHERE_BOUND * volume * size.norm_squared() }
    }
}

/// A point seen from a positive tetrahedron.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    /// Per vertex the orientation of the tetrahedron that has the point in the vertex's stead.
    pub(super) weights: [f64; 4],
    /// The in-sphere determinant, positive inside.
    pub(super) sphere: f64,
}

impl View {
    /// The point `e` seen from the tetrahedron `a, b, c, d`.
    #[inline]
    pub(super) fn new([a, b, c, d]: [&Point3; 4], e: &Point3) -> Self {
        let (ax, ay, az) = (a.x - e.x, a.y - e.y, a.z - e.z);
        let (bx, by, bz) = (b.x - e.x, b.y - e.y, b.z - e.z);
        let (cx, cy, cz) = (c.x - e.x, c.y - e.y, c.z - e.z);
        let (dx, dy, dz) = (d.x - e.x, d.y - e.y, d.z - e.z);
        let (ab, bc, cd) = (ax * by - bx * ay, bx * cy - cx * by, cx * dy - dx * cy);
        let (da, ac, bd) = (dx * ay - ax * dy, ax * cy - cx * ay, bx * dy - dx * by);
        let abc = az * bc - bz * ac + cz * ab;
        let bcd = bz * cd - cz * bd + dz * bc;
        let cda = cz * da + dz * ac + az * cd;
        let dab = dz * ab + az * bd + bz * da;
        let al = ax * ax + ay * ay + az * az;
        let bl = bx * bx + by * by + bz * bz;
        let cl = cx * cx + cy * cy + cz * cz;
        let dl = dx * dx + dy * dy + dz * dz;
        Self { weights: [bcd, -cda, dab, -abc], sphere: (cl * dab - dl * abc) + (al * bcd - bl * cda) }
    }
}

/// Whether `e` lies in the perturbed sphere of the positive tetrahedron `p`.
#[inline]
pub(super) fn in_sphere(p: [&Point3; 4], e: &Point3, bounds: &Bounds) -> bool {
    let det = View::new(p, e).sphere;
    if det.abs() > bounds.sphere { det > 0.0 } else { in_sphere_close(p, e, det) }
}

/// What the static bound leaves open: the bound of these very points, then exact arithmetic.
#[inline(never)]
fn in_sphere_close(p: [&Point3; 4], e: &Point3, det: f64) -> bool {
    if det.abs() > insphere_bound(p, e) { det > 0.0 } else { perturb::in_sphere_close(p, e) }
}

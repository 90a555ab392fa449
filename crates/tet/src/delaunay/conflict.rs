//! Position of a new point relative to the faces and the circumsphere of a tetrahedron, from one evaluation.
//!
//! With the new point as origin, the determinants of three vertices each are its unscaled barycentric coordinates.
//! Their sum, weighted with the squared distances of the vertices, is the in-sphere determinant. One static bound
//! covers the roundoff of all, for the whole bounding box; only undecided cases are evaluated again.

use super::perturb;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::predicates::{INSPHERE_BOUND, ORIENT3D_BOUND, insphere_bound};
use std::ops::{Add, Mul, Sub};

/// A point and its number in the current cavity. Half a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Site {
    pub(super) at: Point3,
    /// Last insertion that numbered it.
    pub(super) stamp: u32,
    /// Its number among the vertices of that insertion's cavity.
    pub(super) local: u32,
}

/// Static roundoff bounds of the determinants for a set of points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    /// Bound for an orientation.
    pub(super) orient: f64,
    /// Bound for an in-sphere determinant.
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
        // Subtraction rounds monotonically, so no coordinate difference exceeds the rounded size of the box.
        let size = high - low;
        let volume = size.x * size.y * size.z;
        Self { orient: ORIENT3D_BOUND * volume, sphere: INSPHERE_BOUND * volume * size.norm_squared() }
    }
}

/// Determinants of a point with respect to a positive tetrahedron.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    /// Orientation of the tetrahedron with each vertex replaced by the point.
    pub(super) weights: [f64; 4],
    /// In-sphere determinant, positive inside.
    pub(super) sphere: f64,
}

impl View {
    /// Evaluates the point `e` against the tetrahedron `a, b, c, d`.
    #[inline]
    pub(super) fn new([a, b, c, d]: [&Point3; 4], e: &Point3) -> Self {
        // Vertices in pairs, for two-lane arithmetic: a with c, b with d.
        let [[px, py, pz], [qx, qy, qz]] = [[a, c], [b, d]]
            .map(|[p, q]| [Two(p.x - e.x, q.x - e.x), Two(p.y - e.y, q.y - e.y), Two(p.z - e.z, q.z - e.z)]);
        let (rx, ry, rz) = (px.swap(), py.swap(), pz.swap());
        let ab_cd = px * qy - qx * py;
        let bc_da = qx * ry - rx * qy;
        let (ac, bd) = (px.0 * py.1 - px.1 * py.0, qx.0 * qy.1 - qx.1 * qy.0);
        let abc_cda = pz * bc_da + rz * ab_cd + Two(-qz.0, qz.1) * Two(ac, ac);
        let bcd_dab = qz * ab_cd.swap() + qz.swap() * bc_da + Two(-rz.0, rz.1) * Two(bd, bd);
        let p_lift = px * px + py * py + pz * pz;
        let q_lift = qx * qx + qy * qy + qz * qz;
        let Two(first, second) = p_lift * bcd_dab - q_lift * abc_cda.swap();
        let ([abc, cda], [bcd, dab]) = ([abc_cda.0, abc_cda.1], [bcd_dab.0, bcd_dab.1]);
        Self { weights: [bcd, -cda, dab, -abc], sphere: first + second }
    }
}

/// Two numbers in one register.
#[derive(Clone, Copy)]
struct Two(f64, f64);

impl Two {
    #[inline]
    fn swap(self) -> Self {
        Self(self.1, self.0)
    }
}

impl Add for Two {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0, self.1 + other.1)
    }
}

impl Sub for Two {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0, self.1 - other.1)
    }
}

impl Mul for Two {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0, self.1 * other.1)
    }
}

/// True if `e` lies in the perturbed circumsphere of the positive tetrahedron `p`.
#[inline]
pub(super) fn in_sphere(p: [&Point3; 4], e: &Point3, bounds: &Bounds) -> bool {
    let det = View::new(p, e).sphere;
    if det.abs() > bounds.sphere { det > 0.0 } else { in_sphere_close(p, e, det) }
}

/// Decides cases within the static bound: first by the bound of these points, then by exact arithmetic.
#[inline(never)]
fn in_sphere_close(p: [&Point3; 4], e: &Point3, det: f64) -> bool {
    if det.abs() > insphere_bound(p, e) { det > 0.0 } else { perturb::in_sphere_close(p, e) }
}

//! Straight tapering vessel pieces and planes across them.

use super::{Point3, Vec3};

/// Straight piece of vessel: an axis from `a` to `b` with radius `ra` at `a` and `rb` at `b`, linear in between.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Tube {
    /// Start of the axis.
    pub a: Point3,
    /// End of the axis.
    pub b: Point3,
    /// Radius at `a`.
    pub ra: f64,
    /// Radius at `b`.
    pub rb: f64,
}

impl Tube {
    /// Length of the axis.
    #[inline]
    pub fn length(&self) -> f64 {
        (self.b - self.a).norm()
    }

    /// Axis point at parameter `t` in [0, 1].
    #[inline]
    pub fn point(&self, t: f64) -> Point3 {
        self.a + (self.b - self.a) * t
    }

    /// Radius at parameter `t` in [0, 1].
    #[inline]
    pub fn radius(&self, t: f64) -> f64 {
        self.ra + (self.rb - self.ra) * t
    }

    /// Smaller of the two radii.
    #[inline]
    pub fn min_radius(&self) -> f64 {
        self.ra.min(self.rb)
    }

    /// Larger of the two radii.
    #[inline]
    pub fn max_radius(&self) -> f64 {
        self.ra.max(self.rb)
    }
}

/// Length of `up` across the axis below which it gives no direction.
const LEAST_ACROSS: f64 = 0.1;

/// Plane across a vessel.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Section {
    /// Intersection of the vessel's axis with the plane.
    pub origin: Point3,
    /// Unit normal of the plane: the direction of the vessel there.
    pub axis: Vec3,
    /// Radius of the vessel there.
    pub radius: f64,
    /// Direction of the frame's first vector, up to its component along the axis.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub up: Option<Vec3>,
}

impl Section {
    /// Section whose frame depends on the axis alone.
    pub fn new(origin: Point3, axis: Vec3, radius: f64) -> Self {
        Self { origin, axis, radius, up: None }
    }

    /// Two unit vectors that span the plane; `(u, w, axis)` is right-handed. `u` is `up` without its component along the axis.
    /// Without `up`, it is the coordinate frame, rotated the shortest way from z to the axis. Along a bend that frame rotates
    /// little about the axis, except near −z, where any frame has a jump.
    pub fn frame(&self) -> (Vec3, Vec3) {
        let n = self.axis;
        let across = |up: Vec3| (up - n * n.dot(&up)).try_normalize(LEAST_ACROSS);
        if let Some(u) = self.up.and_then(across) {
            return (u, n.cross(&u));
        }
        let turned = Vec3::x() - (Vec3::z() + n) * (n.x / (1.0 + n.z));
        let u = (turned - n * n.dot(&turned)).try_normalize(0.0).filter(|u| u.norm_squared().is_finite());
        let u = u.unwrap_or(Vec3::x());
        (u, n.cross(&u))
    }

    /// Signed distance of `p` from the plane, positive on the side to which `axis` points.
    #[inline]
    pub fn height(&self, p: &Point3) -> f64 {
        (p - self.origin).dot(&self.axis)
    }
}

//! Straight tapering pieces of vessel and the planes across them.

use super::{Point3, Vec3};

/// A straight piece of vessel: an axis from `a` to `b` with radius `ra` at `a` and `rb` at `b`, linear in between.
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
    pub fn length(&self) -> f64 {
        (self.b - self.a).norm()
    }

    /// Axis point at parameter `t` in [0, 1].
    pub fn point(&self, t: f64) -> Point3 {
        self.a + (self.b - self.a) * t
    }

    /// Radius at parameter `t` in [0, 1].
    pub fn radius(&self, t: f64) -> f64 {
        self.ra + (self.rb - self.ra) * t
    }

    /// The smaller of the two radii.
    pub fn min_radius(&self) -> f64 {
        self.ra.min(self.rb)
    }

    /// The larger of the two radii.
    pub fn max_radius(&self) -> f64 {
        self.ra.max(self.rb)
    }
}

/// A plane across a vessel.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Section {
    /// Where the vessel's axis meets the plane.
    pub origin: Point3,
    /// Unit normal of the plane: the direction of the vessel there.
    pub axis: Vec3,
    /// Radius of the vessel there.
    pub radius: f64,
}

impl Section {
    /// Two unit vectors that span the plane; `(u, w, axis)` is right-handed and depends on `axis` alone: it is the frame of
    /// the coordinates, turned the shortest way from z to the axis. Where a vessel bends it turns little about the axis, but
    /// near −z, where no frame can be without a jump.
    pub fn frame(&self) -> (Vec3, Vec3) {
        let n = self.axis;
        let turned = Vec3::x() - (Vec3::z() + n) * (n.x / (1.0 + n.z));
        let u = (turned - n * n.dot(&turned)).try_normalize(0.0).filter(|u| u.norm_squared().is_finite());
        let u = u.unwrap_or(Vec3::x());
        (u, n.cross(&u))
    }

    /// Signed distance of `p` from the plane, positive on the side to which `axis` points.
    pub fn height(&self, p: &Point3) -> f64 {
        (p - self.origin).dot(&self.axis)
    }
}

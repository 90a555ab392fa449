//! Planes in which parts of the surface lie but for rounding.

use super::space::Space;
use crate::geometry::{Point3, Vec3, unit_normal};

/// A plane, and a point well above it from which it is looked at.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    at: Point3,
    normal: Vec3,
    pub above: Point3,
}

impl Plane {
    /// The plane of a triangle, which is looked at from as far as it is long.
    pub(super) fn of(s: &Space, triangle: [u32; 3]) -> Self {
        let [a, b, c] = triangle.map(|v| s.point(v).coords);
        let size = (b - a).norm().max((c - a).norm()).max((c - b).norm());
        let (at, normal) = (Point3::from((a + b + c) / 3.0), unit_normal(a, b, c));
        Self { at, normal, above: at + normal * size }
    }

    pub(super) fn height(&self, p: &Point3) -> f64 {
        self.normal.dot(&(p - self.at))
    }
}

/// The area of a triangle.
pub(super) fn area(s: &Space, triangle: [u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|v| s.point(v));
    0.5 * (b - a).cross(&(c - a)).norm()
}

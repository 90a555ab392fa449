//! Planes of surface parts that are flat up to rounding.

use super::space::Space;
use anastomesh_mesh::geometry::{Point3, Vec3};

/// A plane and a point well above it as viewpoint.
#[derive(Clone, Copy)]
pub(super) struct Plane {
    at: Point3,
    normal: Vec3,
    pub above: Point3,
}

impl Plane {
    pub(super) fn height(&self, p: &Point3) -> f64 {
        self.normal.dot(&(p - self.at))
    }
}

/// Area-weighted sums over coplanar triangles.
#[derive(Clone, Copy)]
pub(super) struct Patch {
    /// First corner, the origin of the sums.
    origin: Point3,
    /// Sum of normals of twice the area in length.
    normal: Vec3,
    /// Sums of twice the areas, and of these times three times the centers.
    weight: f64,
    moment: Vec3,
    /// Longest side of the first triangle.
    size: f64,
}

impl Patch {
    /// Starts with one triangle. Its longest side is the height of the viewpoint.
    pub(super) fn new(s: &Space, triangle: [u32; 3]) -> Self {
        let [a, b, c] = triangle.map(|v| *s.point(v));
        let size = (b - a).norm().max((c - a).norm()).max((c - b).norm());
        let none = Vec3::zeros();
        Self { origin: a, normal: none, weight: 0.0, moment: none, size }.with(s, triangle)
    }

    /// Adds another triangle.
    pub(super) fn with(mut self, s: &Space, triangle: [u32; 3]) -> Self {
        let [a, b, c] = triangle.map(|v| s.point(v) - self.origin);
        let normal = (b - a).cross(&(c - a));
        let weight = normal.norm();
        self.normal += normal;
        self.weight += weight;
        self.moment += (a + b + c) * weight;
        self
    }

    pub(super) fn plane(&self) -> Plane {
        let normal = self.normal.normalize();
        let at = self.origin + self.moment / (3.0 * self.weight);
        Plane { at, normal, above: at + normal * self.size }
    }

    /// Twice the area.
    pub(super) fn area(&self) -> f64 {
        self.normal.norm()
    }
}

//! Planes in which parts of the surface lie but for rounding.

use super::space::Space;
use anastomesh_mesh::geometry::{Point3, Vec3};

/// A plane, and a point well above it from which it is looked at.
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

/// Some triangles that lie in one plane, summed up.
#[derive(Clone, Copy)]
pub(super) struct Patch {
    /// A corner, from which sums are taken.
    origin: Point3,
    /// The sum of normals as long as twice the areas.
    normal: Vec3,
    /// Sums of twice the areas, and of three times the centers times these.
    weight: f64,
    moment: Vec3,
    /// Length of the longest side of the first.
    size: f64,
}

impl Patch {
    /// One triangle, whose plane is looked at from as far as it is long.
    pub(super) fn new(s: &Space, triangle: [u32; 3]) -> Self {
        let [a, b, c] = triangle.map(|v| *s.point(v));
        let size = (b - a).norm().max((c - a).norm()).max((c - b).norm());
        let none = Vec3::zeros();
        Self { origin: a, normal: none, weight: 0.0, moment: none, size }.with(s, triangle)
    }

    /// With another triangle.
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

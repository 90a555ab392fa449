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

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of a plane at height 1, and one off it.
    fn space() -> Space {
        Space::of_points([[1.0, 2.0, 1.0], [5.0, 2.0, 1.0], [1.0, 5.0, 1.0], [5.0, 11.0, 1.0], [1.0, 2.0, 9.0]])
    }

    #[test]
    fn the_plane_of_a_triangle_goes_through_its_center() {
        let s = space();
        for triangle in [[0, 1, 2], [1, 2, 0], [2, 0, 1]] {
            let patch = Patch::new(&s, triangle);
            let plane = patch.plane();
            assert_eq!(patch.area(), 12.0);
            assert!((plane.above - Point3::new(7.0 / 3.0, 3.0, 6.0)).norm() < 1e-14, "{}", plane.above);
            assert_eq!([3.0, 1.0, -2.0].map(|z| plane.height(&Point3::new(40.0, -7.0, z))), [2.0, 0.0, -3.0]);
        }
    }

    #[test]
    fn triangles_count_by_their_area() {
        let s = space();
        let patch = Patch::new(&s, [0, 1, 2]).with(&s, [1, 3, 2]);
        assert_eq!(patch.area(), 48.0);
        let center = Point3::new(1.0 + 7.0 / 3.0, 2.0 + 3.25, 6.0);
        assert!((patch.plane().above - center).norm() < 1e-14, "{}", patch.plane().above);
        // Two triangles at a right angle span a plane between theirs.
        let bent = Patch::new(&s, [0, 1, 2]).with(&s, [0, 4, 1]);
        assert_eq!(bent.area(), (12.0_f64 * 12.0 + 32.0 * 32.0).sqrt());
    }
}

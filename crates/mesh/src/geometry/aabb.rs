//! Axis-aligned bounding boxes.

use super::Point3;

/// Axis-aligned bounding box; closed, so touching boxes overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Smallest coordinates.
    pub min: Point3,
    /// Largest coordinates.
    pub max: Point3,
}

impl Aabb {
    /// Empty box: it overlaps no box and is neutral in unions.
    pub const EMPTY: Self = Self {
        min: Point3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
        max: Point3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
    };

    /// Bounding box of a set of points; `EMPTY` for none.
    pub fn of_points<'a>(points: impl IntoIterator<Item = &'a Point3>) -> Self {
        let mut aabb = Self::EMPTY;
        for p in points {
            aabb.include(p);
        }
        aabb
    }

    /// Grows the box to contain `p`.
    #[inline]
    pub fn include(&mut self, p: &Point3) {
        self.min = self.min.inf(p);
        self.max = self.max.sup(p);
    }

    /// Bounding box of both.
    #[must_use]
    #[inline]
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.inf(&other.min), max: self.max.sup(&other.max) }
    }

    /// The box grown by `margin` on every side.
    #[must_use]
    #[inline]
    pub fn grown(&self, margin: f64) -> Self {
        let m = super::Vec3::repeat(margin);
        Self { min: self.min - m, max: self.max + m }
    }

    /// True if the boxes have a point in common.
    #[inline]
    #[allow(clippy::needless_bitwise_bool)]
    pub fn overlaps(&self, other: &Self) -> bool {
        // Without short circuits: unpredictable branches cost more.
        (self.min.x <= other.max.x)
            & (other.min.x <= self.max.x)
            & (self.min.y <= other.max.y)
            & (other.min.y <= self.max.y)
            & (self.min.z <= other.max.z)
            & (other.min.z <= self.max.z)
    }

    /// Twice the centre, sufficient for sorting.
    pub(super) fn doubled_centre(&self) -> [f64; 3] {
        [self.min.x + self.max.x, self.min.y + self.max.y, self.min.z + self.max.z]
    }

    /// Length of the diagonal; 0 for the empty box.
    #[inline]
    pub fn diagonal(&self) -> f64 {
        if self.min.x > self.max.x {
            return 0.0;
        }
        (self.max - self.min).norm()
    }
}

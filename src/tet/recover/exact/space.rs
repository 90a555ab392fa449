//! A complex some of whose vertices are implicit, and the exact predicates on its vertices.

use crate::geometry::Point3;
use crate::geometry::implicit::{self, OnSegment, Site};
use crate::geometry::predicates;
use crate::tet::complex::{Complex, NONE};
use crate::tet::delaunay::in_sphere_perturbed;
use std::cmp::Ordering;

/// A complex whose points are rounded where they are implicit.
pub(super) struct Space {
    pub c: Complex,
    /// What the implicit points are.
    on: Vec<OnSegment>,
    /// For each vertex its place in `on`, or [`NONE`].
    place: Vec<u32>,
}

impl Space {
    pub(super) fn new(c: Complex) -> Self {
        let place = vec![NONE; c.points.len()];
        Self { c, on: Vec::new(), place }
    }

    #[inline]
    pub(super) fn point(&self, v: u32) -> &Point3 {
        &self.c.points[v as usize]
    }

    #[inline]
    pub(super) fn site(&self, v: u32) -> Site<'_> {
        Site { at: self.point(v), on: self.on.get(self.place[v as usize] as usize) }
    }

    #[inline]
    pub(super) fn is_implicit(&self, v: u32) -> bool {
        self.place[v as usize] != NONE
    }

    /// Where an implicit vertex lies on its segment.
    pub(super) fn parameter(&self, v: u32) -> Option<f64> {
        self.on.get(self.place[v as usize] as usize).map(|on| on.t)
    }

    /// Adds an implicit vertex without a tetrahedron.
    pub(super) fn add_implicit(&mut self, on: OnSegment) -> u32 {
        self.place.push(self.on.len() as u32);
        self.on.push(on);
        self.c.add_point(on.rounded())
    }

    /// Adds a vertex without a tetrahedron.
    pub(super) fn add_point(&mut self, p: Point3) -> u32 {
        self.place.push(NONE);
        self.c.add_point(p)
    }

    /// The sign of the orientation of four vertices. Exact.
    #[inline]
    pub(super) fn orient(&self, v: [u32; 4]) -> i32 {
        if v.iter().any(|&x| self.is_implicit(x)) {
            return implicit::orient3d(v.map(|x| self.site(x)));
        }
        let [a, b, c, d] = v.map(|x| self.point(x));
        let o = predicates::orient3d(a, b, c, d);
        i32::from(o > 0.0) - i32::from(o < 0.0)
    }

    /// The same for a point that is no vertex.
    #[inline]
    pub(super) fn orient_to(&self, [a, b, c]: [u32; 3], p: &Point3) -> i32 {
        implicit::orient3d([self.site(a), self.site(b), self.site(c), Site { at: p, on: None }])
    }

    /// Whether `e` lies in the perturbed sphere of a positive tetrahedron.
    #[inline]
    pub(super) fn in_sphere(&self, v: [u32; 4], e: u32) -> bool {
        if self.is_implicit(e) || v.iter().any(|&x| self.is_implicit(x)) {
            return implicit::in_sphere_perturbed(v.map(|x| self.site(x)), self.site(e));
        }
        in_sphere_perturbed(v.map(|x| self.point(x)), self.point(e))
    }

    /// Whether `e`, in the plane of the triangle `v`, lies in its perturbed circle. `above` is any point from which the
    /// triangle runs counter-clockwise.
    pub(super) fn in_circle(&self, [a, b, c]: [u32; 3], above: &Point3, e: u32) -> bool {
        // The lift of `above` does not count, since the other four lie in one plane.
        let above = Site { at: above, on: None };
        implicit::in_sphere_perturbed([self.site(a), self.site(b), self.site(c), above], self.site(e))
    }

    /// Lexicographic order of two vertices. Exact.
    pub(super) fn compare(&self, v: u32, w: u32) -> Ordering {
        implicit::compare(self.site(v), self.site(w))
    }

    /// Whether all tetrahedra are positive, with implicit points as they are. For tests.
    #[cfg(test)]
    pub(super) fn check(&self) {
        if self.c.slots() > 50_000 {
            return;
        }
        for t in self.c.real_tets() {
            assert!(self.orient(self.c.verts(t)) > 0, "tetrahedron {t} is not positive");
        }
        for t in (0..self.c.slots() as u32).filter(|&t| self.c.is_alive(t)) {
            for i in 0..4 {
                let half = 4 * t + i;
                let mate = self.c.mate(half);
                assert_eq!(self.c.mate(mate), half);
                assert_eq!(self.c.is_frozen(mate), self.c.is_frozen(half));
                assert!(crate::tet::complex::opposed(self.c.face(half), self.c.face(mate)));
            }
        }
    }
}

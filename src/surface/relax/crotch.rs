//! Crotches: where two vessels part at a small angle, a grid that is too coarse for the gap between them leaves a web from
//! wall to wall, which takes away some of their lengths. Such edges are split, and what is put amid them goes down to the
//! bottom of the crotch.

use super::{Criterion, Level, Relaxation};

/// How often what is left is looked at: each time halves the edges of a web, and evens out the triangles beside it.
const PASSES: usize = 2;
/// An edge of a web leans by this (a cosine) towards the normals at both of its ends, out of the walls.
const LEAN: f64 = 0.35;
/// Its middle lies so far outside, in radii.
const OUTSIDE: f64 = 0.06;
/// It is as long as this, in edge lengths aimed at.
const SHORTEST: f64 = 0.5;
/// The edge length to aim at beside the new vertex, in lengths of the edge that was split.
const SHRINK: f64 = 0.8;
/// Newton steps from a web to the bottom: each goes half an edge length at most.
const STEPS: usize = 4;

impl<L: Level> Relaxation<'_, L> {
    /// Takes webs away; where there are none, nothing is changed.
    pub(super) fn open_crotches(&mut self) {
        for _ in 0..PASSES {
            if !self.split_webs() {
                return;
            }
            self.flip(Criterion::Angle);
            self.collapse_short();
            self.smooth();
        }
    }

    /// Splits the edges of webs; whether there were any.
    fn split_webs(&mut self) -> bool {
        let mut any = false;
        for i in 0..self.half_count() {
            let h = self.half(i);
            if self.is_editable(h) && self.surface.from(h) < self.surface.to(h) && self.is_web(h) {
                any = true;
                let size = self.aim(self.surface.from(h), self.surface.to(h)).min(SHRINK * self.surface.length(h));
                let m = self.split(h, size);
                for _ in 0..STEPS {
                    let p = self.surface.points[m as usize];
                    self.surface.points[m as usize] = self.projected(m, p);
                }
            }
        }
        any
    }

    fn is_web(&mut self, h: u32) -> bool {
        let ends = [self.surface.from(h), self.surface.to(h)];
        let length = self.surface.length(h);
        if length < SHORTEST * self.aim(ends[0], ends[1]) {
            return false;
        }
        let [a, b] = ends.map(|v| self.surface.points[v as usize]);
        let [na, nb] = ends.map(|v| self.normals[v as usize]);
        let along = (b - a) / length;
        let leans = na.dot(&along) >= LEAN && nb.dot(&along) <= -LEAN;
        leans && self.level.value_and_gradient(&nalgebra::center(&a, &b)).0 >= 1.0 + OUTSIDE
    }
}

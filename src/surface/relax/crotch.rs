//! Crotches: where two vessels part at a small angle, a grid that is too coarse for the gap between them leaves a web from
//! wall to wall, which takes away some of their lengths. Such edges are split, and what is put amid them goes down to the
//! bottom of the crotch.

use super::{Criterion, Level, MAX_STEP, Relaxation, largest_cosine};
use crate::surface::halfedge::HalfEdges;
use anastomesh_mesh::geometry::{Aabb, Point3, Vec3, self_intersections};

/// How often what is left is looked at: each time halves the edges of a web, and evens out the triangles beside it.
const PASSES: usize = 2;
/// Smoothing passes after each split of webs.
const SMOOTHING_PASSES: usize = 2;
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
/// Triangles at the bottom look outwards by this (a cosine), and their smallest angles are over 25°.
const OUTWARDS: f64 = 0.2;
const SLIMMEST: f64 = 0.906;
/// When all is done, no angle near an opened crotch is below 20°.
const SLIMMEST_AT_LAST: f64 = 0.9396;

/// What can be gone back to.
struct Before {
    surface: HalfEdges,
    sizes: Vec<f64>,
    normals: Vec<Vec3>,
}

impl<L: Level> Relaxation<'_, L> {
    /// Takes webs away, and then does `finish`; where there are none, or what comes out is worse than a web, that is all
    /// that is done. For whole surfaces.
    pub(super) fn open_crotches(&mut self, finish: impl Fn(&mut Self)) {
        let first = self.surface.points.len();
        let mut before = None;
        for _ in 0..PASSES {
            if !self.split_webs(&mut before) {
                break;
            }
            for _ in 0..SMOOTHING_PASSES {
                self.flip(Criterion::Angle);
                self.collapse_short();
                self.smooth();
            }
        }
        finish(self);
        if let Some(before) = before
            && !self.is_sound_since(first)
        {
            self.go_back(before);
            finish(self);
        }
    }

    /// Splits the edges of webs; whether there were any.
    fn split_webs(&mut self, before: &mut Option<Before>) -> bool {
        let mut any = false;
        for i in 0..self.half_count() {
            let h = self.half(i);
            if self.is_editable(h) && self.surface.from(h) < self.surface.to(h) && self.is_web(h) {
                let size = self.aim(self.surface.from(h), self.surface.to(h)).min(SHRINK * self.surface.length(h));
                if let Some((bottom, normal)) = self.bottom(h, size) {
                    any = true;
                    before.get_or_insert_with(|| self.before());
                    let m = self.split(h, size) as usize;
                    self.surface.points[m] = bottom;
                    self.normals[m] = normal;
                }
            }
        }
        any
    }

    fn before(&self) -> Before {
        Before { surface: self.surface.clone(), sizes: self.sizes.clone(), normals: self.normals.clone() }
    }

    fn go_back(&mut self, before: Before) {
        *self.surface = before.surface;
        self.sizes = before.sizes;
        self.normals = before.normals;
    }

    /// Whether triangles at the vertices from `first` on, and at their neighbours, are well shaped and do not meet others.
    fn is_sound_since(&self, first: usize) -> bool {
        let s = &*self.surface;
        let new = (first as u32..s.points.len() as u32).filter(|&v| s.has_vertex(v));
        let near = new.flat_map(|v| s.fan(v)).flat_map(|h| s.fan(s.to(h)));
        let corners = |h: u32| [s.from(h), s.to(h), s.apex(h)].map(|v| s.points[v as usize]);
        let mut opened = Aabb::EMPTY;
        for [a, b, c] in near.map(corners) {
            if largest_cosine(&a, &b, &c) > SLIMMEST_AT_LAST {
                return false;
            }
            opened = opened.union(&Aabb::of_points(&[a, b, c]));
        }
        let mesh = s.to_mesh().0;
        let beside = |t: &[u32; 3]| Aabb::of_points(&t.map(|v| mesh.points[v as usize])).overlaps(&opened);
        let triangles: Vec<[u32; 3]> = mesh.triangles.iter().copied().filter(beside).collect();
        self_intersections(&mesh.points, &triangles).is_empty()
    }

    /// Where the middle of an edge goes, and the normal of the level there: as deep as the four triangles that it will have are
    /// well shaped and look outwards.
    fn bottom(&mut self, h: u32, size: f64) -> Option<(Point3, Vec3)> {
        let s = &*self.surface;
        let quad = [s.from(h), s.apex(s.twin(h)), s.to(h), s.apex(h)].map(|v| s.points[v as usize]);
        let mut at = nalgebra::center(&quad[0], &quad[2]);
        let mut found = None;
        for _ in 0..STEPS {
            let (value, gradient) = self.level.value_and_gradient(&at);
            let steep = gradient.norm();
            if steep <= 0.0 {
                break;
            }
            let step = (1.0 - value) / steep;
            let normal = gradient / steep;
            at += normal * step.clamp(-MAX_STEP * size, MAX_STEP * size);
            if !(0..4).all(|k| is_sound(&at, &quad[k], &quad[(k + 1) % 4], &normal)) {
                break;
            }
            found = Some((at, normal));
        }
        found
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

/// Whether a triangle is well shaped and looks the way of the normal.
fn is_sound(a: &Point3, b: &Point3, c: &Point3, normal: &Vec3) -> bool {
    let area = (b - a).cross(&(c - a));
    area.dot(normal) > OUTWARDS * area.norm() && largest_cosine(a, b, c) < SLIMMEST
}

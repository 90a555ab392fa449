//! Removes webs in crotches. If two vessels diverge at a small angle, a coarse grid leaves a web across their gap. The
//! web shortens the visible vessels. Its edges are split, and the new vertices move down to the bottom of the crotch.

use super::{Criterion, Level, MAX_STEP, Relaxation, largest_cosine};
use crate::surface::halfedge::HalfEdges;
use anastomesh_mesh::geometry::{Aabb, Point3, Vec3, self_intersections};

/// Maximum passes. Each pass halves the edges of a web and relaxes the adjacent triangles.
const PASSES: usize = 2;
/// Relaxation rounds per pass.
const SMOOTHING_PASSES: usize = 2;
/// Minimum cosine between a web edge and the normals at its ends, pointing out of the walls.
const LEAN: f64 = 0.35;
/// Minimum distance of the edge's middle outside the wall, in radii.
const OUTSIDE: f64 = 0.06;
/// Minimum length of a web edge, in target edge lengths.
const SHORTEST: f64 = 0.5;
/// Target edge length next to the new vertex, relative to the split edge.
const SHRINK: f64 = 0.8;
/// Newton steps from a web to the bottom. Each step is at most half an edge length.
const STEPS: usize = 4;
/// Minimum cosine between bottom triangles and the normal, and maximum cosine of their angles (25°).
const OUTWARDS: f64 = 0.2;
const SLIMMEST: f64 = 0.906;
/// Maximum cosine of the angles near an opened crotch after all passes (20°).
const SLIMMEST_AT_LAST: f64 = 0.9396;

/// Saved state for a rollback.
struct SavedVertices {
    surface: HalfEdges,
    sizes: Vec<f64>,
    normals: Vec<Vec3>,
}

impl<L: Level> Relaxation<'_, L> {
    /// Opens crotches and then runs `finish`. If the result is not sound, the original state is restored and only
    /// `finish` runs. For whole surfaces.
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
            && self.stopped.is_none()
            && !self.is_sound_since(first)
        {
            self.go_back(before);
            finish(self);
        }
    }

    /// Splits the edges of webs; returns true if any existed.
    fn split_webs(&mut self, before: &mut Option<SavedVertices>) -> bool {
        let mut any = false;
        let count = self.half_count();
        for i in 0..count {
            if self.must_stop(i as usize, count as usize) {
                return false;
            }
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

    fn before(&self) -> SavedVertices {
        SavedVertices { surface: self.surface.clone(), sizes: self.sizes.clone(), normals: self.normals.clone() }
    }

    fn go_back(&mut self, before: SavedVertices) {
        *self.surface = before.surface;
        self.sizes = before.sizes;
        self.normals = before.normals;
    }

    /// True if triangles near the vertices from `first` on are well shaped and have no overlaps.
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

    /// Returns the target point of an edge's middle and the level normal there. The point is the deepest for which all
    /// four new triangles are well shaped and face outwards.
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

/// True if a triangle is well shaped and faces along the normal.
fn is_sound(a: &Point3, b: &Point3, c: &Point3, normal: &Vec3) -> bool {
    let area = (b - a).cross(&(c - a));
    area.dot(normal) > OUTWARDS * area.norm() && largest_cosine(a, b, c) < SLIMMEST
}

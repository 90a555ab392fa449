//! Cavities for vertices on a segment. A cavity is widened if too short a part of the segment sees all its faces. It is
//! then lengthened along the segment as far as one vertex can see.

use super::course::{Course, Deepest};
use super::parts::{sides, sorted};
use super::space::Space;
use crate::star::EdgeRing;
use anastomesh_mesh::geometry::implicit::{self, OnTriangle, Site};
use rustc_hash::{FxHashMap, FxHashSet};

/// Bits of a weight below the leading bit of its interval's length.
const BITS: u32 = 4;

/// Work of an exact parameter on a segment.
const PARAMETER: usize = 30;

/// Maximum growth steps of a cavity.
const STEPS: usize = 32;

/// Maximum growth steps of a deep cavity.
const DEEP_STEPS: usize = 64;

/// Steps without gain after which a deep cavity stops growing.
const PATIENCE: usize = 6;

/// Sufficient distance of a vertex from the faces, relative to their size. It is far above the rounding of coordinates
/// in flat parts, even in single precision.
const DEEP: f64 = 1e-5;

/// Sufficient length of the part of the segment that sees all faces, as a weight.
const WIDE: i128 = (OnTriangle::ONE >> 24).cast_signed();

/// A cavity.
pub(super) enum Dug {
    /// Cavity to be joined to the start vertex, which leads to the segment's end.
    Joins(Vec<u32>),
    /// Cavity with a weight on the segment from which all faces are visible.
    Place(Vec<u32>, u128),
}

pub(super) struct Dig<'a> {
    s: &'a Space,
    /// Number of input points.
    points: usize,
    /// True for edges that must stay.
    keep: &'a dyn Fn(u32, u32) -> bool,
    /// Start vertex.
    at: u32,
    ends: [u32; 2],
    course: Course,
    known: FxHashMap<u32, Sight>,
}

/// Interval of weights from which all faces are visible from inside, and the half-faces of the cavity that limit it.
#[derive(Clone, Copy)]
struct VisibleFaces {
    low: (u128, u32),
    high: (u128, u32),
    /// A face that is visible from nowhere on the segment.
    blind: Option<u32>,
}

/// Part of a segment that sees a face from inside.
#[derive(Clone, Copy)]
enum Sight {
    Everywhere,
    /// Below this weight.
    Before(u128),
    /// Above this weight.
    Behind(u128),
    Nowhere,
}

impl Sight {
    fn of(s: &Space, ends: [u32; 2], half: u32) -> Self {
        let [x, y, z] = s.c.face(half);
        let inside = ends.map(|end| s.orient([x, z, y, end]) > 0);
        if inside == [true; 2] {
            return Self::Everywhere;
        }
        s.count(PARAMETER);
        let weight = || implicit::parameter([x, z, y].map(|v| s.site(v)), ends.map(|v| s.site(v)));
        match inside {
            [true, false] => weight().map_or(Self::Nowhere, Self::Before),
            [false, true] => weight().map_or(Self::Nowhere, Self::Behind),
            _ => Self::Nowhere,
        }
    }
}

impl VisibleFaces {
    fn of(walls: impl Iterator<Item = (u32, Sight)>) -> Self {
        let mut view = Self { low: (0, u32::MAX), high: (OnTriangle::ONE, u32::MAX), blind: None };
        for (half, sight) in walls {
            match sight {
                Sight::Before(t) if t < view.high.0 => view.high = (t, half),
                Sight::Behind(t) if t >= view.low.0 => view.low = (t, half),
                Sight::Nowhere => view.blind = Some(half),
                _ => {}
            }
        }
        view
    }

    fn width(&self) -> i128 {
        if self.blind.is_some() { i128::MIN } else { self.high.0.cast_signed() - self.low.0.cast_signed() }
    }

    /// Weight in the middle half of the interval, with few bits to keep exact arithmetic short.
    fn middle(&self) -> u128 {
        let (low, width) = (self.low.0, self.high.0 - self.low.0);
        let shift = width.max(1).ilog2().saturating_sub(BITS);
        ((low + width / 2) >> shift) << shift
    }
}

/// Weight on a segment from which all faces of a cavity are visible.
pub(super) fn middle(s: &Space, ends: [u32; 2], cavity: &[u32]) -> Option<u128> {
    let view = VisibleFaces::of(s.outer(cavity).into_iter().map(|half| (half, Sight::of(s, ends, half))));
    (view.width() > 0).then(|| view.middle())
}

impl<'a> Dig<'a> {
    pub(super) fn new(
        s: &'a Space,
        points: usize,
        keep: &'a dyn Fn(u32, u32) -> bool,
        at: u32,
        ends: [u32; 2],
    ) -> Self {
        Self { s, points, keep, at, ends, course: Course::new(s, at, ends), known: FxHashMap::default() }
    }

    /// Cavity for the next vertex of the segment beyond its first crossing.
    pub(super) fn dig(&mut self, first: Vec<u32>, deep: bool) -> Option<Dug> {
        let dug = if deep { self.deep(first.clone()) } else { None };
        dug.or_else(|| self.seen(first))
    }

    /// Cavity in which the vertex lies well off all faces. Nearly flat tetrahedra on both sides are included.
    fn deep(&self, mut tets: Vec<u32>) -> Option<Dug> {
        let mut best: Option<(f64, Dug)> = None;
        let mut max_depth = (f64::NEG_INFINITY, 0);
        for step in 0..DEEP_STEPS {
            let walls = self.s.outer(&tets);
            let deepest = self.course.deepest(self.s, &walls);
            if deepest.depth > max_depth.0 {
                max_depth = (deepest.depth, step);
            } else if step > max_depth.1 + PATIENCE && max_depth.0 < DEEP {
                break;
            }
            let best_so_far = best.as_ref().map_or(0.0, |b| b.0);
            let joined = self.depth_of_join(&walls).filter(|&depth| depth > best_so_far);
            let better = deepest.depth > best_so_far || deepest.depth >= DEEP;
            if (joined.is_some() || better) && self.keeps(&tets, &walls) {
                if let Some(depth) = joined.filter(|_| self.joins(&walls)) {
                    if depth >= DEEP {
                        return Some(Dug::Joins(tets));
                    }
                    best = Some((depth, Dug::Joins(tets.clone())));
                }
                let best_so_far = best.as_ref().map_or(0.0, |b| b.0);
                if (deepest.depth > best_so_far || deepest.depth >= DEEP)
                    && let Some(weight) = self.place(&walls, &deepest)
                {
                    best = Some((deepest.depth.min(DEEP), Dug::Place(tets.clone(), weight)));
                }
            } else if best_so_far >= DEEP {
                break;
            }
            let further =
                if deepest.depth < DEEP { self.deepen(&mut tets, &deepest) } else { self.lengthen(&mut tets) };
            if !further {
                break;
            }
        }
        best.map(|b| b.1)
    }

    /// Minimum distance of the start vertex from the faces without it, relative to their size. `None` if no face has
    /// the end.
    fn depth_of_join(&self, walls: &[u32]) -> Option<f64> {
        let s = self.s;
        let leads = walls.iter().any(|&half| s.c.face(half).contains(&self.ends[1]));
        leads.then(|| self.course.depth_from(s, self.at, walls)).filter(|&depth| depth > 0.0)
    }

    /// Weight of a position near the deepest one that sees all faces.
    fn place(&self, walls: &[u32], deepest: &Deepest) -> Option<u128> {
        let weight = Course::weight(deepest);
        let on = OnTriangle::on_segment(self.ends.map(|v| *self.s.point(v)), weight);
        let at = on.rounded();
        let site = Site { at: &at, on: Some(&on) };
        let sees = |&half: &u32| {
            let [a, b, c] = self.s.wall(half).map(|v| self.s.site(v));
            implicit::orient3d([a, b, c, site]) > 0
        };
        walls.iter().all(sees).then_some(weight)
    }

    /// Adds the tetrahedron behind one of the faces nearest to the deepest position, whichever gains more.
    fn deepen(&self, tets: &mut Vec<u32>, deepest: &Deepest) -> bool {
        let mut best: Option<(f64, u32)> = None;
        for half in deepest.tight.into_iter().flatten() {
            let next = self.s.c.mate(half) >> 2;
            if self.s.c.is_frozen(half) || self.s.c.is_ghost(next) {
                continue;
            }
            tets.push(next);
            let depth = self.course.deepest(self.s, &self.s.outer(tets)).depth;
            tets.pop();
            if best.is_none_or(|(d, _)| depth > d) {
                best = Some((depth, next));
            }
        }
        tets.extend(best.map(|b| b.1));
        best.is_some()
    }

    /// Cavity with all faces visible from a position on the segment, however close they are.
    fn seen(&mut self, first: Vec<u32>) -> Option<Dug> {
        let mut tets = first;
        let mut best: Option<(Vec<u32>, VisibleFaces)> = None;
        for step in 0..STEPS {
            let walls = self.s.outer(&tets);
            let view = self.view(&walls);
            let best_so_far = best.as_ref().map_or(0, |b| b.1.width());
            let joins = self.joins(&walls);
            let better = view.width() >= WIDE || view.width() > best_so_far;
            if (joins || better) && (step == 0 || self.keeps(&tets, &walls)) {
                if joins {
                    return Some(Dug::Joins(tets));
                }
                best = Some((tets.clone(), view));
            } else if best_so_far >= WIDE {
                break;
            }
            let further = if view.width() < WIDE { self.widen(&mut tets, &view) } else { self.lengthen(&mut tets) };
            if !further {
                break;
            }
        }
        best.map(|(tets, view)| Dug::Place(tets, view.middle()))
    }

    fn view(&mut self, walls: &[u32]) -> VisibleFaces {
        let (s, ends, known) = (self.s, self.ends, &mut self.known);
        VisibleFaces::of(
            walls.iter().map(|&half| (half, *known.entry(half).or_insert_with(|| Sight::of(s, ends, half)))),
        )
    }

    /// True if the start vertex sees all faces and one of them has the end.
    fn joins(&self, walls: &[u32]) -> bool {
        let s = self.s;
        let sees = |half: u32| {
            let [a, b, c] = s.c.face(half);
            [a, b, c].contains(&self.at) || s.orient([a, c, b, self.at]) > 0
        };
        walls.iter().any(|&half| s.c.face(half).contains(&self.ends[1])) && walls.iter().all(|&half| sees(half))
    }

    /// Adds the tetrahedron behind one of the faces that limit the view, whichever gains more.
    fn widen(&mut self, tets: &mut Vec<u32>, view: &VisibleFaces) -> bool {
        let mut best: Option<(i128, u32)> = None;
        let bounds = if let Some(half) = view.blind { vec![half] } else { vec![view.low.1, view.high.1] };
        for half in bounds {
            if half == u32::MAX || self.s.c.is_frozen(half) || self.s.c.is_ghost(self.s.c.mate(half) >> 2) {
                continue;
            }
            let next = self.s.c.mate(half) >> 2;
            tets.push(next);
            let walls = self.s.outer(tets);
            let width = self.view(&walls).width();
            tets.pop();
            if best.is_none_or(|(w, _)| width > w) {
                best = Some((width, next));
            }
        }
        tets.extend(best.map(|b| b.1));
        best.is_some()
    }

    /// Adds the next tetrahedra that the segment crosses beyond the cavity.
    fn lengthen(&self, tets: &mut Vec<u32>) -> bool {
        let (s, [p, q]) = (self.s, self.ends);
        for half in self.s.outer(tets) {
            let f = s.c.face(half);
            if s.orient([f[0], f[1], f[2], q]) <= 0 {
                continue;
            }
            let sides: [i32; 3] = std::array::from_fn(|i| s.orient([p, q, f[i], f[(i + 1) % 3]]));
            if sides.iter().any(|&x| x < 0) {
                continue;
            }
            let zeros: Vec<usize> = (0..3).filter(|&i| sides[i] == 0).collect();
            return match zeros[..] {
                [] => self.pass_face(tets, half),
                [i] => self.pass_edge(tets, half >> 2, [f[i], f[(i + 1) % 3]]),
                _ => false,
            };
        }
        false
    }

    fn pass_face(&self, tets: &mut Vec<u32>, half: u32) -> bool {
        let next = self.s.c.mate(half) >> 2;
        let free = !self.s.c.is_frozen(half) && !self.s.c.is_ghost(next);
        if free {
            tets.push(next);
        }
        free
    }

    fn pass_edge(&self, tets: &mut Vec<u32>, t: u32, [u, v]: [u32; 2]) -> bool {
        let mut ring = EdgeRing::default();
        let found = ring.collect(&self.s.c, t, u, v, usize::MAX) && !ring.touches_ghost();
        if !found || (self.keep)(u, v) {
            return false;
        }
        for t in ring.tets {
            if !tets.contains(&t) {
                tets.push(t);
            }
        }
        true
    }

    /// True if no vertex, edge or face that must stay is inside the cavity.
    fn keeps(&self, tets: &[u32], walls: &[u32]) -> bool {
        let faces: Vec<[u32; 3]> = walls.iter().map(|&half| self.s.c.face(half)).collect();
        let corners: FxHashSet<u32> = faces.iter().flatten().copied().collect();
        let edges: FxHashSet<[u32; 2]> = faces.iter().flat_map(|&f| sides(f)).collect();
        let inside: FxHashSet<u32> = tets.iter().copied().collect();
        tets.iter().all(|&t| {
            let v = self.s.c.verts(t);
            // Free vertices may be removed.
            let stays = |x: u32| (x as usize) < self.points || self.s.is_implicit(x);
            let frozen = |half| self.s.c.is_frozen(half) && inside.contains(&(self.s.c.mate(half) >> 2));
            v.iter().all(|&x| !stays(x) || corners.contains(&x))
                && !(4 * t..4 * t + 4).any(frozen)
                && (0..4).all(|i| (0..i).all(|j| edges.contains(&sorted(v[i], v[j])) || !(self.keep)(v[i], v[j])))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_view_is_limited_by_the_nearest_faces() {
        let of = |walls: &[(u32, Sight)]| VisibleFaces::of(walls.iter().copied());
        let clear = of(&[(3, Sight::Everywhere)]);
        assert_eq!((clear.low, clear.high, clear.blind), ((0, u32::MAX), (OnTriangle::ONE, u32::MAX), None));
        let walls = [
            (1, Sight::Before(900)),
            (2, Sight::Before(800)),
            (3, Sight::Before(800)),
            (4, Sight::Behind(90)),
            (5, Sight::Behind(100)),
            (6, Sight::Behind(100)),
            (7, Sight::Behind(20)),
            (8, Sight::Before(850)),
        ];
        let view = of(&walls);
        assert_eq!((view.low, view.high, view.blind, view.width()), ((100, 6), (800, 2), None, 700));
        assert_eq!(of(&[(1, Sight::Before(5)), (2, Sight::Behind(8))]).width(), -3);
        let blind = of(&[walls[0], (9, Sight::Nowhere)]);
        assert_eq!((blind.blind, blind.width()), (Some(9), i128::MIN));
    }

    #[test]
    fn the_middle_of_a_view_has_few_bits() {
        let middle = |low, high| VisibleFaces { low: (low, 0), high: (high, 0), blind: None }.middle();
        // Steps of 1/16 of the leading bit of the length.
        assert_eq!(middle(100, 800), 448);
        assert_eq!(middle(1000, 1015), 1007);
        assert_eq!(middle(1000, 1032), 1016);
        assert_eq!(middle(1001, 1033), 1016);
        assert_eq!(middle(7, 7), 7);
        assert_eq!(middle(0, OnTriangle::ONE), OnTriangle::ONE / 2);
    }
}

//! Polygons in the plane of a facet.

use super::space::Space;
use crate::error::{Obstacle, Stuck, TetError};
use anastomesh_mesh::geometry::implicit::{self, Site};
use anastomesh_mesh::geometry::{Point3, Vec3};
use std::cmp::Reverse;
use std::collections::BTreeSet;

/// Point off the plane of a triangle that sees it counter-clockwise.
pub(super) fn point_above(s: &Space, triangle: [u32; 3]) -> Result<Point3, TetError> {
    let [a, b, c] = triangle.map(|v| *s.point(v));
    let size = (b - a).norm().max((c - a).norm());
    let normal = (b - a).cross(&(c - a));
    let unit = normal.try_normalize(0.0).unwrap_or(Vec3::zeros());
    let mut directions = vec![unit];
    for axis in [Vec3::x(), Vec3::y(), Vec3::z()] {
        directions.extend([axis, -axis]);
    }
    let above = directions.iter().map(|d| a + d * size).find(|p| s.orient_to(triangle, p) > 0);
    above.ok_or(TetError::Stuck { part: Obstacle::Triangle(triangle), reason: Stuck::Precision })
}

/// Triangulates a simple polygon in the plane below `above` by ear clipping, best-shaped ears first. The polygon is
/// counter-clockwise from there and may have flat corners. Returns false if it is not simple.
pub(super) fn triangulate(s: &Space, polygon: &[u32], above: &Point3, out: &mut Vec<[u32; 3]>) -> bool {
    out.clear();
    if polygon.len() < 3 {
        return false;
    }
    let mut rest = Ears::new(s, polygon, above);
    for _ in 3..polygon.len() {
        let Some(k) = rest.next_ear() else { return false };
        out.push(rest.corner(k));
        rest.cut(k);
    }
    let Some(k) = (0..polygon.len()).find(|&k| rest.turn[k].is_some()) else { return false };
    out.push(rest.corner(k));
    rest.turn[k] == Some(1)
}

/// Remaining polygon.
struct Ears<'a> {
    s: &'a Space,
    polygon: &'a [u32],
    above: Site<'a>,
    before: Vec<usize>,
    after: Vec<usize>,
    /// Orientation of each remaining corner.
    turn: Vec<Option<i32>>,
    /// Convex corners, best-shaped first.
    convex: BTreeSet<(Reverse<u64>, usize)>,
    /// A corner inside the triangle of each corner, if found. As long as it remains, the first is no ear.
    inside: Vec<Option<usize>>,
}

impl<'a> Ears<'a> {
    fn new(s: &'a Space, polygon: &'a [u32], above: &'a Point3) -> Self {
        let n = polygon.len();
        let (before, after) = ((0..n).map(|k| (k + n - 1) % n).collect(), (0..n).map(|k| (k + 1) % n).collect());
        let above = Site { at: above, on: None };
        let mut ears = Self {
            s,
            polygon,
            above,
            before,
            after,
            turn: vec![None; n],
            convex: BTreeSet::new(),
            inside: vec![None; n],
        };
        (0..n).for_each(|k| ears.look(k));
        ears
    }

    fn corner(&self, k: usize) -> [u32; 3] {
        [self.before[k], k, self.after[k]].map(|k| self.polygon[k])
    }

    fn turn_of(&self, [p, q, r]: [u32; 3]) -> i32 {
        implicit::orient3d([self.s.site(p), self.s.site(q), self.s.site(r), self.above])
    }

    /// Shapes are non-negative, so their bits sort like the values.
    fn key(&self, k: usize) -> (Reverse<u64>, usize) {
        (Reverse(shape(self.s, self.corner(k)).to_bits()), k)
    }

    fn look(&mut self, k: usize) {
        let turn = self.turn_of(self.corner(k));
        self.turn[k] = Some(turn);
        self.inside[k] = None;
        if turn > 0 {
            self.convex.insert(self.key(k));
        }
    }

    /// Best-shaped corner whose triangle contains no other corner. If it contains any, it contains a corner that is not
    /// convex, so only those are tested.
    fn next_ear(&mut self) -> Option<usize> {
        let is_blunt = |turn: Option<i32>| turn.is_some_and(|t| t <= 0);
        let mut blunt: Option<Vec<usize>> = None;
        let mut ear = None;
        for &(_, k) in &self.convex {
            if self.inside[k].is_some_and(|w| is_blunt(self.turn[w])) {
                continue;
            }
            let blunt = blunt.get_or_insert_with(|| (0..self.turn.len()).filter(|&w| is_blunt(self.turn[w])).collect());
            let [p, q, r] = self.corner(k);
            let within = |w: u32| {
                ![p, q, r].contains(&w) && [[r, p, w], [p, q, w], [q, r, w]].into_iter().all(|t| self.turn_of(t) >= 0)
            };
            self.inside[k] = blunt.iter().copied().find(|&w| within(self.polygon[w]));
            if self.inside[k].is_none() {
                ear = Some(k);
                break;
            }
        }
        ear
    }

    fn cut(&mut self, k: usize) {
        let (before, after) = (self.before[k], self.after[k]);
        for k in [before, k, after] {
            self.convex.remove(&self.key(k));
        }
        self.turn[k] = None;
        (self.after[before], self.before[after]) = (after, before);
        self.look(before);
        self.look(after);
    }
}

/// Shape heuristic: area over the squared longest side.
fn shape(s: &Space, corners: [u32; 3]) -> f64 {
    let [p, q, r] = corners.map(|v| s.point(v));
    let longest = (q - p).norm_squared().max((r - q).norm_squared()).max((p - r).norm_squared());
    (q - p).cross(&(r - p)).norm() / longest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_point_above_is_as_far_as_the_longer_side() {
        let s = Space::of_points([[1.0, 1.0, 0.0], [4.0, 1.0, 0.0], [1.0, 5.0, 0.0], [7.0, 1.0, 0.0]]);
        let above = |t: [u32; 3]| point_above(&s, t).unwrap();
        assert_eq!(above([0, 1, 2]), Point3::new(1.0, 1.0, 4.0));
        assert_eq!(above([0, 2, 1]), Point3::new(1.0, 1.0, -4.0));
        assert_eq!(above([1, 2, 0]), Point3::new(4.0, 1.0, 5.0));
        let line = TetError::Stuck { part: Obstacle::Triangle([0, 1, 3]), reason: Stuck::Precision };
        assert_eq!(point_above(&s, [0, 1, 3]), Err(line));
    }

    /// Triangles of a polygon of points in the plane, seen from above.
    fn cut<const N: usize>(points: [[f64; 2]; N]) -> Option<Vec<[u32; 3]>> {
        let s = Space::of_points(points.map(|[x, y]| [x, y, 0.0]));
        let (polygon, mut out) = ((0..N as u32).collect::<Vec<_>>(), vec![[9; 3]]);
        triangulate(&s, &polygon, &Point3::new(0.5, 0.5, 3.0), &mut out).then_some(out)
    }

    /// Triangles that begin with their smallest vertex.
    fn rotated(triangles: Option<Vec<[u32; 3]>>) -> Vec<[u32; 3]> {
        let smallest = |t: [u32; 3]| (0..3).min_by_key(|&i| t[i]).unwrap();
        let rotate = |t: [u32; 3]| [0, 1, 2].map(|i| t[(smallest(t) + i) % 3]);
        let mut all: Vec<[u32; 3]> = triangles.unwrap().into_iter().map(rotate).collect();
        all.sort_unstable();
        all
    }

    #[test]
    fn the_best_ears_are_cut_first() {
        let kite = cut([[0.0, 0.0], [1.0, -1.0], [4.0, 0.0], [1.0, 1.0]]);
        assert_eq!(kite, Some(vec![[1, 2, 3], [3, 0, 1]]));
        assert_eq!(cut([[0.0, 0.0], [2.0, 0.0], [0.0, 2.0]]), Some(vec![[2, 0, 1]]));
    }

    #[test]
    fn ears_contain_no_other_corner() {
        // The two sharp corners of an arrow are its only ears.
        let arrow = cut([[0.0, 0.0], [4.0, -1.0], [0.2, 0.1], [1.0, 4.0]]);
        assert_eq!(rotated(arrow), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn flat_corners_are_no_ears() {
        let flat = cut([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 2.0]]);
        assert_eq!(rotated(flat), [[0, 1, 3], [1, 2, 3]]);
        assert_eq!(cut([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]), None);
    }

    #[test]
    fn polygons_that_are_not_simple_are_refused() {
        assert_eq!(cut([[0.0, 0.0], [2.0, 0.0]]), None);
        assert_eq!(cut([[0.0, 0.0], [0.0, 2.0], [2.0, 0.0]]), None);
        assert_eq!(cut([[0.0, 0.0], [0.0, 2.0], [2.0, 2.0], [2.0, 0.0]]), None);
        assert_eq!(cut([[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]]), None);
    }

    #[test]
    fn shape_is_the_area_over_the_squared_longest_side() {
        let s = Space::of_points([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0]]);
        assert_eq!([[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1]].map(|t| shape(&s, t)), [12.0 / 25.0; 4]);
    }
}

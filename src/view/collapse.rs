//! Surface simplification by edge collapse, in order of least error.

use super::quadric::{Quadric, relative};
use anastomesh_mesh::geometry::{Point3, Vec3};
use rustc_hash::FxHashMap;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Above this multiple of the target triangle count, edges are collapsed without comparison.
const MANY: usize = 6;

/// Surface during simplification.
pub struct Collapse {
    points: Vec<Point3>,
    /// Error quadric of each point.
    quadrics: Vec<Quadric>,
    /// Points that must not move.
    fixed: Vec<bool>,
    /// Version of each point: a move makes older candidates stale.
    moves: Vec<u32>,
    triangles: Vec<Option<[u32; 3]>>,
    /// Triangles of each point, including removed ones.
    around: Vec<Vec<u32>>,
    left: usize,
    centre: Point3,
}

/// Collapse candidate: cost (bits of a non-negative number), ends, and their versions.
type Candidate = Reverse<(u64, [u32; 2], [u32; 2])>;

impl Collapse {
    /// Creates the simplification of a surface with `fixed` points.
    pub fn new(points: Vec<Point3>, triangles: Vec<[u32; 3]>, fixed: Vec<bool>) -> Self {
        let centre = points.first().copied().unwrap_or_else(Point3::origin);
        let mut quadrics = vec![Quadric::default(); points.len()];
        // Preallocated, as vectors would otherwise grow one by one.
        let mut valences = vec![0; points.len()];
        triangles.as_flattened().iter().for_each(|&v| valences[v as usize] += 1);
        let mut around: Vec<Vec<u32>> = valences.into_iter().map(Vec::with_capacity).collect();
        for (i, t) in (0..).zip(&triangles) {
            let [a, b, c] = t.map(|v| points[v as usize]);
            let area = (b - a).cross(&(c - a));
            for v in t {
                around[*v as usize].push(i);
            }
            if let Some(normal) = area.try_normalize(0.0) {
                let plane = Quadric::plane(&normal, &relative(&a, &centre), area.norm());
                for v in t {
                    quadrics[*v as usize] += plane;
                }
            }
        }
        let (left, moves) = (triangles.len(), vec![0; points.len()]);
        Self {
            points,
            quadrics,
            fixed,
            moves,
            triangles: triangles.into_iter().map(Some).collect(),
            around,
            left,
            centre,
        }
    }

    /// Collapses edges down to the target triangle count or until none is allowed. Returns points and triangles.
    pub fn run(mut self, target: usize) -> (Vec<Point3>, Vec<[u32; 3]>) {
        self.thin(MANY * target);
        // Edges with two opposite half-edges; those with one belong to rings and stay.
        let edges = self.triangles.iter().flatten().flat_map(|t| sides(*t)).filter(|[a, b]| a < b);
        let mut heap: BinaryHeap<Candidate> = edges.filter_map(|edge| self.candidate(edge)).collect();
        let mut near = [Vec::new(), Vec::new()];
        while self.left > target
            && let Some(Reverse((_, edge, moves))) = heap.pop()
        {
            if edge.map(|v| self.moves[v as usize]) != moves {
                continue;
            }
            let place = self.place(edge);
            if self.may_go(edge, &place, &mut near) {
                self.merge(edge, place);
                self.neighbours(edge[0], &mut near[0]);
                let beside = near[0].iter().map(|&v| [v.min(edge[0]), v.max(edge[0])]);
                heap.extend(beside.filter_map(|edge| self.candidate(edge)));
            }
        }
        self.done()
    }

    /// Reduces the largest surfaces without comparing errors: one edge per point in a sweep.
    fn thin(&mut self, target: usize) {
        let mut near = [Vec::new(), Vec::new()];
        let mut before = usize::MAX;
        let mut sweep = 0;
        while self.left > target && self.left < before {
            before = self.left;
            sweep += 1;
            for i in 0..self.triangles.len() {
                let Some([a, b, c]) = self.triangles[i] else { continue };
                let is_new = |v: u32| self.moves[v as usize] < sweep;
                let all = [[a, b], [b, c], [c, a]];
                let Some(edge) = all.into_iter().find(|edge| edge.iter().all(|&v| is_new(v))) else { continue };
                if edge.iter().all(|&v| self.fixed[v as usize]) {
                    continue;
                }
                let place = self.place(edge);
                if self.may_go(edge, &place, &mut near) {
                    self.merge(edge, place);
                    self.moves[edge[0] as usize] = sweep;
                }
                if self.left <= target {
                    break;
                }
            }
        }
    }

    /// Candidate of an edge; `None` if the edge is fixed.
    fn candidate(&self, edge: [u32; 2]) -> Option<Candidate> {
        if edge.iter().all(|&v| self.fixed[v as usize]) {
            return None;
        }
        let cost = self.cost(edge, &self.place(edge));
        Some(Reverse((cost.to_bits(), edge, edge.map(|v| self.moves[v as usize]))))
    }

    fn sum([a, b]: [u32; 2], quadrics: &[Quadric]) -> Quadric {
        let mut sum = quadrics[a as usize];
        sum += quadrics[b as usize];
        sum
    }

    fn cost(&self, edge: [u32; 2], place: &Point3) -> f64 {
        let [a, b] = edge.map(|v| self.points[v as usize]);
        // Among lossless collapses, short edges go first.
        Self::sum(edge, &self.quadrics).at(&relative(place, &self.centre)) + 1e-6 * (b - a).norm_squared().powi(2)
    }

    /// Position of the point that replaces an edge.
    fn place(&self, edge: [u32; 2]) -> Point3 {
        let [a, b] = edge.map(|v| self.points[v as usize]);
        match edge.map(|v| self.fixed[v as usize]) {
            [true, _] => a,
            [_, true] => b,
            _ => {
                let middle = Point3::from((a.coords + b.coords) * 0.5);
                let least = Self::sum(edge, &self.quadrics).least().map(|v| self.centre + v);
                // Distant minima are rejected.
                least.filter(|p| (p - middle).norm() <= 2.0 * (b - a).norm()).unwrap_or(middle)
            }
        }
    }

    /// True if a collapse inverts no triangle and keeps the topology. `near` is a buffer for the ends' neighbours.
    fn may_go(&self, [a, b]: [u32; 2], place: &Point3, near: &mut [Vec<u32>; 2]) -> bool {
        let [of_a, of_b] = near;
        self.neighbours(a, of_a);
        self.neighbours(b, of_b);
        let shared = of_a.iter().filter(|v| of_b.contains(v)).count();
        let both = self.alive(a).filter(|(_, t)| t.contains(&b)).count();
        if shared != both || both == 0 {
            return false;
        }
        [a, b].into_iter().all(|v| {
            self.alive(v).filter(|(_, t)| !(t.contains(&a) && t.contains(&b))).all(|(_, t)| {
                let old = normal(t.map(|w| self.points[w as usize]));
                let new = normal(t.map(|w| if w == v { *place } else { self.points[w as usize] }));
                old.dot(&new) > 0.1 * old.norm() * new.norm()
            })
        })
    }

    /// Neighbours of a point; few, so linear search suffices.
    fn neighbours(&self, v: u32, near: &mut Vec<u32>) {
        near.clear();
        for w in self.alive(v).flat_map(|(_, t)| t).filter(|&w| w != v) {
            if !near.contains(&w) {
                near.push(w);
            }
        }
    }

    fn alive(&self, v: u32) -> impl Iterator<Item = (u32, [u32; 3])> {
        self.around[v as usize].iter().filter_map(|&t| Some((t, self.triangles[t as usize]?)))
    }

    /// Collapses an edge to a point.
    fn merge(&mut self, [a, b]: [u32; 2], place: Point3) {
        let of_b: Vec<(u32, [u32; 3])> = self.alive(b).collect();
        for (t, corners) in of_b {
            if corners.contains(&a) {
                self.triangles[t as usize] = None;
                self.left -= 1;
            } else {
                self.triangles[t as usize] = Some(corners.map(|v| if v == b { a } else { v }));
                self.around[a as usize].push(t);
            }
        }
        let merged = self.quadrics[b as usize];
        self.quadrics[a as usize] += merged;
        self.points[a as usize] = place;
        self.fixed[a as usize] |= self.fixed[b as usize];
        self.moves[a as usize] += 1;
        self.moves[b as usize] += 1;
        let (around, triangles) = (&mut self.around[a as usize], &self.triangles);
        around.retain(|&t| triangles[t as usize].is_some());
    }

    fn done(self) -> (Vec<Point3>, Vec<[u32; 3]>) {
        let mut numbers: FxHashMap<u32, u32> = FxHashMap::default();
        let mut points = Vec::new();
        let triangles = self.triangles.iter().flatten().map(|t| {
            t.map(|v| {
                *numbers.entry(v).or_insert_with(|| {
                    points.push(self.points[v as usize]);
                    points.len() as u32 - 1
                })
            })
        });
        let triangles = triangles.collect();
        (points, triangles)
    }
}

fn normal([a, b, c]: [Point3; 3]) -> Vec3 {
    (b - a).cross(&(c - a))
}

fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::rings::rings;
    use std::f64::consts::TAU;

    /// Tube of radius 1 along z, open at both ends.
    fn tube(sides: u32, steps: u32) -> (Vec<Point3>, Vec<[u32; 3]>) {
        let at = |i: u32, j: u32| j * sides + i % sides;
        let point = |n: u32| {
            let angle = TAU * f64::from(n % sides) / f64::from(sides);
            Point3::new(libm::cos(angle), libm::sin(angle), 0.4 * f64::from(n / sides))
        };
        let quad = |(i, j): (u32, u32)| {
            [[at(i, j), at(i + 1, j), at(i, j + 1)], [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]]
        };
        let cells = (0..steps).flat_map(|j| (0..sides).map(move |i| (i, j)));
        ((0..sides * (steps + 1)).map(point).collect(), cells.flat_map(quad).collect())
    }

    #[test]
    fn a_tube_stays_a_tube() {
        let (points, triangles) = tube(12, 30);
        let ends: Vec<bool> = (0..points.len()).map(|v| v < 12 || v >= points.len() - 12).collect();
        let before = triangles.len();
        let (points, triangles) = Collapse::new(points, triangles, ends).run(60);
        assert!(triangles.len() <= 60 && triangles.len() < before / 8, "{}", triangles.len());
        // Both rings are intact, and all points are near the cylinder.
        let rings = rings(&triangles);
        assert_eq!(rings.iter().map(Vec::len).collect::<Vec<_>>(), [12, 12]);
        let off = |p: &Point3| (libm::hypot(p.x, p.y) - 1.0).abs();
        assert!(points.iter().map(off).fold(0.0, f64::max) < 0.2);
    }
}

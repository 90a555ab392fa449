//! Cutting of segments: a missing edge becomes a chain of edges. The first face or edge that it crosses is removed with
//! the tetrahedra around it. A vertex on the segment that sees the whole cavity replaces them.

use super::dig::{Dig, Dug};
use super::parts::sorted;
use super::space::Space;
use crate::error::{Obstacle, Stuck, TetError};
use crate::input::SurfaceEdges;
use crate::progress::Watch;
use crate::star::EdgeRing;
use anastomesh_mesh::geometry::implicit::OnTriangle;
use rustc_hash::FxHashMap;

/// A missing input edge and its vertices, from the first end to the second.
#[derive(Clone, Debug)]
pub(super) struct Segment {
    pub ends: [u32; 2],
    pub chain: Vec<u32>,
}

/// Input edges, and the chains of those that were missing.
#[derive(Clone)]
pub(super) struct Segments<'a> {
    input: &'a SurfaceEdges,
    /// Number of input points.
    pub points: usize,
    pub list: Vec<Segment>,
    /// True if new vertices should lie well off all faces.
    pub deep: bool,
    /// Segment of each pair of ends, smaller vertex first.
    by_ends: FxHashMap<[u32; 2], u32>,
    /// Segment of each piece, smaller vertex first.
    pieces: FxHashMap<[u32; 2], u32>,
}

/// First crossing of a segment after its start.
enum FirstCrossing {
    Exists,
    Face(u32),
    Edge(u32, [u32; 2]),
    Vertex(u32),
    Nothing,
}

impl<'a> Segments<'a> {
    pub(super) fn new(input: &'a SurfaceEdges, points: usize) -> Self {
        Self {
            input,
            points,
            deep: true,
            list: Vec::new(),
            by_ends: FxHashMap::default(),
            pieces: FxHashMap::default(),
        }
    }

    /// Segment between two input points, if it was missing.
    pub(super) fn between(&self, a: u32, b: u32) -> Option<u32> {
        self.by_ends.get(&sorted(a, b)).copied()
    }

    /// Ends of the input edge that contains the edge `a, b`.
    pub(super) fn of_piece(&self, a: u32, b: u32) -> Option<[u32; 2]> {
        if self.input.contains(a, b) {
            return Some([a, b]);
        }
        self.pieces.get(&sorted(a, b)).map(|&i| self.list[i as usize].ends)
    }

    /// Removes a segment from the maps. Returns its chain.
    pub(super) fn forget(&mut self, id: u32) -> Vec<u32> {
        let Segment { ends, chain } = self.list[id as usize].clone();
        self.by_ends.remove(&sorted(ends[0], ends[1]));
        for piece in chain.windows(2) {
            self.pieces.remove(&sorted(piece[0], piece[1]));
        }
        chain
    }

    /// Forgets all segments.
    pub(super) fn clear(&mut self) {
        self.list.clear();
        self.by_ends.clear();
        self.pieces.clear();
    }

    /// Directed sides of a facet, or the pieces of their chains, with the facet to the left.
    pub(super) fn outline(&self, [a, b, c]: [u32; 3]) -> Vec<[u32; 2]> {
        let mut edges = Vec::new();
        for (p, q) in [(a, b), (b, c), (c, a)] {
            let Some(i) = self.between(p, q) else {
                edges.push([p, q]);
                continue;
            };
            let segment = &self.list[i as usize];
            let pairs = segment.chain.windows(2);
            if segment.ends[0] == p {
                edges.extend(pairs.map(|e| [e[0], e[1]]));
            } else {
                edges.extend(pairs.rev().map(|e| [e[1], e[0]]));
            }
        }
        edges
    }

    /// Turns a missing edge into a chain, and counts the work. Returns its index in the list.
    pub(super) fn cut(&mut self, s: &mut Space, ends: [u32; 2], watch: &Watch) -> Result<u32, TetError> {
        let id = self.list.len() as u32;
        self.by_ends.insert(sorted(ends[0], ends[1]), id);
        self.list.push(Segment { ends, chain: vec![ends[0]] });
        let mut at = ends[0];
        while at != ends[1] {
            watch.spend(s.take_work())?;
            let next = self.step(s, at, ends)?.unwrap_or(ends[1]);
            // Register now, so that later steps do not remove the piece.
            self.pieces.insert(sorted(at, next), id);
            self.list[id as usize].chain.push(next);
            at = next;
        }
        Ok(id)
    }

    /// Nearest edge of a face that a segment passes within the flatness tolerance, unless the edge must stay.
    fn grazed(&self, s: &Space, half: u32, ends: [u32; 2]) -> Option<[u32; 2]> {
        let [p, q] = ends.map(|v| s.point(v).coords);
        let f = s.c.face(half);
        let distance = |[u, v]: [u32; 2]| {
            let (a, b) = (s.point(u).coords, s.point(v).coords);
            let across = (q - p).cross(&(b - a));
            across.dot(&(a - p)).abs() / across.norm().max(f64::MIN_POSITIVE)
        };
        let sides = (0..3).map(|i| [f[i], f[(i + 1) % 3]]);
        let (near, edge) = sides.map(|e| (distance(e), e)).min_by(|x, y| x.0.total_cmp(&y.0))?;
        (near < s.flat && self.of_piece(edge[0], edge[1]).is_none()).then_some(edge)
    }

    /// Advances from vertex `at` to the next vertex on the segment, inserting it if needed. Returns `None` at the last
    /// piece.
    fn step(&self, s: &mut Space, at: u32, ends: [u32; 2]) -> Result<Option<u32>, TetError> {
        let meets = |obstacle| TetError::EdgeMeets { edge: ends, obstacle };
        let first = match first_crossing(s, at, ends) {
            FirstCrossing::Exists => return Ok(None),
            FirstCrossing::Vertex(v) if (v as usize) < self.points => return Err(meets(Obstacle::Point(v))),
            FirstCrossing::Vertex(v) => return Ok(Some(v)),
            FirstCrossing::Nothing => return Err(stuck(ends, Stuck::Intersection)),
            FirstCrossing::Face(half) if s.c.is_frozen(half) => return Err(meets(Obstacle::Triangle(s.c.face(half)))),
            FirstCrossing::Face(half) => {
                let grazed = self.grazed(s, half, ends).filter(|_| self.deep).map(|edge| ring(s, half >> 2, edge));
                let pair = vec![half >> 2, s.c.mate(half) >> 2];
                grazed.into_iter().chain([pair]).collect()
            }
            FirstCrossing::Edge(t, [p, q]) => {
                if let Some(other) = self.of_piece(p, q) {
                    return Err(meets(Obstacle::Edge(other)));
                }
                vec![ring(s, t, [p, q])]
            }
        };
        let inside = |tets: &Vec<u32>| !tets.iter().any(|&t| s.c.is_ghost(t));
        let first: Vec<Vec<u32>> = first.into_iter().filter(inside).collect();
        if first.is_empty() {
            return Err(stuck(ends, Stuck::Intersection));
        }
        let keep = |a, b| self.of_piece(a, b).is_some();
        let mut dig = Dig::new(s, self.points, &keep, at, ends);
        let (cavity, weight) = match first.into_iter().find_map(|first| dig.dig(first, self.deep)) {
            Some(Dug::Joins(cavity)) => {
                let walls = s.walls(&cavity);
                return if s.join(&cavity, &walls, at) { Ok(None) } else { Err(stuck(ends, Stuck::Intersection)) };
            }
            Some(Dug::Place(cavity, weight)) => (cavity, weight),
            None => return Err(stuck(ends, Stuck::Precision)),
        };
        let walls = s.walls(&cavity);
        let corners = ends.map(|v| *s.point(v));
        let made = s.insert(&cavity, &walls, OnTriangle::on_segment(corners, weight));
        made.map(Some).ok_or(stuck(ends, Stuck::Precision))
    }
}

/// Tetrahedra around an edge of a tetrahedron.
fn ring(s: &Space, t: u32, [p, q]: [u32; 2]) -> Vec<u32> {
    let mut ring = EdgeRing::default();
    ring.collect(&s.c, t, p, q, usize::MAX);
    ring.tets
}

pub(super) fn stuck(edge: [u32; 2], reason: Stuck) -> TetError {
    TetError::Stuck { part: Obstacle::Edge(edge), reason }
}

/// First crossing of the segment `p, q` beyond its vertex `a`.
fn first_crossing(s: &mut Space, a: u32, [p, q]: [u32; 2]) -> FirstCrossing {
    let tets = s.star(a);
    if tets.iter().any(|&t| s.c.slot_of(t, q).is_some()) {
        return FirstCrossing::Exists;
    }
    for &t in &tets {
        let Some(i) = s.c.slot_of(t, a) else { continue };
        if s.c.is_ghost(t) {
            continue;
        }
        let half = 4 * t + i as u32;
        let f = s.c.face(half);
        let mut sides = [0; 3];
        let inside = (0..3).all(|k| {
            sides[k] = s.orient([p, q, f[(k + 1) % 3], f[(k + 2) % 3]]);
            sides[k] >= 0
        });
        if !inside {
            continue;
        }
        // The opposite cone has all signs reversed, so the direction matters only if two signs are zero.
        let zeros: Vec<usize> = (0..3).filter(|&k| sides[k] == 0).collect();
        match zeros[..] {
            [] => return FirstCrossing::Face(half),
            [k] => return FirstCrossing::Edge(t, [f[(k + 1) % 3], f[(k + 2) % 3]]),
            [k, l] => {
                let v = f[3 - k - l];
                if s.compare(v, a) == s.compare(q, a) {
                    return FirstCrossing::Vertex(v);
                }
            }
            _ => {}
        }
    }
    FirstCrossing::Nothing
}

//! Covering of facets: a missing triangle with chains as sides becomes a union of faces. A front advances from the
//! sides. Behind each front edge lies a face in the facet, or an edge that pierces the facet. A vertex in the facet
//! replaces such an edge with the tetrahedra around it.

use super::segments::Segments;
use super::space::Space;
use crate::error::{Obstacle, Stuck, TetError};
use crate::progress::Watch;
use anastomesh_mesh::geometry::implicit::{self, OnTriangle};
use rustc_hash::FxHashSet;

/// Low bits of a weight to drop if the vertex then still lies inside its cavity.
const SHORT: u32 = 80;

/// A facet that was missing.
pub(super) struct Cover {
    /// Faces of the facet, with its orientation.
    pub pieces: Vec<[u32; 3]>,
    /// Vertices inside the facet.
    pub inner: Vec<u32>,
}

/// Turns a missing triangle, whose sides exist as edges or chains, into a union of frozen faces. Counts the work.
pub(super) fn cover(s: &mut Space, segments: &Segments, triangle: [u32; 3], watch: &Watch) -> Result<Cover, TetError> {
    let edges = segments.outline(triangle);
    let open = edges.iter().copied().collect();
    Front { s, segments, triangle, edges, open }.cover(watch)
}

fn stuck(triangle: [u32; 3], reason: Stuck) -> TetError {
    TetError::Stuck { part: Obstacle::Triangle(triangle), reason }
}

/// Next part of a facet behind a front edge.
enum Behind {
    /// Third vertex of a face.
    Face(u32),
    /// An edge that pierces the facet.
    Edge([u32; 2]),
}

struct Front<'a> {
    s: &'a mut Space,
    segments: &'a Segments<'a>,
    triangle: [u32; 3],
    /// Stack of directed edges with the uncovered part to their left; may contain covered ones.
    edges: Vec<[u32; 2]>,
    /// Front edges not yet covered.
    open: FxHashSet<[u32; 2]>,
}

impl Front<'_> {
    fn cover(&mut self, watch: &Watch) -> Result<Cover, TetError> {
        let intersection = stuck(self.triangle, Stuck::Intersection);
        let mut known: FxHashSet<u32> = self.edges.iter().map(|e| e[0]).collect();
        let mut cover = Cover { pieces: Vec::new(), inner: Vec::new() };
        while let Some([a, b]) = self.edges.pop() {
            if !self.open.contains(&[a, b]) {
                continue;
            }
            watch.spend(self.s.take_work())?;
            let apex = match self.behind([a, b]).ok_or_else(|| intersection.clone())? {
                Behind::Face(v) => v,
                Behind::Edge(edge) => self.pierce(edge)?,
            };
            if known.insert(apex) {
                cover.inner.push(apex);
            }
            let half = self.s.find_face([a, b, apex]).ok_or_else(|| intersection.clone())?;
            self.s.c.freeze(half);
            cover.pieces.push([a, b, apex]);
            self.advance([a, b], apex);
        }
        Ok(cover)
    }

    /// Advances the front over the face behind an edge.
    fn advance(&mut self, [a, b]: [u32; 2], apex: u32) {
        self.open.remove(&[a, b]);
        for [p, q] in [[b, apex], [apex, a]] {
            if !self.open.remove(&[p, q]) {
                self.open.insert([q, p]);
                self.edges.push([q, p]);
            }
        }
    }

    /// Finds the face or piercing edge to the left of a front edge.
    fn behind(&mut self, [a, b]: [u32; 2]) -> Option<Behind> {
        let ring = self.s.ring(a, b)?;
        let [x, y, z] = self.triangle;
        let side: Vec<i32> = ring.rim.iter().map(|&v| self.s.orient([x, y, z, v])).collect();
        let n = ring.len();
        // The left half of the facet's plane lies where the sign rises around the edge.
        (0..n).find_map(|i| {
            let (before, here, after) = (side[(i + n - 1) % n], side[i], side[(i + 1) % n]);
            match (before, here, after) {
                (_, -1, 1) => Some(Behind::Edge([ring.rim[i], ring.rim[(i + 1) % n]])),
                (-1, 0, 1) => Some(Behind::Face(ring.rim[i])),
                _ => None,
            }
        })
    }

    /// Inserts a vertex where edge `u, v` pierces the facet.
    fn pierce(&mut self, [u, v]: [u32; 2]) -> Result<u32, TetError> {
        let triangle = self.triangle;
        if let Some(edge) = self.segments.of_piece(u, v) {
            return Err(TetError::EdgeMeets { edge, obstacle: Obstacle::Triangle(triangle) });
        }
        let ring = self.s.ring(u, v).ok_or(stuck(triangle, Stuck::Intersection))?;
        if !(0..ring.len()).all(|i| ring.spoke(&self.s.c, i).is_some_and(|half| !self.s.c.is_frozen(half))) {
            return Err(stuck(triangle, Stuck::Intersection));
        }
        let weights = implicit::crossing(triangle.map(|x| self.s.site(x)), [self.s.site(u), self.s.site(v)]);
        let weights = weights.ok_or(stuck(triangle, Stuck::Precision))?;
        let corners = triangle.map(|x| *self.s.point(x));
        let walls = self.s.walls(&ring.tets);
        // Fewer bits shorten exact arithmetic; the vertex need only be near the crossing.
        let made = [SHORT, 0].into_iter().find_map(|bits| {
            let weights = weights.map(|w| (w >> bits) << bits);
            let inside = weights.iter().all(|&w| w > 0);
            inside.then(|| self.s.insert(&ring.tets, &walls, OnTriangle { corners, weights })).flatten()
        });
        made.ok_or(stuck(triangle, Stuck::Precision))
    }
}

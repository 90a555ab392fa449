//! Facets: a missing triangle whose sides are chains of edges becomes a union of faces. A front moves inwards from the
//! sides: behind an edge of it there is either a face in the facet, or an edge that pierces the facet. That one goes
//! together with the tetrahedra around it, and a vertex in the facet takes its place.

use super::segments::Segments;
use super::space::Space;
use crate::error::{Obstacle, Stuck, TetError};
use anastomesh_mesh::geometry::implicit::{self, OnTriangle};
use rustc_hash::FxHashSet;

/// Bits of a weight that are left out if that leaves a vertex inside of its cavity.
const SHORT: u32 = 80;

/// A facet that was missing.
pub(super) struct Cover {
    /// The faces that it consists of, counter-clockwise as the facet is.
    pub pieces: Vec<[u32; 3]>,
    /// Vertices inside of it.
    pub inner: Vec<u32>,
}

/// Makes a union of faces of a missing triangle all of whose sides are chains or edges, and freezes it.
pub(super) fn cover(s: &mut Space, segments: &Segments, triangle: [u32; 3]) -> Result<Cover, TetError> {
    let edges = segments.outline(triangle);
    let open = edges.iter().copied().collect();
    Front { s, segments, triangle, edges, open }.cover()
}

fn stuck(triangle: [u32; 3], reason: Stuck) -> TetError {
    TetError::Stuck { part: Obstacle::Triangle(triangle), reason }
}

/// What lies in a facet behind an edge of the front.
enum Behind {
    /// A face, by its third vertex.
    Face(u32),
    /// An edge that pierces the facet.
    Edge([u32; 2]),
}

struct Front<'a> {
    s: &'a mut Space,
    segments: &'a Segments<'a>,
    triangle: [u32; 3],
    /// Directed edges, the facet's uncovered part to their left; some may be covered meanwhile.
    edges: Vec<[u32; 2]>,
    /// Those that are not.
    open: FxHashSet<[u32; 2]>,
}

impl Front<'_> {
    fn cover(&mut self) -> Result<Cover, TetError> {
        let intersection = stuck(self.triangle, Stuck::Intersection);
        let mut known: FxHashSet<u32> = self.edges.iter().map(|e| e[0]).collect();
        let mut cover = Cover { pieces: Vec::new(), inner: Vec::new() };
        while let Some([a, b]) = self.edges.pop() {
            if !self.open.contains(&[a, b]) {
                continue;
            }
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

    /// Moves the front over a face behind an edge.
    fn advance(&mut self, [a, b]: [u32; 2], apex: u32) {
        self.open.remove(&[a, b]);
        for [p, q] in [[b, apex], [apex, a]] {
            if !self.open.remove(&[p, q]) {
                self.open.insert([q, p]);
                self.edges.push([q, p]);
            }
        }
    }

    /// What the facet meets to the left of an edge that lies in it.
    fn behind(&mut self, [a, b]: [u32; 2]) -> Option<Behind> {
        let ring = self.s.ring(a, b)?;
        let [x, y, z] = self.triangle;
        let side: Vec<i32> = ring.rim.iter().map(|&v| self.s.orient([x, y, z, v])).collect();
        let n = ring.len();
        // Around the edge, the left half of the facet's plane lies where the sign goes up.
        (0..n).find_map(|i| {
            let (before, here, after) = (side[(i + n - 1) % n], side[i], side[(i + 1) % n]);
            match (before, here, after) {
                (_, -1, 1) => Some(Behind::Edge([ring.rim[i], ring.rim[(i + 1) % n]])),
                (-1, 0, 1) => Some(Behind::Face(ring.rim[i])),
                _ => None,
            }
        })
    }

    /// Puts a vertex where edge `u, v` pierces the facet.
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
        // Fewer bits make exact arithmetic short; the place need only be near the crossing.
        let made = [SHORT, 0].into_iter().find_map(|bits| {
            let weights = weights.map(|w| (w >> bits) << bits);
            let inside = weights.iter().all(|&w| w > 0);
            inside.then(|| self.s.insert(&ring.tets, &walls, OnTriangle { corners, weights })).flatten()
        });
        made.ok_or(stuck(triangle, Stuck::Precision))
    }
}

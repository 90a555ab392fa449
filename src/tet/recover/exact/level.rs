//! Edges among faces that lie in one plane but for rounding: as in the plane, each edge in their way is exchanged for the
//! other diagonal of its quadrilateral (Sloan, 'A fast algorithm for generating constrained Delaunay triangulations',
//! 1993). In space that takes the ring around the edge apart: its two halves, above and below the quadrilateral, are
//! joined each to a vertex that sees all of it, one of its corners or a new one well off the plane. Nothing is put
//! between points that lie in the plane, where there is no room.

use super::LEVELS;
use super::plane::{Plane, breadth};
use super::room::{Apex, Room};
use super::space::Space;
use crate::geometry::Point3;
use crate::tet::input::SurfaceEdges;
use crate::tet::recover::rule::least_height;
use crate::tet::star::EdgeRing;
use std::collections::VecDeque;

/// Edges in the way of one, at most.
const FAR: usize = 4096;

/// Exchanges for one edge, over the number of edges in its way and on top of it.
const WORK: (usize, usize) = (16, 64);

/// An edge that is in the way, and the vertices across from it on both sides in the plane.
#[derive(Clone, Copy)]
struct Diagonal {
    edge: [u32; 2],
    across: [u32; 2],
}

/// Puts edges into planes of faces.
pub(super) struct Level<'a> {
    pub s: &'a mut Space,
    pub keep: &'a SurfaceEdges,
    /// New vertices that lie on nothing.
    pub made: Vec<u32>,
    /// New vertices in planes.
    pub inside: Vec<(u32, Plane)>,
}

impl Level<'_> {
    /// Makes an edge if it lies in the plane of one of its facets and that is one of faces. What has changed when this
    /// does not succeed is as good as before.
    pub(super) fn insert(&mut self, [a, b]: [u32; 2], facets: &[[u32; 3]]) -> bool {
        let mut facets: Vec<(f64, [u32; 3])> = facets.iter().map(|&f| (breadth(self.s, f), f)).collect();
        facets.sort_by(|x, y| y.0.total_cmp(&x.0));
        self.s.has_edge(a, b)
            || facets.into_iter().any(|(_, facet)| {
                let plane = Plane::of(self.s, facet);
                let course = self.course([a, b], &plane).or_else(|| self.course([b, a], &plane));
                course.is_some_and(|course| self.turn([a, b], course, &plane))
            })
    }

    /// Exchanges the edges that cross one, as far as they come loose.
    fn turn(&mut self, [a, b]: [u32; 2], mut waiting: VecDeque<[u32; 2]>, plane: &Plane) -> bool {
        let mut work = WORK.0 * waiting.len() + WORK.1;
        let mut refused = 0;
        while let Some(edge) = waiting.pop_front() {
            if work == 0 || refused > waiting.len() {
                return false;
            }
            work -= 1;
            let flat = self.quadrilateral(edge, plane);
            let flipped = flat.filter(|q| self.convex(q, plane)).filter(|q| self.exchange(q));
            let Some(Diagonal { across: [x, y], .. }) = flipped else {
                refused += 1;
                waiting.push_back(edge);
                continue;
            };
            refused = 0;
            let ends = [a, b].contains(&x) || [a, b].contains(&y);
            if !ends && self.side([a, b], x, plane) * self.side([a, b], y, plane) < 0 {
                waiting.push_back([x, y]);
            }
        }
        self.s.has_edge(a, b)
    }

    /// On which side of an edge a vertex lies, seen from above: to its left is positive.
    fn side(&self, [a, b]: [u32; 2], v: u32, plane: &Plane) -> i32 {
        self.s.orient_to([a, b, v], &plane.above)
    }

    /// The edges that one crosses from its first end to its second, in a plane of faces.
    fn course(&mut self, [a, b]: [u32; 2], plane: &Plane) -> Option<VecDeque<[u32; 2]>> {
        let first = self.first([a, b], plane);
        let first = first.or_else(|| if self.pierce_before([a, b], plane) { self.first([a, b], plane) } else { None });
        // Always directed so that the end lies to its right.
        let mut edge = first?;
        let mut course = VecDeque::from([edge]);
        while course.len() < FAR {
            if self.keep.contains(edge[0], edge[1]) {
                return None;
            }
            let beyond = self.quadrilateral(edge, plane).map(|q| q.across[0]);
            let next = match beyond {
                Some(next) => next,
                None => self.pierce_beside(edge, true, plane)?,
            };
            if next == b {
                return Some(course);
            }
            match self.side([a, b], next, plane) {
                0 => return None,
                1 => edge[1] = next,
                _ => edge[0] = next,
            }
            course.push_back(edge);
        }
        None
    }

    /// The first edge that one crosses behind a face at its first end in a plane; from right to left.
    fn first(&mut self, [a, b]: [u32; 2], plane: &Plane) -> Option<[u32; 2]> {
        let mut best: Option<(f64, [u32; 2])> = None;
        for t in self.s.star(a) {
            for half in 4 * t..4 * t + 4 {
                let f = self.s.c.face(half);
                let Some(i) = f.iter().position(|&v| v == a) else { continue };
                if self.s.c.is_ghost(t) || self.s.c.is_frozen(half) {
                    continue;
                }
                let [p, q] = [f[(i + 1) % 3], f[(i + 2) % 3]];
                let height = least_height([a, p, q, b].map(|v| self.s.point(v)));
                let crosses = height < self.s.flat
                    && plane.has(self.s, p)
                    && plane.has(self.s, q)
                    && self.side([a, b], p, plane) < 0
                    && self.side([a, b], q, plane) > 0
                    && self.side([p, q], a, plane) > 0
                    && self.side([p, q], b, plane) < 0;
                if crosses && best.is_none_or(|x| height < x.0) {
                    best = Some((height, [p, q]));
                }
            }
        }
        best.map(|(_, edge)| edge)
    }

    /// The vertices across from an edge, to its right and to its left seen from above, that lie in one plane with it.
    fn quadrilateral(&mut self, edge: [u32; 2], plane: &Plane) -> Option<Diagonal> {
        let ring = self.s.ring(edge[0], edge[1])?;
        let side = |&v: &u32| if plane.has(self.s, v) { self.side(edge, v, plane) } else { 0 };
        let sides: Vec<i32> = ring.rim.iter().map(side).collect();
        let mut best: Option<(f64, [u32; 2])> = None;
        for (&x, _) in ring.rim.iter().zip(&sides).filter(|&(_, &side)| side < 0) {
            for (&y, _) in ring.rim.iter().zip(&sides).filter(|&(_, &side)| side > 0) {
                let height = least_height([edge[0], edge[1], x, y].map(|v| self.s.point(v)));
                if height < self.s.flat && best.is_none_or(|b| height < b.0) {
                    best = Some((height, [x, y]));
                }
            }
        }
        best.map(|(_, across)| Diagonal { edge, across })
    }

    fn convex(&self, &Diagonal { edge: [p, q], across }: &Diagonal, plane: &Plane) -> bool {
        self.side(across, p, plane) * self.side(across, q, plane) < 0
    }

    /// Exchanges an edge for the one across.
    fn exchange(&mut self, &Diagonal { edge: [p, q], across: [x, y] }: &Diagonal) -> bool {
        let Some(ring) = self.s.ring(p, q) else { return false };
        if (0..ring.len()).any(|i| ring.spoke(&self.s.c, i).is_none_or(|half| self.s.c.is_frozen(half))) {
            return false;
        }
        let Some(halves) = halves(&ring, [x, y]) else { return false };
        let middle = Point3::from((self.s.point(p).coords + self.s.point(q).coords) * 0.5);
        let [Some(first), Some(second)] = [&halves[0], &halves[1]].map(|faces| self.apex(middle, faces)) else {
            return false;
        };
        self.fill(&ring.tets, halves.iter().map(|half| &half[..]).zip([first, second]))
    }

    /// Fills the room of some tetrahedra: parts of it by their faces, each joined to an apex.
    pub(super) fn fill<'f>(&mut self, old: &[u32], parts: impl Iterator<Item = (&'f [[u32; 3]], Apex)>) -> bool {
        let before = self.s.c.points.len() as u32;
        let mut new = Vec::new();
        for (faces, apex) in parts {
            let apex = match apex {
                Apex::Vertex(w) => w,
                Apex::Point(at) => self.s.add_point(at),
            };
            new.extend(faces.iter().filter(|f| !f.contains(&apex)).map(|&[a, b, c]| [a, b, c, apex]));
        }
        let fits = self.s.c.replace(old, &new, &mut Vec::new());
        self.made.extend(before..self.s.c.points.len() as u32);
        fits
    }

    /// A vertex that sees some faces from well above; a corner of theirs if there is one.
    pub(super) fn apex(&self, middle: Point3, faces: &[[u32; 3]]) -> Option<Apex> {
        let room = Room::new(self.s, middle, faces);
        let levels = LEVELS.iter().filter(|&&least| least * room.size > self.s.flat);
        levels.into_iter().find_map(|&least| room.apex(self.s, least).ok())
    }
}

/// The faces around the two halves of a ring, without its edge, with the two triangles that have the edge from `x` to
/// `y`; counter-clockwise seen from inside.
fn halves(ring: &EdgeRing, [x, y]: [u32; 2]) -> Option<[Vec<[u32; 3]>; 2]> {
    let n = ring.len();
    let at = |v: u32| ring.rim.iter().position(|&w| w == v);
    let (i, j) = (at(x)?, at(y)?);
    let half = |from: usize, to: usize| {
        let (p, q) = (ring.a, ring.b);
        let (x, y) = (ring.rim[from], ring.rim[to]);
        let mut faces = vec![[x, p, y], [q, x, y]];
        let mut k = from;
        while k != to {
            let (u, v) = (ring.rim[k], ring.rim[(k + 1) % n]);
            faces.extend([[p, u, v], [q, v, u]]);
            k = (k + 1) % n;
        }
        faces
    };
    Some([half(i, j), half(j, i)])
}

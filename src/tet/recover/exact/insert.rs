//! Insertion of an implicit vertex into a Delaunay complex (Bowyer–Watson), with implicit vertices all around.

use super::space::Space;
use crate::tet::complex::{GHOST, face_of};
use rustc_hash::FxHashMap;

/// Digs cavities; keeps its buffers.
#[derive(Default)]
pub(super) struct Digger {
    stamp: Vec<u32>,
    now: u32,
    pub cavity: Vec<u32>,
    /// Half-face outside, and its vertices counter-clockwise seen from outside the cavity.
    walls: Vec<(u32, [u32; 3])>,
    pairs: FxHashMap<(u32, u32), u32>,
    /// Edges that the last insertion destroyed, smaller vertex first; those of interest only.
    pub lost: Vec<(u32, u32)>,
}

impl Digger {
    /// Inserts vertex `v`, which lies inside the hull; `start` is where the walk towards it begins. Edges that are
    /// `wanted` and go are put into `lost`.
    pub(super) fn insert(&mut self, s: &mut Space, v: u32, start: u32, wanted: impl Fn(u32, u32) -> bool) {
        let first = locate(s, v, start);
        self.dig(s, first, v);
        self.find_lost(s, wanted);
        self.fill(s, v);
    }

    fn dig(&mut self, s: &Space, first: u32, v: u32) {
        if self.stamp.len() < s.c.slots() {
            self.stamp.resize(2 * s.c.slots(), 0);
        }
        self.now += 1;
        let (outside, inside) = (2 * self.now, 2 * self.now + 1);
        self.cavity.clear();
        self.walls.clear();
        self.cavity.push(first);
        self.stamp[first as usize] = inside;
        let mut head = 0;
        while let Some(&t) = self.cavity.get(head) {
            head += 1;
            for half in 4 * t..4 * t + 4 {
                let mate = s.c.mate(half);
                let n = mate >> 2;
                let seen = self.stamp[n as usize];
                if seen == inside {
                    continue;
                }
                if seen != outside && !s.c.is_ghost(n) && s.in_sphere(s.c.verts(n), v) {
                    self.stamp[n as usize] = inside;
                    self.cavity.push(n);
                } else {
                    self.stamp[n as usize] = outside;
                    self.walls.push((mate, s.c.face(half)));
                }
            }
        }
    }

    fn find_lost(&mut self, s: &Space, wanted: impl Fn(u32, u32) -> bool) {
        self.lost.clear();
        for &t in &self.cavity {
            let w = s.c.verts(t);
            for i in 0..4 {
                for j in 0..i {
                    let (a, b) = (w[i].min(w[j]), w[i].max(w[j]));
                    if wanted(a, b) {
                        self.lost.push((a, b));
                    }
                }
            }
        }
        self.lost.sort_unstable();
        self.lost.dedup();
        self.lost.retain(|(a, b)| !self.walls.iter().any(|(_, f)| f.contains(a) && f.contains(b)));
    }

    fn fill(&mut self, s: &mut Space, v: u32) {
        for &t in &self.cavity {
            s.c.free(t);
        }
        self.pairs.clear();
        for &(outer, [a, b, d]) in &self.walls {
            let t = s.c.alloc([a, d, b, v]);
            s.c.glue(4 * t + 3, outer);
            for i in 0..3 {
                let [p, q, r] = face_of(&[a, d, b, v], i);
                // The edge of the wall is what the face has beside `v`.
                let (from, to) = if p == v {
                    (q, r)
                } else if q == v {
                    (r, p)
                } else {
                    (p, q)
                };
                let half = 4 * t + i as u32;
                match self.pairs.remove(&(to, from)) {
                    Some(other) => s.c.glue(half, other),
                    None => {
                        self.pairs.insert((from, to), half);
                    }
                }
            }
        }
    }
}

/// A tetrahedron whose closure holds vertex `v`, which is not in the complex yet but inside its hull.
fn locate(s: &Space, v: u32, start: u32) -> u32 {
    let c = &s.c;
    let mut t = if c.is_ghost(start) { c.mate(4 * start + 3) >> 2 } else { start };
    let mut from = GHOST;
    loop {
        let w = c.verts(t);
        let exit = (0..4u32).find(|&i| {
            let [a, b, d] = face_of(&w, i as usize);
            i != from && s.orient([a, b, d, v]) > 0
        });
        let Some(i) = exit else { return t };
        let mate = c.mate(4 * t + i);
        if c.is_ghost(mate >> 2) {
            return t;
        }
        (t, from) = (mate >> 2, mate & 3);
    }
}

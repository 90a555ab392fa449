//! Traversal of the tetrahedra around an edge and around a vertex.

use super::complex::{Complex, GHOST, NONE, OTHERS};

/// Ring of tetrahedra around an edge `a, b`: `tets[i]` has the vertices `a, b, rim[i], rim[i + 1]` in an even
/// permutation, cyclically. Around a boundary edge at least two tetrahedra are ghosts.
#[derive(Clone, Debug, Default)]
pub struct EdgeRing {
    /// First end of the edge.
    pub a: u32,
    /// Second end of the edge.
    pub b: u32,
    /// Tetrahedra, in order.
    pub tets: Vec<u32>,
    /// Vertices around the edge, one per tetrahedron; may contain the ghost vertex.
    pub rim: Vec<u32>,
}

impl EdgeRing {
    /// Collects the ring around edge `a, b` of tetrahedron `t`. Returns false if `t` does not have the edge, or if the
    /// ring has more than `max` tetrahedra; the ring is then incomplete.
    pub fn collect(&mut self, c: &Complex, t: u32, a: u32, b: u32, max: usize) -> bool {
        self.a = a;
        self.b = b;
        self.tets.clear();
        self.rim.clear();
        let mut cur = t;
        loop {
            let (Some(i), Some(j)) = (c.slot_of(cur, a), c.slot_of(cur, b)) else { return false };
            if i == j || self.tets.len() == max {
                return false;
            }
            let [k, _] = OTHERS[i][j];
            self.tets.push(cur);
            self.rim.push(c.verts(cur)[k]);
            cur = c.neighbor(cur, k);
            if cur == t {
                return true;
            }
        }
    }

    /// Number of tetrahedra.
    pub fn len(&self) -> usize {
        self.tets.len()
    }

    /// True if the edge lies on the boundary.
    pub fn touches_ghost(&self) -> bool {
        self.rim.contains(&GHOST)
    }

    /// Half-face `a, b, rim[i]` between `tets[i]` and its predecessor, as a half-face of `tets[i]`.
    pub fn spoke(&self, c: &Complex, i: usize) -> Option<u32> {
        let next = self.rim[(i + 1) % self.rim.len()];
        let t = self.tets[i];
        c.slot_of(t, next).map(|k| 4 * t + k as u32)
    }
}

/// Tetrahedra to visit around one vertex before those around another are visited in parallel.
const LARGE: usize = 1024;

/// Tetrahedra around a vertex; reuses its buffers.
#[derive(Clone, Debug, Default)]
pub struct Star {
    walk: Walk,
    /// Second traversal beside the first.
    other: Walk,
}

impl Star {
    /// All tetrahedra at vertex `v`, including ghosts; empty if it has none.
    pub fn around(&mut self, c: &Complex, v: u32) -> &[u32] {
        self.walk.start(c, v);
        while self.walk.next(c).is_some() {}
        &self.walk.tets
    }

    /// First result of `look` for the tetrahedra at vertex `v`, in the order of [`Star::around`].
    pub fn find<T>(&mut self, c: &Complex, v: u32, look: impl Fn(u32) -> Option<T>) -> Option<T> {
        self.walk.start(c, v);
        while let Some(t) = self.walk.next(c) {
            let found = look(t);
            if found.is_some() {
                return found;
            }
        }
        None
    }

    /// A tetrahedron (perhaps a ghost) with edge `a, b`.
    pub fn find_edge(&mut self, c: &Complex, a: u32, b: u32) -> Option<u32> {
        self.find_either(c, [a, b], |t| c.slot_of(t, a).is_some() && c.slot_of(t, b).is_some())
    }

    /// A half-face with the vertices `a, b, d`, in any rotation or orientation.
    pub fn find_face(&mut self, c: &Complex, face: [u32; 3]) -> Option<u32> {
        let t = self.find_either(c, [face[0], face[1]], |t| face.iter().all(|&v| c.slot_of(t, v).is_some()))?;
        (0..4).find(|&i| !face.contains(&c.verts(t)[i])).map(|i| 4 * t + i as u32)
    }

    /// A wanted tetrahedron at both vertices. A few vertices may have most of the complex around them.
    fn find_either(&mut self, c: &Complex, [a, b]: [u32; 2], wanted: impl Fn(u32) -> bool) -> Option<u32> {
        let Self { walk, other } = self;
        walk.start(c, a);
        for _ in 0..LARGE {
            let t = walk.next(c)?;
            if wanted(t) {
                return Some(t);
            }
        }
        other.start(c, b);
        loop {
            for t in [walk.next(c)?, other.next(c)?] {
                if wanted(t) {
                    return Some(t);
                }
            }
        }
    }
}

/// Breadth-first traversal of the tetrahedra around a vertex.
#[derive(Clone, Debug, Default)]
struct Walk {
    vertex: u32,
    stamp: Vec<u32>,
    now: u32,
    tets: Vec<u32>,
    head: usize,
}

impl Walk {
    fn start(&mut self, c: &Complex, v: u32) {
        self.vertex = v;
        self.tets.clear();
        self.head = 0;
        let start = c.vertex_tet(v);
        if start != NONE {
            self.begin(c.slots());
            self.stamp[start as usize] = self.now;
            self.tets.push(start);
        }
    }

    #[inline]
    fn next(&mut self, c: &Complex) -> Option<u32> {
        let t = *self.tets.get(self.head)?;
        self.head += 1;
        let cell = c.cell(t);
        for (&w, &mate) in cell.verts.iter().zip(&cell.mates) {
            let n = mate >> 2;
            let stamp = &mut self.stamp[n as usize];
            if w != self.vertex && *stamp != self.now {
                *stamp = self.now;
                self.tets.push(n);
            }
        }
        Some(t)
    }

    fn begin(&mut self, slots: usize) {
        if self.stamp.len() < slots {
            self.stamp.resize(slots + slots / 4, 0);
        }
        if self.now == u32::MAX {
            self.stamp.fill(0);
            self.now = 0;
        }
        self.now += 1;
    }
}

//! Walks around an edge and around a vertex of a complex.

use super::complex::{Complex, GHOST, NONE, OTHERS};

/// The ring of tetrahedra around an edge `a, b`: `tets[i]` has the vertices `a, b, rim[i], rim[i + 1]` in an even
/// permutation, cyclically. Around a boundary edge two or more of the tetrahedra are ghosts.
#[derive(Clone, Debug, Default)]
pub struct EdgeRing {
    /// First end of the edge.
    pub a: u32,
    /// Second end of the edge.
    pub b: u32,
    /// The tetrahedra, in order.
    pub tets: Vec<u32>,
    /// The vertices around the edge, as many as tetrahedra; may contain the ghost vertex.
    pub rim: Vec<u32>,
}

impl EdgeRing {
    /// Walks around edge `a, b` of tetrahedron `t`. False when `t` does not have the edge, or when the ring has more
    /// than `max` tetrahedra; the ring is then incomplete.
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

    /// Whether the edge lies on the boundary.
    pub fn touches_ghost(&self) -> bool {
        self.rim.contains(&GHOST)
    }

    /// The half-face `a, b, rim[i]` that lies between `tets[i]` and its predecessor, as a half-face of `tets[i]`.
    pub fn spoke(&self, c: &Complex, i: usize) -> Option<u32> {
        let next = self.rim[(i + 1) % self.rim.len()];
        let t = self.tets[i];
        c.slot_of(t, next).map(|k| 4 * t + k as u32)
    }
}

/// Tetrahedra around a vertex; keeps its buffers from one walk to the next.
#[derive(Clone, Debug, Default)]
pub struct Star {
    stamp: Vec<u32>,
    now: u32,
    tets: Vec<u32>,
}

impl Star {
    /// All tetrahedra at vertex `v`, ghosts included; empty when it has none.
    pub fn around(&mut self, c: &Complex, v: u32) -> &[u32] {
        self.tets.clear();
        let start = c.vertex_tet(v);
        if start == NONE {
            return &self.tets;
        }
        self.begin(c.slots());
        self.stamp[start as usize] = self.now;
        self.tets.push(start);
        let mut head = 0;
        while let Some(&t) = self.tets.get(head) {
            head += 1;
            let cell = c.cell(t);
            for (&w, &mate) in cell.verts.iter().zip(&cell.mates) {
                let n = mate >> 2;
                let stamp = &mut self.stamp[n as usize];
                if w != v && *stamp != self.now {
                    *stamp = self.now;
                    self.tets.push(n);
                }
            }
        }
        &self.tets
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

    /// A tetrahedron (perhaps a ghost) with edge `a, b`.
    pub fn find_edge(&mut self, c: &Complex, a: u32, b: u32) -> Option<u32> {
        self.around(c, a).iter().copied().find(|&t| c.slot_of(t, b).is_some())
    }

    /// A half-face with the vertices `a, b, d`, in any rotation or orientation.
    pub fn find_face(&mut self, c: &Complex, [a, b, d]: [u32; 3]) -> Option<u32> {
        self.around(c, a).iter().find_map(|&t| {
            let v = c.verts(t);
            if v.contains(&b) && v.contains(&d) {
                (0..4).find(|&i| v[i] != a && v[i] != b && v[i] != d).map(|i| 4 * t + i as u32)
            } else {
                None
            }
        })
    }
}

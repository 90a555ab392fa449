//! Nested flips: if an edge cannot be removed, its ring is reduced first.

use super::{Recovery, blocked};
use crate::complex::Complex;
use crate::delaunay::hash;
use crate::flips::{MAX_RING, Refusal};
use crate::star::EdgeRing;

/// Maximum size of a ring to reduce.
const LARGE_RING: usize = 4 * MAX_RING;

impl Recovery<'_> {
    /// Removes a face by a 2-3 flip. If its two tetrahedra are not convex, removes one of the reflex edges.
    pub(super) fn clear_face(&mut self, half: u32, depth: u32) -> bool {
        if self.c.is_frozen(half) {
            return false;
        }
        match self.flip_face(half) {
            Ok(()) => true,
            Err(refusal) if blocked(refusal) => {
                let f = self.c.face(half);
                let (a, d) = (self.c.apex(half), self.c.apex(self.c.mate(half)));
                // Reflex edges and flat ones block the flip.
                let reflex = |i: usize| !self.rule.allows(self.c, &[a, d, f[i], f[(i + 1) % 3]]);
                let sides: [bool; 3] = std::array::from_fn(reflex);
                let turn = self.round as usize;
                (turn..turn + 3).map(|i| i % 3).any(|i| {
                    sides[i]
                        && self
                            .star
                            .find_edge(self.c, f[i], f[(i + 1) % 3])
                            .is_some_and(|t| self.clear_edge(t, f[i], f[(i + 1) % 3], depth))
                })
            }
            Err(_) => false,
        }
    }

    /// Removes an edge. If its ring has no valid triangulation, its spokes are flipped first, to a bounded depth. After a
    /// failure the complex is unchanged.
    pub(super) fn clear_edge(&mut self, t: u32, p: u32, q: u32, depth: u32) -> bool {
        if self.edges.contains(p, q) {
            return false;
        }
        self.tried += 1;
        match self.remove_edge(t, p, q) {
            Ok(()) => return true,
            Err(refusal) if !blocked(refusal) || depth == 0 => return false,
            Err(_) => {}
        }
        let key = [p.min(q), p.max(q)];
        if self.failed.get(&key).is_some_and(|&d| d >= depth) {
            return false;
        }
        let mark = self.journal.len();
        self.ends.extend([p, q]);
        let done = self.shrink_and_clear(t, p, q, depth);
        self.ends.truncate(self.ends.len() - 2);
        if !done {
            self.journal.undo_to(self.c, mark);
            self.failed.insert(key, depth);
        }
        done
    }

    /// Removes spokes from the ring of an edge until the edge can be removed. Removals of the reflex edges that block a flip are
    /// nested as in n-to-m flips (Si, 'TetGen, a Delaunay-based quality tetrahedral mesh generator', 2015).
    fn shrink_and_clear(&mut self, t: u32, p: u32, q: u32, depth: u32) -> bool {
        let mut ring = EdgeRing::default();
        let mut start = t;
        // Terminates, since each success shrinks the ring by one.
        while ring.collect(self.c, start, p, q, LARGE_RING) && self.reduce_ring(&ring, depth) {
            let Some(next) = self.star.find_edge(self.c, p, q) else { return true };
            start = next;
            if self.remove_edge(start, p, q).is_ok() {
                return true;
            }
        }
        false
    }

    /// Removes an edge by a valid triangulation of its ring, another one each round to release stuck edges.
    fn remove_edge(&mut self, t: u32, p: u32, q: u32) -> Result<(), Refusal> {
        let (round, salt) = (self.round, Self::salt(self.round));
        let (rule, aim) = (self.rule, self.aim);
        let score = |c: &Complex, v: &[u32; 4]| {
            let coin = v.iter().fold(salt, |h, &x| hash(h ^ u64::from(x)));
            let fits = rule.allows(c, v) && (v[3] != p || aim.allows_face(c, [v[0], v[1], v[2]]));
            fits.then_some(if round == 0 { 1.0 } else { 1.0 + (coin >> 32) as f64 })
        };
        let ends = &self.ends;
        let stays = |v: u32| v != p && v != q && ends.contains(&v);
        let chord = |c: &Complex, [x, y]: [u32; 2]| !stays(x) && !stays(y) && aim.allows_edge(c, [x, y], [p, q]);
        self.flipper.plan_edge_if(self.c, [t, p, q], MAX_RING, chord, score)?;
        self.journal.commit(self.c, &mut self.flipper)
    }

    /// 2-3 flip: exchanges a face for the edge between its two apices.
    pub(super) fn flip_face(&mut self, half: u32) -> Result<(), Refusal> {
        let (rule, aim) = (self.rule, self.aim);
        let fits = |c: &Complex, v: &[u32; 4]| rule.allows(c, v) && aim.allows_edge(c, [v[0], v[1]], [v[2], v[3]]);
        self.flipper.plan_face(self.c, half, |c, v| fits(c, v).then_some(1.0))?;
        self.journal.commit(self.c, &mut self.flipper)
    }

    /// Removes one spoke from a ring.
    fn reduce_ring(&mut self, ring: &EdgeRing, depth: u32) -> bool {
        if ring.touches_ghost() {
            return false;
        }
        // In smaller rings the triangulation decides; a flipped spoke would only limit it.
        for i in 0..if ring.len() > MAX_RING { ring.len() } else { 0 } {
            if let Some(half) = ring.spoke(self.c, i)
                && !self.c.is_frozen(half)
            {
                self.tried += 1;
                if self.flip_face(half).is_ok() {
                    return true;
                }
            }
        }
        for i in 0..ring.len() {
            for end in [ring.a, ring.b] {
                if self.budget == 0 {
                    return false;
                }
                // A reflex edge of the spoke blocks its flip.
                let (r, before) = (ring.rim[i], ring.rim[(i + ring.len() - 1) % ring.len()]);
                let after = ring.rim[(i + 1) % ring.len()];
                let convex = if end == ring.a { [after, before, end, r] } else { [before, after, end, r] };
                if self.rule.allows(self.c, &convex) {
                    continue;
                }
                self.budget -= 1;
                if self.clear_edge(ring.tets[i], end, r, depth - 1) {
                    return true;
                }
            }
        }
        false
    }
}

//! Topological changes: each bad tetrahedron loses the edge or face whose removal helps most.

use super::{Improver, score};
use anastomesh_mesh::quality::TET_EDGES;

/// Maximum tetrahedra around an edge to remove.
const MAX_RING: usize = 7;
/// Minimum factor by which a flip must raise the worst radius ratio. It prevents endless exchanges.
const GAIN: f64 = 1.02;
/// Rounds over the tetrahedra that are still bad, including new ones.
const MAX_FLIP_PASSES: usize = 3;
/// Rounds end if at most one of this many tetrahedra changed; the next round would fail on the same ones.
const YIELD: usize = 50;

/// A face or an edge of a tetrahedron to remove.
#[derive(Clone, Copy, Debug)]
enum Candidate {
    Face(u32),
    Edge(u32, u32),
}

impl Improver<'_> {
    /// Removes faces and edges of tetrahedra below a radius ratio, worst first. Returns the number of changes.
    pub(super) fn flip_below(&mut self, below: f64) -> usize {
        let mut total = 0;
        for _ in 0..MAX_FLIP_PASSES {
            let list = self.worst_first(below);
            let mut flips = 0;
            for &entry in &list {
                // Tetrahedra replaced earlier in this round are seen again in the next.
                if self.is_current(entry) && self.spend() && self.flip_tet(entry.1) {
                    flips += 1;
                }
            }
            let tried = list.len();
            self.keep_list(list);
            total += flips;
            if flips * YIELD <= tried {
                break;
            }
        }
        self.report.flips += total;
        total
    }

    /// Makes the best of the ten removals of a tetrahedron's faces and edges, if it raises the worst radius ratio.
    pub(super) fn flip_tet(&mut self, t: u32) -> bool {
        let floor = self.quality[t as usize] * GAIN;
        let mut best = (floor, None);
        let v = self.c.verts(t);
        for candidate in candidates(t, v) {
            let worst = self.plan(t, candidate, best.0);
            if let Some(worst) = worst
                && worst > best.0
            {
                best = (worst, Some(candidate));
            }
        }
        let Some(candidate) = best.1 else { return false };
        // The last plan may belong to another candidate, so plan again.
        self.plan(t, candidate, floor).is_some()
            && self.eases(self.flipper.removed_tets(), self.flipper.planned())
            && self.commit_flip()
    }

    /// Plans a removal. Returns the worst new radius ratio if it is above `floor`.
    fn plan(&mut self, t: u32, candidate: Candidate, floor: f64) -> Option<f64> {
        let allowance = &self.allowance;
        let above = |c: &_, v: &_| score(c, v).map(|q| allowance.relative(v, q)).filter(|&q| q > floor);
        match candidate {
            Candidate::Face(half) => self.flipper.plan_face(&self.c, half, above).ok(),
            Candidate::Edge(a, b) => self.flipper.plan_edge(&self.c, t, a, b, MAX_RING, above).ok(),
        }
    }

    fn commit_flip(&mut self) -> bool {
        if self.flipper.commit(&mut self.c).is_err() {
            return false;
        }
        let flipper = std::mem::take(&mut self.flipper);
        self.remeasure(flipper.created());
        self.flipper = flipper;
        true
    }
}

fn candidates(t: u32, v: [u32; 4]) -> impl Iterator<Item = Candidate> {
    let edges = TET_EDGES.into_iter().map(move |[i, j]| Candidate::Edge(v[i], v[j]));
    (0..4).map(move |i| Candidate::Face(4 * t + i)).chain(edges)
}

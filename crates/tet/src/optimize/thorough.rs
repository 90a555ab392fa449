//! Thorough improvement. After the quick passes, every tetrahedron that is still bad is treated with all methods, worst
//! first. It stops when nothing improves, or when the cost exceeds the gain ([`AttemptBudget`]). Tetrahedra on surface needles
//! never become good and could be tried forever.

use super::Improver;
use super::allowance::Allowance;

/// Maximum rounds over the tetrahedra that are still bad.
const MAX_THOROUGH_PASSES: usize = 8;
/// Sizes of the cavities to reconnect, and steps of the search in each.
const CAVITIES: [(usize, usize); 2] = [(8, 150), (20, 400)];
/// Radius ratio below which a tetrahedron is improved at the cost of those on needles.
const VERY_BAD: f64 = 0.2;
/// Maximum passes that improve tetrahedra below `VERY_BAD` at the cost of needles.
const MAX_SPARING_PASSES: usize = 3;
/// Minimum factor of improvement by moves.
const GAIN: f64 = 1.1;
/// Rounds end if at most one of this many tetrahedra improved.
const WORTHWHILE: usize = 100;
/// Tetrahedra per attempt that is made regardless of success.
const FREE: usize = 200;
/// Minimum fraction of the strain that a round must remove, once the free attempts are used up.
const MIN_ROUND_GAIN: f64 = 0.25;
/// Maximum attempts: one per 4 tetrahedra, but at least 100.
const MOST: (usize, usize) = (4, 100);
/// As [`MOST`], if needles are spared.
const MOST_SPARED: (usize, usize) = (6, 60);

/// Budget for treating bad tetrahedra, in attempts. A failed attempt takes some 0.2 ms. The free attempts are followed
/// by rounds that pay off, up to the maximum.
#[derive(Debug)]
struct AttemptBudget {
    free: usize,
    most: usize,
    spent: usize,
    /// Total strain of bad tetrahedra before the last round.
    strain: f64,
}

impl AttemptBudget {
    fn of(tets: usize, spare_needles: bool) -> Self {
        let (each, least) = if spare_needles { MOST_SPARED } else { MOST };
        Self { free: tets / FREE, most: (tets / each).max(least), spent: 0, strain: f64::INFINITY }
    }

    /// True if another round pays off, given the current strain of bad tetrahedra.
    fn pays_off(&mut self, strain: f64) -> bool {
        let pays = strain <= (1.0 - MIN_ROUND_GAIN) * self.strain;
        self.strain = strain;
        self.spent < self.most && (pays || self.spent < self.free)
    }

    fn spend(&mut self) -> bool {
        self.spent += 1;
        self.spent <= self.most
    }
}

impl Improver<'_> {
    /// Treats all tetrahedra below the stubborn limit, worst first, except those on needles close to the attainable
    /// quality.
    pub(super) fn treat_thoroughly(&mut self, allowance: &Allowance) {
        let mut budget = AttemptBudget::of(self.c.real_tets().count(), self.options.spare_needles);
        for _ in 0..MAX_THOROUGH_PASSES {
            let list = self.worst_first(self.options.stubborn_below);
            if !budget.pays_off(self.strain_of_list(&list)) {
                self.keep_list(list);
                break;
            }
            let (tried, changes) = self.treat_each(&list, &mut budget, |s, t| {
                let (v, ratio) = (s.c.verts(t), s.quality[t as usize]);
                if s.options.spare_needles && allowance.is_exhausted(&v, ratio) {
                    return false;
                }
                let allowed = allowance.of_tet(&v);
                allowed >= 1.0 || ratio < allowed
            });
            self.keep_list(list);
            self.smooth_stars_below(self.options.smooth_below);
            if changes * WORTHWHILE <= tried {
                break;
            }
        }
    }

    /// Treats the unchanged, wanted entries of a list whose surroundings have changed since a failed attempt. Returns
    /// the numbers tried and improved.
    fn treat_each(
        &mut self,
        list: &[(f64, u32)],
        budget: &mut AttemptBudget,
        wanted: impl Fn(&Self, u32) -> bool,
    ) -> (usize, usize) {
        let (mut tried, mut changes) = (0, 0);
        for &(q, t) in list {
            if !self.is_current((q, t)) || !self.surroundings_changed(t) || !wanted(self, t) {
                continue;
            }
            if !self.spend() || !budget.spend() {
                break;
            }
            tried += 1;
            if self.treat_with_all(t) {
                changes += 1;
            } else {
                self.note_tried(t);
            }
        }
        (tried, changes)
    }

    /// Improves tetrahedra below `VERY_BAD` off the needles, even if those on needles become worse.
    pub(super) fn spare_others(&mut self, allowance: Allowance) {
        if allowance.is_empty() {
            return;
        }
        self.allowance = allowance;
        self.reconnection.forget();
        let mut budget = AttemptBudget::of(self.c.real_tets().count(), self.options.spare_needles);
        for _ in 0..MAX_SPARING_PASSES {
            // Retry all: small moves, which do not count as changes, may decide.
            self.tried.clear();
            let list = self.worst_first(self.options.stubborn_below);
            if !budget.pays_off(self.strain_of_list(&list)) {
                self.keep_list(list);
                break;
            }
            let (tried, changes) = self.treat_each(&list, &mut budget, Self::is_spared);
            self.keep_list(list);
            if changes * WORTHWHILE <= tried {
                break;
            }
        }
        self.allowance = Allowance::default();
    }

    fn strain_of_list(&self, list: &[(f64, u32)]) -> f64 {
        list.iter().map(|&(_, t)| self.strain_of(&[t])).sum()
    }

    /// True if a tetrahedron off the needles is below `VERY_BAD`, or bad beside a needle.
    fn is_spared(&self, t: u32) -> bool {
        let v = self.c.verts(t);
        if self.options.spare_needles && self.allowance.is_exhausted(&v, self.quality[t as usize]) {
            return false;
        }
        (self.quality[t as usize] < VERY_BAD || v.iter().any(|&v| self.allowance.has_needle(v)))
            && self.allowance.of_tet(&v) >= 1.0
    }

    /// True if the surroundings of a tetrahedron have changed since it was tried without success.
    fn surroundings_changed(&self, t: u32) -> bool {
        let tried = self.tried.get(t as usize).copied().unwrap_or(0);
        tried == 0 || self.c.verts(t).iter().any(|&v| self.changed.get(v as usize).copied().unwrap_or(0) >= tried)
    }

    fn note_tried(&mut self, t: u32) {
        self.epoch += 1;
        self.tried.resize(self.c.slots(), 0);
        self.tried[t as usize] = self.epoch;
    }

    pub(super) fn treat_with_all(&mut self, t: u32) -> bool {
        if self.flip_tet(t) || CAVITIES.iter().any(|&(size, nodes)| self.reconnect(t, size, nodes)) {
            self.report.flips += 1;
            true
        } else if self.ease_corners(t) {
            true
        } else if !self.options.keep_points && self.contract_corner(t) {
            self.report.contracted += 1;
            true
        } else if self.insert_near(t) {
            self.report.inserted += 1;
            true
        } else {
            false
        }
    }

    /// Moves the vertices of `t`.
    fn ease_corners(&mut self, t: u32) -> bool {
        let before = self.quality[t as usize];
        for v in self.c.verts(t) {
            if self.movable[v as usize] && self.ease_vertex(v) {
                self.report.moved += 1;
            }
        }
        self.quality[t as usize] > before * GAIN
    }
}

//! State of an improvement, and the order of its passes.

use super::allowance::Allowance;
use super::options::{Effort, OptimizeOptions, OptimizeReport};
use super::reconnect::Reconnection;
use super::star_energy::StarEnergy;
use super::strain::{EASED, strain};
use crate::complex::{Complex, NONE};
use crate::flips::Flipper;
use crate::progress::Watch;
use crate::star::{EdgeRing, Star};
use anastomesh_mesh::quality::radius_ratio;

/// Attempts between two checks for cancellation: some milliseconds.
const CANCEL_INTERVAL: usize = 256;

/// Marks a radius ratio that is out of date.
pub(super) const STALE: f64 = f64::NAN;

/// Buffers of the cavity operations.
#[derive(Clone, Debug, Default)]
pub(super) struct CavityBuffers {
    pub tets: Vec<u32>,
    /// Faces of the cavity, oriented inwards: (new vertex, face) is positive.
    pub faces: Vec<[u32; 3]>,
    pub new: Vec<[u32; 4]>,
    pub created: Vec<u32>,
    pub neighbors: Vec<u32>,
    pub ring: EdgeRing,
    /// Half-faces of the cavity towards the outside.
    pub halves: Vec<u32>,
}

/// A complex under improvement, with cached radius ratios.
#[derive(Debug)]
pub struct Improver<'a> {
    pub(super) c: Complex,
    /// Radius ratio by slot; meaningless for ghosts and dead slots, `STALE` if out of date.
    pub(super) quality: Vec<f64>,
    /// True for vertices that may be moved or removed.
    pub(super) movable: Vec<bool>,
    /// True for vertices whose surroundings have changed since they were last smoothed.
    pub(super) stirred: Vec<bool>,
    /// True for vertices that could not be eased, with unchanged surroundings since.
    pub(super) eased: Vec<bool>,
    pub(super) options: OptimizeOptions,
    pub(super) report: OptimizeReport,
    /// Smoothing may not lower the worst ratio of a star below this, or below its old value if that is less.
    pub(super) guard: f64,
    /// Attainable ratios on fixed triangles; empty unless in use.
    pub(super) allowance: Allowance,
    /// Attempts left.
    pub(super) budget: usize,
    pub(super) flipper: Flipper,
    pub(super) star: Star,
    pub(super) energy: StarEnergy,
    pub(super) cavity: CavityBuffers,
    pub(super) reconnection: Reconnection,
    /// Number of failed attempts.
    pub(super) epoch: u32,
    /// Epoch of the last change around each vertex.
    pub(super) changed: Vec<u32>,
    /// Epoch after which each slot was tried without success; 0 if never.
    pub(super) tried: Vec<u32>,
    worst_first: Vec<(f64, u32)>,
    watch: Watch<'a>,
}

impl<'a> Improver<'a> {
    /// Creates an improver of a complex.
    pub fn new(c: Complex, options: &OptimizeOptions) -> Self {
        let mut improver = Self {
            movable: movable_vertices(&c, options.fixed_points),
            stirred: vec![true; c.points.len()],
            eased: vec![false; c.points.len()],
            quality: vec![0.0; c.slots()],
            options: *options,
            report: OptimizeReport::default(),
            guard: 0.0,
            allowance: Allowance::default(),
            budget: 0,
            flipper: Flipper::default(),
            star: Star::default(),
            energy: StarEnergy::default(),
            cavity: CavityBuffers::default(),
            reconnection: Reconnection::default(),
            epoch: 0,
            changed: Vec::new(),
            tried: Vec::new(),
            worst_first: Vec::new(),
            watch: Watch::NOBODY,
            c,
        };
        improver.budget = options.attempts_per_tet.saturating_mul(improver.c.slots());
        improver.report.worst_before = improver.measure();
        improver
    }

    /// Lets the watch stop the passes early.
    pub fn watched(self, watch: Watch<'a>) -> Self {
        Self { watch, ..self }
    }

    /// Runs all passes.
    pub fn run(&mut self) {
        match self.options.effort {
            // Flips come first: in well-connected stars, one round of smoothing then gains as much as two.
            Effort::Quick => {
                self.flip_below(self.options.flip_below);
                self.smooth_and_flip();
                self.treat_stubborn();
                self.ease_worst(self.options.stubborn_below);
            }
            Effort::Fast | Effort::Full => {
                self.smooth_and_flip();
                if self.options.effort == Effort::Full {
                    self.guard = self.options.stubborn_below;
                    let allowance = Allowance::of(&self.c);
                    self.treat_thoroughly(&allowance);
                    self.spare_others(allowance);
                } else {
                    self.treat_stubborn();
                }
                self.smooth_stars_below(self.options.smooth_below);
                self.ease_worst(self.options.flip_below);
                if self.options.effort == Effort::Full {
                    self.report.flat_left = self.dissolve_flat();
                }
            }
        }
        let worst = self.c.real_tets().map(|t| self.quality[t as usize]).fold(f64::INFINITY, f64::min);
        self.report.worst_after = worst;
        self.report.budget_spent = self.budget == 0;
    }

    fn smooth_and_flip(&mut self) {
        for round in 0..self.options.rounds {
            let moved = self.smooth_stars_below(self.options.smooth_below);
            let flipped = self.flip_below(self.options.flip_below);
            if moved + flipped == 0 && round > 0 {
                break;
            }
        }
    }

    /// Returns the improved complex and the report.
    pub fn finish(self) -> (Complex, OptimizeReport) {
        (self.c, self.report)
    }

    /// Takes one attempt from the budget. Returns false if none is left or the run was cancelled.
    #[inline]
    pub(super) fn spend(&mut self) -> bool {
        if self.budget.is_multiple_of(CANCEL_INTERVAL) && self.watch.ask().is_err() {
            self.budget = 0;
        }
        let left = self.budget > 0;
        self.budget = self.budget.saturating_sub(1);
        left
    }

    /// Computes the radius ratio of every tetrahedron. Returns the smallest.
    fn measure(&mut self) -> f64 {
        let mut worst = f64::INFINITY;
        self.quality.resize(self.c.slots(), 0.0);
        for t in 0..self.c.slots() as u32 {
            if self.c.is_real(t) {
                let q = self.ratio(t);
                self.quality[t as usize] = q;
                worst = worst.min(q);
            }
        }
        worst
    }

    #[inline]
    fn ratio(&self, t: u32) -> f64 {
        let [a, b, c, d] = self.c.verts(t).map(|v| &self.c.points[v as usize]);
        radius_ratio(a, b, c, d)
    }

    /// Updates the radius ratios of new or strongly changed tetrahedra.
    pub(super) fn remeasure(&mut self, tets: &[u32]) {
        self.remeasure_moved(tets);
        for &t in tets {
            self.note_change(t);
        }
    }

    /// Updates radius ratios after a vertex move too small to make failed attempts worth repeating.
    pub(super) fn remeasure_moved(&mut self, tets: &[u32]) {
        self.quality.resize(self.c.slots(), 0.0);
        self.stirred.resize(self.c.points.len(), true);
        self.eased.resize(self.c.points.len(), false);
        for &t in tets {
            self.quality[t as usize] = self.ratio(t);
            for v in self.c.verts(t) {
                self.stirred[v as usize] = true;
                self.eased[v as usize] = false;
            }
        }
    }

    /// Records the epoch of the last change at the vertices of a tetrahedron, for full effort.
    fn note_change(&mut self, t: u32) {
        if self.options.effort == Effort::Full {
            self.changed.resize(self.c.points.len(), 0);
            for v in self.c.verts(t) {
                self.changed[v as usize] = self.epoch;
            }
        }
    }

    /// Updates the radius ratios that are out of date.
    pub(super) fn refresh(&mut self) {
        for t in 0..self.quality.len() as u32 {
            if self.quality[t as usize].is_nan() {
                self.quality[t as usize] = self.ratio(t);
            }
        }
    }

    /// Tetrahedra below a radius ratio, worst first.
    pub(super) fn worst_first(&mut self, below: f64) -> Vec<(f64, u32)> {
        let mut list = std::mem::take(&mut self.worst_first);
        list.clear();
        let real = (0..self.c.slots() as u32).filter(|&t| self.c.is_real(t));
        list.extend(real.map(|t| (self.quality[t as usize], t)).filter(|x| x.0 < below));
        list.sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        list
    }

    /// Returns the list, so that its buffer is reused.
    pub(super) fn keep_list(&mut self, list: Vec<(f64, u32)>) {
        self.worst_first = list;
    }

    /// True if a list entry still describes the tetrahedron in its slot.
    #[inline]
    pub(super) fn is_current(&self, (q, t): (f64, u32)) -> bool {
        self.c.is_real(t) && self.quality[t as usize].to_bits() == q.to_bits()
    }

    /// Strain of a tetrahedron with this radius ratio, relative to the attainable one.
    fn strain(&self, v: &[u32; 4], ratio: f64) -> f64 {
        strain(self.allowance.relative(v, ratio).min(1.0))
    }

    /// Total strain of tetrahedra.
    pub(super) fn strain_of(&self, tets: &[u32]) -> f64 {
        tets.iter().map(|&t| self.strain(&self.c.verts(t), self.quality[t as usize])).sum()
    }

    /// True if exchanging `old` for `new` lowers the strain. Always true for the quick passes.
    pub(super) fn eases(&self, old: &[u32], new: &[[u32; 4]]) -> bool {
        let ratio = |v: &[u32; 4]| {
            let [a, b, c, d] = v.map(|i| &self.c.points[i as usize]);
            radius_ratio(a, b, c, d)
        };
        if self.options.effort != Effort::Full {
            return true;
        }
        let strain_with = |sum: f64, v: &[u32; 4]| match ratio(v) {
            q if q < self.report.worst_before => f64::INFINITY,
            q => sum + self.strain(v, q),
        };
        new.iter().fold(0.0, strain_with) < self.strain_of(old) - EASED
    }

    /// Smallest radius ratio among tetrahedra, relative to the attainable one.
    pub(super) fn worst_of(&self, tets: &[u32]) -> f64 {
        let ratio = |&t: &u32| self.allowance.relative(&self.c.verts(t), self.quality[t as usize]);
        tets.iter().map(ratio).fold(f64::INFINITY, f64::min)
    }
}

/// Vertices that are used, not fixed, and neither on the boundary nor on a frozen face.
fn movable_vertices(c: &Complex, fixed: usize) -> Vec<bool> {
    let mut movable: Vec<bool> = (0..c.points.len()).map(|v| v >= fixed && c.vertex_tet(v as u32) != NONE).collect();
    for t in c.real_tets() {
        for i in 0..4 {
            let half = 4 * t + i;
            if c.is_frozen(half) || c.is_ghost(c.mate(half) >> 2) {
                for v in c.face(half) {
                    movable[v as usize] = false;
                }
            }
        }
    }
    movable
}

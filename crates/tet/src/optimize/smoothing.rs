//! Smoothing of inner vertices: Newton steps on the shape energy of the star, and a direct search for the worst radius
//! ratio.

use super::Improver;
use super::improver::STALE;
use super::star_energy::{Aim, StarEnergy};
use super::{Effort, score};
use anastomesh_mesh::geometry::{Point3, Vec3, predicates::orient3d};

/// Newton steps per vertex and visit.
const NEWTON_STEPS: usize = 2;
/// Maximum halvings of a step that does not lower the energy.
const HALVINGS: usize = 4;
/// Relative decrease of the energy below which a vertex has converged.
const SETTLED: f64 = 1e-3;
/// Relative decrease of the energy above which the neighbours of a vertex are visited again.
const REVISIT_DECREASE: f64 = 1e-2;
/// Radius ratio below which the thorough improvement leaves the vertices of a tetrahedron to the direct search.
const HOPELESS: f64 = 0.15;
/// Rounds of the direct search. Its step halves in a round that finds nothing.
const MAX_SEARCH_STEPS: usize = 12;

/// Maximum vertices moved at the end of the thorough improvement: one per 20 tetrahedra, but at least 200. On good
/// surfaces, that covers all.
const MAX_EASED_VERTICES: (usize, usize) = (20, 200);

/// Factor of improvement since listing above which a tetrahedron is skipped, since a neighbour's move helped it.
const SKIP_FACTOR: f64 = 1.05;

/// Minimum decrease of the strain for a move.
const LEAST_EASE: f64 = 0.002;
/// Decrease of the strain above which failed attempts around a move are worth repeating.
const NEWS: f64 = 0.1;

impl Improver<'_> {
    /// Smooths every movable vertex with an adjacent radius ratio below `below`. Returns the number of vertices moved.
    /// Vertices are visited in ascending order (Gauss-Seidel).
    pub(super) fn smooth_stars_below(&mut self, below: f64) -> usize {
        self.stirred.resize(self.c.points.len(), true);
        self.eased.resize(self.c.points.len(), false);
        let mut due = vec![false; self.c.points.len()];
        let mut strained = vec![false; if self.options.effort == Effort::Full { due.len() } else { 0 }];
        for t in self.c.real_tets() {
            if self.quality[t as usize] < below {
                for v in self.c.verts(t) {
                    due[v as usize] = self.movable[v as usize] && self.stirred[v as usize];
                }
                if self.quality[t as usize] < HOPELESS && !strained.is_empty() {
                    for v in self.c.verts(t) {
                        strained[v as usize] = true;
                    }
                }
            }
        }
        let mut moved = 0;
        for v in 0..due.len() as u32 {
            if !due[v as usize] || !self.spend() {
                continue;
            }
            // The energy of a hopeless tetrahedron would dominate that of the others.
            let is_hopeless = strained.get(v as usize).is_some_and(|&s| s);
            moved += usize::from(if is_hopeless { self.ease_once(v) } else { self.smooth_vertex(v) });
        }
        self.refresh();
        self.report.moved += moved;
        moved
    }

    /// Lowers the energy of a movable vertex's star. Marks its cached ratios as out of date.
    fn smooth_vertex(&mut self, v: u32) -> bool {
        self.stirred[v as usize] = false;
        let tets = self.star.around(&self.c, v);
        self.energy.gather(&self.c, v, tets);
        let star = &self.energy;
        let start = self.c.points[v as usize];
        let mut x = Vec3::zeros();
        let (mut before, mut energy) = (f64::INFINITY, f64::INFINITY);
        for round in 0..NEWTON_STEPS {
            let (here, step) = star.newton_step(&x);
            if round == 0 {
                (before, energy) = (here, here);
            }
            let Some(mut step) = step else { break };
            let mut lower = None;
            for _ in 0..HALVINGS {
                let e = star.energy(&(x + step), energy);
                if e < energy {
                    lower = Some(e);
                    break;
                }
                step *= 0.5;
            }
            let Some(e) = lower else { break };
            x += step;
            let settled = e > energy * (1.0 - SETTLED);
            energy = e;
            if settled {
                break;
            }
        }
        let target = start + x;
        let lower = energy < before * (1.0 - SETTLED);
        // `min` ignores NaN, which marks ratios out of date.
        let worst = star.tets.iter().map(|&t| self.quality[t as usize]).fold(self.guard, f64::min);
        if lower && star.keeps_above(&x, &target, worst.max(self.report.worst_before)) && star.stays_positive(&target) {
            self.c.points[v as usize] = target;
            for &t in &star.tets {
                self.quality[t as usize] = STALE;
            }
            if energy < before * (1.0 - REVISIT_DECREASE) {
                for &t in &star.tets {
                    for w in self.c.verts(t) {
                        // A later visit would not gain more for the vertex itself.
                        self.stirred[w as usize] |= w != v;
                        self.eased[w as usize] = false;
                    }
                }
            }
            return true;
        }
        false
    }

    /// Moves vertices of tetrahedra below a radius ratio, worst first, to ease their stars.
    pub(super) fn ease_worst(&mut self, below: f64) -> usize {
        let list = self.worst_first(below);
        let mut lifted = 0;
        let mut budget = match self.options.effort {
            Effort::Full => (self.c.real_tets().count() / MAX_EASED_VERTICES.0).max(MAX_EASED_VERTICES.1),
            Effort::Quick | Effort::Fast => usize::MAX,
        };
        for &(q, t) in &list {
            if !self.c.is_real(t) || self.quality[t as usize] >= below.min(q * SKIP_FACTOR) {
                continue;
            }
            for v in self.c.verts(t) {
                if self.movable[v as usize] && !self.eased[v as usize] && budget > 0 && self.spend() {
                    budget -= 1;
                    lifted += usize::from(self.ease_vertex(v));
                }
            }
        }
        self.keep_list(list);
        self.report.moved += lifted;
        lifted
    }

    /// Raises the worst radius ratio of a movable vertex's star by a direct search; updates the cached ratios.
    pub(super) fn lift_vertex(&mut self, v: u32) -> bool {
        self.seek(v, false)
    }

    /// Moves a vertex so that the strain of its star falls and its worst radius ratio does not.
    pub(super) fn ease_vertex(&mut self, v: u32) -> bool {
        if self.eased[v as usize] {
            return false;
        }
        let moved = self.seek(v, true);
        self.eased[v as usize] = !moved;
        moved
    }

    fn ease_once(&mut self, v: u32) -> bool {
        let moved = self.ease_vertex(v);
        self.stirred[v as usize] = false;
        moved
    }

    fn seek(&mut self, v: u32, ease: bool) -> bool {
        let tets = self.star.around(&self.c, v);
        self.energy.gather(&self.c, v, tets);
        self.allow_in_star();
        let start = self.c.points[v as usize];
        let mut before = self.energy.worst(&start, f64::NEG_INFINITY);
        if ease {
            self.energy.aim = Aim::Ease(before);
            before = self.energy.value(&start, f64::NEG_INFINITY);
        }
        let (best, value) = search(&self.energy, start, before);
        let least = if ease { before + LEAST_EASE } else { before };
        if value > least && self.energy.stays_positive(&best) {
            self.c.points[v as usize] = best;
            let tets = std::mem::take(&mut self.energy.tets);
            if value > before + NEWS {
                self.remeasure(&tets);
            } else {
                self.remeasure_moved(&tets);
            }
            self.energy.tets = tets;
            return true;
        }
        false
    }

    /// Passes the attainable ratios of the star's tetrahedra to the search.
    fn allow_in_star(&mut self) {
        if !self.allowance.is_empty() {
            self.energy.least = self.report.worst_before;
            let allowed = self.energy.tets.iter().map(|&t| self.allowance.of_tet(&self.c.verts(t)));
            self.energy.allowed.extend(allowed);
        }
    }

    /// Best position of a new vertex in a star-shaped cavity, searched from `p`, and the worst radius ratio there.
    pub(super) fn place_in_cavity(&mut self, p: Point3, faces: &[[u32; 3]]) -> (Point3, f64) {
        self.energy.faces.clear();
        self.energy.aim = Aim::Worst;
        self.energy.faces.extend(faces.iter().map(|f| f.map(|w| self.c.points[w as usize])));
        self.energy.allowed.clear();
        if !self.allowance.is_empty() {
            self.energy.least = self.report.worst_before;
            self.energy.allowed.extend(faces.iter().map(|&f| self.allowance.of_face(f)));
        }
        let before = self.energy.worst(&p, f64::NEG_INFINITY);
        search(&self.energy, p, before)
    }

    /// True if all tetrahedra from a new vertex at `p` to these faces are positive.
    pub(super) fn sees(&self, p: &Point3, faces: &[[u32; 3]]) -> bool {
        faces.iter().all(|f| {
            let [a, b, c] = f.map(|w| &self.c.points[w as usize]);
            orient3d(p, a, b, c) > 0.0
        })
    }

    /// Radius ratio of a tetrahedron, if positive.
    #[inline]
    pub(super) fn score(&self, v: &[u32; 4]) -> Option<f64> {
        score(&self.c, v)
    }
}

/// Direct search for a better position: along the axes, and away from the worst face. The step halves if nothing is
/// found.
fn search(star: &StarEnergy, start: Point3, before: f64) -> (Point3, f64) {
    let reach = star.faces.iter().map(|f| (f[0] - start).norm_squared()).fold(f64::INFINITY, f64::min).sqrt();
    let (mut best, mut value) = (start, before);
    let mut step = 0.25 * reach;
    let mut last = None;
    for _ in 0..MAX_SEARCH_STEPS {
        let from = best;
        let guide = steepest(star, &from).map_or(Vec3::zeros(), |g| g * step);
        let axes = [Vec3::x(), Vec3::y(), Vec3::z()].map(|e| e * step);
        let tries = [last.unwrap_or(guide), guide, axes[0], -axes[0], axes[1], -axes[1], axes[2], -axes[2]];
        last = None;
        for d in tries {
            let p = from + d;
            let w = star.value(&p, value);
            if w > value {
                (best, value, last) = (p, w, Some(d));
                break;
            }
        }
        if last.is_none() {
            step *= 0.5;
        }
    }
    (best, value)
}

/// Unit direction in which the height of the star's worst tetrahedron grows: away from its face.
fn steepest(star: &StarEnergy, p: &Point3) -> Option<Vec3> {
    let mut worst = (f64::INFINITY, 0);
    for i in 0..star.faces.len() {
        let q = star.ratio(p, i);
        if q < worst.0 {
            worst = (q, i);
        }
    }
    let [a, b, c] = star.faces.get(worst.1)?;
    // (p, a, b, c) positive: p lies on the side to which the normal of a, c, b points.
    (c - a).cross(&(b - a)).try_normalize(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimize::star_energy::Summand;
    use anastomesh_mesh::quality::radius_ratio;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_energy_bounds_the_radius_ratio(x in prop::array::uniform12(-1.0..1.0_f64)) {
            let p: [Point3; 4] = std::array::from_fn(|i| Point3::new(x[3 * i], x[3 * i + 1], x[3 * i + 2]));
            let ratio = radius_ratio(&p[0], &p[1], &p[2], &p[3]);
            prop_assume!(ratio.abs() > 1e-9);
            let face = if ratio > 0.0 { [p[1], p[2], p[3]] } else { [p[1], p[3], p[2]] };
            let energy = Summand::new(&p[0], &face).energy(&Vec3::zeros());
            prop_assert!(ratio.abs() * energy >= 1.0 - 1e-9, "{ratio} {energy}");
        }
    }
}

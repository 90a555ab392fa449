//! Exact recovery of what flips leave: several starts and strategies, tried in turns with growing budgets.

use super::complex::Complex;
use super::delaunay;
use super::error::TetError;
use super::recover::exact::{ExactRecovery, Missing, RecoveryStrategy};
use super::recover::{
    self, Priority, RecoverySummary, Rule, coarse_height, flat_height, flat_height_in_single, lies_in_planes,
    lies_turned,
};
use super::request::Request;
use super::sized;
use anastomesh_mesh::budget::Budget;
use anastomesh_mesh::geometry::Point3;

/// Operations of a strategy in the first turn: per missing edge or triangle, and per triangle of the surface.
const OPERATIONS: (u64, u64) = (2_500, 300);

/// Maximum operations in the first turn that are not due to missing parts. More are wasted where few parts are left.
const MAX_CONSTANT: u64 = 2_500_000;

/// Factor of the budget for recovery in planes after few flips.
const PLANE_SHARE: u64 = 2;

/// Factor of the budget for strategies that recover edges in planes first, where rounding has turned the planes.
const LEVEL_SHARE: u64 = 2;

/// Missing edges and triangles, relative to the triangles, from which a surface in planes starts without flat tetrahedra.
/// Exchanges in planes then take less time than cavities for each edge.
const MANY: f64 = 0.5;

/// Maximum turns of a start.
const MAX_TURNS: u32 = 8;

/// Growth of the operations from turn to turn.
const GROWTH: u64 = 4;

/// Turns after which a start returns to the complex left by flips. Parts that are recovered may be in the way of others.
const RETURN_AFTER: u32 = 3;

/// A start is given up after its first turn if that leaves more than this many times the parts that flips of another start
/// leave. Before that, exchanges in planes may recover most of them at once.
const HOPELESS: usize = 4;

/// Operations of each earlier start before a start begins, relative to the first turn of one strategy. The second number
/// holds after the first [`EARLY`] starts, which succeed most often.
const DELAY: (u64, u64) = (1, 4);

/// Number of starts that succeed most often.
const EARLY: u64 = 4;

/// Divisors of the operations of a start in the choice of the next turn: if few parts are left, and if half of them.
const PROMISE: (u64, u64) = (4, 2);

/// Maximum parts that count as few: a constant, or this fraction of the parts that flips left.
const FEW: (usize, f64) = (8, 0.05);

/// Maximum parts that count as half of them.
const HALF: (usize, f64) = (0, 0.5);

/// Strategies are not repeated if they leave more than this fraction of the parts.
const STALLED: f64 = 0.9;

/// A strategy that leaves more than this fraction of the parts helps little.
const POOR: f64 = 0.75;

/// Consecutive strategies that help little, after which the next start is tried.
const MAX_POOR: u32 = 2;

/// Maximum parts left for a repetition of the start: a constant, or this fraction of the parts that flips left.
const FEWER: (usize, f64) = (64, 0.002);

/// Turns after which a start is not yet repeated. Most parts succeed with a larger budget.
const RESTART_AFTER: u32 = 1;

/// Maximum repetitions of a start with the parts first that it has left.
const MAX_RESTARTS: u32 = 3;

/// Budget, relative to the first turn, from which all strategies are tried whatever the gain.
const THOROUGH: u64 = 256;

/// Maximum operations of all starts: per triangle of the surface, plus a constant.
const MAX_OPERATIONS: (u64, u64) = (50_000, 1_000_000_000);

/// A complex to start from, and the strategies to try there.
struct Attempt<'a> {
    /// Flips make nothing thinner than this, if set.
    flat: Option<f64>,
    ways: &'static [RecoveryStrategy],
    recovery: Option<ExactRecovery<'a>>,
    summary: RecoverySummary,
    /// Maximum passes of flips over the missing edges; `None` for the usual number.
    passes: Option<u32>,
    /// True if the Delaunay complex gets points on both sides of the surface. Long edges then cross few tetrahedra, and the
    /// points are removed like other Steiner points.
    filled: bool,
    /// True if strategies have helped little.
    abandoned: bool,
    /// True if a turn has left far more parts than the flips of another start.
    hopeless: bool,
    /// Operations of other starts before this one begins.
    delay: u64,
    /// Turns and operations so far.
    turns: u32,
    spent: u64,
    /// Repetitions with the failed parts first.
    restarts: u32,
    /// Parts that this start has left before.
    failed: Priority,
    /// Complex, missing edges and triangles, and summary before any strategy.
    origin: Option<Origin>,
}

/// Complex left by flips, to which a start returns.
#[derive(Clone)]
struct Origin {
    complex: Complex,
    edges: Vec<[u32; 2]>,
    triangles: Vec<u32>,
    summary: RecoverySummary,
}

impl Origin {
    /// Number of missing edges and triangles.
    fn parts(&self) -> usize {
        self.edges.len() + self.triangles.len()
    }
}

/// Work that is left, and the reason why the last strategy failed.
struct Effort {
    /// Operations that all strategies together may still take.
    left: u64,
    last: TetError,
    /// Fewest parts that the flips of a start have left.
    fewest: usize,
    /// Factor of the budget for strategies that recover edges in planes first.
    level_share: u64,
}

/// Complex with the whole surface.
type Recovered = (Complex, RecoverySummary);

/// Recovers the rest after flips. Starts take turns, each with larger budgets than in its last turn. The next turn belongs
/// to the start with the fewest operations. `before_flips` are the edges missing in the Delaunay complex.
///
/// # Errors
/// Reason of the last failure, once all turns have failed or [`MAX_OPERATIONS`] are spent.
pub(super) fn recover_rest(
    r: &Request,
    points: &[Point3],
    complex: Complex,
    (missing, before_flips): (Missing, &[[u32; 2]]),
) -> Result<Recovered, TetError> {
    let flat = flat_height(&r.surface.points);
    let edges = missing.edges;
    let turned_within = |height| [edges, before_flips].iter().any(|edges| lies_turned(r.surface, edges, height));
    let coarse = || Some(coarse_height(&r.surface.points)).filter(|&height| turned_within(height));
    let single = flat_height_in_single(&r.surface.points).or_else(coarse);
    let edges_turned = turned_within(flat) || single.is_some_and(turned_within);
    let is_turned = edges_turned || lies_in_planes(r.surface, edges, flat) || has_flat(&complex, flat, edges.len());
    let turned = single.filter(|&height| turned_within(height)).or(is_turned.then_some(flat));
    let last = TetError::NotRecovered { edges: missing.edges.to_vec(), triangles: missing.triangles.to_vec() };
    let thick = |thickness| Attempt::thick(thickness, &RecoveryStrategy::TURNED);
    // After few flips most of the missing edges lie in planes, where they are exchanged at once.
    let plane = |height| Attempt { passes: Some(1), ..Attempt::thick(height, &RecoveryStrategy::PLANES) };
    let filled = |flat, ways| Attempt { filled: true, ..Attempt::fresh(flat, ways) };
    // Where rounding has turned planes, flips that make nothing flat leave less.
    let given = Attempt::given(r, points.len(), complex, missing, flat);
    let filled_thick = turned.map(|height| filled(Some(height), &RecoveryStrategy::TURNED));
    let filled = filled(None, &RecoveryStrategy::GIVEN);
    let mut attempts: Vec<Attempt> = Vec::new();
    let many = (edges.len() + missing.triangles.len()) as f64 >= MANY * r.surface.triangles.len() as f64;
    let turned_first = edges_turned || (is_turned && many);
    if turned_first {
        attempts.extend(turned.map(thick).into_iter().chain(filled_thick));
        attempts.extend([given, filled]);
    } else {
        attempts.push(given);
        attempts.extend(turned.map(thick));
        attempts.push(filled);
        attempts.extend(filled_thick);
    }
    attempts.extend(turned.map(plane));
    let others = [Some(flat), single].into_iter().flatten().filter(|&thickness| turned != Some(thickness));
    attempts.extend(others.map(thick));
    attempts.push(Attempt::thick(turned.unwrap_or(flat), &RecoveryStrategy::LAST));
    let whole = MAX_OPERATIONS.0 * r.surface.triangles.len() as u64 + MAX_OPERATIONS.1;
    let fewest = edges.len() + missing.triangles.len();
    let level_share = if turned_first { LEVEL_SHARE } else { 1 };
    let mut effort = Effort { left: whole, last, fewest, level_share };
    let first = operations(r, fewest);
    for (place, attempt) in (0..).zip(&mut attempts) {
        attempt.delay = place * first * if place < EARLY { DELAY.0 } else { DELAY.1 };
    }
    while effort.left > 0 {
        let open = attempts.iter_mut().filter(|attempt| attempt.turns < MAX_TURNS && !attempt.hopeless);
        let Some(next) = open.min_by_key(|attempt| attempt.claim(r, first)) else { break };
        if let Some(done) = next.turn(r, points, &mut effort)? {
            return Ok(done);
        }
    }
    Err(effort.last)
}

/// Operations of a strategy in the first turn.
fn operations(r: &Request, missing: usize) -> u64 {
    OPERATIONS.0 * missing as u64 + MAX_CONSTANT.min(OPERATIONS.1 * r.surface.triangles.len() as u64)
}

/// True if flips have left more flat tetrahedra than edges, a sign of flat surface parts.
fn has_flat(complex: &Complex, height: f64, edges: usize) -> bool {
    let flat = complex.real_tets().filter(|&t| !Rule::Thick(height).allows(complex, &complex.verts(t)));
    flat.take(edges + 1).count() > edges
}

impl<'a> Attempt<'a> {
    /// Starts with the complex left by flips.
    fn given(r: &Request<'a>, points: usize, complex: Complex, missing: Missing, flat: f64) -> Self {
        let summary = RecoverySummary {
            missing_edges: missing.edges.len(),
            missing_triangles: missing.triangles.len(),
            steiner_points: complex.points.len() - points,
        };
        let (edges, triangles) = (missing.edges.to_vec(), missing.triangles.to_vec());
        let origin = Origin { complex: complex.clone(), edges, triangles, summary: summary.clone() };
        let recovery = Some(ExactRecovery::new(complex, (r.surface, r.edges), missing, flat));
        Self { recovery, summary, origin: Some(origin), ..Self::fresh(None, &RecoveryStrategy::GIVEN) }
    }

    /// Starts with flips that make nothing thinner than `flat`.
    fn thick(flat: f64, ways: &'static [RecoveryStrategy]) -> Self {
        Self::fresh(Some(flat), ways)
    }

    /// Starts with the Delaunay complex.
    fn fresh(flat: Option<f64>, ways: &'static [RecoveryStrategy]) -> Self {
        let summary = RecoverySummary::default();
        Self {
            flat,
            ways,
            recovery: None,
            summary,
            passes: None,
            filled: false,
            abandoned: false,
            hopeless: false,
            delay: 0,
            turns: 0,
            spent: 0,
            restarts: 0,
            failed: Priority::default(),
            origin: None,
        }
    }

    /// Returns to the complex left by flips.
    fn reset(&mut self, r: &Request<'a>) {
        if let Some(Origin { complex, edges, triangles, summary }) = self.origin.clone() {
            let missing = Missing { edges: &edges, triangles: &triangles };
            let flat = self.flat.unwrap_or(flat_height(&r.surface.points));
            self.recovery = Some(ExactRecovery::new(complex, (r.surface, r.edges), missing, flat));
            self.summary = summary;
        }
    }

    /// Number of missing edges and triangles, once known.
    fn missing(&self) -> usize {
        self.recovery.as_ref().map_or(usize::MAX, ExactRecovery::missing)
    }

    /// True if hardly fewer parts are missing than `before`.
    fn has_stalled(&self, before: usize) -> bool {
        self.missing() as f64 > STALLED * before as f64
    }

    /// True if strategies have recovered almost all parts that flips left: no more are missing than a constant, or this
    /// fraction.
    fn leaves(&self, (constant, fraction): (usize, f64)) -> bool {
        let Some(origin) = &self.origin else { return false };
        let share = fraction * origin.parts() as f64;
        self.missing() <= constant.max(share as usize)
    }

    /// Operations that count in the choice of the next turn: those so far, and those that the turn takes at least. `first`
    /// are those of a start that has not begun.
    fn claim(&self, r: &Request, first: u64) -> u64 {
        let Some(origin) = &self.origin else { return self.delay + self.spent + first };
        let fresh = self.repeats_start() || self.returns();
        let parts = if fresh { origin.parts() } else { self.missing() };
        let all = self.spent + u64::from(MAX_POOR) * self.share() * operations(r, parts);
        let promise = if self.returns() {
            1
        } else if self.leaves(FEW) {
            PROMISE.0
        } else if self.leaves(HALF) {
            PROMISE.1
        } else {
            1
        };
        self.delay + all / promise
    }

    /// Budget of the next turn, relative to the first. A repeated start has that of the last turn.
    fn share(&self) -> u64 {
        GROWTH.pow(self.turns - u32::from(self.repeats_start()))
    }

    /// True if the next turn repeats the start.
    fn repeats_start(&self) -> bool {
        self.turns > RESTART_AFTER && self.restarts < MAX_RESTARTS && self.leaves(FEWER)
    }

    /// True if the next turn returns to the complex left by flips.
    fn returns(&self) -> bool {
        self.turns > 0 && self.turns.is_multiple_of(RETURN_AFTER) && !self.repeats_start()
    }

    /// Tries all strategies with larger budgets than in the last turn, or repeats the start.
    fn turn(&mut self, r: &Request<'a>, points: &[Point3], effort: &mut Effort) -> Result<Option<Recovered>, TetError> {
        let (before, share) = (effort.left, self.share());
        let done = if self.repeats_start() {
            self.restart(r, points, share, effort)?
        } else {
            if self.returns() {
                self.reset(r);
            }
            self.turns += 1;
            self.repeat(r, points, share, effort)?
        };
        self.spent += before - effort.left;
        // The start with the fewest parts always goes on.
        let parts = self.origin.as_ref().map_or(0, Origin::parts).min(self.missing());
        self.hopeless = parts > effort.fewest.saturating_mul(HOPELESS);
        Ok(done)
    }

    /// Repeats a nearly successful start. What it left comes first, while nothing is in the way. No repetition follows one
    /// that does not help.
    fn restart(
        &mut self,
        r: &Request<'a>,
        points: &[Point3],
        share: u64,
        effort: &mut Effort,
    ) -> Result<Option<Recovered>, TetError> {
        self.restarts += 1;
        let mut failed = self.failed.clone();
        if let Some(recovery) = &self.recovery {
            failed.add(recovery.missing_parts());
        }
        let summary = RecoverySummary::default();
        let mut again = Self { recovery: None, summary, failed, origin: None, ..*self };
        let done = again.repeat(r, points, share, effort)?;
        if done.is_none() && again.missing() < self.missing() {
            *self = again;
        } else {
            self.restarts = MAX_RESTARTS;
        }
        Ok(done)
    }

    /// Repeats all strategies while they recover enough.
    fn repeat(
        &mut self,
        r: &Request<'a>,
        points: &[Point3],
        share: u64,
        effort: &mut Effort,
    ) -> Result<Option<Recovered>, TetError> {
        loop {
            let before = self.missing();
            let done = self.run(r, points, share, effort)?;
            if done.is_some() || effort.left == 0 || self.abandoned || self.has_stalled(before) {
                return Ok(done);
            }
        }
    }

    /// Tries all strategies, each with `share` times the operations of the first turn. Stops after some that help little.
    fn run(
        &mut self,
        r: &Request<'a>,
        points: &[Point3],
        share: u64,
        effort: &mut Effort,
    ) -> Result<Option<Recovered>, TetError> {
        if self.recovery.is_none()
            && let Some(done) = self.start(r, points)?
        {
            return Ok(Some(done));
        }
        effort.fewest = effort.fewest.min(self.origin.as_ref().map_or(usize::MAX, Origin::parts));
        let share = if self.passes.is_some() { PLANE_SHARE * share } else { share };
        let mut poor = 0;
        self.abandoned = false;
        for &way in self.ways {
            let Some(recovery) = &mut self.recovery else { return Ok(None) };
            let before = recovery.missing();
            let room = if way.level.is_some() { effort.level_share } else { 1 };
            let budget = Budget::new(room * share * operations(r, recovery.missing()));
            let result = recovery.attempt(way, share, &r.watch.within(&budget));
            r.watch.spend(budget.spent() as usize)?;
            effort.left = effort.left.saturating_sub(budget.spent());
            match result {
                Ok((complex, exact)) => {
                    let mut summary = self.summary.clone();
                    summary.steiner_points += exact.steiner_points;
                    return Ok(Some((complex, summary)));
                }
                Err(TetError::OverBudget { .. } | TetError::NotRecovered { .. }) => {}
                Err(error @ TetError::Stuck { .. }) => effort.last = error,
                Err(error) => return Err(error),
            }
            if recovery.missing() < before
                && let Some(done) = self.flip_again(r)?
            {
                return Ok(Some(done));
            }
            if self.missing() as f64 <= POOR * before as f64 {
                poor = 0;
            } else if budget.spent() > 0 {
                poor += 1;
            }
            self.abandoned = poor == MAX_POOR && share < THOROUGH;
            if self.abandoned {
                break;
            }
        }
        Ok(None)
    }

    /// Repeats the flips and Steiner points for the parts that a strategy left. Less is in their way than before.
    fn flip_again(&mut self, r: &Request<'a>) -> Result<Option<Recovered>, TetError> {
        let Some(recovery) = self.recovery.take() else { return Ok(None) };
        let (mut complex, made, too_long) = recovery.into_complex();
        self.summary.steiner_points += made;
        let rule = self.flat.map_or(Rule::Positive, Rule::Thick);
        let before = complex.points.len();
        let result = recover::recover(&mut complex, r.surface, r.edges, rule, r.watch);
        self.summary.steiner_points += complex.points.len() - before;
        match result {
            Ok(_) => Ok(Some((complex, self.summary.clone()))),
            Err(TetError::NotRecovered { edges, triangles }) => {
                let missing = Missing { edges: &edges, triangles: &triangles };
                let flat = self.flat.unwrap_or(flat_height(&r.surface.points));
                let recovery = ExactRecovery::new(complex, (r.surface, r.edges), missing, flat);
                self.recovery = Some(recovery.after(too_long));
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }

    /// Repeats the flips. Returns the complex if they recover the whole surface.
    fn start(&mut self, r: &Request<'a>, points: &[Point3]) -> Result<Option<Recovered>, TetError> {
        let given = points.len();
        let mut points = points.to_vec();
        if self.filled {
            let more = sized::scaffold_points(r, &points)?;
            points.extend(more);
        }
        let mut complex = delaunay::delaunay_watched(&points, r.watch)?;
        let rule = self.flat.map_or(Rule::Positive, Rule::Thick);
        let flips = (rule, self.passes.unwrap_or(recover::MAX_FLIP_PASSES), &self.failed);
        match recover::recover_with(&mut complex, r.surface, r.edges, flips, r.watch) {
            Ok(summary) => Ok(Some((complex, summary))),
            Err(TetError::NotRecovered { edges, triangles }) => {
                let missing = Missing { edges: &edges, triangles: &triangles };
                let flat = self.flat.unwrap_or(flat_height(&r.surface.points));
                let start = Self::given(r, given, complex, missing, flat);
                (self.recovery, self.summary, self.origin) = (start.recovery, start.summary, start.origin);
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }
}

#[cfg(test)]
mod tests;

//! Exact recovery of what flips leave: several starts and strategies, tried in turns with growing budgets.

use super::complex::Complex;
use super::delaunay;
use super::error::TetError;
use super::recover::exact::{ExactRecovery, Missing, RecoveryStrategy};
use super::recover::{self, RecoverySummary, Rule, flat_height, flat_height_in_single, lies_in_planes, lies_turned};
use super::request::Request;
use anastomesh_mesh::budget::Budget;
use anastomesh_mesh::geometry::Point3;

/// Operations of a strategy in the first round: per missing edge or triangle, plus a constant.
const OPERATIONS: (u64, u64) = (60_000, 20_000_000);

/// Factor of the budget for recovery in planes after few flips.
const PLANE_SHARE: u64 = 8;

/// Maximum rounds over all strategies.
const MAX_ROUNDS: u32 = 5;

/// Growth of the operations from round to round.
const GROWTH: u64 = 4;

/// A complex to start from, and the strategies to try there.
struct Attempt<'a> {
    /// Flips make nothing thinner than this; `None` for the complex that is given.
    flat: Option<f64>,
    ways: &'static [RecoveryStrategy],
    recovery: Option<ExactRecovery<'a>>,
    summary: RecoverySummary,
    /// Maximum passes of flips over the missing edges; `None` for the usual number.
    passes: Option<u32>,
    /// Complex, missing edges and triangles, and summary before any strategy.
    origin: Option<Origin>,
}

/// Complex left by flips, to which each round returns.
#[derive(Clone)]
struct Origin {
    complex: Complex,
    edges: Vec<[u32; 2]>,
    triangles: Vec<u32>,
    summary: RecoverySummary,
}

/// Complex with the whole surface.
type Recovered = (Complex, RecoverySummary);

/// Recovers the rest after flips. The strategies of one start are repeated while they recover anything. All are tried
/// with a small budget before any gets a larger one. `before_flips` are the edges missing in the Delaunay complex.
pub(super) fn recover_rest(
    r: &Request,
    points: &[Point3],
    complex: Complex,
    (missing, before_flips): (Missing, &[[u32; 2]]),
) -> Result<Recovered, TetError> {
    let flat = flat_height(&r.surface.points);
    let single = flat_height_in_single(&r.surface.points);
    let edges = missing.edges;
    let turned_within = |height| [edges, before_flips].iter().any(|edges| lies_turned(r.surface, edges, height));
    let is_turned =
        lies_in_planes(r.surface, edges, flat) || turned_within(flat) || has_flat(&complex, flat, edges.len());
    let turned = single.filter(|&height| turned_within(height)).or(is_turned.then_some(flat));
    let mut last = TetError::NotRecovered { edges: missing.edges.to_vec(), triangles: missing.triangles.to_vec() };
    let thick = |thickness| Attempt::thick(thickness, &RecoveryStrategy::TURNED);
    // After few flips most of the missing edges lie in planes, where they are exchanged at once.
    let plane = |height| Attempt { passes: Some(1), ..Attempt::thick(height, &RecoveryStrategy::PLANES) };
    let mut attempts: Vec<Attempt> = turned.map(thick).into_iter().collect();
    attempts.push(Attempt::given(r, points, complex, missing, flat));
    attempts.extend(turned.map(plane));
    let others = [Some(flat), single].into_iter().flatten().filter(|&thickness| turned != Some(thickness));
    attempts.extend(others.map(thick));
    attempts.push(Attempt::thick(turned.unwrap_or(flat), &RecoveryStrategy::LAST));
    for round in 0..MAX_ROUNDS {
        for attempt in &mut attempts {
            if round > 0 {
                attempt.reset(r);
            }
            loop {
                let before = attempt.missing();
                if let Some(done) = attempt.run(r, points, GROWTH.pow(round), &mut last)? {
                    return Ok(done);
                }
                if attempt.missing() >= before {
                    break;
                }
            }
        }
    }
    Err(last)
}

/// True if flips have left more flat tetrahedra than edges, a sign of flat surface parts.
fn has_flat(complex: &Complex, height: f64, edges: usize) -> bool {
    let flat = complex.real_tets().filter(|&t| !Rule::Thick(height).allows(complex, &complex.verts(t)));
    flat.take(edges + 1).count() > edges
}

impl<'a> Attempt<'a> {
    /// Starts with the complex left by flips.
    fn given(r: &Request<'a>, points: &[Point3], complex: Complex, missing: Missing, flat: f64) -> Self {
        let summary = RecoverySummary {
            missing_edges: missing.edges.len(),
            missing_triangles: missing.triangles.len(),
            steiner_points: complex.points.len() - points.len(),
        };
        let (edges, triangles) = (missing.edges.to_vec(), missing.triangles.to_vec());
        let origin = Origin { complex: complex.clone(), edges, triangles, summary: summary.clone() };
        let recovery = Some(ExactRecovery::new(complex, (r.surface, r.edges), missing, flat));
        Self { flat: None, ways: &RecoveryStrategy::GIVEN, recovery, summary, passes: None, origin: Some(origin) }
    }

    /// Starts with flips that make nothing thinner than `flat`.
    fn thick(flat: f64, ways: &'static [RecoveryStrategy]) -> Self {
        Self { flat: Some(flat), ways, recovery: None, summary: RecoverySummary::default(), passes: None, origin: None }
    }

    /// Returns to the complex left by flips. Parts that are recovered may be in the way of others.
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

    /// Tries all strategies, each with `share` times the operations of the first round.
    fn run(
        &mut self,
        r: &Request<'a>,
        points: &[Point3],
        share: u64,
        last: &mut TetError,
    ) -> Result<Option<Recovered>, TetError> {
        if let Some(flat) = self.flat.filter(|_| self.recovery.is_none())
            && let Some(done) = self.start(r, points, flat)?
        {
            return Ok(Some(done));
        }
        let share = if self.passes.is_some() { PLANE_SHARE * share } else { share };
        for &way in self.ways {
            let Some(recovery) = &mut self.recovery else { return Ok(None) };
            let before = recovery.missing();
            let budget = Budget::new(share * (OPERATIONS.0 * recovery.missing() as u64 + OPERATIONS.1));
            let result = recovery.attempt(way, share, &r.watch.within(&budget));
            r.watch.spend(budget.spent() as usize)?;
            match result {
                Ok((complex, exact)) => {
                    let mut summary = self.summary.clone();
                    summary.steiner_points += exact.steiner_points;
                    return Ok(Some((complex, summary)));
                }
                Err(TetError::OverBudget { .. } | TetError::NotRecovered { .. }) => {}
                Err(error @ TetError::Stuck { .. }) => *last = error,
                Err(error) => return Err(error),
            }
            if recovery.missing() < before
                && let Some(done) = self.flip_again(r)?
            {
                return Ok(Some(done));
            }
        }
        Ok(None)
    }

    /// Repeats the flips and Steiner points for the parts that a strategy left. Less is in their way than before.
    fn flip_again(&mut self, r: &Request<'a>) -> Result<Option<Recovered>, TetError> {
        let Some(recovery) = self.recovery.take() else { return Ok(None) };
        let (mut complex, made) = recovery.into_complex();
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
                self.recovery = Some(ExactRecovery::new(complex, (r.surface, r.edges), missing, flat));
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }

    /// Repeats the flips. Returns the complex if they recover the whole surface.
    fn start(&mut self, r: &Request<'a>, points: &[Point3], flat: f64) -> Result<Option<Recovered>, TetError> {
        let mut complex = delaunay::delaunay_watched(points, r.watch)?;
        let flips = (Rule::Thick(flat), self.passes.unwrap_or(recover::MAX_FLIP_PASSES));
        match recover::recover_with(&mut complex, r.surface, r.edges, flips, r.watch) {
            Ok(summary) => Ok(Some((complex, summary))),
            Err(TetError::NotRecovered { edges, triangles }) => {
                let missing = Missing { edges: &edges, triangles: &triangles };
                *self = Self {
                    ways: self.ways,
                    flat: Some(flat),
                    passes: self.passes,
                    ..Self::given(r, points, complex, missing, flat)
                };
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }
}

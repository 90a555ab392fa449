//! Recovery of parts one after another. A part that fails is undone and waits until all others are recovered. Then it
//! is tried in other orders, and with the other kind of cavity; by then its obstacles have changed.

use super::level::level_out;
use super::one::{ExactSummary, about_input, recover_part};
use super::parts::{Missing, Part, parts};
use super::push::Push;
use super::state::State;
use super::ways::RecoveryStrategy;
use crate::error::{Obstacle, Stuck, TetError};
use crate::input::SurfaceEdges;
use crate::progress::Watch;
use crate::recover::flat::dissolve_flat;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::budget::Budget;

/// Maximum rounds over the waiting parts.
const MAX_PASSES: u64 = 3;

/// Maximum rounds if a large part is left, since large parts take most of the time.
const MAX_PASSES_LARGE: u64 = 2;

/// Round after which the remaining edges are tried in planes of facets.
const LEVEL_AFTER: u64 = 1;

/// Minimum missing edges of a large part. Also the number of recovered edges after which the state is saved.
const LARGE: usize = 100;

/// Operations for one part in the first round: per missing edge or triangle, plus a constant. Each round doubles them.
const PART_OPERATIONS: (u64, u64) = (10_000, 200_000);

/// Slots of a complex that are copied in the time of one operation.
const COPIED: usize = 4;

/// Maximum waiting parts before a strategy is abandoned: a constant, plus this fraction of all parts.
const MAX_WAITING: (usize, f64) = (16, 0.5);

/// Failed recovery.
pub(super) struct Failed<'a> {
    pub error: TetError,
    /// True if another attempt may succeed.
    pub again: bool,
    /// State with the parts recovered so far, and the parts still missing.
    pub rest: Option<Box<State<'a>>>,
}

impl Failed<'_> {
    fn new(error: TetError, again: bool) -> Self {
        Self { error, again, rest: None }
    }
}

/// Recovers parts with one strategy.
pub(super) struct Queue<'a, 'b> {
    push: Push<'a>,
    summary: ExactSummary,
    surface: &'b TriMesh,
    edges: &'b SurfaceEdges,
    way: RecoveryStrategy,
    /// Maximum implicit vertices.
    budget: usize,
    /// Operations for each part, relative to [`PART_OPERATIONS`].
    share: u64,
    watch: &'b Watch<'b>,
}

/// State to return to when a part fails.
struct Saved<'a, 'p> {
    push: Push<'a>,
    summary: ExactSummary,
    /// Number of parts tried before.
    at: usize,
    /// Parts recovered since the state was saved.
    since: Vec<&'p Part>,
}

impl<'a, 'b> Queue<'a, 'b> {
    pub(super) fn new(
        push: Push<'a>,
        (surface, edges): (&'b TriMesh, &'b SurfaceEdges),
        (way, budget, share): (RecoveryStrategy, usize, u64),
        watch: &'b Watch<'b>,
    ) -> Self {
        Self { push, summary: ExactSummary::default(), surface, edges, way, budget, share, watch }
    }

    /// Recovers all missing parts.
    pub(super) fn run(mut self, missing: Missing) -> Result<(Push<'a>, ExactSummary), Failed<'a>> {
        let mut waiting = parts(&self.surface.triangles, missing);
        for round in 0..MAX_PASSES {
            self.push.segments.deep = self.way.deep != (round % 2 == 1);
            let (stuck, last) = self.pass(&waiting, round)?;
            let Some(error) = last else { return Ok((self.push, self.summary)) };
            let large = stuck.iter().any(|part| part.edges.len() >= LARGE);
            if round + 1 == if large { MAX_PASSES_LARGE } else { MAX_PASSES } {
                let rest = State::of(self.push, stuck.into_iter(), self.summary);
                return Err(Failed { error, again: true, rest: Some(Box::new(rest)) });
            }
            waiting = stuck.into_iter().cloned().collect();
            if round == LEVEL_AFTER {
                let before = (self.push.clone(), self.summary);
                waiting = self.level(&waiting).map_err(|failed| {
                    let rest = State::of(before.0, waiting.iter(), before.1);
                    Failed { rest: Some(Box::new(rest)), ..failed }
                })?;
            }
        }
        Ok((self.push, self.summary))
    }

    /// Recovers remaining edges in planes of facets, after dissolving flat tetrahedra. Returns the parts still missing.
    fn level(&mut self, waiting: &[Part]) -> Result<Vec<Part>, Failed<'a>> {
        let edges: Vec<[u32; 2]> = waiting.iter().flat_map(|part| &part.edges).copied().collect();
        let triangles: Vec<u32> = waiting.iter().flat_map(|part| &part.triangles).copied().collect();
        let missing = Missing { edges: &edges, triangles: &triangles };
        let flat = self.push.s.flat;
        dissolve_flat(&mut self.push.s.c, self.surface, self.edges, flat);
        let left = level_out(&mut self.push, self.edges, missing, f64::INFINITY, self.watch);
        let Some((edges, triangles)) = left.map_err(|error| Failed::new(error, false))? else {
            return Ok(waiting.to_vec());
        };
        Ok(parts(&self.surface.triangles, Missing { edges: &edges, triangles: &triangles }))
    }

    /// Tries each part once. Returns the failed parts and the last error.
    fn pass<'p>(&mut self, parts: &'p [Part], round: u64) -> Result<(Vec<&'p Part>, Option<TetError>), Failed<'a>> {
        let mut saved = self.save(0);
        let (mut stuck, mut last) = (Vec::new(), None);
        for (at, part) in parts.iter().enumerate() {
            let since: usize = saved.since.iter().map(|part| 1 + part.edges.len()).sum();
            if since > 0 && since + part.edges.len() >= LARGE {
                saved = self.save(at);
            }
            let Err(failed) = self.recover(part, round) else {
                saved.since.push(part);
                continue;
            };
            if failed.again {
                stuck.push(part);
            }
            let waiting = MAX_WAITING.0 + (MAX_WAITING.1 * parts.len() as f64) as usize;
            if !failed.again || stuck.len() > waiting {
                return Err(Self::rest(failed, saved, &stuck, parts));
            }
            last = Some(failed.error);
            if let Err(failed) = self.backtrack(&mut saved, at + 1, round) {
                return Err(Self::rest(failed, saved, &stuck, parts));
            }
        }
        Ok((stuck, last))
    }

    /// Failure with the saved state, which lacks the stuck parts before it and all parts after it.
    fn rest<'p>(failed: Failed<'a>, saved: Saved<'a, 'p>, stuck: &[&'p Part], parts: &'p [Part]) -> Failed<'a> {
        let after = &parts[saved.at..];
        let before = stuck.iter().copied().filter(|part| !after.iter().any(|p| std::ptr::eq(p, *part)));
        let rest = State::of(saved.push, before.chain(after), saved.summary);
        Failed { rest: Some(Box::new(rest)), ..failed }
    }

    /// State before part `at`.
    fn save<'p>(&self, at: usize) -> Saved<'a, 'p> {
        Saved { push: self.push.clone(), summary: self.summary, since: Vec::new(), at }
    }

    /// Undoes the last part: restores the saved state and repeats the parts recovered since.
    fn backtrack(&mut self, saved: &mut Saved<'a, '_>, at: usize, round: u64) -> Result<(), Failed<'a>> {
        // The whole complex is copied.
        let counted = self.watch.spend(saved.push.s.c.slots() / COPIED);
        counted.map_err(|stop| Failed::new(stop.into(), false))?;
        (self.push, self.summary) = (saved.push.clone(), saved.summary);
        let done = std::mem::take(&mut saved.since);
        for part in &done {
            self.recover(part, round)?;
        }
        if !done.is_empty() {
            *saved = self.save(at);
        }
        Ok(())
    }

    fn recover(&mut self, part: &Part, round: u64) -> Result<(), Failed<'a>> {
        let salt = self.way.salt + round;
        let size = (part.edges.len() + part.triangles.len()) as u64;
        let limit = Budget::new((self.share * (PART_OPERATIONS.0 * size + PART_OPERATIONS.1)) << round);
        let watch = self.watch.within(&limit);
        let done = recover_part(&mut self.push, part, salt, &mut self.summary, self.budget, &watch);
        self.watch.spend(limit.spent() as usize).map_err(|stop| Failed::new(stop.into(), false))?;
        done.map_err(|error| match error {
            // Few parts need much more than the others. After these, less is in the way.
            TetError::OverBudget { .. } => Failed::new(out_of_budget(part, &self.push.triangles), true),
            error => {
                let error = about_input(error, self.surface, part);
                // The surface does not intersect itself, so the obstacle may be gone at the next attempt.
                let again = matches!(error, TetError::Stuck { reason, .. } if reason != Stuck::Budget);
                Failed::new(error, again)
            }
        })
    }
}

fn out_of_budget(part: &Part, triangles: &[[u32; 3]]) -> TetError {
    let triangle = part.triangles.first().map(|&t| Obstacle::Triangle(triangles[t as usize]));
    let part = part.edges.first().map(|&edge| Obstacle::Edge(edge)).or(triangle).unwrap_or(Obstacle::Point(0));
    TetError::Stuck { part, reason: Stuck::Budget }
}

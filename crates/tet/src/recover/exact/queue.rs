//! Recovery of parts one after another. A part that fails is undone and waits until all others are recovered. Then it
//! is tried in other orders, and with the other kind of cavity; by then its obstacles have changed.

use super::level::level_out;
use super::one::{ExactSummary, about_input, recover_part};
use super::parts::{Missing, Part, parts};
use super::push::Push;
use super::ways::RecoveryStrategy;
use crate::error::{Stuck, TetError};
use crate::input::SurfaceEdges;
use crate::progress::Watch;
use crate::recover::flat::dissolve_flat;
use anastomesh_mesh::TriMesh;

/// Maximum rounds over the waiting parts.
const MAX_PASSES: u64 = 6;

/// Maximum rounds if a large part is left, since large parts take most of the time.
const MAX_PASSES_LARGE: u64 = 2;

/// Round after which the remaining edges are tried in planes of facets.
const LEVEL_AFTER: u64 = 1;

/// Minimum missing edges of a large part. Also the number of recovered edges after which the state is saved.
const LARGE: usize = 100;

/// Maximum waiting parts before a strategy is abandoned: a constant, plus this fraction of all parts.
const MAX_WAITING: (usize, f64) = (16, 0.25);

/// Error of a failed recovery, and a flag for retry.
pub(super) struct Failed {
    pub error: TetError,
    pub again: bool,
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
    watch: &'b Watch<'b>,
}

/// State to return to when a part fails.
struct Saved<'a, 'p> {
    push: Push<'a>,
    summary: ExactSummary,
    /// Parts recovered since the state was saved.
    since: Vec<&'p Part>,
}

impl<'a, 'b> Queue<'a, 'b> {
    pub(super) fn new(
        push: Push<'a>,
        (surface, edges): (&'b TriMesh, &'b SurfaceEdges),
        (way, budget): (RecoveryStrategy, usize),
        watch: &'b Watch<'b>,
    ) -> Self {
        Self { push, summary: ExactSummary::default(), surface, edges, way, budget, watch }
    }

    /// Recovers all missing parts.
    pub(super) fn run(mut self, missing: Missing) -> Result<(Push<'a>, ExactSummary), Failed> {
        let mut waiting = parts(&self.surface.triangles, missing);
        for round in 0..MAX_PASSES {
            self.push.segments.deep = self.way.deep != (round % 2 == 1);
            let (stuck, last) = self.pass(&waiting, round)?;
            let Some(error) = last else { return Ok((self.push, self.summary)) };
            let large = stuck.iter().any(|part| part.edges.len() >= LARGE);
            if round + 1 == if large { MAX_PASSES_LARGE } else { MAX_PASSES } {
                return Err(Failed { error, again: true });
            }
            waiting = stuck.into_iter().cloned().collect();
            if round == LEVEL_AFTER {
                waiting = self.level(&waiting)?;
            }
        }
        Ok((self.push, self.summary))
    }

    /// Recovers remaining edges in planes of facets, after dissolving flat tetrahedra. Returns the parts still missing.
    fn level(&mut self, waiting: &[Part]) -> Result<Vec<Part>, Failed> {
        let edges: Vec<[u32; 2]> = waiting.iter().flat_map(|part| &part.edges).copied().collect();
        let triangles: Vec<u32> = waiting.iter().flat_map(|part| &part.triangles).copied().collect();
        let missing = Missing { edges: &edges, triangles: &triangles };
        let flat = self.push.s.flat;
        dissolve_flat(&mut self.push.s.c, self.surface, self.edges, flat);
        let left = level_out(&mut self.push, self.edges, missing, f64::INFINITY, self.watch);
        let Some((edges, triangles)) = left.map_err(|error| Failed { error, again: false })? else {
            return Ok(waiting.to_vec());
        };
        Ok(parts(&self.surface.triangles, Missing { edges: &edges, triangles: &triangles }))
    }

    /// Tries each part once. Returns the failed parts and the last error.
    fn pass<'p>(&mut self, parts: &'p [Part], round: u64) -> Result<(Vec<&'p Part>, Option<TetError>), Failed> {
        let mut saved = self.save();
        let (mut stuck, mut last) = (Vec::new(), None);
        for part in parts {
            let since: usize = saved.since.iter().map(|part| 1 + part.edges.len()).sum();
            if since > 0 && since + part.edges.len() >= LARGE {
                saved = self.save();
            }
            match self.recover(part, round) {
                Ok(()) => saved.since.push(part),
                Err(Failed { error, again: true }) => {
                    stuck.push(part);
                    if stuck.len() > MAX_WAITING.0 + (MAX_WAITING.1 * parts.len() as f64) as usize {
                        return Err(Failed { error, again: true });
                    }
                    last = Some(error);
                    self.backtrack(&mut saved, round)?;
                }
                Err(failed) => return Err(failed),
            }
        }
        Ok((stuck, last))
    }

    fn save<'p>(&self) -> Saved<'a, 'p> {
        Saved { push: self.push.clone(), summary: self.summary, since: Vec::new() }
    }

    /// Undoes the last part: restores the saved state and repeats the parts recovered since.
    fn backtrack(&mut self, saved: &mut Saved<'a, '_>, round: u64) -> Result<(), Failed> {
        // The whole complex is copied.
        let counted = self.watch.spend(saved.push.s.c.slots());
        counted.map_err(|stop| Failed { error: stop.into(), again: false })?;
        (self.push, self.summary) = (saved.push.clone(), saved.summary);
        let done = std::mem::take(&mut saved.since);
        for part in &done {
            self.recover(part, round)?;
        }
        if !done.is_empty() {
            *saved = self.save();
        }
        Ok(())
    }

    fn recover(&mut self, part: &Part, round: u64) -> Result<(), Failed> {
        let salt = self.way.salt + round;
        let done = recover_part(&mut self.push, part, salt, &mut self.summary, self.budget, self.watch);
        done.map_err(|error| {
            let error = about_input(error, self.surface, part);
            // The surface does not intersect itself, so the obstacle may be gone at the next attempt.
            let again = matches!(error, TetError::Stuck { reason, .. } if reason != Stuck::Budget);
            Failed { error, again }
        })
    }
}

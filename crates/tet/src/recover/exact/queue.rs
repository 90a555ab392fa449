//! Parts one after the other. One that is stuck is undone and waits until all others are there; then it is tried in other
//! orders, and with cavities of the other kind: what was in its way has changed by then.

use super::level::level_out;
use super::one::{ExactSummary, about_input, recover_part};
use super::parts::{Missing, Part, parts};
use super::push::Push;
use super::ways::Way;
use crate::error::{Stuck, TetError};
use crate::input::SurfaceEdges;
use crate::progress::Watch;
use crate::recover::flat::dissolve_flat;
use anastomesh_mesh::TriMesh;

/// Maximum passes over the stuck parts with one way of recovery.
const MAX_PASSES: u64 = 6;

/// Maximum passes over stuck parts if one of them is large. Large parts take most of the time.
const MAX_PASSES_LARGE: u64 = 2;

/// After this time, what is left is turned in planes of faces.
const LEVEL_AFTER: u64 = 1;

/// Missing edges of a part that is large, and of those parts that are done again when the next one is undone.
const LARGE: usize = 100;

/// So many parts may wait, and this share of all, before a way is given up.
const WAITING: (usize, f64) = (16, 0.25);

/// Why parts could not be recovered, and whether all may be tried again.
pub(super) struct Failed {
    pub error: TetError,
    pub again: bool,
}

/// Recovers parts in a way.
pub(super) struct Queue<'a, 'b> {
    push: Push<'a>,
    summary: ExactSummary,
    surface: &'b TriMesh,
    edges: &'b SurfaceEdges,
    way: Way,
    /// Implicit vertices allowed.
    budget: usize,
    watch: &'b Watch<'b>,
}

/// What can be gone back to.
struct Saved<'a, 'p> {
    push: Push<'a>,
    summary: ExactSummary,
    /// Recovered since.
    since: Vec<&'p Part>,
}

impl<'a, 'b> Queue<'a, 'b> {
    pub(super) fn new(
        push: Push<'a>,
        (surface, edges): (&'b TriMesh, &'b SurfaceEdges),
        (way, budget): (Way, usize),
        watch: &'b Watch<'b>,
    ) -> Self {
        Self { push, summary: ExactSummary::default(), surface, edges, way, budget, watch }
    }

    /// Recovers all that is missing.
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

    /// Turns edges in planes of faces, for what is left, where flat tetrahedra are in the way no longer. Returns what is
    /// left then.
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

    /// Tries parts once. Returns those that are stuck, and why the last of them is.
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
                    if stuck.len() > WAITING.0 + (WAITING.1 * parts.len() as f64) as usize {
                        return Err(Failed { error, again: true });
                    }
                    last = Some(error);
                    self.go_back(&mut saved, round)?;
                }
                Err(failed) => return Err(failed),
            }
        }
        Ok((stuck, last))
    }

    fn save<'p>(&self) -> Saved<'a, 'p> {
        Saved { push: self.push.clone(), summary: self.summary, since: Vec::new() }
    }

    /// Undoes the last part: goes back to what was saved, and does again what came since, as it was done before.
    fn go_back(&mut self, saved: &mut Saved<'a, '_>, round: u64) -> Result<(), Failed> {
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
            // The surface does not meet itself, so whatever was in the way may not be there another time.
            let again = matches!(error, TetError::Stuck { reason, .. } if reason != Stuck::Budget);
            Failed { error, again }
        })
    }
}

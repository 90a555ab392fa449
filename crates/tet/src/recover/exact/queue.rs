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
use anastomesh_mesh::budget::{Budget, Stop};

/// Maximum rounds over the waiting parts.
const MAX_PASSES: u64 = 3;

/// Maximum rounds if a large part is left, since large parts take most of the time.
const MAX_PASSES_LARGE: u64 = 2;

/// Round after which the remaining edges are tried in planes of facets.
const LEVEL_AFTER: u64 = 1;

/// Minimum missing edges of a large part.
const LARGE: usize = 100;

/// Operations for one part in the first round: per missing edge or triangle, plus a constant. Each round doubles them.
const PART_OPERATIONS: (u64, u64) = (10_000, 200_000);

/// Maximum waiting parts before a strategy is abandoned: a constant, plus this fraction of all parts.
const MAX_WAITING: (usize, f64) = (16, 0.5);

/// Failed recovery.
pub(super) struct Failed<'a> {
    pub error: TetError,
    /// True if a larger budget may recover more.
    pub limited: bool,
    /// State with the parts recovered so far, and the parts still missing.
    pub rest: Box<State<'a>>,
}

/// Result of one round over the parts.
struct Pass<'p> {
    /// Parts still missing.
    stuck: Vec<&'p Part>,
    /// Last failure of a part.
    last: Option<TetError>,
    /// Reason to end the strategy.
    end: Option<TetError>,
}

/// Result for one part, with the reason to end early.
enum Tried {
    Recovered(Option<Stop>),
    /// Another attempt may succeed.
    Waits(TetError, Option<Stop>),
    Fails(TetError),
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
    /// True if a part has exceeded its budget.
    limited: bool,
}

impl<'a, 'b> Queue<'a, 'b> {
    pub(super) fn new(
        push: Push<'a>,
        (surface, edges): (&'b TriMesh, &'b SurfaceEdges),
        (way, budget, share): (RecoveryStrategy, usize, u64),
        watch: &'b Watch<'b>,
    ) -> Self {
        Self { push, summary: ExactSummary::default(), surface, edges, way, budget, share, watch, limited: false }
    }

    /// Recovers all missing parts.
    pub(super) fn run(mut self, missing: Missing) -> Result<(Push<'a>, ExactSummary), Failed<'a>> {
        let mut waiting = parts(&self.surface.triangles, missing);
        for round in 0..MAX_PASSES {
            self.push.segments.deep = self.way.deep != (round % 2 == 1);
            let Pass { stuck, last, end } = self.pass(&waiting, round);
            let large = stuck.iter().any(|part| part.edges.len() >= LARGE);
            let is_last = round + 1 == if large { MAX_PASSES_LARGE } else { MAX_PASSES };
            let error = match (end, last) {
                (None, None) => return Ok((self.push, self.summary)),
                (None, Some(error)) if is_last => Some(error),
                (end, _) => end,
            };
            if let Some(error) = error {
                let rest = State::of(self.push, stuck.into_iter(), self.summary);
                let limited = self.limited || matches!(error, TetError::OverBudget { .. });
                return Err(Failed { error, limited, rest: Box::new(rest) });
            }
            waiting = stuck.into_iter().cloned().collect();
            if round == LEVEL_AFTER {
                let before = (self.push.clone(), self.summary);
                waiting = self.level(&waiting).map_err(|error| {
                    let rest = State::of(before.0, waiting.iter(), before.1);
                    Failed { error, limited: true, rest: Box::new(rest) }
                })?;
            }
        }
        Ok((self.push, self.summary))
    }

    /// Recovers remaining edges in planes of facets, after dissolving flat tetrahedra. Returns the parts still missing.
    fn level(&mut self, waiting: &[Part]) -> Result<Vec<Part>, TetError> {
        let edges: Vec<[u32; 2]> = waiting.iter().flat_map(|part| &part.edges).copied().collect();
        let triangles: Vec<u32> = waiting.iter().flat_map(|part| &part.triangles).copied().collect();
        let missing = Missing { edges: &edges, triangles: &triangles };
        let flat = self.push.s.flat;
        dissolve_flat(&mut self.push.s.c, self.surface, self.edges, flat);
        let left = level_out(&mut self.push, self.edges, missing, f64::INFINITY, self.watch)?;
        let Some((edges, triangles)) = left else {
            return Ok(waiting.to_vec());
        };
        Ok(parts(&self.surface.triangles, Missing { edges: &edges, triangles: &triangles }))
    }

    /// Tries each part once.
    fn pass<'p>(&mut self, parts: &'p [Part], round: u64) -> Pass<'p> {
        let waiting = MAX_WAITING.0 + (MAX_WAITING.1 * parts.len() as f64) as usize;
        let (mut stuck, mut last) = (Vec::new(), None);
        for (at, part) in parts.iter().enumerate() {
            let (recovered, end) = match self.recover(part, round) {
                Tried::Recovered(end) => (true, end.map(TetError::from)),
                Tried::Waits(error, end) => {
                    stuck.push(part);
                    let full = (stuck.len() > waiting).then(|| error.clone());
                    last = Some(error);
                    (true, end.map(TetError::from).or(full))
                }
                Tried::Fails(error) => (false, Some(error)),
            };
            if end.is_some() {
                stuck.extend(&parts[at + usize::from(recovered)..]);
                return Pass { stuck, last, end };
            }
        }
        Pass { stuck, last, end: None }
    }

    /// Tries a part. After a failure, the complex is as before.
    fn recover(&mut self, part: &Part, round: u64) -> Tried {
        let salt = self.way.salt + round;
        let size = (part.edges.len() + part.triangles.len()) as u64;
        let own = (self.share * (PART_OPERATIONS.0 * size + PART_OPERATIONS.1)) << round;
        let limit = Budget::new(own.min(self.watch.left()));
        let watch = self.watch.within(&limit);
        let (mark, summary) = (self.push.record(), self.summary);
        let done = recover_part(&mut self.push, part, salt, &mut self.summary, self.budget, &watch);
        if done.is_ok() {
            self.push.keep();
        } else {
            self.push.undo(mark);
            self.summary = summary;
        }
        let end = self.watch.spend(limit.spent() as usize).err();
        match done {
            Ok(()) => Tried::Recovered(end),
            // Few parts need much more than the others. After these, less is in the way.
            Err(TetError::OverBudget { .. }) => {
                self.limited = true;
                Tried::Waits(out_of_budget(part, &self.push.triangles), end)
            }
            Err(error) => match about_input(error, self.surface, part) {
                // The surface does not intersect itself, so the obstacle may be gone at the next attempt.
                error @ TetError::Stuck { reason, .. } if reason != Stuck::Budget => Tried::Waits(error, end),
                error => Tried::Fails(error),
            },
        }
    }
}

fn out_of_budget(part: &Part, triangles: &[[u32; 3]]) -> TetError {
    let triangle = part.triangles.first().map(|&t| Obstacle::Triangle(triangles[t as usize]));
    let part = part.edges.first().map(|&edge| Obstacle::Edge(edge)).or(triangle).unwrap_or(Obstacle::Point(0));
    TetError::Stuck { part, reason: Stuck::Budget }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_over_its_budget_is_named_by_its_first_edge() {
        let of = |edges: &[[u32; 2]], triangles: &[u32]| {
            let part = Part { edges: edges.to_vec(), triangles: triangles.to_vec() };
            out_of_budget(&part, &[[0, 1, 2], [2, 1, 3]])
        };
        let stuck = |part| TetError::Stuck { part, reason: Stuck::Budget };
        assert_eq!(of(&[[4, 5], [1, 2]], &[1]), stuck(Obstacle::Edge([4, 5])));
        assert_eq!(of(&[], &[1, 0]), stuck(Obstacle::Triangle([2, 1, 3])));
    }
}

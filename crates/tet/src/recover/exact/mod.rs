//! Exact recovery, which cannot fail in exact arithmetic. Implicit vertices are inserted at crossings, then moved off
//! the surface (George, Borouchaki, Saltel, 'Ultimate robustness in meshing an arbitrary polyhedron', 2003). Tetrahedra
//! that no missing part crosses stay unchanged.
//!
//! Edges in planes of facets, up to rounding, are first recovered by exchanges there ([`level`], [`pierce`]). Then:
//!
//! 1. [`segments`]: missing edges become chains of edges, with a vertex at each face or edge that they cross.
//! 2. [`facets`]: missing triangles become unions of faces, with a vertex at each edge that pierces them.
//! 3. [`push`]: copies inside the sectors between facets replace each vertex ([`sectors`], [`room`], [`wider`]).

mod course;
mod dig;
mod facets;
mod helpers;
mod kernel;
mod level;
mod looks;
mod one;
mod parts;
mod pierce;
mod plane;
mod polygon;
mod push;
mod queue;
mod sectors;
mod segments;
mod space;
mod state;
mod ways;
mod wider;

use crate::complex::Complex;
use crate::error::TetError;
use crate::input::SurfaceEdges;
use crate::progress::Watch;
use anastomesh_mesh::TriMesh;
use one::ExactSummary;
pub(crate) use parts::Missing;
use push::Push;
use queue::{Failed, Queue};
use segments::Segments;
use space::Space;
use state::State;
pub(crate) use ways::RecoveryStrategy;

/// Exact recovery of the missing parts in a complex that has the rest of the surface with its triangles frozen. The
/// surface must not intersect itself; its triangles may share whole edges and vertices in any way.
pub(crate) struct ExactRecovery<'a> {
    surface: &'a TriMesh,
    edges: &'a SurfaceEdges,
    start: State<'a>,
    level: Leveled<'a>,
    /// Last recovery in planes that took too long.
    too_long: Option<TooLong>,
    /// Strategies that have recovered nothing in the present state, with the largest budget of each.
    futile: Vec<(RecoveryStrategy, u64)>,
}

/// State after recovery in planes.
enum Leveled<'a> {
    /// Not tried.
    Unknown,
    /// Too many edges would remain.
    Useless,
    Done(Box<State<'a>>),
}

/// Recovery in planes that took too long. It is repeated with a larger budget, or once many more parts are recovered.
#[derive(Clone, Copy)]
pub(crate) struct TooLong {
    share: u64,
    missing: usize,
}

/// Maximum missing parts, relative to those of a recovery in planes that took too long, for its repetition.
const REPEAT_BELOW: f64 = 0.5;

impl<'a> ExactRecovery<'a> {
    /// Recovery that starts with `c`. `flat` is the thickness below which a part counts as flat in the choice between
    /// ways.
    pub(crate) fn new(
        c: Complex,
        (surface, edges): (&'a TriMesh, &'a SurfaceEdges),
        missing: Missing,
        flat: f64,
    ) -> Self {
        let segments = Segments::new(edges, surface.points.len());
        let push = Push::new(Space::new(c, flat), segments, surface.triangles.clone());
        let start = State { push, edges: missing.edges.to_vec(), triangles: missing.triangles.to_vec(), made: 0 };
        Self { surface, edges, start, level: Leveled::Unknown, too_long: None, futile: Vec::new() }
    }

    /// Number of missing edges and triangles.
    pub(crate) fn missing(&self) -> usize {
        self.start.edges.len() + self.start.triangles.len()
    }

    /// Missing edges and triangles.
    pub(crate) fn missing_parts(&self) -> Missing<'_> {
        Missing { edges: &self.start.edges, triangles: &self.start.triangles }
    }

    /// Complex with the parts recovered so far, the number of Steiner points made, and what took too long.
    pub(crate) fn into_complex(self) -> (Complex, usize, Option<TooLong>) {
        (self.start.push.s.c, self.start.made, self.too_long)
    }

    /// Recovery that continues after flips.
    pub(crate) fn after(self, too_long: Option<TooLong>) -> Self {
        Self { too_long, ..self }
    }

    /// True if recovery in planes would take too long again.
    fn is_too_long(&self, share: u64) -> bool {
        let alike = |last: TooLong| self.missing() as f64 > REPEAT_BELOW * last.missing as f64;
        self.too_long.is_some_and(|last| share <= last.share && alike(last))
    }

    /// True if a strategy cannot recover anything, as an earlier attempt has shown. It would repeat the same work.
    fn is_futile(&self, way: RecoveryStrategy, share: u64) -> bool {
        // Strategies differ in the treatment of edges.
        let alike = |other: RecoveryStrategy| other == way || self.start.edges.is_empty();
        self.futile.iter().any(|&(other, tried)| share <= tried && alike(other))
    }

    /// Tries one strategy. Each part may take `share` times the usual operations. After a failure, the parts that it
    /// recovered are kept.
    ///
    /// # Errors
    /// [`TetError::EdgeMeets`]; [`TetError::Stuck`] if no floating-point position off the surface exists or the vertex
    /// budget is exceeded; [`TetError::OverBudget`]; [`TetError::Cancelled`].
    pub(crate) fn attempt(
        &mut self,
        way: RecoveryStrategy,
        share: u64,
        watch: &Watch,
    ) -> Result<(Complex, ExactSummary), TetError> {
        let none = TetError::NotRecovered { edges: self.start.edges.clone(), triangles: self.start.triangles.clone() };
        if self.is_futile(way, share) {
            return Err(none);
        }
        if let Some(part) = way.level {
            let known = match self.level {
                Leveled::Unknown => self.is_too_long(share),
                Leveled::Useless => part.is_finite(),
                Leveled::Done(_) => true,
            };
            if !known {
                let leveled = self.start.leveled(self.edges, part, watch);
                if matches!(leveled, Err(TetError::OverBudget { .. })) {
                    self.too_long = Some(TooLong { share, missing: self.missing() });
                }
                self.level = leveled?.map_or(Leveled::Useless, |state| Leveled::Done(Box::new(state)));
            }
        }
        let state = match (&self.level, way.level) {
            (Leveled::Done(state), Some(_)) => Some(&**state),
            (_, Some(_)) => None,
            (_, None) => Some(&self.start),
        };
        let Some(state) = state else { return Err(none) };
        let left = Missing { edges: &state.edges, triangles: &state.triangles };
        let budget = way.budget(state.edges.len());
        let made = state.made;
        let queue = Queue::new(state.push.clone(), (self.surface, self.edges), (way, budget, share), watch);
        match queue.run(left) {
            Ok((push, summary)) => {
                Ok((push.s.c, ExactSummary { steiner_points: made + summary.steiner_points, ..summary }))
            }
            Err(Failed { error, limited, rest }) => {
                let before = state.edges.len() + state.triangles.len();
                if rest.edges.len() + rest.triangles.len() < before {
                    self.start = State { made: made + rest.made, ..*rest };
                    self.level = Leveled::Unknown;
                    self.futile.clear();
                } else {
                    self.futile.push((way, if limited { share } else { u64::MAX }));
                }
                Err(error)
            }
        }
    }
}

#[cfg(test)]
pub(crate) mod shapes;
#[cfg(test)]
mod tests;

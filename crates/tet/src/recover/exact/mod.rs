//! The exact tier, which does not fail in exact arithmetic: what is missing is cut into the complex with implicit vertices
//! on it, which are then moved off the surface (George, Borouchaki, Saltel, 'Ultimate robustness in meshing an arbitrary
//! polyhedron', 2003). Only what is crossed changes.
//!
//! What lies in planes of faces but for rounding is recovered before, by turning edges there ([`level`], [`pierce`]). Then:
//!
//! 1. [`segments`]: missing edges become chains of edges, with a vertex at each face or edge that they cross.
//! 2. [`facets`]: missing triangles become unions of faces, with a vertex at each edge that pierces them.
//! 3. [`push`]: each of these vertices gives way to copies inside the sectors between the facets around it ([`sectors`],
//!    [`kernel`]); where a sector is too narrow, what lies beside it is taken as well ([`wider`]).

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
mod ways;
mod wider;

use crate::complex::Complex;
use crate::error::TetError;
use crate::input::SurfaceEdges;
use crate::progress::Watch;
use anastomesh_mesh::TriMesh;
use level::level_out;
pub(crate) use one::ExactSummary;
pub(crate) use parts::Missing;
use push::Push;
use queue::{Failed, Queue};
use segments::Segments;
use space::Space;
pub(crate) use ways::RecoveryStrategy;

/// Recovers what is missing in a complex that has all the rest of the surface, its triangles frozen, in the first of the
/// ways that succeeds. The surface may not meet itself; its triangles may share whole edges and vertices in any way, well
/// inside the complex. What is thinner than `flat` counts as flat where that chooses between ways.
///
/// # Errors
/// [`TetError::EdgeMeets`]; [`TetError::Stuck`] where no floating-point position was found off the surface, or too many
/// vertices were needed; [`TetError::Cancelled`].
pub(crate) fn recover_exact(
    c: &Complex,
    surface: &TriMesh,
    edges: &SurfaceEdges,
    missing: Missing,
    (ways, flat): (&[RecoveryStrategy], f64),
    watch: &Watch,
) -> Result<(Complex, ExactSummary), TetError> {
    let segments = Segments::new(edges, surface.points.len());
    let push = Push::new(Space::new(c.clone(), flat), segments, surface.triangles.clone());
    let start = Start { push, edges: missing.edges.to_vec(), triangles: missing.triangles.to_vec() };
    let mut level: Option<Option<Start>> = None;
    let mut last = TetError::NotRecovered { edges: start.edges.clone(), triangles: start.triangles.clone() };
    for &way in ways {
        let start = match (way.level, &mut level) {
            (None, _) => &start,
            (Some(_), Some(Some(level))) => level,
            (Some(_), Some(None)) => continue,
            (Some(share), none) => match none.insert(start.leveled(edges, share, watch)?) {
                Some(level) => level,
                None => continue,
            },
        };
        let left = Missing { edges: &start.edges, triangles: &start.triangles };
        let budget = way.budget(start.edges.len());
        match Queue::new(start.push.clone(), (surface, edges), (way, budget), watch).run(left) {
            Ok((push, summary)) => return Ok((push.s.c, summary)),
            Err(Failed { error, .. }) if !matches!(error, TetError::Stuck { .. }) => return Err(error),
            Err(Failed { error, .. }) => last = error,
        }
    }
    Err(last)
}

/// A complex, and what of the surface is missing in it.
#[derive(Clone)]
struct Start<'a> {
    push: Push<'a>,
    edges: Vec<[u32; 2]>,
    triangles: Vec<u32>,
}

impl Start<'_> {
    /// With what lies in planes of faces recovered; nothing where more than a share of the edges would be left.
    fn leveled(&self, edges: &SurfaceEdges, share: f64, watch: &Watch) -> Result<Option<Self>, TetError> {
        let mut push = self.push.clone();
        let missing = Missing { edges: &self.edges, triangles: &self.triangles };
        let left = level_out(&mut push, edges, missing, share, watch)?;
        Ok(left.map(|(edges, triangles)| Self { push, edges, triangles }))
    }
}

#[cfg(test)]
mod tests;

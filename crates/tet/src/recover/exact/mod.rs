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
mod level;
mod looks;
mod one;
mod parts;
mod pierce;
mod plane;
mod polygon;
mod push;
mod queue;
mod room;
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
pub(crate) use ways::Way;

/// Recovers the missing parts in a complex that has the rest of the surface with its triangles frozen. The ways are
/// tried in order until one succeeds. The surface must not intersect itself; its triangles may share whole edges and
/// vertices in any way. `flat` is the thickness below which a part counts as flat in the choice between ways.
///
/// # Errors
/// [`TetError::EdgeMeets`]; [`TetError::Stuck`] if no floating-point position off the surface exists or the vertex
/// budget is exceeded; [`TetError::Cancelled`].
pub(crate) fn recover_exact(
    c: &Complex,
    surface: &TriMesh,
    edges: &SurfaceEdges,
    missing: Missing,
    (ways, flat): (&[Way], f64),
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

/// A complex and the edges and triangles of the surface that it lacks.
#[derive(Clone)]
struct Start<'a> {
    push: Push<'a>,
    edges: Vec<[u32; 2]>,
    triangles: Vec<u32>,
}

impl Start<'_> {
    /// Recovers edges in facet planes. Returns `None` if more than `share` of the edges would remain missing.
    fn leveled(&self, edges: &SurfaceEdges, share: f64, watch: &Watch) -> Result<Option<Self>, TetError> {
        let mut push = self.push.clone();
        let missing = Missing { edges: &self.edges, triangles: &self.triangles };
        let left = level_out(&mut push, edges, missing, share, watch)?;
        Ok(left.map(|(edges, triangles)| Self { push, edges, triangles }))
    }
}

#[cfg(test)]
mod tests;

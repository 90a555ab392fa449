//! The exact tier, which does not fail in exact arithmetic: what is missing is cut into the complex with implicit vertices
//! on it, which are then moved off the surface (George, Borouchaki, Saltel, 'Ultimate robustness in meshing an arbitrary
//! polyhedron', 2003). Only what is crossed changes.
//!
//! What lies in planes of faces but for rounding is recovered before, by turning edges there ([`level`], [`pierce`]). Then:
//!
//! 1. [`segments`]: missing edges become chains of edges, with a vertex at each face or edge that they cross.
//! 2. [`facets`]: missing triangles become unions of faces, with a vertex at each edge that pierces them.
//! 3. [`push`]: each of these vertices gives way to copies inside the sectors between the facets around it ([`sectors`],
//!    [`room`]); where a sector is too narrow, what lies beside it is taken as well ([`wider`]).

mod course;
mod dig;
mod facets;
mod helpers;
mod level;
mod looks;
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

use crate::mesh::TriMesh;
use crate::tet::complex::Complex;
use crate::tet::delaunay::hash;
use crate::tet::error::{Obstacle, Stuck, TetError};
use crate::tet::input::SurfaceEdges;
use crate::tet::progress::Watch;
use helpers::add_helpers;
use level::level_out;
pub(in crate::tet) use parts::Missing;
use parts::Part;
use push::Push;
use queue::{Failed, Queue};
use segments::Segments;
use space::Space;
pub(in crate::tet) use ways::Way;

/// Edges of those missing that may be left when what lies in planes is recovered; beyond that it gains nothing, and new
/// vertices are in the way.
const WORTHWHILE: f64 = 0.2;

/// What the exact tier did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::tet) struct ExactSummary {
    /// Vertices that were put on edges.
    pub on_segments: usize,
    /// Vertices that were put inside of triangles.
    pub on_facets: usize,
    /// Vertices off the surface that remain.
    pub steiner_points: usize,
}

/// Recovers what is missing in a complex that has all the rest of the surface, its triangles frozen, in the first of the
/// ways that succeeds. The surface may not meet itself; its triangles may share whole edges and vertices in any way, well
/// inside the complex. What is thinner than `flat` counts as flat where that chooses between ways.
///
/// # Errors
/// [`TetError::EdgeMeets`]; [`TetError::Stuck`] where no floating-point position was found off the surface, or too many
/// vertices were needed; [`TetError::Cancelled`].
pub(in crate::tet) fn recover_exact(
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
    let mut level: Option<Start> = None;
    let mut last = TetError::NotRecovered { edges: start.edges.clone(), triangles: start.triangles.clone() };
    for &way in ways {
        let start = match &mut level {
            _ if !way.level => &start,
            Some(level) => level,
            none => none.insert(start.leveled(edges, watch)?),
        };
        if way.level && start.edges.len() as f64 > WORTHWHILE * missing.edges.len() as f64 {
            continue;
        }
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
    /// With what lies in planes of faces recovered.
    fn leveled(&self, edges: &SurfaceEdges, watch: &Watch) -> Result<Self, TetError> {
        let mut push = self.push.clone();
        let missing = Missing { edges: &self.edges, triangles: &self.triangles };
        let (edges, triangles) = level_out(&mut push, edges, missing, watch)?;
        Ok(Self { push, edges, triangles })
    }
}

/// What happens to helpers is told of the edge that they were to help.
fn about_input(error: TetError, surface: &TriMesh, part: &Part) -> TetError {
    let known = |v: &u32| (*v as usize) < surface.points.len();
    let of_input = |part: &Obstacle| match part {
        Obstacle::Triangle(v) => v.iter().all(known),
        Obstacle::Edge(v) => v.iter().all(known),
        Obstacle::Point(v) => known(v),
    };
    let error = match error {
        TetError::EdgeMeets { edge, obstacle } => {
            TetError::EdgeMeets { edge, obstacle: obstacle.as_given(&surface.triangles) }
        }
        other => other,
    };
    let told = match &error {
        TetError::EdgeMeets { edge, obstacle } => edge.iter().all(known) && of_input(obstacle),
        TetError::Stuck { part, .. } => of_input(part),
        _ => true,
    };
    let dangling = part.edges.first().filter(|_| !told);
    dangling.map_or(error, |&edge| TetError::Stuck { part: Obstacle::Edge(edge), reason: Stuck::Dangling })
}

fn recover_part(
    push: &mut Push,
    part: &Part,
    salt: u64,
    summary: &mut ExactSummary,
    budget: usize,
    watch: &Watch,
) -> Result<(), TetError> {
    let spend = |push: &Push, on: Obstacle| {
        watch.ask()?;
        let over = push.s.implicit_vertices() > budget;
        if over { Err(TetError::Stuck { part: on, reason: Stuck::Budget }) } else { Ok(()) }
    };
    let helpers = add_helpers(push, part, salt);
    // At random: fans of long thin triangles come in halves of halves then, where one after the other each next chain
    // would have to fit between the one before and what lies beyond.
    let mut edges = part.edges.clone();
    edges.sort_by_key(|&[a, b]| (hash(salt ^ (u64::from(a) << 32 | u64::from(b))), a, b));
    for &ends in &edges {
        spend(push, Obstacle::Edge(ends))?;
        let id = push.segments.cut(&mut push.s, ends)?;
        summary.on_segments += push.add_segment(id);
    }
    let beside = push.segments.list.len() as u32;
    for &ends in &helpers.edges {
        spend(push, Obstacle::Edge(ends))?;
        push.segments.cut(&mut push.s, ends)?;
    }
    #[cfg(test)]
    push.s.check();
    for &t in &part.triangles {
        spend(push, Obstacle::Triangle(push.triangles[t as usize]))?;
        let cover = facets::cover(&mut push.s, &push.segments, push.triangles[t as usize])?;
        summary.on_facets += push.add_facet(t, cover);
    }
    let mut inner = Vec::new();
    for &t in &helpers.triangles {
        let cover = facets::cover(&mut push.s, &push.segments, push.triangles[t as usize])?;
        inner.extend(push.add_helper(t, cover));
    }
    #[cfg(test)]
    push.s.check();
    push.settle()?;
    if !helpers.triangles.is_empty() {
        push.drop_helpers(&helpers.triangles, beside..push.segments.list.len() as u32, inner);
        push.settle()?;
    }
    summary.steiner_points += push.finish();
    let lost = part.triangles.iter().map(|&t| push.triangles[t as usize]).find(|&t| push.s.find_face(t).is_none());
    lost.map_or(Ok(()), |t| Err(TetError::Stuck { part: Obstacle::Triangle(t), reason: Stuck::Precision }))
}

#[cfg(test)]
mod tests;

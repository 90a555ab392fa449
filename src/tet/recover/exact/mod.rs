//! The exact tier, which does not fail in exact arithmetic: what is missing is cut into the complex with implicit vertices
//! on it, which are then moved off the surface (George, Borouchaki, Saltel, 'Ultimate robustness in meshing an arbitrary
//! polyhedron', 2003). Only what is crossed changes.
//!
//! 1. [`segments`]: missing edges become chains of edges, with a vertex at each face or edge that they cross.
//! 2. [`facets`]: missing triangles become unions of faces, with a vertex at each edge that pierces them.
//! 3. [`push`]: each of these vertices gives way to copies inside the sectors between the facets around it ([`sectors`],
//!    [`room`]).

mod dig;
mod facets;
mod parts;
mod polygon;
mod push;
mod room;
mod sectors;
mod segments;
mod space;

use crate::mesh::TriMesh;
use crate::tet::complex::Complex;
use crate::tet::delaunay::hash;
use crate::tet::error::{Stuck, TetError};
use crate::tet::input::SurfaceEdges;
use crate::tet::progress::Watch;
use parts::{Part, parts, sides, sorted};
use push::Push;
use rustc_hash::FxHashMap;
use segments::Segments;
use space::Space;

/// Times that it is tried in another order, where a vertex has found no room.
const ATTEMPTS: u64 = 4;

/// What the surface has and the complex lacks.
#[derive(Clone, Copy)]
pub(in crate::tet) struct Missing<'a> {
    pub edges: &'a [[u32; 2]],
    pub triangles: &'a [u32],
}

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

/// Recovers what is missing in a complex that has all the rest of the surface, its triangles frozen. The surface may not
/// meet itself; its triangles may share whole edges and vertices in any way, well inside the complex.
///
/// # Errors
/// [`TetError::EdgeMeets`]; [`TetError::Stuck`] where no floating-point position exists off the surface.
pub(in crate::tet) fn recover_exact(
    c: &Complex,
    surface: &TriMesh,
    edges: &SurfaceEdges,
    missing: Missing,
    watch: &Watch,
) -> Result<(Complex, ExactSummary), TetError> {
    let mut attempt = 0;
    loop {
        match recover_parts(c.clone(), surface, edges, missing, attempt, watch) {
            Err(TetError::Stuck { reason: Stuck::Precision, .. }) if attempt + 1 < ATTEMPTS => attempt += 1,
            result => return result,
        }
    }
}

fn recover_parts(
    c: Complex,
    surface: &TriMesh,
    edges: &SurfaceEdges,
    missing: Missing,
    salt: u64,
    watch: &Watch,
) -> Result<(Complex, ExactSummary), TetError> {
    let triangles = &surface.triangles;
    let segments = Segments::new(edges, surface.points.len());
    let mut push = Push::new(Space::new(c), segments, triangles);
    let mut summary = ExactSummary::default();
    for part in parts(triangles, missing) {
        watch.ask()?;
        recover_part(&mut push, &part, triangles, salt, &mut summary)?;
    }
    Ok((push.s.c, summary))
}

fn recover_part(
    push: &mut Push,
    part: &Part,
    triangles: &[[u32; 3]],
    salt: u64,
    summary: &mut ExactSummary,
) -> Result<(), TetError> {
    let first = push.segments.list.len() as u32;
    // At random: fans of long thin triangles come in halves of halves then, where one after the other each next chain
    // would have to fit between the one before and what lies beyond.
    let mut edges = part.edges.clone();
    edges.sort_by_key(|&[a, b]| (hash(salt ^ (u64::from(a) << 32 | u64::from(b))), a, b));
    let mut facets: FxHashMap<[u32; 2], u32> = FxHashMap::default();
    for side in part.triangles.iter().flat_map(|&t| sides(triangles[t as usize])) {
        *facets.entry(side).or_default() += 1;
    }
    for &[a, b] in &edges {
        // Where no two facets make sectors, neighbours of two vertices have to, so these stay close.
        let far = facets.get(&sorted(a, b)).is_some_and(|&n| n >= 2);
        push.segments.cut(&mut push.s, [a, b], far)?;
    }
    #[cfg(test)]
    push.s.check();
    for id in first..push.segments.list.len() as u32 {
        summary.on_segments += push.add_segment(id);
    }
    for &t in &part.triangles {
        let cover = facets::cover(&mut push.s, &push.segments, triangles[t as usize])?;
        summary.on_facets += push.add_facet(t, cover);
    }
    #[cfg(test)]
    push.s.check();
    summary.steiner_points += push.finish()?;
    Ok(())
}

#[cfg(test)]
mod tests;

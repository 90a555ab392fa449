//! The exact tier, which does not fail in exact arithmetic: a constrained Delaunay tetrahedralization with implicit
//! vertices on segments (Diazzi, Panozzo, Vaxman, Attene, 'Constrained Delaunay tetrahedrization: a robust and practical
//! approach', 2023), which are then moved off the surface (George, Borouchaki, Saltel 2003).
//!
//! 1. [`segments`]: missing edges are split until their pieces are Delaunay edges ([`insert`]).
//! 2. [`facets`]: what crosses a triangle gives way to constrained Delaunay tetrahedralizations above and below ([`wrap`]).
//! 3. [`push`]: each vertex on an edge gives way to copies inside the sectors around the edge ([`room`]).

mod facets;
mod insert;
mod polygon;
mod push;
mod room;
mod segments;
mod space;
mod wrap;

use crate::geometry::Point3;
use crate::tet::complex::Complex;
use crate::tet::delaunay::delaunay;
use crate::tet::error::TetError;
use push::Push;
use segments::Segments;
use space::Space;

/// What the exact tier did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::tet) struct ExactSummary {
    /// Vertices that were put on edges.
    pub on_segments: usize,
    /// Triangles that had to be recovered.
    pub facets: usize,
    /// Vertices off the surface that remain.
    pub steiner_points: usize,
}

/// A complex over `points` (no two at one place, the triangles and edges well inside their convex hull) in which each
/// of `triangles` is a frozen face and each of `edges` is an edge. Further vertices follow `points`; some may be unused.
/// Triangles may meet in any way that shares whole edges and vertices.
///
/// # Errors
/// [`TetError::EdgeMeets`]; [`TetError::Stuck`] where no floating-point position exists off an edge; errors of
/// [`delaunay`].
pub(in crate::tet) fn recover_exact(
    points: &[Point3],
    triangles: &[[u32; 3]],
    edges: &[[u32; 2]],
) -> Result<(Complex, ExactSummary), TetError> {
    // One zero only: implicit points do not tell −0 from 0 where ties are broken by coordinates.
    let positive_zeros: Vec<Point3> = points.iter().map(|p| p.map(|x| x + 0.0)).collect();
    let mut s = Space::new(delaunay(&positive_zeros)?);
    let mut segments = Segments::new(&positive_zeros, triangles, edges);
    let on_segments = segments.recover(&mut s)?;
    #[cfg(test)]
    s.check();
    let mut facets = facets::recover(&mut s, &segments, triangles)?;
    #[cfg(test)]
    s.check();
    let summary = ExactSummary { on_segments, facets: facets.missing, steiner_points: 0 };
    let mut push = Push::new(&mut s, &mut segments, &mut facets, triangles);
    push.all()?;
    let free = push.free;
    let steiner_points = free.len();
    let mut c = s.c;
    c.points[..points.len()].copy_from_slice(points);
    Ok((c, ExactSummary { steiner_points, ..summary }))
}

#[cfg(test)]
mod tests;

//! What a surface must be before it is tetrahedralized: closed, manifold in its edges, oriented outwards, finite.

use super::certify::enclosed_volume;
use super::error::TetError;
use crate::geometry::predicates::{collinear, in_exact_range};
use crate::mesh::TriMesh;

/// The edges of a closed surface.
#[derive(Clone, Debug, Default)]
pub(super) struct SurfaceEdges {
    /// Each edge once, smaller vertex first, in ascending order.
    pub edges: Vec<[u32; 2]>,
    /// `edges[offset[v]..offset[v + 1]]` have `v` as their smaller vertex.
    offset: Vec<u32>,
}

impl SurfaceEdges {
    /// Where in `edges` those with the smaller vertex `v` are.
    pub fn range(&self, v: u32) -> Option<std::ops::Range<usize>> {
        let end = *self.offset.get((v as usize).saturating_add(1))?;
        Some(self.offset[v as usize] as usize..end as usize)
    }

    /// Whether the surface has edge `a, b`.
    pub fn contains(&self, a: u32, b: u32) -> bool {
        let (a, b) = (a.min(b), a.max(b));
        self.range(a).is_some_and(|r| self.edges[r].iter().any(|e| e[1] == b))
    }
}

/// Checks the surface and lists its edges.
pub(super) fn validate(surface: &TriMesh) -> Result<SurfaceEdges, TetError> {
    let (points, triangles) = (surface.points.len(), surface.triangles.len());
    if points == 0 || triangles == 0 {
        return Err(TetError::Empty { points, triangles });
    }
    if points.max(triangles) > (u32::MAX / 64) as usize {
        return Err(TetError::TooLarge { points });
    }
    if let Some(i) = surface.points.iter().position(|p| !p.iter().all(|&x| in_exact_range(x))) {
        return Err(TetError::OutOfRange { point: i as u32, position: surface.points[i] });
    }
    for (i, &vertices) in surface.triangles.iter().enumerate() {
        let [a, b, c] = vertices;
        if a == b || b == c || c == a || vertices.iter().any(|&v| v as usize >= points) {
            return Err(TetError::BadTriangle { triangle: i as u32, vertices });
        }
        let [p, q, r] = vertices.map(|v| &surface.points[v as usize]);
        if collinear(p, q, r) {
            return Err(TetError::FlatTriangle { triangle: i as u32, vertices });
        }
    }
    let edges = list_edges(surface)?;
    let (volume, _) = enclosed_volume(surface);
    if volume < 0.0 {
        return Err(TetError::InsideOut { volume });
    }
    Ok(edges)
}

/// Pairs the edges; each must be run through once in each direction.
fn list_edges(surface: &TriMesh) -> Result<SurfaceEdges, TetError> {
    let mut sides: Vec<([u32; 2], bool)> = Vec::with_capacity(3 * surface.triangles.len());
    for t in &surface.triangles {
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            sides.push(([a.min(b), a.max(b)], a < b));
        }
    }
    sides.sort_unstable();
    let mut edges = Vec::with_capacity(sides.len() / 2);
    let (mut open, mut crowded, mut twisted) = (Vec::new(), Vec::new(), Vec::new());
    for run in sides.chunk_by(|x, y| x.0 == y.0) {
        match *run {
            [(e, x), (_, y)] if x != y => edges.push(e),
            [(e, _), (_, _)] => twisted.push(e),
            [(e, _)] => open.push(e),
            _ => crowded.push(run[0].0),
        }
    }
    if let Some(&edge) = crowded.first() {
        return Err(TetError::NotManifold { edge, count: crowded.len() });
    }
    if let Some(&edge) = open.first() {
        return Err(TetError::Open { edge, count: open.len() });
    }
    if let Some(&edge) = twisted.first() {
        return Err(TetError::NotOriented { edge, count: twisted.len() });
    }
    let mut offset = vec![0u32; surface.points.len() + 1];
    for e in &edges {
        offset[e[0] as usize + 1] += 1;
    }
    for v in 0..surface.points.len() {
        offset[v + 1] += offset[v];
    }
    Ok(SurfaceEdges { edges, offset })
}

//! Total thickness of the shells at each vertex, before prisms are tested.
//!
//! Three limits apply besides the thickness wanted. They are the space up to the next surface, the convergence of directions
//! around concave places, and a gradual change along the wall.

use crate::layers::{clear_widths, lower};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Point3, Vec3};

/// Share of half the space between two surfaces that shells fill at most. The rest is left for the tissue.
const FILLED: f64 = 0.7;
/// Minimum length of an edge outside the shells, relative to that edge on the wall.
const NARROWEST: f64 = 0.35;
/// Maximum difference of neighbouring thicknesses, relative to their distance.
const GRADE: f64 = 0.3;

/// Thickness at each vertex. `all` is the surface with all obstacles, and begins with the vertices.
pub(super) fn heights(all: &TriMesh, wall: &[[u32; 3]], ways: &[Vec3], wanted: &[f64]) -> Vec<f64> {
    let points = &all.points;
    let furthest = |v: usize| 2.0 * wanted[v] / FILLED;
    let widths = clear_widths(all, ways, furthest);
    let mut heights: Vec<f64> =
        widths.iter().zip(wanted).map(|(width, wanted)| wanted.min(0.5 * FILLED * width)).collect();
    limit_convergence(&mut heights, points, wall, ways);
    lower(&mut heights, points, wall, GRADE);
    heights
}

/// Limits heights so that no edge becomes too short outside.
fn limit_convergence(heights: &mut [f64], points: &[Point3], wall: &[[u32; 3]], ways: &[Vec3]) {
    for &[a, b, c] in wall {
        for [x, y] in [[a, b], [b, c], [c, a]].map(|side| side.map(|v| v as usize)) {
            let edge = points[y] - points[x];
            let closer = -(ways[y] - ways[x]).dot(&edge) / edge.norm_squared();
            if closer > 0.0 {
                let most = (1.0 - NARROWEST) / closer;
                heights[x] = heights[x].min(most);
                heights[y] = heights[y].min(most);
            }
        }
    }
}

//! How long the edges of a wall are to be: in proportion to the radius of the vessel they lie on, growing slowly away
//! from what is thin.

use super::SurfaceParams;
use super::field::Field;
use super::halfedge::HalfEdges;
use std::collections::VecDeque;

/// How much longer edges may become on a way, over its length: edges that share a vertex differ by a fifth.
pub(crate) const GROWTH: f64 = 0.25;

/// The edge length to aim at, at each vertex of a surface near the wall.
pub(super) fn wall_sizes(surface: &HalfEdges, field: &mut Field, params: &SurfaceParams) -> Vec<f64> {
    if params.edge_at(field.largest_radius()) <= params.edge_at(0.0) {
        return vec![params.edge_at(0.0); surface.points.len()];
    }
    let mut sizes: Vec<f64> = surface.points.iter().map(|p| params.edge_at(field.radius(p))).collect();
    grade(surface, &mut sizes);
    sizes
}

/// Lowers sizes until no two neighbours differ by more than [`GROWTH`] times their distance.
fn grade(surface: &HalfEdges, sizes: &mut [f64]) {
    let mut queue: VecDeque<u32> = (0..sizes.len() as u32).filter(|&v| surface.has_vertex(v)).collect();
    let mut queued = vec![true; sizes.len()];
    // Sizes only fall, and to one of finitely many sums along ways: this ends.
    while let Some(v) = queue.pop_front() {
        queued[v as usize] = false;
        let size = sizes[v as usize];
        for h in surface.fan(v) {
            let to = surface.to(h) as usize;
            if sizes[to] > size && sizes[to] > size + GROWTH * surface.length(h) {
                sizes[to] = size + GROWTH * surface.length(h);
                if !queued[to] {
                    queued[to] = true;
                    queue.push_back(to as u32);
                }
            }
        }
    }
}

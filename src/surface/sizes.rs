//! Target edge lengths of a wall: proportional to the vessel radius, with limited growth away from thin vessels.

use super::SurfaceParams;
use super::field::Field;
use super::halfedge::HalfEdges;
use anastomesh_mesh::geometry::{Point3, Section, Total};
use anastomesh_skeleton::FineFork;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Maximum growth of the target edge length per unit of distance: edges that share a vertex differ by a fifth.
pub(crate) const GROWTH: f64 = 0.25;

/// Local refinement of edges at bifurcations. Edges grow from there and reach the usual length at the ends, which other
/// blocks share.
#[derive(Clone, Debug, Default)]
pub struct Finer {
    /// The refined bifurcations.
    pub forks: Vec<FineFork>,
    /// The ends of the block.
    pub ends: Vec<Section>,
}

impl Finer {
    /// Number of additional relaxation rounds. Each round halves edges once.
    pub(super) fn rounds(&self) -> u32 {
        let least = self.forks.iter().map(|fork| fork.factor).fold(1.0, f64::min);
        (1.0 / least).log2().ceil() as u32
    }

    /// Factor on the target edge length `size` at a point of the wall.
    pub(super) fn factor(&self, p: &Point3, size: f64) -> f64 {
        if self.forks.is_empty() {
            return 1.0;
        }
        let to_end = self.ends.iter().map(|end| distance(end, p)).fold(f64::INFINITY, f64::min);
        let at = |fork: &FineFork| {
            let from_fork = ((p - fork.at).norm() - fork.within).max(0.0);
            if from_fork == 0.0 {
                return fork.factor;
            }
            // Growth as elsewhere, or faster where an end is near.
            let share = from_fork / (from_fork + to_end);
            fork.factor + (GROWTH * from_fork / size).max((1.0 - fork.factor) * share)
        };
        self.forks.iter().map(at).fold(1.0, f64::min)
    }
}

/// Distance of a point from the disc of an end.
fn distance(end: &Section, p: &Point3) -> f64 {
    let height = end.height(p);
    let across = (p - end.origin - end.axis * height).norm();
    height.hypot((across - end.radius).max(0.0))
}

/// Target edge length at each vertex of a surface near the wall.
pub(super) fn wall_sizes(surface: &HalfEdges, field: &mut Field, params: &SurfaceParams, finer: &Finer) -> Vec<f64> {
    let mut sizes = graded(surface, field, params);
    if !finer.forks.is_empty() {
        sizes.iter_mut().zip(&surface.points).for_each(|(size, p)| *size *= finer.factor(p, *size));
    }
    sizes
}

/// Target edge lengths from the radius alone.
fn graded(surface: &HalfEdges, field: &mut Field, params: &SurfaceParams) -> Vec<f64> {
    if params.edge_at(field.largest_radius()) <= params.edge_at(0.0) {
        return vec![params.edge_at(0.0); surface.points.len()];
    }
    let mut sizes: Vec<f64> = surface.points.iter().map(|p| params.edge_at(field.radius(p))).collect();
    grade(surface, &mut sizes);
    sizes
}

/// Lowers sizes until neighbours differ by at most [`GROWTH`] times their distance.
fn grade(surface: &HalfEdges, sizes: &mut [f64]) {
    let lowers = |sizes: &[f64], v: u32, h: u32| {
        let (size, there) = (sizes[v as usize], sizes[surface.to(h) as usize]);
        there > size && there > size + GROWTH * surface.length(h)
    };
    let is_source = |&v: &u32| surface.has_vertex(v) && surface.fan(v).any(|h| lowers(sizes, v, h));
    let sources = (0..sizes.len() as u32).filter(is_source);
    // The smallest size first (Dijkstra's algorithm), so that each vertex is final when its turn comes.
    let mut heap: BinaryHeap<Reverse<(Total, u32)>> = sources.map(|v| Reverse((Total(sizes[v as usize]), v))).collect();
    while let Some(Reverse((Total(size), v))) = heap.pop() {
        if size > sizes[v as usize] {
            continue;
        }
        for h in surface.fan(v) {
            if lowers(sizes, v, h) {
                let to = surface.to(h);
                sizes[to as usize] = size + GROWTH * surface.length(h);
                heap.push(Reverse((Total(sizes[to as usize]), to)));
            }
        }
    }
}

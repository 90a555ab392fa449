//! How long the edges of a wall are to be: in proportion to the radius of the vessel they lie on, growing slowly away
//! from what is thin.

use super::SurfaceParams;
use super::field::Field;
use super::halfedge::HalfEdges;
use anastomesh_mesh::geometry::{Point3, Section};
use anastomesh_skeleton::FineFork;
use std::collections::VecDeque;

/// How much longer edges may become on a way, over its length: edges that share a vertex differ by a fifth.
pub(crate) const GROWTH: f64 = 0.25;

/// Where edges are shorter than the radius asks for: at forks, from where they grow again, and are as long as elsewhere at
/// ends, which other blocks have as well.
#[derive(Clone, Debug, Default)]
pub struct Finer {
    /// The forks.
    pub forks: Vec<FineFork>,
    /// The ends.
    pub ends: Vec<Section>,
}

impl Finer {
    /// Rounds of relaxation on top of the usual ones: each halves edges once.
    pub(super) fn rounds(&self) -> u32 {
        let least = self.forks.iter().map(|fork| fork.factor).fold(1.0, f64::min);
        (1.0 / least).log2().ceil() as u32
    }

    /// How many times as long as `size` edges at a place on the wall are.
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
            // As quickly as edges grow elsewhere, and quicker where an end is near.
            let share = from_fork / (from_fork + to_end);
            fork.factor + (GROWTH * from_fork / size).max((1.0 - fork.factor) * share)
        };
        self.forks.iter().map(at).fold(1.0, f64::min)
    }
}

/// Distance of a place from the disc of an end.
fn distance(end: &Section, p: &Point3) -> f64 {
    let height = end.height(p);
    let across = (p - end.origin - end.axis * height).norm();
    height.hypot((across - end.radius).max(0.0))
}

/// The edge length to aim at, at each vertex of a surface near the wall.
pub(super) fn wall_sizes(surface: &HalfEdges, field: &mut Field, params: &SurfaceParams, finer: &Finer) -> Vec<f64> {
    let mut sizes = graded(surface, field, params);
    if !finer.forks.is_empty() {
        sizes.iter_mut().zip(&surface.points).for_each(|(size, p)| *size *= finer.factor(p, *size));
    }
    sizes
}

/// Those that the radius asks for.
fn graded(surface: &HalfEdges, field: &mut Field, params: &SurfaceParams) -> Vec<f64> {
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

//! The given axis held against the one that was meshed.

use super::spread::Spread;
use super::tubes::Tubes;
use anastomesh_skeleton::{EdgeId, Skeleton};
use rayon::prelude::*;
use serde::Serialize;

/// The axis is looked at in steps of so many radii,
const STEP: f64 = 1.0;
/// and in so many of an edge at most.
const MOST_STEPS: f64 = 16.0;
/// Places further off than this, in radii, are kept, and so many of them at most.
const FAR: f64 = 0.5;
const MOST_KEPT: usize = 10_000;

/// A place of the given axis that is far from the one that was meshed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Displaced {
    /// The nodes of the given edge, as in the file.
    pub given: [u32; 2],
    /// Where it is.
    pub place: [f64; 3],
    /// The nodes of the edge that was meshed nearest to it.
    pub meshed: [u32; 2],
    /// How far the meshed axis is from there, in radii.
    pub radii: f64,
}

/// How far the meshed axis is from the given one.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Displacements {
    /// Over the axis, in radii of the given vessel.
    #[serde(flatten)]
    pub spread: Spread,
    /// Length of the given axis.
    pub given_length: f64,
    /// Length of the axis that was meshed.
    pub meshed_length: f64,
    /// Places half a radius off and more, the furthest of each edge, the furthest first; ten thousand at most.
    #[serde(skip)]
    pub furthest: Vec<Displaced>,
}

/// Edges that are looked at at a time.
const AT_A_TIME: usize = 1 << 14;

impl Displacements {
    /// `tubes`: those of what was meshed.
    pub(super) fn of(given: &Skeleton, meshed: &Skeleton, tubes: &Tubes) -> Self {
        let edges: Vec<EdgeId> = given.edge_ids().collect();
        let (mut all, mut furthest) = (Vec::new(), Vec::new());
        for some in edges.chunks(AT_A_TIME) {
            let look = |&edge| along(given, edge, meshed, tubes);
            let found: Vec<(Vec<f32>, Option<Displaced>)> = some.par_iter().with_min_len(64).map(look).collect();
            for (values, worst) in found {
                all.extend(values);
                furthest.extend(worst.filter(|d| d.radii > FAR));
            }
            // A stable sort: the earlier of equals comes first.
            furthest.sort_by(|a: &Displaced, b| b.radii.total_cmp(&a.radii));
            furthest.truncate(MOST_KEPT);
        }
        Self {
            spread: Spread::of(all),
            given_length: edges.iter().map(|&e| given.length(e)).sum(),
            meshed_length: tubes.list.iter().map(anastomesh_mesh::geometry::Tube::length).sum(),
            furthest,
        }
    }
}

/// The displacements along one edge, and the largest of them.
fn along(given: &Skeleton, edge: EdgeId, meshed: &Skeleton, tubes: &Tubes) -> (Vec<f32>, Option<Displaced>) {
    let tube = given.tube(edge);
    let count = (tube.length() / (STEP * tube.min_radius())).ceil().clamp(1.0, MOST_STEPS);
    let ends = given.edge(edge).nodes.map(|n| given.node(n));
    let mut worst: Option<Displaced> = None;
    let values = (0..=count as usize).map(|k| {
        let t = k as f64 / count;
        let place = tube.point(t);
        // At a node of several vessels one lumen is shared, as wide as the node.
        let shared =
            ends.iter().filter(|n| (n.position - place).norm() <= n.radius).map(|n| n.radius).fold(0.0, f64::max);
        let radius = tube.radius(t).max(shared);
        // In radii of the thicker: what lies within a thicker vessel, as a spur did that was taken off, is in its lumen.
        let off = |distance: f64, meshed: f64| distance * (radius / meshed).min(1.0);
        let Some(near) = tubes.nearest(&place, radius, off) else { return f32::INFINITY };
        let radii = off(near.distance, near.radius) / radius;
        if worst.is_none_or(|w| radii > w.radii) {
            let beside = meshed.edge(near.edge).nodes.map(|n| meshed.node(n).original);
            worst = Some(Displaced { given: ends.map(|n| n.original), place: place.into(), meshed: beside, radii });
        }
        radii as f32
    });
    (values.collect(), worst)
}

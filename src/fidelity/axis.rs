//! Comparison of the given axis with the meshed axis.

use super::spread::Spread;
use anastomesh_skeleton::Tubes;
use anastomesh_skeleton::{EdgeId, Skeleton};
use rayon::prelude::*;
use serde::Serialize;

/// Sampling step along the axis, in radii.
const STEP: f64 = 1.0;
/// Maximum samples per edge.
const MOST_STEPS: f64 = 16.0;
/// Minimum displacement, in radii, of listed places, and maximum number of listed places.
const FAR: f64 = 0.5;
const MOST_KEPT: usize = 10_000;

/// Place of the given axis that is far from the meshed axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Displaced {
    /// Nodes of the given edge, as indices in the file.
    pub given: [u32; 2],
    /// The nearer one of them.
    pub node: u32,
    /// Position of the place.
    pub place: [f64; 3],
    /// Nodes of the nearest meshed edge.
    pub meshed: [u32; 2],
    /// Distance of the meshed axis, in radii.
    pub radii: f64,
}

/// Displacement between the given and the meshed axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Displacements {
    /// Distribution over the axis, in radii of the given vessel.
    #[serde(flatten)]
    pub spread: Spread,
    /// Place with the largest displacement; `None` without vessels.
    pub place: Option<Displaced>,
    /// Length of the given axis.
    pub given_length: f64,
    /// Length of the meshed axis.
    pub meshed_length: f64,
    /// Places displaced by more than half a radius: the maximum of each edge, in descending order, at most 10 000.
    #[serde(skip)]
    pub furthest: Vec<Displaced>,
}

/// Number of edges processed at a time.
const AT_A_TIME: usize = 1 << 14;

impl Displacements {
    /// Measures the displacements; `tubes` are those of the meshed network.
    pub(crate) fn of(given: &Skeleton, meshed: &Skeleton, tubes: &Tubes) -> Self {
        let edges: Vec<EdgeId> = given.edge_ids().collect();
        let (mut all, mut furthest) = (Vec::new(), Vec::new());
        let mut place: Option<Displaced> = None;
        for some in edges.chunks(AT_A_TIME) {
            let look = |&edge| along(given, edge, meshed, tubes);
            let found: Vec<(Vec<f32>, Option<Displaced>)> = some.par_iter().with_min_len(64).map(look).collect();
            for (values, worst) in found {
                all.extend(values);
                // Of equal values the first is kept.
                if let Some(worst) = worst.filter(|w| place.is_none_or(|place| w.radii > place.radii)) {
                    place = Some(worst);
                }
                furthest.extend(worst.filter(|d| d.radii > FAR));
            }
            // Stable sort: of equal values the earlier comes first.
            furthest.sort_by(|a: &Displaced, b| b.radii.total_cmp(&a.radii));
            furthest.truncate(MOST_KEPT);
        }
        Self {
            spread: Spread::of(all),
            place,
            given_length: edges.iter().map(|&e| given.length(e)).sum(),
            meshed_length: tubes.list.iter().map(anastomesh_mesh::geometry::Tube::length).sum(),
            furthest,
        }
    }
}

/// Displacements along one edge, and their maximum.
fn along(given: &Skeleton, edge: EdgeId, meshed: &Skeleton, tubes: &Tubes) -> (Vec<f32>, Option<Displaced>) {
    let tube = given.tube(edge);
    let count = (tube.length() / (STEP * tube.min_radius())).ceil().clamp(1.0, MOST_STEPS);
    let ends = given.edge(edge).nodes.map(|n| given.node(n));
    let mut worst: Option<Displaced> = None;
    let values = (0..=count as usize).map(|k| {
        let t = k as f64 / count;
        let place = tube.point(t);
        // Vessels at a node share one lumen with the radius of the node.
        let shared =
            ends.iter().filter(|n| (n.position - place).norm() <= n.radius).map(|n| n.radius).fold(0.0, f64::max);
        let radius = tube.radius(t).max(shared);
        // Relative to the thicker vessel: a removed spur within a thicker vessel lies in its lumen.
        let off = |distance: f64, meshed: f64| distance * (radius / meshed).min(1.0);
        let Some(near) = tubes.nearest(&place, radius, off) else { return f32::INFINITY };
        let radii = off(near.distance, near.radius) / radius;
        if worst.is_none_or(|w| radii > w.radii) {
            let beside = meshed.edge(near.edge).nodes.map(|n| meshed.node(n).original);
            let (given, node) = (ends.map(|n| n.original), ends[usize::from(t > 0.5)].original);
            worst = Some(Displaced { given, node, place: place.into(), meshed: beside, radii });
        }
        radii as f32
    });
    (values.collect(), worst)
}

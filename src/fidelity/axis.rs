//! The given axis held against the one that was meshed.

use super::{Spread, Tubes};
use crate::geometry::Point3;
use crate::skeleton::{EdgeId, Skeleton};
use rayon::prelude::*;
use serde::Serialize;

/// The axis is looked at in steps of so many radii,
const STEP: f64 = 1.0;
/// and in so many of an edge at most.
const MOST_STEPS: f64 = 16.0;
/// Places that are named.
const NAMED: usize = 10;

/// A place of the given axis that is far from the one that was meshed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Displaced {
    /// The nearer node of the given edge, as in the file.
    pub node: u32,
    /// Where it is.
    pub place: [f64; 3],
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
    /// The places that are furthest off, one of each edge.
    pub furthest: Vec<Displaced>,
}

impl Displacements {
    pub(super) fn of(given: &Skeleton, meshed: &Tubes) -> Self {
        let edges: Vec<EdgeId> = given.edge_ids().collect();
        let found: Vec<(Vec<f64>, Option<Displaced>)> =
            edges.par_iter().with_min_len(64).map(|&edge| along(given, edge, meshed)).collect();
        let mut furthest: Vec<Displaced> = found.iter().filter_map(|(_, worst)| *worst).collect();
        // A stable sort: the earlier of equals comes first.
        furthest.sort_by(|a, b| b.radii.total_cmp(&a.radii));
        furthest.truncate(NAMED);
        Self {
            spread: Spread::of(found.into_iter().flat_map(|(values, _)| values).collect()),
            given_length: edges.iter().map(|&e| given.length(e)).sum(),
            meshed_length: meshed.list.iter().map(crate::geometry::Tube::length).sum(),
            furthest,
        }
    }
}

/// The displacements along one edge, and the largest of them.
fn along(given: &Skeleton, edge: EdgeId, meshed: &Tubes) -> (Vec<f64>, Option<Displaced>) {
    let tube = given.tube(edge);
    let count = (tube.length() / (STEP * tube.min_radius())).ceil().clamp(1.0, MOST_STEPS);
    let ends = given.edge(edge).nodes.map(|n| given.node(n).original);
    let mut worst: Option<Displaced> = None;
    let values = (0..=count as usize).map(|k| {
        let t = k as f64 / count;
        let (place, radius) = (tube.point(t), tube.radius(t));
        let radii = off(&place, radius, meshed);
        if worst.is_none_or(|w| radii > w.radii) {
            worst = Some(Displaced { node: ends[usize::from(t > 0.5)], place: place.into(), radii });
        }
        radii
    });
    (values.collect(), worst)
}

/// Distance of the meshed axis from a place, in radii; 0 for a place within the vessel that took this one in.
fn off(place: &Point3, radius: f64, meshed: &Tubes) -> f64 {
    meshed.nearest(place, radius, |distance, _| distance).map_or(f64::INFINITY, |near| near.distance / radius)
}

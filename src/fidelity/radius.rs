//! Radius error of the sections of a mesh or a network.

use super::spread::Spread;
use super::tubes::Tubes;
use anastomesh_skeleton::{EdgeId, Skeleton};
use rayon::prelude::*;
use serde::Serialize;

/// Samples per edge.
const PER_EDGE: usize = 3;

/// Network that radii are compared with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum RadiusReference {
    /// Wall of the mesh and the given vessels.
    #[default]
    Given,
    /// Wall of the mesh and the moved vessels, because the wall of a moved vessel is far from the given one.
    Moved,
    /// Radii of a network and those of the given one, without a mesh.
    Network,
}

/// Relative radius error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SectionErrors {
    /// Distribution of |d − r| / r.
    #[serde(flatten)]
    pub spread: Spread,
    /// Compared networks.
    pub of: RadiusReference,
}

/// Relative difference between the given radii and those of the nearest vessel of another network, along the given axis.
pub(super) fn change(given: &Skeleton, tubes: &Tubes) -> Spread {
    let edges: Vec<EdgeId> = given.edge_ids().collect();
    let errors = |&edge: &EdgeId| {
        let tube = given.tube(edge);
        let at = move |k: usize| (k as f64 + 0.5) / PER_EDGE as f64;
        (0..PER_EDGE).filter_map(move |k| {
            let (place, radius) = (tube.point(at(k)), tube.radius(at(k)));
            let near = tubes.nearest(&place, radius, |distance, _| distance)?;
            Some(((near.radius - radius).abs() / radius) as f32)
        })
    };
    Spread::of(edges.par_iter().with_min_len(64).flat_map_iter(errors).collect())
}

//! Comparison of two networks, without a mesh.

use super::radius::{RadiusReference, SectionErrors};
use super::{Compared, Displacements, Fidelity, Spread, lumen, lumen_of};
use anastomesh_skeleton::{EdgeId, Skeleton, Tubes};
use rayon::prelude::*;

/// Samples per edge.
const PER_EDGE: usize = 3;

impl Fidelity {
    /// Compares a network that replaces the given one, without a mesh: the volume is that of its lumen.
    pub(crate) fn of_network(networks: Compared) -> Self {
        let Compared { given, outline, meshed } = networks;
        let (lumen, tubes) = (lumen_of(outline), Tubes::of(meshed));
        let volume = lumen::volume(meshed, &tubes);
        let axis = Displacements::of(given, meshed, &tubes);
        let radius = SectionErrors { spread: radius_change(given, &tubes), of: RadiusReference::Network };
        Self { axis, radius, lumen, volume, wall: Spread::default() }
    }
}

/// Relative difference between the given radii and those of the nearest vessel of another network, along the given axis.
fn radius_change(given: &Skeleton, tubes: &Tubes) -> Spread {
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

//! Overlaps that a refinement resolves.

use anastomesh_skeleton::{Adjacency, CrotchRule, Overlap, Overlaps, Skeleton};
use rayon::prelude::*;

/// Overlaps of vessels with radii multiplied by a factor. Without `crotches`, the overlaps in crotches of bifurcations do not
/// count: measured vessels leave bifurcations at small angles, and their lumens divide where the tubes separate.
pub(super) fn overlapping(skeleton: &Skeleton, adjacency: &Adjacency, crotches: bool, factor: f64) -> Overlaps {
    let wide = (factor > 1.0).then(|| {
        let mut wide = skeleton.clone();
        wide.edges.iter_mut().for_each(|edge| edge.radii = edge.radii.map(|r| factor * r));
        wide
    });
    let wide = wide.as_ref().unwrap_or(skeleton);
    let mut found = wide.overlaps(adjacency);
    if !crotches {
        let rule = CrotchRule { narrower: 1.0 / factor, ..CrotchRule::default() };
        let stays = |pair: &&Overlap| !wide.is_in_crotch(adjacency, pair, rule);
        found.pairs = found.pairs.par_iter().with_min_len(16).filter(stays).copied().collect();
    }
    found
}

//! Overlaps that a refinement resolves.

use anastomesh_skeleton::{Adjacency, CrotchRule, CrotchSearch, EdgeId, Overlap, Overlaps, Skeleton};
use rayon::prelude::*;
use std::borrow::Cow;

/// Distance, in sums of radii, by which vessels may part between a contact and their crotch. Else their walls enclose a gap there.
const PARTING: f64 = 0.15;

/// Overlaps of vessels with radii multiplied by a factor. Without `crotches`, the overlaps in crotches of bifurcations do not
/// count. Measured vessels leave bifurcations at small angles, and their lumens divide where the tubes separate.
pub(super) fn overlapping(skeleton: &Skeleton, adjacency: &Adjacency, crotches: bool, factor: f64) -> Overlaps {
    let wide = widened(skeleton, factor);
    let mut found = wide.overlaps(adjacency);
    if !crotches {
        found.pairs = by_crotch(&wide, adjacency, &found, factor, false);
    }
    found
}

/// Pairs of edges, in ascending order, that overlap in the crotch of a bifurcation if radii are multiplied by a factor.
pub(super) fn in_crotches(skeleton: &Skeleton, adjacency: &Adjacency, factor: f64) -> Vec<[EdgeId; 2]> {
    let wide = widened(skeleton, factor);
    let found = wide.overlaps(adjacency);
    by_crotch(&wide, adjacency, &found, factor, true).iter().map(|overlap| overlap.edges).collect()
}

fn widened(skeleton: &Skeleton, factor: f64) -> Cow<'_, Skeleton> {
    let mut wide = Cow::Borrowed(skeleton);
    if factor > 1.0 {
        wide.to_mut().edges.iter_mut().for_each(|edge| edge.radii = edge.radii.map(|r| factor * r));
    }
    wide
}

/// Overlaps of a widened network that lie in a crotch, or those that do not.
fn by_crotch(wide: &Skeleton, adjacency: &Adjacency, found: &Overlaps, factor: f64, inside: bool) -> Vec<Overlap> {
    let rule = CrotchRule { narrower: 1.0 / factor, parting: PARTING, ..CrotchRule::default() };
    let by_edge = found.pairs.par_chunk_by(|p, q| p.edges[0] == q.edges[0]);
    let of_edge = |search: &mut CrotchSearch, pairs: &[Overlap]| -> Vec<Overlap> {
        pairs.iter().filter(|pair| search.is_in_crotch(wide, adjacency, pair, rule) == inside).copied().collect()
    };
    let kept: Vec<Vec<Overlap>> = by_edge.map_init(CrotchSearch::default, of_edge).collect();
    kept.concat()
}

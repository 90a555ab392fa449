//! Comparison of two layouts of one skeleton. Moving a few cuts changes only a few clusters.

use std::cmp::Ordering;
use std::sync::Arc;

use super::{Layout, NONE, Placed};
use crate::partition::parts::{ClusterId, CutId};

/// Indices, in another layout, of clusters and cuts with identical inputs.
#[derive(Debug)]
pub struct Same {
    pub clusters: Vec<Option<ClusterId>>,
    pub cuts: Vec<Option<CutId>>,
}

impl Layout {
    /// Returns the unchanged clusters and cuts. A missed match is harmless: it counts as changed.
    pub fn same_as(&self, before: &Self) -> Same {
        let counts = [self, before].map(|layout| [layout.clusters_len(), layout.cuts_len()]);
        if !Arc::ptr_eq(&self.skeleton, &before.skeleton) || self.overrun != before.overrun {
            return Same { clusters: vec![None; counts[0][0]], cuts: vec![None; counts[0][1]] };
        }
        // Both layouts are sorted alike.
        let order = |i, j| self.cluster_place(i).partial_cmp(&before.cluster_place(j));
        let clusters = common([counts[0][0], counts[1][0]], order, |i, j| self.is_same_cluster(i, before, j));
        let place = |layout: &Self, i: usize| (layout.cuts[i].branch, layout.cuts[i].planes[0]);
        let order = |i, j| place(self, i).partial_cmp(&place(before, j));
        let is_same_cut = |i: usize, j: usize| {
            let ups = [(self, i), (before, j)].map(|(layout, cut)| layout.ups(CutId(cut as u32)));
            self.cuts[i].planes == before.cuts[j].planes && ups[0] == ups[1]
        };
        let cuts = common([counts[0][1], counts[1][1]], order, is_same_cut);
        Same {
            clusters: clusters.into_iter().map(|j| j.map(ClusterId)).collect(),
            cuts: cuts.into_iter().map(|j| j.map(CutId)).collect(),
        }
    }

    /// Sort key of a cluster: its lowest node. Clusters without a node come last, by branch and position.
    fn cluster_place(&self, cluster: usize) -> (u32, u32, f64) {
        let node = self.nodes(ClusterId(cluster as u32)).first().map_or(NONE, |node| node.0);
        let first = self.pieces_of(cluster).first().filter(|_| node == NONE);
        first.map_or((node, 0, 0.0), |piece| (node, piece.branch, self.planes_of(piece)[0].unwrap_or(0.0)))
    }

    /// Cut planes at the ends of a piece.
    fn planes_of(&self, piece: &Placed) -> [Option<f64>; 2] {
        [0, 1].map(|end| (piece.cuts[end] != NONE).then(|| self.cuts[piece.cuts[end] as usize].planes[1 - end]))
    }

    fn is_same_cluster(&self, i: usize, before: &Self, j: usize) -> bool {
        let same_piece = |(k, (a, b)): (usize, (&Placed, &Placed))| {
            let [k, l] = [self.first_piece[i], before.first_piece[j]].map(|first| first + k as u32);
            let overruns = |layout: &Self, piece: u32| [0, 1].map(|end| layout.overruns.get(&(piece, end)).copied());
            let ups = |layout: &Self, piece: &Placed| {
                [0, 1].map(|end| (piece.cuts[end] != NONE).then(|| layout.ups(CutId(piece.cuts[end]))[1 - end]))
            };
            a.branch == b.branch
                && a.terminals == b.terminals
                && self.planes_of(a) == before.planes_of(b)
                && overruns(self, k) == overruns(before, l)
                && ups(self, a) == ups(before, b)
        };
        let (own, other) = (self.pieces_of(i), before.pieces_of(j));
        let [a, b] = [(self, i), (before, j)].map(|(layout, i)| layout.nodes(ClusterId(i as u32)));
        a == b
            && self.r_min[i].to_bits() == before.r_min[j].to_bits()
            && own.len() == other.len()
            && own.iter().zip(other).enumerate().all(same_piece)
    }
}

/// Merges two ordered lists. Returns for each element of the first the matching index in the second.
fn common(
    [own, other]: [usize; 2],
    order: impl Fn(usize, usize) -> Option<Ordering>,
    same: impl Fn(usize, usize) -> bool,
) -> Vec<Option<u32>> {
    let mut found = vec![None; own];
    let (mut i, mut j) = (0, 0);
    while i < own && j < other {
        let order = order(i, j).unwrap_or(Ordering::Equal);
        if order.is_eq() && same(i, j) {
            found[i] = Some(j as u32);
        }
        i += usize::from(order.is_le());
        j += usize::from(order.is_ge());
    }
    found
}

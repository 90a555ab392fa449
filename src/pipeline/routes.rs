//! Blocks along each branch.

use crate::partition::{CutId, Layout};
use anastomesh_skeleton::{BranchId, EdgeId, Overlaps, Skeleton};
use serde::{Deserialize, Serialize};

/// The branches of pairs of edges: each pair once, the lower branch first, ascending.
pub fn branch_pairs(skeleton: &Skeleton, edges: impl Iterator<Item = [EdgeId; 2]>) -> Vec<[BranchId; 2]> {
    let mut edges = edges.peekable();
    if edges.peek().is_none() {
        return Vec::new();
    }
    let branch_of = skeleton.branches(&skeleton.adjacency()).of_edge;
    let mut pairs: Vec<[BranchId; 2]> = Vec::new();
    for edges in edges {
        let [a, b] = edges.map(|e| branch_of[e.index()].0);
        pairs.push([a.min(b), a.max(b)]);
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// Each branch with each block that it runs through, ascending; blocks by their numbers: clusters by their ids, then
/// connectors.
fn routes(partition: &Layout) -> Vec<(BranchId, u32)> {
    let connectors = (partition.clusters_len() as u32..).zip(0..partition.cuts_len() as u32);
    let mut routes: Vec<(BranchId, u32)> =
        partition.branches_of_clusters().map(|(b, cluster)| (b, cluster.0)).collect();
    routes.extend(connectors.map(|(block, cut)| (partition.branch_of_cut(CutId(cut)), block)));
    routes.sort_unstable();
    routes.dedup();
    routes
}

/// Closeness of the vessels of a cluster, apart from bifurcations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Tangle {
    /// No two vessels meet.
    Free,
    /// Edges meet that have no common node, but no vessels overlap.
    Meeting,
    /// Two vessels overlap.
    Overlapping,
}

/// Tangle of each cluster: that of vessels whose branches both run through it.
pub fn tangled_clusters(skeleton: &Skeleton, partition: &Layout, overlaps: &Overlaps) -> Vec<Tangle> {
    let mut tangled = vec![Tangle::Free; partition.clusters_len()];
    let meeting = branch_pairs(skeleton, overlaps.unconnected.iter().copied());
    let overlapping = branch_pairs(skeleton, overlaps.pairs.iter().map(|o| o.edges));
    if meeting.is_empty() && overlapping.is_empty() {
        return tangled;
    }
    let routes = routes(partition);
    let all = [(Tangle::Meeting, meeting), (Tangle::Overlapping, overlapping)];
    for (tangle, [a, b]) in all.iter().flat_map(|(tangle, pairs)| pairs.iter().map(move |pair| (*tangle, *pair))) {
        let first = routes.partition_point(|(branch, _)| *branch < a);
        for &(_, block) in routes[first..].iter().take_while(|(branch, _)| *branch == a) {
            if routes.binary_search(&(b, block)).is_ok()
                && let Some(tangled) = tangled.get_mut(block as usize)
            {
                *tangled = tangle;
            }
        }
    }
    tangled
}

/// Pairs of blocks with branches of overlapping vessels.
#[derive(Debug, Default)]
pub struct Overlapping {
    pairs: Vec<[BranchId; 2]>,
    /// Each block with each of its branches, ascending; empty when nothing overlaps.
    branches: Vec<(u32, BranchId)>,
}

impl Overlapping {
    /// Of all blocks of a partition.
    pub fn of(skeleton: &Skeleton, partition: &Layout, overlaps: &Overlaps) -> Self {
        if overlaps.pairs.is_empty() {
            return Self::default();
        }
        let pairs = branch_pairs(skeleton, overlaps.pairs.iter().map(|o| o.edges));
        let mut branches: Vec<(u32, BranchId)> = routes(partition).into_iter().map(|(b, block)| (block, b)).collect();
        branches.sort_unstable();
        Self { pairs, branches }
    }

    /// True if these two blocks have overlapping vessels.
    pub fn do_overlap(&self, [x, y]: [u32; 2]) -> bool {
        let of = |block: u32| {
            let first = self.branches.partition_point(|(b, _)| *b < block);
            self.branches[first..].iter().take_while(move |(b, _)| *b == block).map(|(_, branch)| *branch)
        };
        of(x).any(|a| of(y).any(|b| self.pairs.binary_search(&[a.min(b), a.max(b)]).is_ok()))
    }
}

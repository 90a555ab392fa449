//! Blocks along each branch.

use crate::partition::{CutId, Layout};
use anastomesh_skeleton::{BranchId, EdgeId, Overlaps, Skeleton};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

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
/// `joined`: branches whose walls met.
pub fn tangled_clusters(
    skeleton: &Skeleton,
    partition: &Layout,
    overlaps: &Overlaps,
    joined: &BTreeSet<[BranchId; 2]>,
) -> Vec<Tangle> {
    let mut tangled = vec![Tangle::Free; partition.clusters_len()];
    let mut meeting = branch_pairs(skeleton, overlaps.unconnected.iter().copied());
    meeting.extend(joined);
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

/// Vessels that are not cut because walls intersect.
#[derive(Debug, Default)]
pub struct Uncut {
    /// Those whose connectors intersected a block. As part of a cluster they can be refined.
    pub branches: BTreeSet<BranchId>,
    /// Those that share a cluster, as their blocks intersected each other with the finest grids, too.
    pub joined: BTreeSet<[BranchId; 2]>,
}

/// Each block with each of its branches, ascending.
#[derive(Debug, Default)]
struct BranchesOfBlocks(Vec<(u32, BranchId)>);

impl BranchesOfBlocks {
    fn of(partition: &Layout) -> Self {
        let mut branches: Vec<(u32, BranchId)> = routes(partition).into_iter().map(|(b, block)| (block, b)).collect();
        branches.sort_unstable();
        Self(branches)
    }

    /// Pairs of branches, one of each block, the lower one first.
    fn pairs(&self, [x, y]: [u32; 2]) -> impl Iterator<Item = [BranchId; 2]> {
        let of = |block: u32| {
            let first = self.0.partition_point(|(b, _)| *b < block);
            self.0[first..].iter().take_while(move |(b, _)| *b == block).map(|(_, branch)| *branch)
        };
        of(x).flat_map(move |a| of(y).map(move |b| [a.min(b), a.max(b)]))
    }
}

/// Pairs of branches, one of each block of a pair.
pub fn branches_of_pairs(partition: &Layout, blocks: &[[u32; 2]]) -> BTreeSet<[BranchId; 2]> {
    let branches = BranchesOfBlocks::of(partition);
    blocks.iter().flat_map(|pair| branches.pairs(*pair)).collect()
}

/// Pairs of blocks with branches of overlapping vessels.
#[derive(Debug, Default)]
pub struct Overlapping {
    pairs: Vec<[BranchId; 2]>,
    /// Empty when nothing overlaps.
    branches: BranchesOfBlocks,
}

impl Overlapping {
    /// Of all blocks of a partition.
    pub fn of(skeleton: &Skeleton, partition: &Layout, overlaps: &Overlaps) -> Self {
        if overlaps.pairs.is_empty() {
            return Self::default();
        }
        let pairs = branch_pairs(skeleton, overlaps.pairs.iter().map(|o| o.edges));
        Self { pairs, branches: BranchesOfBlocks::of(partition) }
    }

    /// True if these two blocks have overlapping vessels.
    pub fn do_overlap(&self, blocks: [u32; 2]) -> bool {
        self.branches.pairs(blocks).any(|pair| self.pairs.binary_search(&pair).is_ok())
    }
}

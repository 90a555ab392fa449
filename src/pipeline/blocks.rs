//! Blocks of a network, and their names.

use std::collections::BTreeSet;

use rustc_hash::FxHashMap;

use super::make::BlockResult;
use super::report::Retry;
use super::routes::Tangle;
use super::store::RecordId;
use super::timing::BlockTimes;
use crate::block::Cured;
use crate::partition::{CutId, Layout};
use anastomesh_skeleton::{NodeId, Skeleton};

/// Maximum number of listed nodes of a block.
const LISTED: usize = 20;

/// Pairs of blocks whose walls meet, the lower number first: clusters by their ids, then connectors.
pub type Meetings = Vec<[u32; 2]>;

/// Blocks of a network.
#[derive(Debug)]
pub struct Blocks {
    /// Partition that they belong to.
    pub partition: Layout,
    /// Tangle of each cluster.
    pub tangled: Vec<Tangle>,
    /// By `ClusterId`; an error for a cluster without a successful attempt.
    pub clusters: Vec<BlockResult>,
    /// By `CutId`; none beside a failed cluster.
    pub connectors: Vec<Option<BlockResult>>,
    /// Clusters that were remeshed with another strategy because their walls intersected others.
    pub apart: BTreeSet<u32>,
    /// Strategies that helped failed blocks.
    pub cured: FxHashMap<RecordId, Cured>,
    /// Retries.
    pub retries: Vec<Retry>,
    /// Times of the blocks.
    pub times: BlockTimes,
}

impl Blocks {
    /// True if any block failed.
    pub fn any_failed(&self) -> bool {
        self.clusters.iter().any(Result::is_err) || self.connectors.iter().any(|made| matches!(made, Some(Err(_))))
    }

    /// Geometry of each block in the store, by number; `None` for missing ones.
    pub fn records(&self) -> impl Iterator<Item = Option<RecordId>> {
        let clusters = self.clusters.iter().map(Some);
        let made = clusters.chain(self.connectors.iter().map(Option::as_ref));
        made.map(|made| Some(made?.as_ref().ok()?.records.geometry))
    }

    /// Name of a block by its number: clusters by their ids, then connectors.
    pub fn name(&self, block: u32) -> String {
        match (block as usize).checked_sub(self.clusters.len()) {
            None => format!("cluster {block}"),
            Some(connector) => format!("connector {connector}"),
        }
    }
}

/// Names of the nodes at the ends of a block's branches, as in the file that was read.
pub fn original_nodes(skeleton: &Skeleton, nodes: impl Iterator<Item = NodeId>) -> Vec<u32> {
    let mut list: Vec<u32> = nodes.map(|n| skeleton.node(n).original).collect();
    list.sort_unstable();
    list.dedup();
    list.truncate(LISTED);
    list
}

/// The nodes of the two clusters that a cut separates.
pub fn cut_nodes(skeleton: &Skeleton, partition: &Layout, cut: CutId) -> Vec<u32> {
    let sides = partition.sides_of_cut(cut);
    let nodes = sides.iter().flat_map(|(cluster, _)| partition.nodes(*cluster));
    original_nodes(skeleton, nodes.copied())
}

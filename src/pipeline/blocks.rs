//! The blocks of a network, and what they are called.

use super::make::Made;
use super::report::Retry;
use super::timing::BlockTimes;
use crate::partition::{CutId, Layout};
use crate::skeleton::{NodeId, Skeleton};

/// How many nodes of a block a report lists.
const LISTED: usize = 20;

/// The blocks of a network.
#[derive(Debug)]
pub struct Blocks {
    /// The partition that they belong to.
    pub partition: Layout,
    /// By `ClusterId`; an error for a cluster that failed to the end.
    pub clusters: Vec<Made>,
    /// By `CutId`; none beside a failed cluster.
    pub connectors: Vec<Option<Made>>,
    /// What was retried.
    pub retries: Vec<Retry>,
    /// How long they took.
    pub times: BlockTimes,
}

impl Blocks {
    /// What a block is called, by its number: clusters by their ids, then connectors.
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

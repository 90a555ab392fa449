//! Which blocks the vessels run through.

use crate::partition::Partition;
use crate::skeleton::{BranchId, EdgeId, Skeleton};

/// The blocks through which each branch runs.
pub struct Routes {
    branch_of: Vec<(BranchId, u32)>,
    /// Ascending; blocks by their numbers: clusters by their ids, then connectors.
    through: Vec<(BranchId, u32)>,
}

impl Routes {
    /// Of the skeleton's edges in the partition's blocks.
    pub fn of(skeleton: &Skeleton, partition: &Partition) -> Self {
        let connectors = (partition.clusters.len() as u32..).zip(&partition.cuts);
        let mut through: Vec<(BranchId, u32)> =
            partition.pieces.iter().map(|piece| (piece.branch, piece.cluster.0)).collect();
        through.extend(connectors.map(|(block, cut)| (cut.branch, block)));
        through.sort_unstable();
        through.dedup();
        Self { branch_of: skeleton.branches(&skeleton.adjacency()).of_edge, through }
    }

    /// The blocks of the branch of an edge, ascending.
    pub fn blocks(&self, edge: EdgeId) -> impl Iterator<Item = u32> + Clone + '_ {
        let branch = self.branch_of[edge.index()].0;
        let first = self.through.partition_point(|(b, _)| *b < branch);
        self.through[first..].iter().take_while(move |(b, _)| *b == branch).map(|(_, block)| *block)
    }
}

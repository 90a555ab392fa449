//! Summary figures of a partition.

/// Partition figures for the run log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct PartitionSummary {
    /// Number of clusters.
    pub clusters: usize,
    /// Clusters with a junction, counted as in the paper.
    pub junction_clusters: usize,
    /// Node count of the largest cluster.
    pub largest_nodes: usize,
    /// Largest tube count of a cluster, including overruns.
    pub largest_tubes: usize,
    /// Number of cuts, equal to the number of connectors.
    pub cuts: usize,
    /// Uncut branches, by reason.
    pub uncut: UncutCounts,
    /// Terminals with a shortened overrun.
    pub short_overruns: usize,
    /// Terminals whose cap is too close to another vessel.
    pub caps_not_clear: usize,
}

/// Uncut branches, by reason (see `UncutReason`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct UncutCounts {
    /// The branch ends in a terminal and is not long.
    pub terminal: usize,
    /// The caller forbade the cut.
    pub forbidden: usize,
    /// The branch is too short.
    pub length: usize,
    /// The branch is too short for its angle with a neighbour.
    pub angle: usize,
    /// No part is straight enough.
    pub bend: usize,
    /// No place is clear of other vessels.
    pub clearance: usize,
}

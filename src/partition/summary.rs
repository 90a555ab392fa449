//! A partition in figures.

/// What the pipeline prints of a partition.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct PartitionSummary {
    /// Number of clusters.
    pub clusters: usize,
    /// Clusters that hold a junction, as the paper counts.
    pub junction_clusters: usize,
    /// Nodes of the cluster that has most.
    pub largest_nodes: usize,
    /// Tubes of the cluster that has most, overruns included.
    pub largest_tubes: usize,
    /// Number of cuts, that is of connectors.
    pub cuts: usize,
    /// Branches that are not cut, by reason.
    pub uncut: UncutCounts,
    /// Terminals whose overrun was shortened.
    pub short_overruns: usize,
    /// Terminals whose cap is not clear of another vessel.
    pub caps_not_clear: usize,
}

/// Branches that are not cut, by reason (see `UncutReason`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct UncutCounts {
    /// They end in a terminal and are not long.
    pub terminal: usize,
    /// The caller forbade it.
    pub forbidden: usize,
    /// Too short.
    pub length: usize,
    /// Too short for their angle to a neighbour.
    pub angle: usize,
    /// Nowhere straight enough.
    pub bend: usize,
    /// Nowhere clear of another vessel.
    pub clearance: usize,
}

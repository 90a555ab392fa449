//! A partition in figures.

use super::Layout;
use super::parts::{ClusterId, PartitionWarning, UncutReason};
use crate::skeleton::BranchId;

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

impl Layout {
    /// The partition in figures.
    pub fn summary(&self) -> PartitionSummary {
        let mut summary = PartitionSummary {
            clusters: self.clusters_len(),
            largest_nodes: self.largest_nodes(),
            cuts: self.cuts_len(),
            uncut: UncutCounts::of(self.uncut()),
            ..PartitionSummary::default()
        };
        for (i, cluster) in (0..).zip(self.clusters()) {
            // A cluster without a junction is one piece; every other has three pieces or a piece that closes on a junction.
            let pieces = self.pieces_in(ClusterId(i));
            summary.junction_clusters += usize::from(pieces > 2 || (pieces == 2 && cluster.ends.len() != 2));
            summary.largest_tubes = summary.largest_tubes.max(cluster.tubes.len());
        }
        let short = |w: &&PartitionWarning| matches!(w, PartitionWarning::ShortOverrun { .. });
        summary.short_overruns = self.warnings().iter().filter(short).count();
        summary.caps_not_clear = self.warnings().len() - summary.short_overruns;
        summary
    }
}

impl UncutCounts {
    fn of(branches: &[(BranchId, UncutReason)]) -> Self {
        let mut uncut = Self::default();
        for (_, reason) in branches {
            *match reason {
                UncutReason::Terminal => &mut uncut.terminal,
                UncutReason::Forbidden => &mut uncut.forbidden,
                UncutReason::Length => &mut uncut.length,
                UncutReason::Angle => &mut uncut.angle,
                UncutReason::Bend => &mut uncut.bend,
                UncutReason::Clearance { .. } => &mut uncut.clearance,
            } += 1;
        }
        uncut
    }
}

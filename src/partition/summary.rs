//! A partition in figures.

use super::parts::{Partition, PartitionWarning, UncutReason};

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

impl Partition {
    /// The partition in figures.
    pub fn summary(&self) -> PartitionSummary {
        let mut uncut = UncutCounts::default();
        for (_, reason) in &self.uncut {
            *match reason {
                UncutReason::Terminal => &mut uncut.terminal,
                UncutReason::Forbidden => &mut uncut.forbidden,
                UncutReason::Length => &mut uncut.length,
                UncutReason::Angle => &mut uncut.angle,
                UncutReason::Bend => &mut uncut.bend,
                UncutReason::Clearance { .. } => &mut uncut.clearance,
            } += 1;
        }
        let short = |w: &&PartitionWarning| matches!(w, PartitionWarning::ShortOverrun { .. });
        let short_overruns = self.warnings.iter().filter(short).count();
        PartitionSummary {
            clusters: self.clusters.len(),
            junction_clusters: self.junction_clusters(),
            largest_nodes: self.clusters.iter().map(|c| c.nodes.len()).max().unwrap_or(0),
            largest_tubes: self.clusters.iter().map(|c| c.tubes.len()).max().unwrap_or(0),
            cuts: self.cuts.len(),
            uncut,
            short_overruns,
            caps_not_clear: self.warnings.len() - short_overruns,
        }
    }

    /// A cluster without a junction is one piece; every other has three pieces or a piece that closes on a junction.
    fn junction_clusters(&self) -> usize {
        let mut pieces = vec![0_usize; self.clusters.len()];
        for piece in &self.pieces {
            pieces[piece.cluster.0 as usize] += 1;
        }
        self.clusters.iter().zip(pieces).filter(|(c, n)| *n > 2 || (*n == 2 && c.ends.len() != 2)).count()
    }
}

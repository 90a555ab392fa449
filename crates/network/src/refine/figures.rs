//! Quality figures of a state, and comparison of states.

use super::overlapping::overlapping;
use anastomesh_skeleton::{Metrics, Overlaps, Share, Skeleton};
use serde::{Deserialize, Serialize};

/// Metrics and overlap counts of one state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Figures {
    /// Metrics of the paper (Fig. 11).
    pub metrics: Metrics,
    /// Overlapping pairs of edges; in measured networks without those in the crotch of a bifurcation.
    pub overlaps: usize,
    /// Overlapping pairs that share a node.
    pub beside: usize,
    /// Pairs of touching edges without a common node, including neighbours along a vessel.
    pub unconnected: usize,
    /// Unconnected pairs that no edge joins.
    pub far: usize,
}

/// Metric that a caller may protect: the result must not be worse in it than the input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum Metric {
    /// Overlapping pairs of edges.
    Overlaps,
    /// Pairs of touching edges that no edge joins.
    FarPairs,
    /// Barrier potential.
    Barrier,
    /// Edges shorter than 2 radii.
    Shorter2,
    /// Edges shorter than 2.5 radii.
    Shorter25,
    /// Edges shorter than 3 radii.
    Shorter3,
    /// Pairs of edges that leave a node at less than π/10.
    Angles,
    /// Nodes of valence 2 at which a vessel reverses its direction.
    Folds,
    /// Edges that fail equation 11.
    Equation11,
    /// Edges that fail equation 12.
    Equation12,
    /// Inner branches that cannot be cut.
    Cuttable,
}

impl Metric {
    /// All metrics.
    pub const ALL: [Self; 11] = [
        Self::Overlaps,
        Self::FarPairs,
        Self::Barrier,
        Self::Shorter2,
        Self::Shorter25,
        Self::Shorter3,
        Self::Angles,
        Self::Folds,
        Self::Equation11,
        Self::Equation12,
        Self::Cuttable,
    ];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Overlaps => "overlaps",
            Self::FarPairs => "far-pairs",
            Self::Barrier => "barrier",
            Self::Shorter2 => "shorter2",
            Self::Shorter25 => "shorter25",
            Self::Shorter3 => "shorter3",
            Self::Angles => "angles",
            Self::Folds => "folds",
            Self::Equation11 => "equation11",
            Self::Equation12 => "equation12",
            Self::Cuttable => "cuttable",
        }
    }

    /// Badness in this metric: less is better.
    fn bad(self, of: &Figures) -> f64 {
        let m = of.metrics;
        let missing = |s: Share| (s.of - s.count) as f64;
        match self {
            Self::Overlaps => of.overlaps as f64,
            Self::FarPairs => of.far as f64,
            Self::Barrier => m.barrier,
            Self::Shorter2 => m.shorter_than_2.count as f64,
            Self::Shorter25 => m.shorter_than_2_5.count as f64,
            Self::Shorter3 => m.shorter_than_3.count as f64,
            Self::Angles => m.narrow.count as f64,
            Self::Folds => m.folds.count as f64,
            Self::Equation11 => missing(m.long_enough),
            Self::Equation12 => missing(m.open_enough),
            Self::Cuttable => missing(m.cuttable),
        }
    }
}

impl Figures {
    /// Figures of a skeleton. In `measured` networks, overlaps in crotches of bifurcations do not count.
    pub fn of(skeleton: &Skeleton, measured: bool) -> Self {
        Self::with_overlaps(skeleton, measured).0
    }

    pub(super) fn with_overlaps(skeleton: &Skeleton, measured: bool) -> (Self, Overlaps) {
        let adjacency = skeleton.adjacency();
        let overlaps = overlapping(skeleton, &adjacency, !measured, 1.0);
        let figures = Self {
            metrics: skeleton.metrics(&adjacency),
            overlaps: overlaps.pairs.len(),
            beside: overlaps.pairs.iter().filter(|o| o.shares_node()).count(),
            unconnected: overlaps.unconnected.len(),
            far: overlaps.far,
        };
        (figures, overlaps)
    }

    /// Metrics among `among` in which this state is worse than `other`.
    pub fn worse_than(&self, other: &Self, among: &[Metric]) -> Vec<Metric> {
        among.iter().copied().filter(|m| m.bad(self) > m.bad(other)).collect()
    }

    /// Lexicographic score of a state: overlaps, far pairs, inner branches that cannot be cut, edges that fail equation
    /// 11.
    pub(super) fn score(&self) -> [usize; 4] {
        let missing = |s: Share| s.of - s.count;
        [self.overlaps, self.far, missing(self.metrics.cuttable), missing(self.metrics.long_enough)]
    }
}

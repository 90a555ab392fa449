//! Report of the preparation.

use super::{FilledRadius, Island, JoinedReport, MergeReport, ResampleReport, ShortTip, Spur, TouchingTip};
use anastomesh_skeleton::{CleanReport, Skeleton};
use serde::Serialize;

/// Size of a network.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Size {
    /// Number of nodes.
    pub nodes: usize,
    /// Number of edges.
    pub edges: usize,
    /// Number of nodes with one edge.
    pub tips: usize,
    /// Number of nodes with more than two edges.
    pub branch_points: usize,
    /// Number of connected pieces.
    pub components: usize,
    /// Number of independent loops.
    pub loops: usize,
}

impl Size {
    /// Size of a network; only nodes and edges are set if an edge refers to a missing node.
    pub fn of(skeleton: &Skeleton) -> Self {
        let (nodes, edges) = (skeleton.nodes.len(), skeleton.edges.len());
        let mut size = Self { nodes, edges, ..Self::default() };
        if skeleton.edges.iter().flat_map(|e| e.nodes).any(|n| n.index() >= nodes) {
            return size;
        }
        let adjacency = skeleton.adjacency();
        size.tips = adjacency.terminals().len();
        size.branch_points = skeleton.node_ids().filter(|&n| adjacency.valence(n) > 2).count();
        let components = skeleton.components(&adjacency);
        size.components = components.list.len();
        size.loops = components.list.iter().map(anastomesh_skeleton::Component::loops).sum();
        size
    }
}

impl PrepareReport {
    /// True if the preparation changed anything.
    pub fn changed(&self) -> bool {
        let Self { given, measured, result, .. } = *self;
        *self != Self { given, read: given, measured, result, ..Self::default() }
    }
}

/// Changes to a network. Nodes are numbered as in the input, from 0.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PrepareReport {
    /// Size of the input.
    pub given: Size,
    /// Size after reading and cleaning, before all cures except that of the radii.
    pub read: Size,
    /// True if the network is measured: its vessels are polylines.
    pub measured: bool,
    /// Size of the result.
    pub result: Size,
    /// Replaced radii, by node.
    pub radii: Vec<FilledRadius>,
    /// Report of the cleaning.
    pub cleaned: CleanReport,
    /// Merged lines.
    pub merge: MergeReport,
    /// Removed spurs, in order of removal.
    pub spurs: Vec<Spur>,
    /// Merged branch points and closed loops.
    pub joined: JoinedReport,
    /// Tips that were too close to their branch point for a cap.
    pub short_tips: Vec<ShortTip>,
    /// Tips that end in or on another vessel.
    pub touching: Vec<TouchingTip>,
    /// Removed components.
    pub islands: Vec<Island>,
    /// Report of the resampling.
    pub resample: ResampleReport,
}

//! What was done to a network.

use super::{FilledRadius, Island, JoinedReport, MergeReport, ResampleReport, ShortTip, Spur, TouchingTip};
use anastomesh_skeleton::{CleanReport, Skeleton};
use serde::Serialize;

/// How large a network is.
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
    /// The size of a network; all zero but nodes and edges when an edge names no node.
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
    /// Whether anything was done.
    pub fn changed(&self) -> bool {
        let Self { given, measured, result, .. } = *self;
        *self != Self { given, read: given, measured, result, ..Self::default() }
    }
}

/// What was done to a network. Nodes are numbered as in the input, from 0.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct PrepareReport {
    /// As given.
    pub given: Size,
    /// When read and cleaned, before any cure but that of the radii.
    pub read: Size,
    /// Whether the network was measured: its vessels are polylines.
    pub measured: bool,
    /// In the end.
    pub result: Size,
    /// Radii that were filled, by node.
    pub radii: Vec<FilledRadius>,
    /// What cleaning did.
    pub cleaned: CleanReport,
    /// Lines that were merged.
    pub merge: MergeReport,
    /// Spurs that were taken off, in the order in which they went.
    pub spurs: Vec<Spur>,
    /// Branch points joined, loops closed.
    pub joined: JoinedReport,
    /// Tips that were too close to their branch point for a cap.
    pub short_tips: Vec<ShortTip>,
    /// Tips that end in or on another vessel.
    pub touching: Vec<TouchingTip>,
    /// Components that were dropped.
    pub islands: Vec<Island>,
    /// What resampling did.
    pub resample: ResampleReport,
}

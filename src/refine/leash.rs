//! How far the nodes of a measured network may go: nothing moves but what overlaps, and that no further than it has to.

use super::frame::Frame;
use super::params::Freedom;
use anastomesh_mesh::geometry::{Point3, Total};
use anastomesh_skeleton::{EdgeId, NodeId, Overlaps, Skeleton};
use rustc_hash::FxHashSet;
use serde::{Deserialize, Serialize};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// How far a node of a polyline may go, in its radii, unless an overlap demands more: short of what counts as displaced, which
/// is measured between nodes, too.
const USUAL: f64 = 0.9;
/// Along the skeleton vessels give way this far from where they overlap, in sums of the radii there.
const REACH: f64 = 4.0;
/// The last share of it over which the way that a node may go falls to nothing.
const RAMP: f64 = 0.6;
/// Vessels closer than this, in sums of their radii, are all but touching.
const CLOSE: f64 = 1.02;
/// The furthest that an overlap can demand, in sums of its radii: a vessel that crosses another one's axis has to go one.
const DEMANDED: f64 = 2.0;

/// A node that moved far.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FarNode {
    /// The node, as in the input.
    pub node: u32,
    /// How far, in radii of its thinnest vessel.
    pub radii: f64,
}

/// Whether there is nothing for whose sake anything would have to move.
fn overlaps_nowhere(network: &Skeleton) -> bool {
    network.overlaps(&network.adjacency()).pairs.is_empty()
}

/// How far nodes may go.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leashes {
    /// At first, in radii of the node.
    radii: f64,
    /// Whether vessels that still overlap may go further.
    grows: bool,
}

impl Leashes {
    /// What is asked for; none where nodes are as free as the paper has them.
    pub(super) fn of(freedom: Freedom, given: &Skeleton) -> Option<Self> {
        let measured = Self { radii: USUAL, grows: true };
        match freedom {
            Freedom::Auto => (given.is_measured() || overlaps_nowhere(given)).then_some(measured),
            Freedom::Measured => Some(measured),
            Freedom::Radii(radii) => Some(Self { radii, grows: false }),
            Freedom::Grown => None,
        }
    }

    /// The nodes that moved further than usual, the furthest first.
    pub(super) fn demanded(self, skeleton: &Skeleton, origin: &[Point3]) -> Vec<FarNode> {
        // In radii of the thinnest vessel at each.
        let mut thin = vec![f64::INFINITY; skeleton.nodes.len()];
        for (node, radius) in skeleton.edges.iter().flat_map(|e| e.nodes.into_iter().zip(e.radii)) {
            thin[node.index()] = thin[node.index()].min(radius);
        }
        let moved = skeleton.nodes.iter().zip(origin).zip(thin);
        let moved = moved.map(|((n, o), r)| FarNode { node: n.original, radii: (n.position - o).norm() / r });
        let mut far: Vec<FarNode> = moved.filter(|n| n.radii > self.radii).collect();
        far.sort_by(|a, b| b.radii.total_cmp(&a.radii).then(a.node.cmp(&b.node)));
        far
    }

    /// Overlaps, and vessels that were let go and are all but touching: walls are not exactly at their radius.
    pub(super) fn close(frame: &Frame, overlaps: &Overlaps) -> Overlaps {
        let is_loose = |node: &NodeId| frame.leash[node.index()] > 0.0;
        let overlapping: FxHashSet<[EdgeId; 2]> = overlaps.pairs.iter().map(|o| o.edges).collect();
        let mut wide = frame.skeleton.clone();
        wide.edges.iter_mut().for_each(|edge| edge.radii = edge.radii.map(|r| CLOSE * r));
        let mut close = wide.overlaps(&frame.adjacency);
        close.pairs.retain(|o| overlapping.contains(&o.edges) || o.nodes.iter().flatten().any(is_loose));
        close
    }

    /// Lets the nodes near overlaps go: at first by so many of their radii, then twice as far each time.
    pub(super) fn loosen(self, frame: &mut Frame, overlaps: &Overlaps) {
        let mut seen = vec![false; frame.origin.len()];
        // How far the search goes on, its node, and the sum of the radii of the overlap that it comes from.
        let mut heap: BinaryHeap<(Total, Reverse<NodeId>, Total)> = BinaryHeap::new();
        for overlap in &overlaps.pairs {
            let reached = |node| (Total(REACH * overlap.radii), Reverse(node), Total(overlap.radii));
            heap.extend(overlap.nodes.into_iter().flatten().map(reached));
        }
        while let Some((Total(left), Reverse(node), Total(radii))) = heap.pop() {
            if std::mem::replace(&mut seen[node.index()], true) {
                continue;
            }
            let usual = self.radii * frame.skeleton.node(node).radius;
            let further = if self.grows { (2.0 * frame.leash[node.index()]).min(DEMANDED * radii) } else { 0.0 };
            // Less and less towards where nothing moves, so that no kink is left there.
            let share = (left / (RAMP * REACH * radii)).min(1.0);
            frame.loosen(node, share * usual.max(further));
            for &edge in frame.adjacency.edges(node) {
                let left = left - frame.skeleton.length(edge);
                let next = frame.skeleton.edge(edge).other(node);
                if left > 0.0 && !seen[next.index()] {
                    heap.push((Total(left), Reverse(next), Total(radii)));
                }
            }
        }
    }
}

//! Displacement limits of a measured network: only overlapping vessels move, and no further than necessary.

use super::contact::tip_clearances;
use super::frame::Frame;
use super::overlapping::overlapping;
use super::params::Freedom;
use anastomesh_mesh::geometry::{Point3, Total};
use anastomesh_skeleton::{EdgeId, NodeId, Overlap, Overlaps, Skeleton};
use rustc_hash::FxHashSet;
use serde::{Deserialize, Serialize};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Default displacement limit of a polyline node, in its radii, unless an overlap demands more. Below 1, as
/// displacement is also measured between nodes.
const USUAL: f64 = 0.9;
/// Distance along the skeleton, in sums of radii, within which vessels yield to an overlap.
const REACH: f64 = 4.0;
/// Final fraction of `REACH` over which the limit falls to zero.
const RAMP: f64 = 0.6;
/// Vessels closer than this, in sums of their radii, almost touch.
const CLOSE: f64 = 1.02;
/// Maximum limit for an overlap, in sums of its radii: a vessel that crosses another axis has to move by one.
const DEMANDED: f64 = 2.0;

/// Node with a large displacement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FarNode {
    /// Node index in the input.
    pub node: u32,
    /// Displacement, in radii of its thinnest vessel.
    pub radii: f64,
}

/// True if no vessels overlap.
fn overlaps_nowhere(network: &Skeleton) -> bool {
    network.overlaps(&network.adjacency()).pairs.is_empty()
}

/// Overlaps of vessels with radii multiplied by a factor.
fn widened(frame: &Frame, factor: f64) -> Overlaps {
    overlapping(&frame.skeleton, &frame.adjacency, false, factor)
}

/// Displacement limits of nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leashes {
    /// Initial limit, in radii of the node.
    radii: f64,
    /// True if the limit grows for vessels that still overlap.
    grows: bool,
}

impl Leashes {
    /// Limits for a `freedom`; `None` if nodes move freely as in the paper.
    pub(super) fn of(freedom: Freedom, given: &Skeleton) -> Option<Self> {
        let measured = Self { radii: USUAL, grows: true };
        match freedom {
            Freedom::Auto => (given.is_measured() || overlaps_nowhere(given)).then_some(measured),
            Freedom::Measured => Some(measured),
            Freedom::Radii(radii) => Some(Self { radii, grows: false }),
            Freedom::Grown => None,
        }
    }

    /// Nodes displaced beyond the initial limit, largest displacement first.
    pub(super) fn demanded(self, skeleton: &Skeleton, origin: &[Point3]) -> Vec<FarNode> {
        // Displacement is in radii of the thinnest vessel at each node.
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

    /// Vessels whose walls may intersect, though their tubes do not overlap: closer than `near` sums of their radii, if that is
    /// more than usual.
    pub(super) fn near(frame: &Frame, near: f64) -> Overlaps {
        widened(frame, near.max(CLOSE))
    }

    /// Overlaps, plus vessels closer than `near` sums of their radii, and released vessels that almost touch: walls deviate
    /// slightly from the radius.
    pub(super) fn close(frame: &Frame, overlaps: &Overlaps, near: f64) -> Overlaps {
        let is_loose = |node: &NodeId| frame.leash[node.index()] > 0.0;
        let known: FxHashSet<[EdgeId; 2]> = overlaps.pairs.iter().map(|o| o.edges).collect();
        let factor = near.max(CLOSE);
        let mut close = widened(frame, factor);
        // The radii are those of the widened vessels.
        let is_near = |o: &Overlap| factor * o.distance < near * o.radii;
        close.pairs.retain(|o| known.contains(&o.edges) || is_near(o) || o.nodes.iter().flatten().any(is_loose));
        close
    }

    /// Terminals that almost touch, as overlaps of their vessels at these places.
    pub(super) fn at_tips(frame: &Frame) -> Vec<Overlap> {
        let (skeleton, adjacency) = (&frame.skeleton, &frame.adjacency);
        let tips = tip_clearances(skeleton, adjacency, CLOSE);
        let mut close = widened(frame, CLOSE).pairs;
        close.retain_mut(|overlap| {
            let [a, b] = overlap.nodes.map(|nodes| nodes.into_iter().find(|n| tips.contains_key(n)));
            let [Some(a), Some(b)] = [a, b] else { return false };
            overlap.points = [a, b].map(|n| skeleton.node(n).position);
            true
        });
        close
    }

    /// Raises the limits of nodes near overlaps: first to the initial limit, then by doubling.
    pub(super) fn loosen(self, frame: &mut Frame, overlaps: &Overlaps) {
        let mut seen = vec![false; frame.origin.len()];
        // Remaining search distance, its node, and the sum of radii of the originating overlap.
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
            // Decreases towards fixed vessels, so that no kink remains.
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

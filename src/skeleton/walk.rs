//! Distances along the skeleton, near one place.

use super::{Adjacency, NodeId, Skeleton};
use rustc_hash::FxHashMap;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Distances along the skeleton from one node, as far as a limit (Dijkstra's algorithm). Keeps its memory between
/// searches.
#[derive(Default)]
pub struct LocalDistances {
    found: FxHashMap<NodeId, f64>,
    heap: BinaryHeap<Nearest>,
}

impl LocalDistances {
    /// Finds all nodes within `limit` of `start`.
    pub fn search(&mut self, skeleton: &Skeleton, adjacency: &Adjacency, start: NodeId, limit: f64) {
        self.found.clear();
        self.heap.clear();
        self.heap.push(Nearest { distance: 0.0, node: start });
        while let Some(Nearest { distance, node }) = self.heap.pop() {
            if self.found.contains_key(&node) {
                continue;
            }
            self.found.insert(node, distance);
            for &edge in adjacency.edges(node) {
                let next = skeleton.edge(edge).other(node);
                let further = distance + skeleton.length(edge);
                if further <= limit && !self.found.contains_key(&next) {
                    self.heap.push(Nearest { distance: further, node: next });
                }
            }
        }
    }

    /// Distance of a node; infinite beyond the limit.
    pub fn of(&self, node: NodeId) -> f64 {
        self.found.get(&node).copied().unwrap_or(f64::INFINITY)
    }
}

/// The smallest distance comes first out of a heap.
#[derive(PartialEq)]
struct Nearest {
    distance: f64,
    node: NodeId,
}

impl Eq for Nearest {}

impl Ord for Nearest {
    fn cmp(&self, other: &Self) -> Ordering {
        other.distance.total_cmp(&self.distance).then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Nearest {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

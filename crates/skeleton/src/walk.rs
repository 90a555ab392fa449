//! Local distances along the skeleton.

use super::{Adjacency, NodeId, Skeleton};
use anastomesh_mesh::geometry::Total;
use rustc_hash::FxHashMap;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Distances along the skeleton from one node up to a limit (Dijkstra's algorithm). Reuses its memory between searches.
#[derive(Default)]
pub struct LocalDistances {
    found: FxHashMap<NodeId, f64>,
    /// Nearest first.
    heap: BinaryHeap<Reverse<(Total, NodeId)>>,
}

impl LocalDistances {
    /// Finds all nodes within `limit` of `start`.
    pub fn search(&mut self, skeleton: &Skeleton, adjacency: &Adjacency, start: NodeId, limit: f64) {
        self.found.clear();
        self.heap.clear();
        self.heap.push(Reverse((Total(0.0), start)));
        while let Some(Reverse((Total(distance), node))) = self.heap.pop() {
            if self.found.contains_key(&node) {
                continue;
            }
            self.found.insert(node, distance);
            for &edge in adjacency.edges(node) {
                let next = skeleton.edge(edge).other(node);
                let further = distance + skeleton.length(edge);
                if further <= limit && !self.found.contains_key(&next) {
                    self.heap.push(Reverse((Total(further), next)));
                }
            }
        }
    }

    /// Distance of a node; infinite beyond the limit.
    pub fn of(&self, node: NodeId) -> f64 {
        self.found.get(&node).copied().unwrap_or(f64::INFINITY)
    }
}

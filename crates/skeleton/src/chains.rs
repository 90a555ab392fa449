//! All branches of a skeleton in flat lists. In networks of millions of vessels, each branch is built only when used.

use serde::{Deserialize, Serialize};

use super::{Adjacency, Branch, EdgeId, NodeId, Skeleton};

/// All branches, by `BranchId`: those that start at junctions and terminals by their first node, then the rings.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Chains {
    /// Start of the edges of each branch, with an end marker.
    first: Vec<u32>,
    /// Nodes in order, one more per branch than edges.
    nodes: Vec<NodeId>,
    edges: Vec<EdgeId>,
}

impl Chains {
    /// Number of branches.
    pub fn len(&self) -> usize {
        self.first.len() - 1
    }

    /// Returns `true` if the list is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    fn range(&self, branch: u32) -> std::ops::Range<usize> {
        self.first[branch as usize] as usize..self.first[branch as usize + 1] as usize
    }

    /// Edges along a branch.
    pub fn edges(&self, branch: u32) -> &[EdgeId] {
        &self.edges[self.range(branch)]
    }

    /// Nodes along a branch.
    pub fn nodes(&self, branch: u32) -> &[NodeId] {
        let (range, before) = (self.range(branch), branch as usize);
        &self.nodes[range.start + before..=range.end + before]
    }

    /// First and last node.
    pub fn ends(&self, branch: u32) -> [NodeId; 2] {
        let nodes = self.nodes(branch);
        [nodes[0], nodes[nodes.len() - 1]]
    }

    /// A branch with its arc lengths.
    pub fn branch(&self, skeleton: &Skeleton, branch: u32) -> Branch {
        let edges = self.edges(branch).to_vec();
        let mut arc = Vec::with_capacity(edges.len() + 1);
        let mut length = 0.0;
        arc.push(length);
        for &edge in &edges {
            length += skeleton.length(edge);
            arc.push(length);
        }
        Branch { nodes: self.nodes(branch).to_vec(), edges, arc }
    }
}

impl Skeleton {
    /// All branches. Every edge belongs to exactly one.
    pub fn chains(&self, adjacency: &Adjacency) -> Chains {
        // Every branch has two ends, except rings, which are not counted.
        let ends: usize = self.node_ids().map(|node| adjacency.valence(node)).filter(|&valence| valence != 2).sum();
        let mut first = Vec::with_capacity(ends.div_ceil(2) + 1);
        first.push(0);
        let chains = Chains {
            first,
            nodes: Vec::with_capacity(self.edges.len() + ends.div_ceil(2)),
            edges: Vec::with_capacity(self.edges.len()),
        };
        let mut walk = Walk { skeleton: self, adjacency, chains, seen: vec![false; self.edges.len()] };
        for node in self.node_ids() {
            if adjacency.valence(node) != 2 {
                for &edge in adjacency.edges(node) {
                    walk.branch(node, edge);
                }
            }
        }
        for edge in self.edge_ids() {
            walk.branch(self.edge(edge).nodes[0], edge);
        }
        walk.chains
    }
}

struct Walk<'a> {
    skeleton: &'a Skeleton,
    adjacency: &'a Adjacency,
    chains: Chains,
    seen: Vec<bool>,
}

impl Walk<'_> {
    /// Follows the chain that leaves `start` by `first` until it ends or closes, unless already visited.
    fn branch(&mut self, start: NodeId, first: EdgeId) {
        if self.seen[first.index()] {
            return;
        }
        let (mut node, mut edge) = (start, first);
        self.chains.nodes.push(start);
        loop {
            self.seen[edge.index()] = true;
            node = self.skeleton.edge(edge).other(node);
            self.chains.edges.push(edge);
            self.chains.nodes.push(node);
            if node == start || self.adjacency.valence(node) != 2 {
                break;
            }
            let pair = self.adjacency.edges(node);
            edge = if pair[0] == edge { pair[1] } else { pair[0] };
        }
        self.chains.first.push(self.chains.edges.len() as u32);
    }
}

//! Invariants of a cleaned skeleton.

use super::{Edge, EdgeId, LARGEST, NodeId, Skeleton, SkeletonError, is_usable_radius};

impl Skeleton {
    /// Checks that ids exist, numbers are finite, radii positive, edges distinct and not empty, and nodes not isolated.
    ///
    /// # Errors
    /// The first violation.
    pub fn check(&self) -> Result<(), SkeletonError> {
        if self.edges.is_empty() {
            return Err(SkeletonError::NoVessel { nodes: self.nodes.len() });
        }
        self.check_numbers()?;
        let adjacency = self.adjacency();
        for id in self.edge_ids() {
            let [a, b] = self.edge(id).nodes;
            if a == b || self.node(a).position == self.node(b).position {
                return Err(SkeletonError::NoLength { edge: id });
            }
        }
        let mut seen = vec![EdgeId(u32::MAX); self.nodes.len()];
        for node in self.node_ids() {
            if adjacency.valence(node) == 0 {
                return Err(SkeletonError::Isolated { node });
            }
            self.check_repeats(node, adjacency.edges(node), &mut seen)?;
        }
        Ok(())
    }

    /// Checks for repeated edges. `seen` is scratch: the edge to each visited node, valid if that edge is at `node`.
    fn check_repeats(&self, node: NodeId, edges: &[EdgeId], seen: &mut [EdgeId]) -> Result<(), SkeletonError> {
        for &id in edges {
            let other = self.edge(id).other(node);
            let before = seen[other.index()];
            if before.0 != u32::MAX && before != id && self.edge(before).nodes.contains(&node) {
                return Err(SkeletonError::RepeatedEdge { edges: [before, id] });
            }
            seen[other.index()] = id;
        }
        Ok(())
    }

    /// Checks that every number is usable and every edge refers to existing nodes.
    ///
    /// # Errors
    /// The first violation.
    pub fn check_numbers(&self) -> Result<(), SkeletonError> {
        for node in &self.nodes {
            if !node.position.iter().all(|x| x.abs() < LARGEST) {
                return Err(SkeletonError::BadPosition { original: node.original, position: node.position });
            }
            if !is_usable_radius(node.radius) {
                return Err(SkeletonError::BadNodeRadius { original: node.original, radius: node.radius });
            }
        }
        for (id, Edge { nodes, radii }) in self.edges.iter().enumerate() {
            let edge = EdgeId(id as u32);
            if let Some(&node) = nodes.iter().find(|n| n.index() >= self.nodes.len()) {
                return Err(SkeletonError::UnknownNode { edge, node, nodes: self.nodes.len() });
            }
            if let Some(&radius) = radii.iter().find(|&&r| !is_usable_radius(r)) {
                return Err(SkeletonError::BadEdgeRadius { edge, radius });
            }
        }
        Ok(())
    }
}

//! Terminals too close to each other for both caps.

use super::{Adjacency, NodeId, Skeleton};
use kiddo::{ImmutableKdTree, SquaredEuclidean};
use serde::Serialize;

/// Two terminals closer than the sum of their radii.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CrowdedTerminals {
    /// The two nodes, in ascending order.
    pub nodes: [NodeId; 2],
    /// Their distance.
    pub distance: f64,
    /// Sum of their radii.
    pub radii: f64,
}

impl Skeleton {
    /// Pairs of terminals closer than the sum of their radii, in ascending order. Cleaning merges terminals at one
    /// point.
    pub fn crowded_terminals(&self, adjacency: &Adjacency) -> Vec<CrowdedTerminals> {
        self.crowded_among(&adjacency.terminals())
    }

    /// Pairs among the given nodes, which must be at different points.
    pub fn crowded_among(&self, terminals: &[NodeId]) -> Vec<CrowdedTerminals> {
        let places: Vec<[f64; 3]> = terminals.iter().map(|&n| self.node(n).position.into()).collect();
        // Building fails only without points or with NaN coordinates.
        let Ok(tree) = ImmutableKdTree::<f64, 3>::new_from_slice(&places) else { return Vec::new() };
        let mut pairs = Vec::new();
        for (&a, place) in terminals.iter().zip(&places) {
            let own = self.node(a).radius;
            // The thicker of two finds the thinner: the sum of radii is at most twice its own.
            let reach = 2.0 * own;
            for near in tree.query(place).within::<SquaredEuclidean<f64>>(reach * reach).unsorted().execute() {
                let b = terminals[near.item as usize];
                let other = self.node(b).radius;
                let thicker = own > other || (own == other && a < b);
                let distance = (self.node(a).position - self.node(b).position).norm();
                if a != b && thicker && distance < own + other {
                    pairs.push(CrowdedTerminals { nodes: [a.min(b), a.max(b)], distance, radii: own + other });
                }
            }
        }
        pairs.sort_unstable_by_key(|p| p.nodes);
        pairs
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Edge, Node};
    use anastomesh_mesh::geometry::Point3;
    use proptest::prelude::*;

    /// One vessel from each given terminal to a distant point of its own.
    fn vessels(terminals: &[([f64; 3], f64)]) -> Skeleton {
        let mut skeleton = Skeleton::default();
        for (i, &(p, radius)) in terminals.iter().enumerate() {
            let far = [1e3 * (i + 1) as f64, 5e3, 0.0];
            for place in [p, far] {
                let original = skeleton.nodes.len() as u32;
                skeleton.nodes.push(Node { position: Point3::from(place), radius, original });
            }
            let nodes = [NodeId(2 * i as u32), NodeId(2 * i as u32 + 1)];
            skeleton.edges.push(Edge { nodes, radii: [radius; 2] });
        }
        skeleton
    }

    #[test]
    fn none_in_an_empty_skeleton() {
        let empty = Skeleton::default();
        assert_eq!(empty.crowded_terminals(&empty.adjacency()), []);
    }

    proptest! {
        #[test]
        fn the_same_as_all_pairs(terminals in prop::collection::vec((prop::array::uniform3(0.0..20.0), 0.1..3.0), 1..60)) {
            let skeleton = vessels(&terminals);
            let found = skeleton.crowded_terminals(&skeleton.adjacency());
            let mut expected = Vec::new();
            for (i, a) in skeleton.nodes.iter().enumerate() {
                for (j, b) in skeleton.nodes.iter().enumerate().skip(i + 1) {
                    if (a.position - b.position).norm() < a.radius + b.radius {
                        expected.push([NodeId(i as u32), NodeId(j as u32)]);
                    }
                }
            }
            prop_assert_eq!(found.iter().map(|p| p.nodes).collect::<Vec<_>>(), expected);
        }
    }
}

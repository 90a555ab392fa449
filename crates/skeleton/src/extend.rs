//! Straight extension of terminals, so that outflow is fully developed and boundary conditions do not affect vessels.

use super::{Edge, Node, NodeId, Skeleton};
use rustc_hash::FxHashMap;

/// A skeleton with longer terminals.
#[derive(Clone, Debug, PartialEq)]
pub struct Extended {
    /// The skeleton; a new end has the original index of its terminal.
    pub skeleton: Skeleton,
    /// Terminals extended less than requested because of another vessel, with the extension in radii.
    pub cut_short: Vec<(NodeId, f64)>,
}

/// Maximum halvings of an obstructed extension before it is left out.
const HALVINGS: u32 = 3;

impl Skeleton {
    /// Extends terminals by the given number of radii each; 0 changes nothing. No extension overlaps another vessel.
    pub fn extended(&self, radii: &FxHashMap<NodeId, f64>) -> Extended {
        let mut terminals: Vec<(NodeId, f64, u32)> = radii.iter().map(|(&node, &by)| (node, by, 0)).collect();
        terminals.sort_unstable_by_key(|(node, ..)| *node);
        terminals.retain(|(_, by, _)| *by > 0.0);
        loop {
            let skeleton = self.with_pieces(&terminals);
            let mut in_the_way: Vec<usize> = Vec::new();
            for pair in skeleton.overlaps(&skeleton.adjacency()).pairs {
                in_the_way.extend(pair.edges.iter().filter_map(|edge| edge.index().checked_sub(self.edges.len())));
            }
            in_the_way.sort_unstable();
            in_the_way.dedup();
            // Extensions of length 0 have no edge, so only the others are counted.
            let with_edge: Vec<usize> = (0..terminals.len()).filter(|&i| terminals[i].1 > 0.0).collect();
            if in_the_way.is_empty() {
                let cut = terminals.iter().filter(|(.., halved)| *halved > 0);
                return Extended { skeleton, cut_short: cut.map(|&(node, by, _)| (node, by)).collect() };
            }
            for piece in in_the_way {
                let (_, by, halved) = &mut terminals[with_edge[piece]];
                *halved += 1;
                *by = if *halved > HALVINGS { 0.0 } else { *by / 2.0 };
            }
        }
    }

    fn with_pieces(&self, terminals: &[(NodeId, f64, u32)]) -> Self {
        let adjacency = self.adjacency();
        let mut longer = self.clone();
        for &(node, by, _) in terminals.iter().filter(|(_, by, _)| *by > 0.0) {
            let edge = self.edge(adjacency.edges(node)[0]);
            let (end, radius) = (self.node(node), edge.radii[edge.end(node)]);
            let way = (end.position - self.node(edge.other(node)).position).normalize();
            let tip = NodeId(longer.nodes.len() as u32);
            longer.nodes.push(Node { position: end.position + way * (by * radius), radius, original: end.original });
            longer.edges.push(Edge { nodes: [node, tip], radii: [radius; 2] });
        }
        longer
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::network;

    #[test]
    fn a_terminal_goes_on_straight_and_keeps_its_name() {
        let tube = network(&[[0.0; 3], [0.0, 0.0, 9.0]], 1.0, &[(0, 1)]);
        let Extended { skeleton, cut_short } =
            tube.extended(&[(NodeId(1), 5.0), (NodeId(0), 0.0)].into_iter().collect());
        assert_eq!((skeleton.nodes.len(), cut_short.len()), (3, 0));
        assert_eq!((skeleton.nodes[2].position.z, skeleton.nodes[2].original), (14.0, 1));
        assert_eq!(skeleton.adjacency().terminals(), [NodeId(0), NodeId(2)]);
    }

    #[test]
    fn a_piece_ends_before_another_vessel() {
        let points = [[0.0; 3], [0.0, 0.0, 9.0], [-9.0, 0.0, 17.0], [9.0, 0.0, 17.0]];
        let two = network(&points, 1.0, &[(0, 1), (2, 3)]);
        let Extended { skeleton, cut_short } = two.extended(&[(NodeId(1), 10.0)].into_iter().collect());
        assert_eq!(cut_short, [(NodeId(1), 5.0)]);
        assert_eq!(skeleton.nodes[4].position.z, 14.0);
        let near = network(&points.map(|[x, y, z]| [x, y, z.min(11.1)]), 1.0, &[(0, 1), (2, 3)]);
        let Extended { skeleton, cut_short } = near.extended(&[(NodeId(1), 10.0)].into_iter().collect());
        assert_eq!((skeleton, cut_short), (near, vec![(NodeId(1), 0.0)]));
    }
}

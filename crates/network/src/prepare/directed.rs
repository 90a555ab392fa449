//! Orientation of edges away from the inlet.

use anastomesh_skeleton::{NodeId, Skeleton};

/// Orients every edge away from the inlet of its component, breadth first. The inlet is the thickest terminal, or the
/// first node if there is no terminal. In a network with loops two edges may lead to one node.
pub fn directed(skeleton: &Skeleton) -> Skeleton {
    let adjacency = skeleton.adjacency();
    let components = skeleton.components(&adjacency);
    let roots = skeleton.roots(&adjacency, &components);
    let mut result = skeleton.clone();
    let mut turned = vec![false; skeleton.edges.len()];
    let mut seen = vec![false; skeleton.nodes.len()];
    for (component, root) in components.list.iter().zip(roots) {
        let root: NodeId = root.unwrap_or(component.nodes[0]);
        let mut front = std::collections::VecDeque::from([root]);
        seen[root.index()] = true;
        while let Some(node) = front.pop_front() {
            for &id in adjacency.edges(node) {
                if std::mem::replace(&mut turned[id.index()], true) {
                    continue;
                }
                let edge = &mut result.edges[id.index()];
                if edge.nodes[0] != node {
                    edge.nodes.swap(0, 1);
                    edge.radii.swap(0, 1);
                }
                if !std::mem::replace(&mut seen[edge.nodes[1].index()], true) {
                    front.push_back(edge.nodes[1]);
                }
            }
        }
    }
    result
}

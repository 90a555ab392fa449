//! Components too small to mesh.

use anastomesh_skeleton::{Skeleton, SkeletonError, clean};
use serde::Serialize;

/// Removed component.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Island {
    /// First node of the component.
    pub node: u32,
    /// Number of nodes.
    pub nodes: usize,
    /// Length of the vessels, in the unit of the network.
    pub length: f64,
}

/// Removes components with fewer than `smallest` nodes.
pub(super) fn drop(skeleton: &Skeleton, smallest: usize) -> Result<(Skeleton, Vec<Island>), SkeletonError> {
    let components = skeleton.components(&skeleton.adjacency());
    let small = components.list.iter().filter(|c| c.nodes.len() < smallest);
    let islands: Vec<Island> = small
        .map(|c| Island {
            node: skeleton.node(c.nodes[0]).original,
            nodes: c.nodes.len(),
            length: c.edges.iter().map(|&e| skeleton.length(e)).sum(),
        })
        .collect();
    let large = |node: anastomesh_skeleton::NodeId| {
        components.list[components.of_node[node.index()] as usize].nodes.len() >= smallest
    };
    let edges = skeleton.edges.iter().filter(|e| large(e.nodes[0])).copied().collect();
    Ok((clean(&Skeleton { nodes: skeleton.nodes.clone(), edges })?.0, islands))
}

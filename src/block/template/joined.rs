//! Topology of a tube of several templates.

use crate::block::topology::{FinishedJoint, Topology};
use anastomesh_mesh::adjacency::{NONE, TetAdjacency};
use std::sync::Arc;

/// Piece of a tube.
pub struct Part<'a> {
    pub topology: &'a Topology,
    /// Faces of both discs in the same order.
    pub interface: &'a [Vec<u32>; 2],
}

/// Joins pieces at their discs. Vertices of the outer discs have the same numbers in the tube and in the pieces.
pub fn joined<'a>(parts: impl Iterator<Item = Part<'a>>) -> Topology {
    let (mut out, mut adjacency) = (Topology::default(), TetAdjacency::default());
    // Faces of the last disc so far.
    let mut open: Vec<u32> = Vec::new();
    for Part { topology, interface: [first, second] } in parts {
        let base = 4 * adjacency.neighbors.len() as u32;
        let moved = |face: &u32| if *face == NONE { NONE } else { face + base };
        adjacency.neighbors.extend(topology.adjacency.neighbors.iter().map(|row| row.each_ref().map(moved)));
        adjacency.crowded.extend(topology.adjacency.crowded.iter().map(moved));
        out.wall.extend(topology.wall.iter().map(moved));
        let neighbors = adjacency.neighbors.as_flattened_mut();
        for (&a, b) in open.iter().zip(first.iter().map(moved)) {
            neighbors[a as usize] = b;
            neighbors[b as usize] = a;
        }
        open = second.iter().map(moved).collect();
        if out.discs.is_empty() {
            out.discs.push(topology.discs[0].clone());
        }
        out.discs.truncate(1);
        let FinishedJoint { vertices, faces } = &topology.discs[1];
        out.discs.push(FinishedJoint { vertices: vertices.clone(), faces: faces.iter().map(moved).collect() });
    }
    out.adjacency = Arc::new(adjacency);
    out
}

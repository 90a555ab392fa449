//! Small networks from bytes.

use anastomesh_mesh::Point3;
use anastomesh_skeleton::{Component, Edge, Node, NodeId, Skeleton};

/// Radii that a byte selects. Those after the first twelve are unusable or absurd.
const RADII: [f64; 16] = [0.5, 0.5, 0.5, 0.3, 0.3, 0.2, 0.1, 0.7, 1.0, 1.0, 1.5, 2.5, 0.0, -1.0, f64::NAN, 1e-3];

/// Number of components, loops and terminals.
pub type Shape = [usize; 3];

/// Builds a network of up to 16 nodes on a grid of 16³ points and up to 24 edges. `usable` leaves out radii that are not.
///
/// Two bytes are a node: three coordinates and a radius. Each later byte is an edge between two nodes. Radii of edges are
/// those of their nodes or, with bit 1 of `mode`, those of one node. Bit 0 joins consecutive nodes, as in a polyline. Bit 2
/// moves nodes off the grid.
pub fn network(mode: u8, bytes: &[u8], usable: bool) -> Skeleton {
    let Some((&count, bytes)) = bytes.split_first() else { return Skeleton::default() };
    let (nodes, edges) = bytes.split_at((2 * (2 + usize::from(count & 15))).min(bytes.len()));
    let node = |(i, b): (usize, &[u8])| {
        let step = if mode & 4 == 0 { 0.0 } else { 0.07 * i as f64 };
        let [x, y, z] = [b[0] & 15, b[0] >> 4, b[1] & 15].map(|x| f64::from(x) + step);
        let radius = RADII[usize::from(if usable { (b[1] >> 4) % 12 } else { b[1] >> 4 })];
        Node { position: Point3::new(x, 0.5 * y, z), radius, original: i as u32 }
    };
    let nodes: Vec<Node> = nodes.chunks_exact(2).enumerate().map(node).collect();
    let mut pairs: Vec<[u8; 2]> = Vec::new();
    if mode & 1 != 0 {
        pairs.extend((1..nodes.len() as u8).map(|i| [i - 1, i]));
    }
    pairs.extend(edges.iter().take(24).map(|b| [b & 15, b >> 4]));
    let edge = |pair: [u8; 2]| {
        let [a, b] = pair.map(|i| usize::from(i) % nodes.len());
        let radii = [nodes[a].radius, nodes[if mode & 2 == 0 { b } else { a }].radius];
        Edge { nodes: [NodeId(a as u32), NodeId(b as u32)], radii }
    };
    let edges = if nodes.is_empty() { Vec::new() } else { pairs.into_iter().map(edge).collect() };
    Skeleton { nodes, edges }
}

/// Counts components, loops and terminals.
pub fn shape(network: &Skeleton) -> Shape {
    let adjacency = network.adjacency();
    let components = network.components(&adjacency).list;
    [components.len(), components.iter().map(Component::loops).sum(), adjacency.terminals().len()]
}

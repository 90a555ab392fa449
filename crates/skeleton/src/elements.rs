//! Nodes, edges, and skeletons.

use anastomesh_mesh::geometry::{Point3, Tube};

/// Index of a node in its skeleton.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub struct NodeId(pub u32);

/// Index of an edge in its skeleton.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub struct EdgeId(pub u32);

/// Index of a branch: a maximal chain of edges through nodes of valence 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub struct BranchId(pub u32);

/// A node: a point on the axis of a vessel.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Node {
    /// Position.
    pub position: Point3,
    /// Radius of the vessel there.
    pub radius: f64,
    /// Index of the node in its input file (0-based order of the points). After a split, that of the split node.
    pub original: u32,
}

/// An edge: a straight piece of vessel between two nodes.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Edge {
    /// Its two nodes.
    pub nodes: [NodeId; 2],
    /// Radius of the vessel at either end: the nodes' radii, or the edge's own radius if the input has one per edge.
    pub radii: [f64; 2],
}

/// A vessel skeleton. Several components and loops are valid.
///
/// ```
/// use anastomesh_mesh::Point3;
/// use anastomesh_skeleton::{Edge, Node, NodeId, Skeleton};
///
/// let node = |z: f64, original| Node { position: Point3::new(0.0, 0.0, z), radius: 1.0, original };
/// let edges = vec![Edge { nodes: [NodeId(0), NodeId(1)], radii: [1.0; 2] }];
/// let vessel = Skeleton { nodes: vec![node(0.0, 0), node(9.0, 1)], edges };
/// assert!(vessel.check().is_ok());
/// ```
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Skeleton {
    /// Nodes, by `NodeId`.
    pub nodes: Vec<Node>,
    /// Edges, by `EdgeId`.
    pub edges: Vec<Edge>,
}

impl Skeleton {
    /// Straight piece of vessel of an edge.
    pub fn tube(&self, edge: EdgeId) -> Tube {
        let e = &self.edges[edge.0 as usize];
        Tube {
            a: self.nodes[e.nodes[0].0 as usize].position,
            b: self.nodes[e.nodes[1].0 as usize].position,
            ra: e.radii[0],
            rb: e.radii[1],
        }
    }
}

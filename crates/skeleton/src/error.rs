//! Errors of skeletons.

use super::{EdgeId, NodeId};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::units::counted;

/// Reason why a skeleton is unusable.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SkeletonError {
    /// No edge, so no vessel.
    #[error(
        "the network has no vessel ({}, no edge of positive length): connect two nodes at different positions",
        counted(*nodes, "node")
    )]
    NoVessel {
        /// Number of nodes.
        nodes: usize,
    },
    /// An edge refers to a missing node.
    #[error("edge {} refers to node {}, but only nodes 0 to {} exist", edge.0, node.0, nodes.saturating_sub(1))]
    UnknownNode {
        /// The edge.
        edge: EdgeId,
        /// The missing node.
        node: NodeId,
        /// Number of nodes.
        nodes: usize,
    },
    /// A coordinate is infinite, NaN, or too large for computation.
    #[error("node {original} has the position {position}: coordinates must be finite and below {LARGEST:e}")]
    BadPosition {
        /// The node, as numbered in the file (from 0).
        original: u32,
        /// Its position.
        position: Point3,
    },
    /// A radius of a node is not [usable](is_usable_radius).
    #[error("node {original} has the radius {radius:?}: radii must be positive, between {SMALLEST:e} and {LARGEST:e}")]
    BadNodeRadius {
        /// The node, as numbered in the file (from 0).
        original: u32,
        /// Its radius.
        radius: f64,
    },
    /// A radius of an edge is not [usable](is_usable_radius).
    #[error("edge {} has the radius {radius:?}: radii must be positive, between {SMALLEST:e} and {LARGEST:e}", edge.0)]
    BadEdgeRadius {
        /// The edge.
        edge: EdgeId,
        /// Its radius.
        radius: f64,
    },
    /// An edge has no length: both its ends are one node, or lie at one point.
    #[error("edge {} has zero length", edge.0)]
    NoLength {
        /// The edge.
        edge: EdgeId,
    },
    /// Two edges between the same two nodes.
    #[error("edges {} and {} join the same two nodes", edges[0].0, edges[1].0)]
    RepeatedEdge {
        /// The two edges.
        edges: [EdgeId; 2],
    },
    /// A node has no edge.
    #[error("node {} has no edge", node.0)]
    Isolated {
        /// The node.
        node: NodeId,
    },
}

/// Upper bound of coordinates, so that no product of five of them overflows in the predicates.
pub const LARGEST: f64 = 1e50;

/// Lower bound of radii, so that no product of five of them is rounded to zero.
pub const SMALLEST: f64 = 1e-50;

/// True if a radius is large enough and small enough for computation: between [`SMALLEST`] and [`LARGEST`].
pub fn is_usable_radius(radius: f64) -> bool {
    (SMALLEST..LARGEST).contains(&radius)
}

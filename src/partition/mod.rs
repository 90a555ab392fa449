//! Floor 3: 3.2.1 of the paper. Long vessels are cut; what stays together is a cluster.

use crate::geometry::{Section, Tube};
use crate::skeleton::{BranchId, NodeId};

/// Index of a cluster.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
pub struct ClusterId(pub u32);

/// Index of a cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
pub struct CutId(pub u32);

/// The network cut into clusters.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Partition {
    /// Clusters, by `ClusterId`.
    pub clusters: Vec<Cluster>,
    /// Cuts, by `CutId`; each joins two clusters (or a cluster to itself round a loop) by one connector.
    pub cuts: Vec<Cut>,
}

/// Branches that are meshed together.
#[derive(Clone, Debug, PartialEq)]
pub struct Cluster {
    /// Nodes inside the cluster.
    pub nodes: Vec<NodeId>,
    /// The vessels to mesh, up to the cut planes and terminals, each continued straight beyond its end plane by
    /// `OVERRUN` radii so that the surface has its full radius at the plane.
    pub tubes: Vec<Tube>,
    /// Where the cluster ends.
    pub ends: Vec<ClusterEnd>,
}

/// A plane at which a cluster ends.
#[derive(Clone, Debug, PartialEq)]
pub struct ClusterEnd {
    /// The plane; its axis points out of the cluster.
    pub section: Section,
    /// What is there.
    pub kind: EndKind,
    /// Indices into `Cluster::tubes` of the overrun: the pieces that lie beyond the plane.
    pub overrun: Vec<u32>,
}

/// What a cluster ends in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EndKind {
    /// A cut; `side` says which of the cut's two sides this cluster is.
    Cut {
        /// The cut.
        cut: CutId,
        /// 0 or 1.
        side: u8,
    },
    /// A terminal or root: a flat cap goes here, its centre is the node.
    Terminal(NodeId),
}

/// A place where a vessel is cut and later joined by a connector.
#[derive(Clone, Debug, PartialEq)]
pub struct Cut {
    /// The branch that is cut.
    pub branch: BranchId,
    /// For either side: the cluster and the index of the end in `Cluster::ends`.
    pub sides: [(ClusterId, u32); 2],
    /// The vessel between the two cut planes: sections from side 0's plane to side 1's, axes along the way from 0 to 1;
    /// between two consecutive sections the axis is straight (or turns by little) and the radius linear.
    pub path: Vec<Section>,
}

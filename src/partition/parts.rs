//! What a network is cut into: clusters, the cuts between them, and what may go wrong there.

use std::ops::Range;

use super::summary::PartitionSummary;
use anastomesh_mesh::geometry::{Section, Tube};
use anastomesh_skeleton::{BranchId, FineFork, NodeId};

/// Index of a cluster.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub struct ClusterId(pub u32);

/// Index of a cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub struct CutId(pub u32);

/// The network cut into clusters.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Partition {
    /// Clusters, by `ClusterId`.
    pub clusters: Vec<Cluster>,
    /// Cuts, by `CutId`; each joins two clusters (or a cluster to itself round a loop) by one connector.
    pub cuts: Vec<Cut>,
    /// Where on its branch each cut stands: arc lengths of the planes of side 0 and side 1, by `CutId`.
    pub cut_arcs: Vec<[f64; 2]>,
    /// The pieces of the branches that the clusters hold, by branch and arc length. With the cuts they cover every
    /// branch exactly once.
    pub pieces: Vec<Piece>,
    /// The branches that are in one cluster from end to end, and why.
    pub uncut: Vec<(BranchId, UncutReason)>,
    /// What may go wrong in a cluster.
    pub warnings: Vec<PartitionWarning>,
    pub(super) summary: PartitionSummary,
}

impl Partition {
    /// All of it in figures.
    pub fn summary(&self) -> PartitionSummary {
        self.summary
    }
}

/// A piece of a branch in a cluster.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// The cluster.
    pub cluster: ClusterId,

    /// The branch.
    pub branch: BranchId,
    /// Arc lengths between which it lies.
    pub arc: [f64; 2],
    /// Its tubes, in the direction of the branch, without overruns: a range of `Cluster::tubes`.
    pub tubes: Range<u32>,
}

/// Why a branch is not cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum UncutReason {
    /// It ends in a terminal and is not long.
    Terminal,
    /// The caller forbade it.
    Forbidden,
    /// Too short (equation 11, and room for a connector).
    Length,
    /// Too short for the angle at which it leaves another branch (equation 12).
    Angle,
    /// Nowhere straight enough for a connector.
    Bend,
    /// Nowhere clear of another vessel of its cluster.
    Clearance {
        /// The branch in its way at the first place that was tried.
        near: BranchId,
    },
}

/// Something that a cluster's mesh may suffer from.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum PartitionWarning {
    /// A terminal's overrun was shortened, as a vessel is in its way.
    ShortOverrun {
        /// The cluster.
        cluster: ClusterId,
        /// The terminal.
        node: NodeId,
        /// The branch in the way.
        near: BranchId,
        /// Length of the overrun in radii.
        radii: f64,
    },
    /// A terminal lies within or too close to another vessel of its cluster: its cap may fail.
    CapNotClear {
        /// The cluster.
        cluster: ClusterId,
        /// The terminal.
        node: NodeId,
        /// The other vessel.
        near: BranchId,
    },
}

/// Branches that are meshed together.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Cluster {
    /// Nodes inside the cluster.
    pub nodes: Vec<NodeId>,
    /// The vessels to mesh, up to the cut planes and terminals, each continued straight beyond its end plane by
    /// [`super::PartitionParams::overrun`] radii so that the surface has its full radius at the plane.
    pub tubes: Vec<Tube>,
    /// Where the cluster ends.
    pub ends: Vec<ClusterEnd>,
    /// Forks that are to have shorter edges.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fine: Vec<FineFork>,
    /// What the network asks for in the middle of a cluster that is one vessel, in edges that the resolution gives.
    #[serde(skip)]
    pub size: Option<f64>,
}

/// A plane at which a cluster ends.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ClusterEnd {
    /// The plane; its axis points out of the cluster.
    pub section: Section,
    /// What is there.
    pub kind: EndKind,
    /// Index into `Cluster::tubes` of the overrun: the piece that lies beyond the plane.
    pub overrun: u32,
}

/// What a cluster ends in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
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
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Cut {
    /// The branch that is cut.
    pub branch: BranchId,
    /// For either side: the cluster and the index of the end in `Cluster::ends`.
    pub sides: [(ClusterId, u32); 2],
    /// The vessel between the two cut planes: sections from side 0's plane to side 1's, axes along the way from 0 to 1;
    /// between two consecutive sections the axis is straight (or turns by little) and the radius linear.
    pub path: Vec<Section>,
    /// What the network asks for in the middle of it, in edges that the resolution gives.
    #[serde(skip)]
    pub size: Option<f64>,
}

impl Cut {
    /// The sides of a cut between no clusters.
    pub(crate) const NOWHERE: [(ClusterId, u32); 2] = [(ClusterId(u32::MAX), u32::MAX); 2];
}

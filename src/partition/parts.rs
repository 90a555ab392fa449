//! Result types of the partition: clusters, cuts, and warnings.

use std::ops::Range;

use super::summary::PartitionSummary;
use anastomesh_mesh::geometry::{Section, Tube};
use anastomesh_skeleton::{BranchId, FinePlace, NodeId};

/// Index of a cluster.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub struct ClusterId(pub u32);

/// Index of a cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
pub struct CutId(pub u32);

/// Partition of a network into clusters.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Partition {
    /// Clusters, by `ClusterId`.
    pub clusters: Vec<Cluster>,
    /// Cuts, by `CutId`; each joins two clusters (or a cluster to itself around a loop) by one connector.
    pub cuts: Vec<Cut>,
    /// Position of each cut on its branch: arc lengths of the planes of side 0 and side 1, by `CutId`.
    pub cut_arcs: Vec<[f64; 2]>,
    /// Branch pieces of the clusters, by branch and arc length. Together with the cuts they cover every branch exactly
    /// once.
    pub pieces: Vec<BranchPiece>,
    /// Branches that lie in one cluster from end to end, with the reason.
    pub uncut: Vec<(BranchId, UncutReason)>,
    /// Possible defects of cluster meshes.
    pub warnings: Vec<PartitionWarning>,
    pub(super) summary: PartitionSummary,
}

impl Partition {
    /// Summary figures of the partition.
    pub fn summary(&self) -> PartitionSummary {
        self.summary
    }
}

/// Piece of a branch in a cluster.
#[derive(Clone, Debug, PartialEq)]
pub struct BranchPiece {
    /// The cluster.
    pub cluster: ClusterId,

    /// The branch.
    pub branch: BranchId,
    /// Arc lengths of its two ends.
    pub arc: [f64; 2],
    /// Tubes in the direction of the branch, without overruns: a range of `Cluster::tubes`.
    pub tubes: Range<u32>,
}

/// Reason why a branch is not cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum UncutReason {
    /// The branch ends in a terminal and is not long.
    Terminal,
    /// The caller forbade the cut.
    Forbidden,
    /// The branch is too short for equation 11 and a connector.
    Length,
    /// The branch is too short for its angle with another branch (equation 12).
    Angle,
    /// No part is straight enough for a connector.
    Bend,
    /// No place is clear of other vessels of the cluster.
    Clearance {
        /// Obstructing branch at the first place tried.
        near: BranchId,
    },
}

/// Possible defect of a cluster's mesh.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[non_exhaustive]
pub enum PartitionWarning {
    /// Overrun of a terminal, shortened because a vessel is in its way.
    ShortOverrun {
        /// The cluster.
        cluster: ClusterId,
        /// Node of the terminal.
        node: NodeId,
        /// Obstructing branch.
        near: BranchId,
        /// Length of the overrun, in radii.
        radii: f64,
    },
    /// Terminal inside or too close to another vessel of its cluster: its cap may fail.
    CapNotClear {
        /// The cluster.
        cluster: ClusterId,
        /// Node of the terminal.
        node: NodeId,
        /// Branch of the other vessel.
        near: BranchId,
    },
}

/// Set of branches that are meshed together.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Cluster {
    /// Nodes inside the cluster.
    pub nodes: Vec<NodeId>,
    /// Vessels to mesh, up to the cut planes and terminals. An overrun of [`super::PartitionParams::overrun`] radii
    /// continues each vessel straight beyond its end plane, so that the surface has the full radius at the plane.
    pub tubes: Vec<Tube>,
    /// End planes of the cluster.
    pub ends: Vec<ClusterEnd>,
    /// Places with shorter edges.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fine: Vec<FinePlace>,
    /// Requested edge size in the middle of a single-vessel cluster, relative to the edge length of the resolution.
    #[serde(skip)]
    pub size: Option<f64>,
    /// Cells of the canonical forks that the cluster may be an image of, nearest first.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cells: Vec<ForkCell>,
}

/// Minimum angle of a bend between two straight vessels that is rounded as a bifurcation is, in radians. Vessels with smaller
/// bends are tubes along a curved axis.
pub const SHARP_BEND: f64 = 0.35;

/// Number of coordinates of a fork's shape.
pub const FORK_PLACES: usize = 12;

/// Cell of similar bifurcations, which have one template.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
pub struct ForkCell {
    /// Sides of the ends of the vessels.
    pub sides: [u8; 3],
    /// Steps of the coordinates of the shape.
    pub steps: [i8; FORK_PLACES],
}

impl ForkCell {
    /// Steps of the height and of the azimuths.
    pub(crate) fn leading(&self) -> [i8; 3] {
        let [height, first, second, ..] = self.steps;
        [height, first, second]
    }
}

/// Cells of the clusters of a network.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ForkCells {
    /// Cells with a canonical fork.
    pub chosen: Vec<ForkCell>,
    /// Nearest two of them for each cluster, or fewer.
    pub nearest: Vec<[Option<u32>; 2]>,
}

impl ForkCells {
    /// Cells of a cluster, nearest first.
    pub fn of(&self, cluster: u32) -> Vec<ForkCell> {
        let nearest = self.nearest.get(cluster as usize).into_iter().flatten().flatten();
        nearest.map(|&cell| self.chosen[cell as usize]).collect()
    }
}

/// End plane of a cluster.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ClusterEnd {
    /// Plane whose axis points out of the cluster.
    pub section: Section,
    /// Kind of the end.
    pub kind: EndKind,
    /// Index into `Cluster::tubes` of the overrun, the tube beyond the plane.
    pub overrun: u32,
}

/// Kind of a cluster end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EndKind {
    /// A cut; `side` is the side of the cut on which this cluster lies.
    Cut {
        /// Index of the cut.
        cut: CutId,
        /// Side: 0 or 1.
        side: u8,
    },
    /// A terminal or root: a flat cap is placed here, centred at the node.
    Terminal(NodeId),
}

/// Gap between two cut planes of a vessel, later bridged by a connector.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Cut {
    /// Branch of the cut.
    pub branch: BranchId,
    /// Cluster and index into `Cluster::ends`, for each side.
    pub sides: [(ClusterId, u32); 2],
    /// Sections of the vessel from side 0's plane to side 1's, with axes from 0 to 1. Between consecutive sections the
    /// axis is straight (or turns slightly) and the radius is linear.
    pub path: Vec<Section>,
    /// Requested edge size in the middle, relative to the edge length of the resolution.
    #[serde(skip)]
    pub size: Option<f64>,
}

impl Cut {
    /// Placeholder for the sides of a cut without clusters.
    pub(crate) const NOWHERE: [(ClusterId, u32); 2] = [(ClusterId(u32::MAX), u32::MAX); 2];
}

//! Report of a meshing run.

mod text;

#[cfg(feature = "cli")]
pub use text::named;

use super::timing::{BlockTimes, StageTime};
use crate::block::{Astray, ThinLayers};
use serde::Serialize;

/// A block that did not come out at the first try.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Retry {
    /// `cluster 12` or `connector 7`.
    pub block: String,
    /// Nodes of the block, as indices in the file that was read (the first 20).
    pub nodes: Vec<u32>,
    /// The stage that failed and why.
    pub reason: String,
    /// Remedy.
    pub remedy: String,
}

/// A block that could not be meshed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FailedBlock {
    /// `cluster 12` or `connector 7`.
    pub block: String,
    /// Nodes of the block, as indices in the file that was read (the first 20).
    pub nodes: Vec<u32>,
    /// The stage that failed and why, at the last try.
    pub reason: String,
    /// Terminals that could not be capped, if that is why.
    pub uncapped: Vec<u32>,
    /// True if its thinnest vessel needs more grid cells than the limit.
    pub too_fine: bool,
    /// File with the input that reproduces the failure, when one could be written.
    pub dump: Option<String>,
}

/// A cluster in which vessels of the network overlap, and what became of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FusedBlock {
    /// `cluster 12`.
    pub block: String,
    /// Nodes of the block, as indices in the file that was read (the first 20).
    pub nodes: Vec<u32>,
    /// Handles of its wall.
    pub handles: i64,
    /// Loops of its skeleton: other than the handles where vessels fused.
    pub loops: i64,
    /// Terminals that have no cap because their tip lies in another vessel.
    pub uncapped: Vec<u32>,
    /// An axis that is not within the wall, vessels that became one lumen: the genus need not tell.
    #[serde(flatten)]
    pub(crate) astray: Astray,
}

impl FusedBlock {
    /// True if vessels became one lumen. The genus need not tell, and if it does, no two axes need be in one lumen.
    pub fn is_one_lumen(&self) -> bool {
        self.astray.fused.is_some() || self.handles > self.loops
    }
}

/// A cluster in which loops of the skeleton enclose nothing: they lie within their own lumen.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FilledLoops {
    /// `cluster 12`.
    pub block: String,
    /// Nodes of the block, as indices in the file that was read (the first 20).
    pub nodes: Vec<u32>,
    /// Number of filled loops.
    pub loops: i64,
}

/// A cluster in which narrow gaps between vessels that touch were closed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct ClosedGaps {
    /// `cluster 12`.
    pub block: String,
    /// Nodes of the block, as indices in the file that was read (the first 20).
    pub nodes: Vec<u32>,
    /// Places of the gaps.
    pub places: Vec<[f64; 3]>,
}

/// A block in which layers are thinner than asked for.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ThinBlock {
    /// `cluster 12` or `connector 7`.
    pub block: String,
    /// Nodes of the block, as indices in the file that was read (the first 20).
    pub nodes: Vec<u32>,
    /// Thickness and position.
    #[serde(flatten)]
    pub layers: ThinLayers,
}

/// Numbers of blocks of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct BlockCounts {
    /// Number of clusters.
    pub clusters: usize,
    /// Number of connectors.
    pub connectors: usize,
    /// Number of nodes of the largest cluster.
    pub largest_cluster_nodes: usize,
}

/// Two vessels that overlap, or two triangles of the wall that meet.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Meeting {
    /// The two edges, each as a pair of node indices in the file that was read.
    pub edges: [[u32; 2]; 2],
    /// The vessels that they belong to, by number: pairs of the same two are one meeting, seen edge by edge.
    pub vessels: [u32; 2],
    /// Smallest distance of their axes.
    pub distance: f64,
    /// Sum of their radii there.
    pub radii: f64,
}

/// Size of a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct MeshSize {
    /// Number of tetrahedra.
    pub tets: usize,
    /// Number of points.
    pub points: usize,
    /// Number of triangles of the wall.
    pub wall_triangles: usize,
    /// Number of triangles of the caps.
    pub cap_triangles: usize,
}

impl RunReport {
    /// Terminals without a cap, as indices in the file that was read: those abandoned
    /// when vessels were fused, and those of failed blocks.
    pub fn uncapped(&self) -> impl Iterator<Item = u32> {
        self.fused.iter().flat_map(|f| &f.uncapped).chain(self.failed.iter().flat_map(|f| &f.uncapped)).copied()
    }

    /// Deepest overlap of each pair of vessels, the deepest first.
    pub fn overlapping_places(&self) -> Vec<&Meeting> {
        let mut places: Vec<&Meeting> = self.overlaps.iter().collect();
        let depth = |m: &Meeting| m.distance / m.radii;
        let vessels = |m: &Meeting| [m.vessels[0].min(m.vessels[1]), m.vessels[0].max(m.vessels[1])];
        places.sort_by(|a, b| vessels(a).cmp(&vessels(b)).then(depth(a).total_cmp(&depth(b))));
        places.dedup_by_key(|m| vessels(m));
        // A stable sort: the vessels of lower numbers come first among equals.
        places.sort_by(|a, b| depth(a).total_cmp(&depth(b)));
        places
    }

    /// True if the walls contain the vessels: every axis within, and, unless they were to fuse, vessels that are apart as two
    /// lumens.
    pub fn keeps_vessels(&self, fuse: bool) -> bool {
        self.fused.iter().all(|f| f.astray.outside.is_none() && (fuse || f.astray.fused.is_none()))
    }
}

/// Everything that a run has to say.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RunReport {
    /// Nodes and edges of the network after cleaning and splitting.
    pub network: [usize; 2],
    /// Nodes made by the splitting of valence > 3.
    pub nodes_split: usize,
    /// Vessels that overlap.
    pub overlaps: Vec<Meeting>,
    /// Pairs of edges without a common node whose tubes intersect, including neighbours along a vessel. Each edge is a pair
    /// of node indices in the file that was read.
    #[serde(skip)]
    pub unconnected: Vec<[[u32; 2]; 2]>,
    /// The blocks.
    pub blocks: BlockCounts,
    /// The partition in figures.
    pub(crate) partition: Option<crate::partition::PartitionSummary>,
    /// The joints.
    #[cfg(feature = "woven")]
    pub(crate) joints: Option<crate::woven::JointReport>,
    /// Blocks that needed another try.
    pub retries: Vec<Retry>,
    /// Clusters in which overlapping vessels changed the topology.
    pub fused: Vec<FusedBlock>,
    /// Loops that vessels make which fused: handles of the walls beyond the loops of the skeleton.
    pub anastomoses: i64,
    /// Clusters with loops that are filled by their own lumen, which are none of the mesh.
    pub filled: Vec<FilledLoops>,
    /// Clusters in which narrow gaps between vessels were closed.
    pub(crate) closed_gaps: Vec<ClosedGaps>,
    /// Blocks in which layers, where they were asked for, are less than half as thick at some place; the thinnest first.
    pub thin_layers: Vec<ThinBlock>,
    /// Blocks that are missing from the mesh.
    pub failed: Vec<FailedBlock>,
    /// Size of the mesh.
    pub mesh: MeshSize,
    /// Expected cost of the run.
    pub estimate: super::Estimate,
    /// Wall time.
    pub(crate) stages: Vec<StageTime>,
    /// Times of the blocks.
    pub(crate) block_times: BlockTimes,
}

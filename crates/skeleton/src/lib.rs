//! Floor 2: the vessel skeleton, a graph whose nodes are points with a radius and whose edges are vessels.

mod branch;
mod chains;
mod check;
mod clean;
pub mod course;
mod crowding;
pub mod cuttability;
mod elements;
mod error;
mod extend;
#[doc(hidden)]
pub mod fixtures;
mod graph;
mod groups;
mod measured;
mod metrics;
mod overlap;
pub mod resolution;
mod size_at;
#[cfg(test)]
mod tests;
mod walk;

pub use branch::{Branch, Branches, Place};
pub use clean::{CleanReport, clean};
pub use crowding::CrowdedTerminals;
pub use cuttability::{ANGLE_MARGIN, CONNECTOR_ROOM, CUT_DISTANCE, CutRules, separation};
pub use elements::{BranchId, Edge, EdgeId, Node, NodeId, Skeleton};
pub use error::{LARGEST, SkeletonError};
pub use extend::Extended;
pub use graph::{Adjacency, Component, Components};
pub use groups::LineGroup;
pub use metrics::{Barrier, Metrics, NARROW, PairGradient, Share};
pub use overlap::{Overlap, Overlaps};
pub use size_at::{BadSize, FineFork, LEAST_SIZE, NodeSizes, SizeAt};

pub use chains::Chains;
pub use groups::Kinship;
pub use metrics::paper_unit;
pub use overlap::{JOINED, deepest_apart};
pub use size_at::Leg;
pub use walk::LocalDistances;

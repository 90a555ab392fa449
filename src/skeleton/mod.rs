//! Floor 2: the vessel skeleton, a graph whose nodes are points with a radius and whose edges are vessels.

mod branch;
mod chains;
mod check;
mod clean;
pub(crate) mod course;
mod crowding;
pub(crate) mod cuttability;
mod elements;
mod error;
mod extend;
#[cfg(test)]
pub(crate) mod fixtures;
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

pub use branch::{Branch, Branches};
pub use clean::{CleanReport, clean};
pub use crowding::CrowdedTerminals;
pub use cuttability::{ANGLE_MARGIN, CONNECTOR_ROOM, CUT_DISTANCE, CutRules, separation};
pub use elements::{BranchId, Edge, EdgeId, Node, NodeId, Skeleton};
pub use error::{LARGEST, SkeletonError};
pub use extend::Extended;
pub use graph::{Adjacency, Component};
pub use groups::LineGroup;
pub use metrics::{Barrier, Metrics, NARROW, Share};
pub use overlap::{Overlap, Overlaps};
pub use size_at::{BadSize, FineFork, LEAST_SIZE, NodeSizes, SizeAt};

pub(crate) use chains::Chains;
pub(crate) use groups::Kinship;
pub(crate) use metrics::paper_unit;
pub(crate) use overlap::{JOINED, deepest_apart};
pub(crate) use size_at::Leg;
pub use walk::LocalDistances;

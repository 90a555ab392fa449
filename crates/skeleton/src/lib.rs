//! Skeletons of vascular networks: graphs whose nodes are points with a radius and whose edges are vessels.
//!
//! ```
//! use anastomesh_mesh::Point3;
//! use anastomesh_skeleton::{Edge, Node, NodeId, Skeleton, clean};
//!
//! let node = |z: f64, original| Node { position: Point3::new(0.0, 0.0, z), radius: 1.0, original };
//! let edges = vec![Edge { nodes: [NodeId(0), NodeId(1)], radii: [1.0; 2] }];
//! let vessel = Skeleton { nodes: vec![node(0.0, 0), node(9.0, 1)], edges };
//! let (vessel, report) = clean(&vessel)?;
//! assert!(report.is_empty());
//! assert_eq!(vessel.components(&vessel.adjacency()).list.len(), 1);
//! # Ok::<(), anastomesh_skeleton::SkeletonError>(())
//! ```
//!
//! | to | use |
//! |---|---|
//! | clean a skeleton that was read | [`clean`] |
//! | split it into branches and connected components | [`Branches`], [`Components`], [`Chains`] |
//! | find overlapping vessels | [`Overlaps`] |
//! | find where branches can be cut | [`cuttability`], [`course`] |
//! | measure it | [`Metrics`] |
//! | find the vessel nearest to a place | [`Tubes`] |
//! | choose edge lengths | [`SizeAt`], [`SizeField`], [`resolution`] |
//!
//! The crate has no features.

mod branch;
mod chains;
mod check;
mod clean;
pub mod course;
mod crotch;
mod crowding;
pub mod cuttability;
mod elements;
mod error;
mod extend;
mod fine_place;
#[doc(hidden)]
pub mod fixtures;
mod graph;
mod groups;
mod measured;
mod metrics;
mod overlap;
pub mod resolution;
mod size_at;
mod size_field;
#[cfg(test)]
mod tests;
mod tubes;
mod walk;

pub use branch::{Branch, Branches, Place};
pub use clean::{CleanReport, clean};
pub use crotch::{CrotchRule, CrotchSearch};
pub use crowding::CrowdedTerminals;
pub use cuttability::{ANGLE_MARGIN, CONNECTOR_ROOM, CUT_DISTANCE, CutRules, separation};
pub use elements::{BranchId, Edge, EdgeId, Node, NodeId, Skeleton};
pub use error::{LARGEST, SMALLEST, SkeletonError, is_usable_radius};
pub use extend::Extended;
pub use fine_place::{FinePlace, LEAST_SIZE};
pub use graph::{Adjacency, Component, Components};
pub use groups::LineGroup;
pub use metrics::{Barrier, Metrics, NARROW, PairGradient, Share};
pub use overlap::{Overlap, Overlaps};
pub use size_at::{BadSize, NodeSizes, SizeAt};
pub use size_field::{FineStation, SizeField, SizeFieldError};
pub use tubes::{NearestTube, Tubes};

pub use chains::Chains;
pub use fine_place::Leg;
pub use groups::Kinship;
pub use metrics::paper_unit;
pub use overlap::{JOINED, deepest_apart};
pub use walk::LocalDistances;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

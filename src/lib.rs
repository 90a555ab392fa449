//! Anastomesh turns the skeleton of a vascular network (a graph: node = point with a radius, edge = vessel) into one
//! tetrahedral volume mesh with a labelled boundary.
//!
//! | to | use |
//! |---|---|
//! | mesh a network | [`network::mesh_network`], with [`network::clean`] and [`network::refine`] before it |
//! | fill a surface with tetrahedra | [`tet::Tetrahedralizer`] |
//! | check a mesh | [`check::check_volume`], [`check::check_tets`] |
//! | read and write files | [`io`] |
//!
//! Points, surfaces and meshes are the plain types of this page. Loops run in the current thread pool of `rayon`; results
//! do not depend on its size. `ARCHITECTURE.md` describes the rooms inside.

mod block;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
mod geometry;
mod grow;
pub mod io;
mod mesh;
mod partition;
mod pipeline;
mod prepare;
mod refine;
mod report;
mod skeleton;
mod stitch;
mod surface;
pub mod tet;

pub use geometry::{Point3, Vec3};
pub use mesh::source::MeshSource;
pub use mesh::{Cap, Patch, TetMesh, TriMesh, VolumeMesh, WALL};

/// Vessel networks: made usable, moved apart, grown, and meshed.
pub mod network {
    pub use crate::grow::{Dual, GenerateError, GenerateParams, Morphometry, Organ, RAT_KIDNEY, dual, generate};
    pub use crate::pipeline::{
        Estimate, JointStyle, Manifest, MeshPlan, Meshed, Observer, RunError, RunReport, Stage, Store, Stored,
        TooLarge, mesh_into, mesh_network,
    };
    pub use crate::prepare::{PrepareParams, PrepareReport, Prepared, directed, prepare};
    pub use crate::refine::{
        Crowded, Metric, Progress, RefineError, RefineParams, RefineReport, Refined, Residual, refine,
    };
    pub use crate::report::info::NetworkInfo;
    pub use crate::report::inlets::{Inlet, Inlets, NoTerminal, Why};
    pub use crate::skeleton::{Adjacency, CleanReport, Edge, EdgeId, Node, NodeId, Skeleton, SkeletonError, clean};
}

/// Whether a mesh is valid, line by line, and how well its tetrahedra are shaped.
pub mod check {
    pub use crate::mesh::check::parts::{PiecesError, check_pieces};
    pub use crate::mesh::check::{CheckReport, Expectation, Line, Outcome, Verdict, check_tets, check_volume};
    pub use crate::mesh::quality::TetQuality;
}

/// For the tests, benchmarks and fuzz targets of this crate; not part of what it promises.
#[doc(hidden)]
pub mod testing {
    pub use crate::block::{BlockParams, ClusterMesh, EndStyle, mesh_cluster};
    pub use crate::geometry::predicates::{insphere, orient3d};
    pub use crate::geometry::{
        Aabb, Bvh, Improper, Section, Tube, point_segment, point_tube, self_contacts, self_intersections,
    };
    pub use crate::mesh::facets::triangulate;
    pub use crate::partition::{
        Cluster, ClusterEnd, ClusterId, CutId, EndKind, PartitionParams, PartitionSummary, check_partition, partition,
    };
    pub use crate::prepare::{Fault, SpurReason};
    pub use crate::refine::split;
    pub use crate::surface::{Field, SurfaceParams, vessel_surface};
    pub use crate::tet::delaunay::delaunay;
}

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

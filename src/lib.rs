//! Anastomesh turns the skeleton of a vascular network into one tetrahedral volume mesh with a labelled boundary. The
//! skeleton is a graph: nodes are points with a radius, edges are vessels.
//!
#![doc = include_str!("../docs/tree.html")]
//!
//! ```
//! use anastomesh::io::{MeshNotes, NetworkOptions, read_network, write_mesh};
//! use anastomesh::meshing::Run;
//!
//! let file = read_network("fixtures/tree_30.vtp".as_ref(), &NetworkOptions::default())?;
//! let made = Run::new(file).mesh(&())?;
//! assert!(made.is_valid() && made.check.counts.caps == 16);
//! let folder = tempfile::tempdir()?;
//! write_mesh(&folder.path().join("tree.vtu"), &made.mesh, &MeshNotes::default())?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | to | use |
//! |---|---|
//! | mesh a network | [`meshing::Run`] |
//! | grow, repair or refine a network | [`network`] |
//! | add vessel walls and tissue to a mesh | [`domain`] |
//! | compute flow, outlet models and reduced-order models | [`flow`] |
//! | fill a surface with tetrahedra | [`tet::Tetrahedralizer`] |
//! | check a mesh | [`check::check_volume`], [`check::check_tets`] |
//! | read and write files | [`io`] |
//! | follow long operations, and stop them | [`Progress`] |
//!
//! Loops run in the current thread pool of `rayon`; results do not depend on its size. `ARCHITECTURE.md` describes the
//! crates and modules.
//!
//! # Features
//!
//! | feature | default | adds |
//! |---|---|---|
//! | `cli` | yes | the program `anastomesh` |
//! | `woven` | yes | joints as in the paper: [`JointStyle::Woven`](meshing::JointStyle::Woven) |

mod block;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
mod fidelity;
mod partition;
#[cfg(feature = "cli")]
mod picture;
mod pipeline;
#[cfg(feature = "cli")]
mod report;
mod run;
mod surface;
#[cfg(feature = "cli")]
mod view;
#[cfg(feature = "woven")]
mod woven;

pub use anastomesh_domain as domain;
pub use anastomesh_flow as flow;
pub use anastomesh_io as io;
pub use anastomesh_mesh as mesh;
pub use anastomesh_mesh::progress::{Progress, Stage};
pub use anastomesh_mesh::source::MeshSource;
pub use anastomesh_mesh::{Cap, Patch, Point3, TetMesh, TriMesh, Vec3, VolumeMesh, WALL};
pub use anastomesh_network as network;
pub use anastomesh_skeleton as skeleton;
pub use anastomesh_tet as tet;

/// Meshing of a network, in memory or by blocks on disk.
///
/// [`Run`](meshing::Run) does everything that the command `mesh` does: preparation, refinement, retries, comparison with the
/// network and flow. [`mesh_network`](meshing::mesh_network) and [`mesh_into`](meshing::mesh_into) mesh a network as it is.
pub mod meshing {
    // A whole run.
    pub use crate::fidelity::{
        Along, Bin, Change, Changes, Displaced, Displacements, Fidelity, RadiusReference, SectionErrors, Spread,
    };
    pub use crate::run::{
        Attempt, Defect, Fault, Limits, MeshingError, NetworkMesh, Networks, PreparedRun, RefinedAxis, Run, Strategy,
    };
    // Its steps and reports.
    pub use crate::block::ThinLayers;
    pub use crate::partition::PartitionError;
    pub use crate::pipeline::{
        BlockCounts, Difference, Estimate, FailedBlock, FilledLoops, Forecast, FusedBlock, JointStyle, LeftWhole,
        Manifest, Meeting, MeshPlan, MeshSize, Meshed, NoShard, PlanError, Retry, Role, RunError, RunReport, Shard,
        ShareReport, StageTime, Store, StoreError, ThinBlock, TooLarge, Whole, make_share, mesh_into, mesh_network,
    };
}

/// Validity check of a mesh, and the quality of its tetrahedra.
///
/// The contents of a report are described in [`crate::mesh::check`].
pub mod check {
    pub use anastomesh_mesh::check::{CheckReport, Expectation, Line, Outcome, Verdict, check_tets, check_volume};
    pub use anastomesh_mesh::quality::TetQuality;
}

/// For the tests, benchmarks and fuzz targets of this crate; not part of what it promises.
#[doc(hidden)]
pub mod testing {
    pub use crate::block::{BlockDump, BlockParams, ClusterMesh, EndStyle, mesh_cluster, shared_cells, template_of};
    pub use crate::partition::{
        Cluster, ClusterEnd, ClusterId, CutId, EndKind, PartitionParams, PartitionSummary, SHARP_BEND, check_partition,
        partition,
    };
    pub use crate::pipeline::replay;
    #[cfg(feature = "cli")]
    pub use crate::report::info::NetworkInfo;
    pub use crate::surface::{Field, SurfaceParams, vessel_surface};
    pub use anastomesh_network::flow::solve as network_flow;

    // Types of their signatures.
    pub use crate::block::{
        About, Astray, BlockError, BlockInput, CapFaces, ConnectorAttempt, ConnectorFailure, ConnectorFault,
        ConnectorMesh, Cured, Division, DumpError, EndFault, EndSurface, EndVertex, Finished, FinishedCap,
        FinishedJoint, FlattenFailure, NotOnBoundary, StoredEnd,
    };
    pub use crate::partition::{
        BranchPiece, Cut, ForkCell, ForkCells, Partition, PartitionFlaw, PartitionWarning, UncutCounts, UncutReason,
    };
    #[cfg(feature = "cli")]
    pub use crate::report::info::{Quartiles, UnitGuess};
    pub use crate::surface::{CapError, CapFailure, SharedDisc, SurfaceError};
    pub use anastomesh_io::network::{
        NetworkFormat, read_network_arrays, read_network_from, refinement_arrays, write_tree,
    };
    pub use anastomesh_io::surface::{SurfaceFormat, read_complex_arrays, read_surface_from};
    pub use anastomesh_io::volume::{MeshFormat, read_mesh_arrays, read_mesh_from, write_mesh_to};
    pub use anastomesh_mesh::Bounds;
    pub use anastomesh_mesh::facets::triangulate;
    pub use anastomesh_mesh::geometry::predicates::{insphere, orient3d};
    pub use anastomesh_mesh::geometry::{
        Aabb, Bvh, Improper, Section, Tube, point_segment, point_tube, self_contacts, self_intersections,
    };
    pub use anastomesh_tet::parts::delaunay;

    /// A cluster with trimmed ends.
    ///
    /// # Errors
    /// The block's.
    #[cfg(feature = "woven")]
    pub fn mesh_trimmed(
        id: ClusterId,
        cluster: &Cluster,
        params: &BlockParams,
    ) -> Result<ClusterMesh, crate::block::BlockError> {
        crate::woven::mesh_trimmed(id, cluster, params, &anastomesh_tet::parts::Watch::NOBODY)
    }
}

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

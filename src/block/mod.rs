//! Meshing of one block, cluster or connector, from its skeleton part (sections 3.2.2 and 3.2.3 of the paper).
//!
//! A cluster is contoured, closed by discs at its terminals and cuts, and filled with tetrahedra. The disc at a cut is
//! an [`EndSurface`]. A connector is a tube between two end surfaces, whose vertices and triangles it adopts. Blocks
//! are thus merged by identity and never by distance.

mod alone;
mod buried;
mod cluster;
mod connector;
mod connector_surface;
mod contoured;
mod dump;
mod end_surface;
mod error;
mod faithful;
mod finished;
mod fork;
mod free_ends;
mod graph;
mod hull;
mod layered;
mod lone_tube;
mod loops;
mod params;
mod path;
mod record;
mod rings;
mod shape;
mod strip;
mod template;
mod topology;
mod wall;
mod webs;

pub(crate) use buried::buried;
pub use cluster::mesh_cluster;
pub(crate) use cluster::mesh_cluster_watched;
pub use connector::{ConnectorMesh, DIVISIONS, mesh_connector, mesh_free_connector};
pub use connector_surface::{ConnectorEnd, ConnectorFault, Division, EndVertex};
pub use contoured::{CapFaces, ClusterMesh};
pub use dump::{BlockDump, BlockInput, DumpError};
pub use end_surface::{EndFault, EndSurface, StoredEnd};
pub use error::{BlockError, ConnectorAttempt, ConnectorFailure, FlattenFailure, NotOnBoundary};
pub use faithful::Astray;
pub use finished::{About, Cured, Finished, FinishedCap};
pub use fork::{shared_cells, template_of};
pub use free_ends::shared_ends;
pub use layered::ThinLayers;
pub use params::{BlockParams, EndStyle};
pub use record::{Bytes, Connectivity, Encoded, Geometry, Piece, Record};
pub use topology::FinishedJoint;

#[cfg(all(test, feature = "woven"))]
pub(crate) use connector_surface::connector_surface;
// Parts of blocks with trimmed ends.
#[cfg(feature = "woven")]
pub(crate) use {
    contoured::cut_ends,
    end_surface::{CutEnd, CutPlane, cross, crossing, disc_rim},
};

#[cfg(test)]
mod cluster_tests;
#[cfg(test)]
mod connector_tests;
#[cfg(test)]
pub(crate) mod fixtures;

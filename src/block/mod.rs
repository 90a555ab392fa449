//! Floor 4: one block, cluster or connector, from its piece of skeleton to tetrahedra (3.2.2 and 3.2.3 of the paper).
//!
//! A cluster is contoured, closed at its terminals, filled with tetrahedra and trimmed at its cuts; what trimming
//! exposes at a cut is an [`EndSurface`]. A connector is a tube between two end surfaces, which it takes over vertex
//! for vertex and triangle for triangle, so that blocks are later merged by identity and never by a distance.

mod alone;
mod cluster;
mod connector;
mod connector_surface;
mod dump;
mod end_surface;
mod error;
mod finished;
mod params;
mod path;
mod record;
mod rings;
mod shape;
mod wall;
mod weave;
mod woven;

pub(crate) use cluster::mesh_cluster_watched;
pub use cluster::{CapFaces, ClusterMesh, mesh_cluster};
pub use connector::{ConnectorMesh, DIVISIONS, mesh_connector, mesh_free_connector, shared_ends};
pub use connector_surface::ConnectorEnd;
pub use dump::{BlockDump, BlockInput};
pub use end_surface::{EndSurface, StoredEnd};
pub use error::{BlockError, ConnectorAttempt};
pub use finished::{About, Cured, Finished, FinishedJoint};
pub use params::{BlockParams, EndStyle};
pub use record::{Bytes, Record, Sizes, encode};

#[cfg(test)]
mod cluster_tests;
#[cfg(test)]
mod connector_tests;
#[cfg(test)]
mod fixtures;
#[cfg(test)]
mod joint_tests;

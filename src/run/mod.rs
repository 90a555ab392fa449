//! One run from a network as it was read to its mesh: cures, inlets, refinement, meshing with fallbacks, fidelity, flow.
//!
//! [`Run`] collects what is asked for, [`PreparedRun`] is the network ready to be meshed, [`NetworkMesh`] is what came of
//! it. The verbs `mesh` and `surface` do nothing to a network beside this.

mod builder;
mod defect;
mod error;
mod limits;
mod networks;
mod prepared;
mod result;
mod strategy;

pub use builder::Run;
pub use defect::Defect;
pub use error::MeshingError;
pub use limits::Limits;
#[cfg(feature = "cli")]
pub(crate) use networks::without_islands;
pub use networks::{Networks, RefinedAxis};
pub use prepared::PreparedRun;
pub use result::NetworkMesh;
pub use strategy::{Attempt, Fault, Strategy};

//! One run from a network as it was read to its mesh: cures, inlets, refinement, meshing with fallbacks, fidelity, flow.
//!
//! [`Run`] collects what is asked for, [`PreparedRun`] is the network ready to be meshed, [`NetworkMesh`] is what came of
//! it. The verbs `mesh` and `surface` do nothing to a network beside this.

mod builder;
mod error;
mod networks;
mod prepared;
mod result;
mod strategy;

pub use builder::Run;
pub use error::MeshingError;
pub use networks::Networks;
pub use prepared::PreparedRun;
pub use result::{Defect, NetworkMesh};
pub use strategy::{Attempt, Fault, Strategy};

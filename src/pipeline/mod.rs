//! Floor 6: the plan run over all blocks.

mod apart;
mod attempts;
mod block_budget;
mod blocks;
mod caps;
mod carried;
mod cures;
mod data;
mod describe;
mod effort;
mod error;
mod estimate;
mod flow_error;
mod flow_plan;
mod forecast;
mod in_memory;
mod inlets;
mod make;
mod once;
mod outlets;
mod plan;
mod report;
mod rounds;
mod routes;
mod run;
mod schedule;
mod seen;
mod share;
mod sizes;
#[cfg(feature = "woven")]
mod smoothed;
mod store;
mod terminals;
#[cfg(test)]
mod tests;
mod timing;
mod tips;
mod whole;

pub use caps::{CapRow, Caps, CapsError, Outlets};
pub use data::{Datum, VesselData};
pub use error::RunError;
pub use estimate::{Estimate, TooLarge};
pub use flow_error::FlowError;
pub use flow_plan::{FlowPlan, Inflow};
#[cfg(feature = "cli")]
pub(crate) use flow_plan::{FlowSolution, InletSite};
pub use forecast::Forecast;
pub(crate) use in_memory::mesh_in_memory;
pub use in_memory::mesh_network;
pub use inlets::{Inlet, InletReason, Inlets, NoTerminal};
pub use once::replay;
pub use outlets::{OutletKind, OutletPlan, OutletSplit, Reference};
pub use plan::{JointStyle, MeshPlan, PlanError};
#[cfg(feature = "cli")]
pub use report::named;
pub use report::{BlockCounts, FailedBlock, FilledLoops, FusedBlock, Meeting, MeshSize, Retry, RunReport, ThinBlock};
pub(crate) use run::mesh_shared;
pub use run::{Meshed, Stored, mesh_into};
pub use share::{ShareReport, make_share};
pub use store::{Difference, Manifest, NoShard, Role, Shard, Store, StoreError};
pub(crate) use store::{KeyMaker, fingerprint};
pub use terminals::NotATerminal;
pub use timing::Clock;
pub use timing::StageTime;
pub use whole::{LeftWhole, Whole};

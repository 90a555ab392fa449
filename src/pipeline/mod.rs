//! Floor 6: the plan run over all blocks.

mod apart;
mod attempts;
mod blocks;
#[cfg(feature = "cli")]
mod caps;
mod carried;
mod cures;
#[cfg(feature = "cli")]
mod data;
mod describe;
mod error;
mod estimate;
#[cfg(feature = "cli")]
mod forecast;
mod make;
mod once;
mod plan;
mod report;
mod rounds;
mod routes;
mod run;
mod schedule;
mod seen;
mod share;
mod sizes;
mod store;
mod terminals;
#[cfg(test)]
mod tests;
mod timing;
mod tips;
mod whole;

#[cfg(feature = "cli")]
pub use caps::{CapRow, Caps, Fluid, Outlets};
#[cfg(feature = "cli")]
pub use data::{Datum, VesselData};
pub use error::RunError;
pub use estimate::{Estimate, TooLarge};
#[cfg(feature = "cli")]
pub use forecast::Forecast;
#[cfg(feature = "cli")]
pub use once::replay;
pub use plan::{JointStyle, MeshPlan, PlanError};
pub use report::{BlockCounts, FailedBlock, FilledLoops, FusedBlock, Meeting, MeshSize, Retry, RunReport, ThinBlock};
#[cfg(feature = "cli")]
pub(crate) use run::mesh_shared;
pub use run::{Meshed, Stored, mesh_into, mesh_network};
#[cfg(feature = "cli")]
pub use share::{ShareReport, make_share};
pub use store::{Difference, Manifest, Shard, Store, StoreError};
#[cfg(feature = "cli")]
pub use store::{KeyMaker, NoShard, Role, fingerprint, two_numbers};
pub use terminals::NotATerminal;
#[cfg(feature = "cli")]
pub use timing::Clock;
pub use timing::StageTime;
#[cfg(feature = "cli")]
pub use whole::LeftWhole;
pub use whole::Whole;

//! Floor 6: the plan run over all blocks.

mod apart;
mod attempts;
mod block_budget;
mod blocks;
mod carried;
mod cures;
mod describe;
mod effort;
mod error;
mod estimate;
mod forecast;
mod in_memory;
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
#[cfg(feature = "woven")]
mod smoothed;
mod store;
#[cfg(test)]
mod tests;
mod timing;
mod tips;
mod whole;

pub use error::RunError;
pub use estimate::{Estimate, TooLarge};
pub use forecast::Forecast;
pub(crate) use in_memory::mesh_in_memory;
pub use in_memory::mesh_network;
pub use once::replay;
pub use plan::{JointStyle, MeshPlan, PlanError};
#[cfg(feature = "cli")]
pub use report::named;
pub use report::{BlockCounts, FailedBlock, FilledLoops, FusedBlock, Meeting, MeshSize, Retry, RunReport, ThinBlock};
pub(crate) use run::mesh_shared;
pub use run::{Meshed, mesh_into};
pub use share::{ShareReport, make_share};
pub use store::{Difference, Manifest, NoShard, Role, Shard, Store, StoreError};
pub(crate) use store::{KeyMaker, fingerprint};
pub use timing::Clock;
pub use timing::StageTime;
pub use whole::{LeftWhole, Whole};

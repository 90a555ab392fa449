//! Floor 5: the plan run over all blocks.

mod apart;
mod assemble;
mod attempts;
mod blocks;
mod cures;
mod describe;
mod estimate;
mod make;
mod observer;
mod plan;
mod report;
mod rounds;
mod routes;
mod run;
mod schedule;
pub mod store;
mod terminals;
#[cfg(test)]
mod tests;
mod timing;
mod whole;

pub use estimate::{Estimate, TooLarge};
pub use observer::{Observer, Silent, Stage};
pub use plan::{JointStyle, MeshPlan, PlanError};
pub use report::{BlockCounts, FailedBlock, FusedBlock, Meeting, MeshSize, Retry, RunReport};
pub use run::{Meshed, RunError, Stored, mesh_into, mesh_network};
pub use terminals::{NotATerminal, TerminalPatches, assign as assign_patches};
pub use timing::{BlockTimes, Clock, StageTime};
pub use whole::Whole;

//! Floor 5: the plan run over all blocks.

mod assemble;
mod attempts;
mod observer;
mod plan;
mod report;
mod rounds;
mod run;
mod terminals;
#[cfg(test)]
mod tests;
mod timing;

pub use assemble::AssembleError;
pub use observer::{Observer, Silent, Stage};
pub use plan::{JointStyle, MeshPlan, PlanError};
pub use report::{BlockCounts, FailedBlock, FusedBlock, Meeting, MeshSize, Retry, RunReport, StageTime};
pub use run::{Meshed, RunError, mesh_network};
pub use terminals::{NotATerminal, TerminalPatches, assign as assign_patches};
pub use timing::Clock;

//! Floor 5: the plan run over all blocks.

mod observer;
mod plan;
mod terminals;

pub use observer::{Observer, Silent, Stage};
pub use plan::{MeshPlan, PlanError};
pub use terminals::{NotATerminal, TerminalPatches, assign as assign_patches};

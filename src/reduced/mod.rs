//! Reduced-order flow: one-dimensional solutions, zero- and one-dimensional models, and results of solvers along vessels.

mod along;
mod build;
mod vessels;

pub use along::{Along, BranchFlow, ResultFluid};
pub use build::{ModelOptions, Supply, reduced_model};
pub use vessels::{VesselFlow, VesselRow};

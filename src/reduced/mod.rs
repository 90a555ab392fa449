//! Reduced-order flow: one-dimensional solutions, zero- and one-dimensional models, and results of solvers along vessels.

mod build;
mod vessels;

pub use build::{ModelOptions, Supply, reduced_model};
pub use vessels::{VesselFlow, VesselRow};

//! Regions around a lumen: shells (vessel wall, perivascular space) and tissue, as one conforming mesh.
//!
//! The lumen's wall is the inner side of the first shell, with the same vertices and triangles. The outermost shell is the
//! inner boundary of the tissue.

mod assemble;
mod build;
mod error;
mod organ;
mod plan;
mod surface;
#[cfg(test)]
mod tests;
mod unfold;
mod without;

pub use build::{Domain, ShellsReport};
pub use error::DomainError;
pub use plan::{DomainPlan, DomainPlanError, ShellPlan, Thickness, TissuePlan, TissueShape};

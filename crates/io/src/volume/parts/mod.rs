//! Partition of a mesh into parts for parallel solvers.
//!
//! Cells are the tetrahedra, or the prisms, pyramids and tetrahedra of a mesh with layers. [`Partition`] gives each cell its
//! part, [`Shared`] finds the points and ghost cells between parts, and [`PartReader`] reads one part at a time.

mod bisect;
mod content;
mod error;
mod partition;
mod shared;
#[cfg(test)]
mod tests;
mod tree;

pub(super) use content::PartReader;
pub use error::PartsError;
pub(super) use partition::{Lookup, Partition};
pub(super) use shared::Ghost;
pub(super) use tree::BlockGraph;

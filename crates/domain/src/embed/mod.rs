//! Vessels as lines in tissue, for coupled models of flow in one and three dimensions.
//!
//! The tissue is filled with tetrahedra that are small at the vessels. Each vessel is divided into pieces, one for each
//! tetrahedron that it passes through.

mod build;
mod clip;
mod error;
mod inside;
mod organ;
mod pieces;
mod plan;
mod sources;
#[cfg(test)]
mod tests;

pub use build::Embedding;
pub use error::{PieceFault, PiecesError};
pub use pieces::{Piece, Pieces};
pub use plan::EmbedPlan;

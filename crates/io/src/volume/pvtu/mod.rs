//! Meshes in pieces (`.pvtu`): an index, and beside it a folder of VTU files, each some blocks that hang together, so that
//! programs load what they need, and in parallel.
//!
//! Points that several pieces share are in each of them; the point array `GlobalPointIds` (`Int64`) says which is which.
//! Cells have the arrays of a VTU, and the first piece has its field data.

mod error;
mod folder;
mod order;
mod plan;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub use error::PvtuFault;
pub(super) use folder::PieceFolder;
pub(super) use read::read;
pub(super) use write::{Pieces, write};

//! Meshes in pieces (`.pvtu`): an index and a folder of VTU files. Each file holds connected blocks, so that programs
//! can load parts, also in parallel.
//!
//! Shared points are in each of their pieces, identified by the point array `GlobalPointIds` (`Int64`). Cells have the
//! arrays of a VTU file, and the first piece has its field data.

mod error;
mod folder;
mod mixed;
mod order;
mod parts;
#[cfg(test)]
mod parts_tests;
mod plan;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub use error::PvtuFault;
pub(super) use folder::PieceFolder;
pub(super) use mixed::stage_mixed;
pub(super) use parts::stage_parts;
pub(super) use read::read;
pub(super) use write::{Pieces, stage};

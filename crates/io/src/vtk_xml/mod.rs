//! VTK XML files (VTP, VTU, PVTU): the element tree with its arrays, and blockwise reading and writing of compressed
//! arrays. For arbitrary input bytes, this module never panics, and its allocations are bounded by a multiple of the
//! file size.

mod array;
mod blocks;
mod decode;
mod document;
mod error;
mod packed;
#[cfg(test)]
mod tests;

pub(super) use array::{DataArray, Values};
pub(super) use blocks::{Blocks, Packing, write_blocks, write_spaces};
pub(super) use document::{ElementId, VtkXml};
pub use error::VtkError;
pub(super) use packed::{BlockFile, PackedArray};

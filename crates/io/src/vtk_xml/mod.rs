//! VTK's XML files (VTP, VTU, PVTU): the tree of elements and the arrays in it, and arrays that are written and read
//! a compressed block at a time. Nothing here panics or allocates more than a multiple of the file's size, whatever the
//! bytes are.

mod array;
mod blocks;
mod decode;
mod document;
mod error;
mod packed;
#[cfg(test)]
mod tests;

pub(super) use array::Values;
pub(super) use blocks::{Blocks, Packing, write_blocks, write_spaces};
pub(super) use document::{ElementId, VtkXml};
pub use error::VtkError;
pub(super) use packed::{BlockFile, PackedArray};

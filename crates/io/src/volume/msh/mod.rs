//! Gmsh's MSH 4.1, binary: one volume, one surface per patch, physical groups of the patches' names; and 2.2, text.
//!
//! Node and element tags count from 1 in the order of the mesh (tetrahedra first), so that reading restores the order.
//! Values beside the mesh become data of nodes and elements; tags then follow the file.
//! What a later check needs to know has no place in the format; it goes into a section of our own, which Gmsh and
//! others pass over.

mod cursor;
mod error;
mod names;
mod read;
mod surfaces;
mod tags;
#[cfg(test)]
mod tests;
mod values;
mod write;
mod write_2;

pub use error::MshFault;
pub(super) use read::read;
pub(super) use write::write;
pub(super) use write_2::write as write_2;

//! Gmsh formats MSH 4.1 (binary) with one volume, one surface and physical group per patch, and MSH 2.2 (text).
//!
//! Second-order elements have types 11 and 9. Gmsh swaps the last two nodes of VTK's ten-node tetrahedron. Midpoints are nodes of the
//! volume, also on the boundary.
//!
//! Node and element tags count from 1 in the order of the mesh (tetrahedra first), so that reading restores the order.
//! Additional values become node and element data; tags are then in file order. Data for later checks are in a custom
//! section, which Gmsh and other programs ignore.

mod cursor;
mod elements;
mod error;
mod mixed;
mod names;
mod parts;
#[cfg(test)]
mod parts_tests;
mod read;
mod surfaces;
mod tags;
#[cfg(test)]
mod tests;
mod values;
mod write;
mod write_2;

pub use error::MshFault;
pub(super) use mixed::write_mixed;
pub(super) use parts::write_parts;
pub(super) use read::read;
pub(super) use write::write;
pub(super) use write_2::{write as write_2, write_mixed as write_mixed_2};

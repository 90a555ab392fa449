//! PLY: elements with properties in any order; the vertices' `x`, `y`, `z` and the faces' `vertex_indices` are taken,
//! all others passed over.

mod data;
mod head;
mod read;
mod write;

pub(super) use read::read;
pub(super) use write::{write, write_boundary};

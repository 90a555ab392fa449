//! PLY format. The vertex properties `x`, `y`, `z` and the face property `vertex_indices` are read, in any order;
//! others are skipped.

mod data;
mod head;
mod read;
mod write;

pub(super) use read::read;
pub(super) use write::{write, write_boundary};

//! SWC format: one node per row (id, type, x, y, z, radius, parent).

mod error;
mod read;
mod write;

pub use error::SwcError;
pub(super) use read::read;
pub(super) use write::{parents, write};

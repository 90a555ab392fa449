//! Input of SimVascular's one-dimensional solver: nodes, segments with end areas, and joints between segments.

mod read;
mod write;

pub use read::Sv1dError;
pub(super) use read::read;
pub(super) use write::{check, write};

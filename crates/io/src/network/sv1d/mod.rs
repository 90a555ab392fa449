//! The input of SimVascular's one-dimensional solver: nodes, segments with an area at either end, joints between segments.

mod read;

pub use read::Sv1dError;
pub(super) use read::read;

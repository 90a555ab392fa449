//! Pajek's `.net`: vertices with coordinates and parameters, arcs and edges with theirs.

mod read;

pub use read::PajekError;
pub(super) use read::read;

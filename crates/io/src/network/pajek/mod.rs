//! Pajek format `.net`: vertices with coordinates and parameters, and arcs and edges with theirs.

mod read;

pub use read::PajekError;
pub(super) use read::read;

//! JSON as NetworkX writes it (node-link): a list of nodes with positions, a list of edges that name them.

mod read;

pub use read::JsonError;
pub(super) use read::read;

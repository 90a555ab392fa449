//! JSON in NetworkX's node-link format: a list of nodes with positions, and a list of edges between them. A model of
//! `svZeroDSolver` is recognised by its contents.

mod read;

pub use read::JsonError;
pub(super) use read::read;

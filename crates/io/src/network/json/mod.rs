//! JSON in NetworkX's node-link format: a list of nodes with positions, and a list of edges between them. A model of
//! `svZeroDSolver` and a mesh of `Flows1D0D3D` are recognised by their contents.

mod read;
mod vessels;

pub use read::JsonError;
pub(super) use read::read;
pub use vessels::VesselListError;

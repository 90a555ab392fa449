//! Format of `VessMorphoVis`: numbered vertices, and strands of vertices.

mod read;

pub use read::VmvError;
pub(super) use read::read;

//! VTP and VTU formats: VTK poly data or an unstructured grid with vessels as lines.

mod error;
mod read;
mod write;

pub use error::VtpError;
pub(super) use read::{read, read_grid};
pub(super) use write::bytes_of;

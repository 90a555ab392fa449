//! VTP format: VTK poly data with vessels as lines.

mod error;
mod read;
mod write;

pub use error::VtpError;
pub(super) use read::read;
pub(super) use write::bytes_of;

//! VTP: VTK poly data whose lines are vessels.

mod error;
mod read;
mod write;

pub use error::VtpError;
pub(super) use read::read;
pub(super) use write::bytes_of;

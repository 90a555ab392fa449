//! File access for all formats: errors, and atomic writing.

mod asked;
mod atomic;
mod error;
mod folder;
mod hidden;
mod set;
mod staged;
mod whole;

pub(super) use asked::Asked;
pub use atomic::AtomicFile;
pub use error::{FileError, OutputError};
pub(super) use folder::AtomicFolder;
pub(super) use hidden::{is_hidden_name, locked, make_hidden, remove_left};
pub use set::OutputSet;
pub(super) use staged::{Contents, Staged};
pub(super) use whole::{
    Writing, by_extension, ensure_sound, extension, read_bytes, stage_all, stage_whole, write_whole,
};
pub use whole::{ensure_text_writable, write_bytes, write_text};

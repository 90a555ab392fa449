//! File access for all formats: errors, and atomic writing.

mod asked;
mod atomic;
mod error;
mod folder;
mod whole;

pub(super) use asked::Asked;
pub use atomic::AtomicFile;
pub(super) use atomic::{is_hidden_name, locked, make_hidden, remove_left};
pub use error::FileError;
pub(super) use folder::AtomicFolder;
pub(super) use whole::{Writing, by_extension, ensure_sound, extension, read_bytes, write_all_whole, write_whole};
pub use whole::{bytes_to_commit, ensure_text_writable, write_bytes, write_text};

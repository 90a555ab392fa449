//! Between a path and its bytes, whatever the format: what can go wrong, and files that appear whole or not at all.

mod asked;
mod atomic;
mod error;
mod folder;
mod whole;

pub(super) use asked::Asked;
pub(super) use atomic::{AtomicFile, is_hidden_name, locked, make_hidden, remove_left};
pub use error::FileError;
pub(super) use folder::AtomicFolder;
pub(super) use whole::{Writing, by_extension, ensure_sound, extension, read_bytes, write_all_whole, write_whole};
pub use whole::{ensure_text_writable, write_bytes, write_text};

//! Networks as arrays in a folder `.npyd`.

mod read;
#[cfg(test)]
mod tests;
mod write;

pub use read::NpyNetworkError;
pub(super) use read::{ARRAYS, read};
pub(super) use write::ensure_writable;
pub(super) use write::stage;

//! `NumPy` arrays: a folder `.npyd` with one memory-mappable `.npy` file per array. The array names tell meshes,
//! networks and triangle complexes apart, each with its own reader.

mod array;
mod error;
mod folder;
mod header;
#[cfg(test)]
mod tests;
mod write;

pub use error::{NpyError, NpyFault};
pub(super) use folder::{Arrays, ensure_rows};
pub use folder::{holds, is_folder};
pub(super) use write::{Item, head, write_array};

//! `NumPy`'s arrays: a folder `.npyd` with a `.npy` file for each, which programs map into memory as they are. What the arrays are
//! called says what the folder holds: a mesh, a network or a complex of triangles; each family has a reader of its own.

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

//! Meshes as arrays in a folder `.npyd`: `points` (n, 3), `tets` (m, 4) and `tet_blocks` (m), `triangles` (k, 3) of the boundary
//! with `triangle_patches` (k) and `triangle_blocks` (k), and `mesh.json` with what is no array: the names of patches, caps, notes.

mod names;
mod notes;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub(super) use read::read;
pub use read::read_mesh_arrays;
pub(super) use write::{ensure_writable, write};

//! Meshes as arrays in a folder `.npyd`: `points` (n, 3), `tets` (m, 4), `tet_blocks` (m), boundary `triangles` (k, 3),
//! `triangle_patches` (k) and `triangle_blocks` (k). `mesh.json` contains patch names, caps and notes.

mod names;
mod notes;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub(super) use read::read;
pub use read::read_mesh_arrays;
pub(super) use write::{ensure_writable, stage};

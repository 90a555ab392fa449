//! Meshes as arrays in a folder `.npyd`: `points` (n, 3), `tets` (m, 4) and `tet_blocks` (m), `triangles` (k, 3) of the boundary
//! with `triangle_patches` (k) and `triangle_blocks` (k), and `mesh.json` with what is no array: the names of patches, caps, notes.

mod notes;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub(super) use read::read;
pub use read::read_mesh_arrays;
pub(super) use write::{ensure_writable, write};

/// Names of the arrays, shared by writer and reader.
mod array {
    pub const POINTS: &str = "points";
    pub const TETS: &str = "tets";
    pub const TET_BLOCKS: &str = "tet_blocks";
    pub const TRIANGLES: &str = "triangles";
    pub const TRIANGLE_PATCHES: &str = "triangle_patches";
    pub const TRIANGLE_BLOCKS: &str = "triangle_blocks";
    pub const ALL: [&str; 6] = [POINTS, TETS, TET_BLOCKS, TRIANGLES, TRIANGLE_PATCHES, TRIANGLE_BLOCKS];
}

/// The file with what is no array.
const NOTES: &str = "mesh.json";

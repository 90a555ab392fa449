//! Names shared by writer and reader.

pub(super) const POINTS: &str = "points";
pub(super) const TETS: &str = "tets";
pub(super) const TET_BLOCKS: &str = "tet_blocks";
pub(super) const TRIANGLES: &str = "triangles";
pub(super) const TRIANGLE_PATCHES: &str = "triangle_patches";
pub(super) const TRIANGLE_BLOCKS: &str = "triangle_blocks";
/// Layer of each tetrahedron, in meshes with layers.
pub(super) const TET_LAYER: &str = "tet_layer";

/// Arrays of every mesh.
pub(super) const ARRAYS: [&str; 6] = [POINTS, TETS, TET_BLOCKS, TRIANGLES, TRIANGLE_PATCHES, TRIANGLE_BLOCKS];

/// File with the data besides arrays.
pub(super) const NOTES: &str = "mesh.json";

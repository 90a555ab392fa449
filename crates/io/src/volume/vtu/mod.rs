//! VTK unstructured grids (`.vtu`): labelled tetrahedral meshes with raw or zlib-compressed appended data. Boundaries
//! alone are poly data (`.vtp`).
//!
//! Tetrahedra precede the boundary triangles. The `Int32` cell arrays `patch` and `block` hold the labels (the patch of
//! a tetrahedron is 0). In a mesh with regions, `region` holds the same as `block`, and `region_ids` and `region_names` the
//! regions. A mesh with layers has `layer`: 1 at the wall, 0 outside of layers. Field data contain the patch names (`patch_names`, indexed by id) and the data for later
//! checks: caps, loops of each component, terminals.

pub(super) mod arrays;
mod error;
mod fields;
pub(super) mod file;
mod layout;
mod mixed;
mod names;
mod pieces;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub(super) use arrays::PieceArrays;
pub use error::VtuFault;
pub use layout::VtuPiecesError;
pub(super) use mixed::{MixedGrid, write_mixed};
pub(super) use names::{CELL_IDS, ELEMENT_ID, GHOSTS, GLOBAL_IDS, LAYER, NODE_ID, REGION};
pub use pieces::VtuPieces;
pub(super) use read::{GridReader, read};
pub use write::write_boundary;
pub(super) use write::{Grid, Recounted, SolverIds, write};

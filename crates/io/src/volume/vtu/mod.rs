//! VTK unstructured grids (`.vtu`): a labelled tetrahedral mesh, in appended data compressed with zlib or as they are; and
//! its boundary alone as poly data (`.vtp`).
//!
//! Tetrahedra come first, then the boundary triangles; the `Int32` cell arrays `patch` and `block` say where each
//! belongs (a tetrahedron's patch is 0). Field data name the patches (`patch_names`, indexed by the id) and hold what a
//! later check needs to know: the caps, the loops of each component, the terminals.

pub(super) mod arrays;
mod error;
mod fields;
pub(super) mod file;
mod layout;
mod names;
mod pieces;
mod read;
#[cfg(test)]
mod tests;
mod write;

pub use error::VtuFault;
pub use layout::VtuPiecesError;
pub(super) use names::GLOBAL_IDS;
pub use pieces::VtuPieces;
pub(super) use read::{GridReader, read};
pub use write::write_boundary;
pub(super) use write::{Grid, Recounted, write};

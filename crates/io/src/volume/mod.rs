//! Tetrahedral volume mesh files: one module per format, and format detection by extension.
//!
//! Each format has its errors in `error`, and `read` and `write` on bytes and streams, independent of other formats.

mod content;
mod error;
#[doc(hidden)]
pub mod fixtures;
mod format;
#[cfg(test)]
mod in_pieces;
mod layers;
mod medit;
mod msh;
mod npy;
mod openfoam;
mod options;
mod parts;
mod pvtu;
mod read;
mod regions;
mod second;
#[cfg(test)]
mod second_tests;
mod simvascular;
#[cfg(test)]
mod tests;
mod vtu;
mod write;

pub use content::{MeshFile, MeshNotes};
pub use error::MeshFileError;

/// Contents of [`MeshFileError`]: the faults of each format.
pub mod faults {
    pub use super::content::SecondOrderFault;
    pub use super::error::MeshFault;
    pub use super::medit::MeditFault;
    pub use super::msh::MshFault;
    pub use super::pvtu::PvtuFault;
    pub use super::vtu::VtuFault;
}

pub use format::MeshFormat;
pub use npy::read_mesh_arrays;
pub use options::GridOptions;
pub use options::WriteOptions;
pub use parts::PartsError;
pub use read::{read_mesh, read_mesh_from};
pub use regions::{region_paths, stage_regions, write_regions};
pub use vtu::write_boundary as write_poly_data;
pub use vtu::{VtuPieces, VtuPiecesError};
pub use write::{ensure_writable, write_mesh, write_mesh_to};
pub use write::{ensure_writable_as, stage_mesh, write_mesh_with};

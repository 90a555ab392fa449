//! Triangle surface files: one module per format, and format detection by extension.

mod boundary;
mod content;
mod error;
mod faces;
mod format;
mod glb;
mod groups;
mod npy;
mod obj;
mod off;
mod ply;
mod read;
mod stl;
#[cfg(test)]
mod tests;
mod three_mf;
mod vtp;
mod write;

pub use boundary::{ensure_boundary_writable, write_boundary, write_boundary_watched};
pub use content::{SurfaceContent, SurfaceNote};
pub use error::{SurfaceFault, SurfaceFileError};
pub use format::SurfaceFormat;
pub use npy::{ArrayComplex, ArrayRegion, read_complex, read_complex_arrays};
pub use read::{read_content_as, read_content_from, read_surface, read_surface_from};
pub use write::write_surface;

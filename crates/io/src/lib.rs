//! Floor 3: readers and writers.
//!
//! Three families of files, each with a folder per format: `volume` (tetrahedral meshes), `network` and `surface`. `tetgen`
//! stands apart because its files are more than one of these. What formats share: `file` (paths, whole files), `text` (words
//! and numbers with their lines), `vtk_xml`, `npy` (arrays of `NumPy`), `patches` (names).
//!
//! A new format of a family takes
//! 1. a folder with `error` (an enum of what can be wrong with such a file), `read` and `write`: from bytes or a path to the
//!    family's `content` and from there to a stream. It knows neither the other formats nor what paths there are;
//! 2. a variant of the enum in the family's `format`, with its extensions, and one of the enum of faults in its `error`;
//! 3. an arm in the family's `read` and in its `write`, which the compiler then asks for.
//!
//! A volume mesh is written from passes over a [`MeshSource`](anastomesh_mesh::source::MeshSource), so that memory does not grow
//! with it; where a format needs the whole, `volume::write` gathers it.

#[cfg(test)]
mod damage;
mod file;
pub mod network;
pub mod npy;
mod patches;
pub mod surface;
#[doc(hidden)]
pub mod tetgen;
mod text;
pub mod volume;
mod vtk_xml;

/// Faults that several formats share: paths, words and numbers, VTK's XML.
pub mod faults {
    pub use crate::file::FileError;
    pub use crate::text::{Place, TextFault};
    pub use crate::vtk_xml::VtkError;
}

pub use anastomesh_mesh::boundary::{BoundaryPart, BoundarySurface};
pub use file::{ensure_text_writable, write_bytes, write_text};
pub use network::{NetworkArray, NetworkFile, NetworkFileError, NetworkOptions, read_network, write_network};
pub use surface::{SurfaceFileError, read_surface, write_boundary, write_surface};
pub use volume::{MeshFile, MeshFileError, MeshNotes, read_mesh, write_mesh};

//! Readers and writers of vascular networks, triangle surfaces and tetrahedral meshes.
//!
//! ```
//! use anastomesh_io::{read_surface, write_surface};
//! use anastomesh_mesh::shapes::sphere_surface;
//!
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("sphere.ply");
//! write_surface(&path, &sphere_surface(2))?;
//! assert_eq!(read_surface(&path)?, sphere_surface(2));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | module | contents | formats, by the extension of the file |
//! |---|---|---|
//! | [`network`] | skeletons of vascular networks | `vtp`, `vtk`, `vtu`, `swc`, `csv`, `tsv`, `graphml`, `gxl`, `xml`, `net`, `pajek`, `json`, `vmv`, `am`, `in`, `edge`, `npyd` |
//! | [`surface`] | triangle surfaces, and boundaries of meshes | `off`, `ply`, `stl`, `obj`; boundaries also `vtp`, `glb`, `3mf` |
//! | [`volume`] | tetrahedral meshes with labelled boundaries, and cases for solvers | `vtu`, `pvtu`, `msh`, `msh2`, `mesh`, `ele`, `foam`, `svmesh`, `npyd` |
//! | [`flow`] | flow rates and outlet models of solver cases | |
//! | [`results`] | results of flow solvers | `foam`, `vtu` |
//! | [`npy`] | arrays of `NumPy`, which all three families have | |
//! | [`faults`] | faults that formats share | |
//!
//! Some formats are only read, or only written.
//!
//! # Features
//!
//! None.
//!
//! # A new format
//!
//! Each family has a folder for each format. Formats share `file` (paths, whole files), `text` (words and numbers with their
//! lines), `vtk_xml`, `npy`, and `patches` (names). A new format needs
//! 1. a folder with `error` (an enum of the faults of such a file), `read` and `write`. They convert bytes or a path to
//!    the family's `content`, and the content to a stream. They depend neither on other formats nor on the list of paths;
//! 2. a variant of the enum in the family's `format`, with its extensions, and one of the enum of faults in its `error`;
//! 3. an arm in the family's `read` and in its `write`, which the compiler then asks for.
//!
//! A volume mesh is written in passes over a [`MeshSource`](anastomesh_mesh::source::MeshSource), so that memory does not
//! grow with the mesh. `volume::write` gathers the whole mesh for formats that need it.

#[cfg(test)]
mod damage;
mod file;
pub mod flow;
pub mod network;
pub mod npy;
mod patches;
pub mod results;
mod scalar;
pub mod surface;
#[doc(hidden)]
pub mod tetgen;
mod text;
pub mod volume;
mod vtk_xml;
mod xml;

/// Faults that several formats share: paths, words and numbers, VTK's XML.
pub mod faults {
    pub use crate::file::FileError;
    pub use crate::text::{Place, TextFault};
    pub use crate::vtk_xml::VtkError;
    pub use crate::xml::XmlFault;
}

pub use anastomesh_mesh::boundary::{BoundaryPart, BoundarySurface};
pub use file::{AtomicFile, OutputError, OutputSet, ensure_text_writable, write_bytes, write_text};
pub use network::{NetworkArray, NetworkFile, NetworkFileError, NetworkOptions, read_network, write_network};
pub use surface::{SurfaceFileError, read_surface, write_boundary, write_surface};
pub use volume::{MeshFile, MeshFileError, MeshNotes, read_mesh, write_mesh};

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

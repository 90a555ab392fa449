//! Floor 3: readers and writers, one file per format.

mod atomic;
pub mod mesh_file;
pub mod msh;
mod msh_read;
pub mod network;
pub mod vtk_xml;
pub mod vtu;
mod vtu_read;

//! Text formats of `TetGen` (manual of version 1.5, section 5).
//!
//! - points: `.node`
//! - piecewise linear complexes: `.poly`, `.smesh`
//! - file families of tetrahedral meshes: `.node`, `.ele`, `.face`, `.edge`, `.neigh`

mod error;
mod family;
mod mesh;
mod nodes;
mod plc;
mod plc_read;
#[cfg(test)]
mod tests;

pub use error::TetgenFault;
pub use error::TetgenFileError;
pub use family::{Extent, MeshFamily};
pub use mesh::read_mesh;
pub use mesh::read_mesh_from;
pub use nodes::{Nodes, read_nodes, read_nodes_as};
pub use plc::{Facet, Plc, PlcFormat, Region};
pub use plc_read::{read_plc, read_plc_as};

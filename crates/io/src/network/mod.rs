//! Network files: one module per format, and format detection by extension.

mod amira;
mod columns;
mod content;
mod csv;
mod error;
mod format;
mod graph;
#[cfg(test)]
mod graph_tests;
mod graph_xml;
mod hdf5;
mod json;
mod npy;
mod pajek;
mod polylines;
mod radii;
mod read;
mod reduced;
mod scale;
mod sv1d;
mod svzerod;
mod swc;
#[cfg(test)]
mod tests;
mod tetgen;
mod vmv;
mod vtk;
mod vtp;
mod write;

pub use content::{NetworkArray, NetworkFile, NetworkNote, NetworkOptions, NodeNames, refinement_arrays};
pub use error::NetworkFileError;

/// Contents of [`NetworkFileError`]: the faults of each format.
pub mod faults {
    pub use super::amira::AmiraError;
    pub use super::csv::{CsvError, Table};
    pub use super::error::NetworkFault;
    pub use super::graph::{GraphFault, GraphPlace};
    pub use super::graph_xml::GraphXmlError;
    pub use super::hdf5::Hdf5Error;
    pub use super::json::{JsonError, VesselListError};
    pub use super::npy::NpyNetworkError;
    pub use super::pajek::PajekError;
    pub use super::radii::{NodeArrayFault, RadiusFault};
    pub use super::sv1d::Sv1dError;
    pub use super::svzerod::SvZeroDError;
    pub use super::swc::SwcError;
    pub use super::tetgen::EdgeFileError;
    pub use super::vmv::VmvError;
    pub use super::vtk::VtkLegacyError;
    pub use super::vtp::VtpError;
}

pub use format::NetworkFormat;
pub use read::{read_network, read_network_arrays, read_network_from};
pub use reduced::{ModelEnd, ReducedFault, ReducedModel, ReducedVessel, Stiffness};
pub use write::{ensure_network_writable, ensure_tree_writable, stage_network};
pub use write::{ensure_reduced_writable, write_network, write_reduced, write_tree};

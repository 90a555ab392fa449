//! Errors of reading and writing networks.

use super::amira::AmiraError;
use super::csv::CsvError;
use super::graph::GraphFault;
use super::graph_xml::GraphXmlError;
use super::hdf5::Hdf5Error;
use super::json::JsonError;
use super::npy::NpyNetworkError;
use super::pajek::PajekError;
use super::radii::RadiusFault;
use super::reduced::ReducedFault;
use super::sv1d::Sv1dError;
use super::swc::SwcError;
use super::tetgen::EdgeFileError;
use super::vmv::VmvError;
use super::vtk::VtkLegacyError;
use super::vtp::VtpError;
use crate::file::FileError;
use anastomesh_skeleton::{NodeId, SkeletonError};
use std::path::PathBuf;

/// Known extensions, for messages.
pub(super) const KNOWN: &str =
    ".swc, .vtp, .vtk, .vtu, .am, .csv, .graphml, .gxl, .net, .pajek, .json, .vmv, .h5, .npyd, .in, .node with .edge";

/// Errors of reading and writing a network file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NetworkFileError {
    /// The extension is unknown, or the file cannot be read, is empty or is not a network.
    #[error(transparent)]
    File(#[from] FileError<NetworkFault>),
    /// The path is a directory.
    #[error("{}: is a directory; name a network file ({KNOWN})", path.display())]
    Directory {
        /// Path of the directory.
        path: PathBuf,
    },
    /// The format cannot be written.
    #[error("{}: networks are written as .vtp or .npyd; name a file with one of these extensions", path.display())]
    NotWritten {
        /// Path of the file.
        path: PathBuf,
    },
    /// The format has no reduced-order models.
    #[error("{}: models are written as .json (svZeroDSolver) or .in (svOneDSolver); name a file with one of these extensions", path.display())]
    NotAModel {
        /// Path of the file.
        path: PathBuf,
    },
    /// The solver does not take the model.
    #[error("{}: {fault}", path.display())]
    Model {
        /// Path of the file.
        path: PathBuf,
        /// Reason.
        fault: ReducedFault,
    },
    /// SWC files can contain trees only.
    #[error("{}: several vessels lead to node {}, but .swc can only contain trees; name a .vtp file", path.display(), node.0)]
    NotATree {
        /// Path of the file.
        path: PathBuf,
        /// Node with several incoming edges, numbered from 0.
        node: NodeId,
    },
    /// The operating system reported a write error.
    #[error("{}: cannot be written: {source}; name a file in an existing, writable folder", path.display())]
    Write {
        /// Path of the file.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
}

impl NetworkFileError {
    /// Names of the arrays of a file in which none has the name of a radius. [`radius_array`] selects one of them, and
    /// [`radius`] replaces them.
    ///
    /// [`radius_array`]: super::NetworkOptions::radius_array
    /// [`radius`]: super::NetworkOptions::radius
    pub fn arrays_without_radii(&self) -> Option<&[String]> {
        let Self::File(FileError::Content { fault, .. }) = self else { return None };
        let (NetworkFault::Vtp(VtpError::Radius(radius))
        | NetworkFault::Vtk(VtkLegacyError::Radius(radius))
        | NetworkFault::Amira(AmiraError::Radius(radius))
        | NetworkFault::Npy(NpyNetworkError::Radius(radius))
        | NetworkFault::GraphXml(GraphXmlError::Graph(GraphFault::Radius(radius)))
        | NetworkFault::Pajek(PajekError::Graph(GraphFault::Radius(radius)))
        | NetworkFault::Json(JsonError::Graph(GraphFault::Radius(radius)))
        | NetworkFault::Hdf5(Hdf5Error::Radius(radius))
        | NetworkFault::Vmv(VmvError::Graph(GraphFault::Radius(radius)))
        | NetworkFault::TetgenEdges(EdgeFileError::Radius(radius))
        | NetworkFault::Csv(CsvError::Graph(GraphFault::Radius(radius)))) = fault
        else {
            return None;
        };
        match radius {
            RadiusFault::NoRadius { available } => Some(available),
            RadiusFault::UnknownArray { .. } => None,
        }
    }
}

/// Errors of the contents of a network file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NetworkFault {
    /// The SWC file is invalid.
    #[error(transparent)]
    Swc(#[from] SwcError),
    /// The VTP file is invalid.
    #[error(transparent)]
    Vtp(#[from] VtpError),
    /// The legacy VTK file is invalid.
    #[error(transparent)]
    Vtk(#[from] VtkLegacyError),
    /// The Amira spatial graph is invalid.
    #[error(transparent)]
    Amira(#[from] AmiraError),
    /// The tables are invalid.
    #[error(transparent)]
    Csv(#[from] CsvError),
    /// The GraphML or GXL file is invalid.
    #[error(transparent)]
    GraphXml(#[from] GraphXmlError),
    /// The Pajek file is invalid.
    #[error(transparent)]
    Pajek(#[from] PajekError),
    /// The node-link data are invalid.
    #[error(transparent)]
    Json(#[from] JsonError),
    /// The array folder is invalid.
    #[error(transparent)]
    Npy(#[from] NpyNetworkError),
    /// The format consists of several files.
    #[error("a network of this format is a folder: name its path")]
    SeveralFiles,
    /// The input of the one-dimensional solver is invalid.
    #[error(transparent)]
    Sv1d(#[from] Sv1dError),
    /// The VMV file is invalid.
    #[error(transparent)]
    Vmv(#[from] VmvError),
    /// The HDF5 file is invalid.
    #[error(transparent)]
    Hdf5(#[from] Hdf5Error),
    /// TetGen's files are invalid.
    #[error(transparent)]
    TetgenEdges(#[from] EdgeFileError),
    /// The format has no named node arrays.
    #[error(
        "this format has no named node arrays, so '{wanted}' does not exist: write the network as .vtp, .vtk, .csv, \
         .graphml or .json"
    )]
    NoNodeArrays {
        /// Requested name.
        wanted: String,
    },
    /// A number is unusable.
    #[error("{0}; correct the file, or let `anastomesh prepare` fill invalid radii")]
    Numbers(#[from] SkeletonError),
}

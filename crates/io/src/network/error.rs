//! Why a network could not be read or written.

use super::amira::AmiraError;
use super::csv::CsvError;
use super::graph::GraphFault;
use super::graph_xml::GraphXmlError;
use super::json::JsonError;
use super::npy::NpyNetworkError;
use super::pajek::PajekError;
use super::radii::RadiusFault;
use super::sv1d::Sv1dError;
use super::swc::SwcError;
use super::vtk::VtkLegacyError;
use super::vtp::VtpError;
use crate::file::FileError;
use anastomesh_skeleton::{NodeId, SkeletonError};
use std::path::PathBuf;

/// The extensions that are known, for messages.
pub(super) const KNOWN: &str = ".swc, .vtp, .vtk, .am, .csv, .graphml, .gxl, .net, .json, .npyd, .in";

/// Why a network could not be read or written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NetworkFileError {
    /// The file has no known extension, cannot be read, is empty or holds no network.
    #[error(transparent)]
    File(#[from] FileError<NetworkFault>),
    /// It is a directory.
    #[error("{}: is a directory; name a network file ({KNOWN})", path.display())]
    Directory {
        /// The directory.
        path: PathBuf,
    },
    /// Networks are not written in this format.
    #[error("{}: networks are written as .vtp or .npyd; name a file with one of these extensions", path.display())]
    NotWritten {
        /// The file.
        path: PathBuf,
    },
    /// SWC holds trees only.
    #[error("{}: several vessels lead to node {}: only trees are written as .swc; name a .vtp file", path.display(), node.0)]
    NotATree {
        /// The file.
        path: PathBuf,
        /// The node, numbered from 0.
        node: NodeId,
    },
    /// The operating system refused to write.
    #[error("{}: cannot be written: {source}; name a file in a folder that exists and can be written to", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Its reason.
        source: std::io::Error,
    },
}

impl NetworkFileError {
    /// Reports that no array of the file is named like a radius, so that
    /// [`radius_array`](super::NetworkOptions::radius_array) has to name one.
    pub fn lacks_radii(&self) -> bool {
        let Self::File(FileError::Content { fault, .. }) = self else { return false };
        let (NetworkFault::Vtp(VtpError::Radius(radius))
        | NetworkFault::Vtk(VtkLegacyError::Radius(radius))
        | NetworkFault::Amira(AmiraError::Radius(radius))
        | NetworkFault::Npy(NpyNetworkError::Radius(radius))
        | NetworkFault::GraphXml(GraphXmlError::Graph(GraphFault::Radius(radius)))
        | NetworkFault::Pajek(PajekError::Graph(GraphFault::Radius(radius)))
        | NetworkFault::Json(JsonError::Graph(GraphFault::Radius(radius)))
        | NetworkFault::Csv(CsvError::Graph(GraphFault::Radius(radius)))) = fault
        else {
            return false;
        };
        matches!(radius, RadiusFault::NoRadius { .. })
    }
}

/// Why the content of a file is no network.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NetworkFault {
    /// It is no usable SWC file.
    #[error(transparent)]
    Swc(#[from] SwcError),
    /// It is no usable VTP file.
    #[error(transparent)]
    Vtp(#[from] VtpError),
    /// It is no usable legacy VTK file.
    #[error(transparent)]
    Vtk(#[from] VtkLegacyError),
    /// It is no usable spatial graph of Amira.
    #[error(transparent)]
    Amira(#[from] AmiraError),
    /// The tables are no usable network.
    #[error(transparent)]
    Csv(#[from] CsvError),
    /// It is no usable GraphML or GXL file.
    #[error(transparent)]
    GraphXml(#[from] GraphXmlError),
    /// It is no usable Pajek file.
    #[error(transparent)]
    Pajek(#[from] PajekError),
    /// It is no usable node-link data.
    #[error(transparent)]
    Json(#[from] JsonError),
    /// It is no usable folder of arrays.
    #[error(transparent)]
    Npy(#[from] NpyNetworkError),
    /// Networks of this format are several files.
    #[error("a network of this format is a folder: name its path")]
    SeveralFiles,
    /// It is no usable input of a one-dimensional solver.
    #[error(transparent)]
    Sv1d(#[from] Sv1dError),
    /// Files of its format have no numbers of nodes under names of their own.
    #[error(
        "it has no array '{wanted}', as files of its format have none on nodes that are found by a name: \
         write the network as .vtp, .vtk, .csv, .graphml or .json"
    )]
    NoNodeArrays {
        /// What was asked for.
        wanted: String,
    },
    /// A number in it cannot be used.
    #[error("{0}; correct the file, or let `anastomesh prepare` fill radii that cannot be used")]
    Numbers(#[from] SkeletonError),
}

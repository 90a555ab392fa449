//! Network formats and their file extensions.

use super::error::{KNOWN, NetworkFileError};
use crate::file::{FileError, by_extension};
use std::path::Path;

/// Format of network files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum NetworkFormat {
    /// Rows of id, type, x, y, z, radius, parent: `.swc`.
    Swc,
    /// VTK poly data with lines: `.vtp`.
    Vtp,
    /// Legacy VTK format with lines: `.vtk`.
    Vtk,
    /// ASCII spatial graph of Amira or Avizo: `.am`.
    Amira,
    /// Tables of nodes and edges: `.csv`.
    Csv,
    /// GraphML or GXL: `.graphml`, `.gxl`, `.xml`.
    GraphXml,
    /// Pajek lists: `.net`.
    Pajek,
    /// Node-link data of NetworkX: `.json`.
    Json,
    /// Folder of `NumPy` arrays: `.npyd`.
    Npy,
    /// Input of SimVascular's one-dimensional solver: `.in`.
    Sv1d,
    /// VTK unstructured grid with lines: `.vtu`.
    Vtu,
    /// Vertices and strands of `VessMorphoVis`: `.vmv`.
    Vmv,
    /// Sections of vascpy and `VessMorphoVis`, or SONATA segments, in HDF5: `.h5`, `.hdf5`.
    Hdf5,
    /// TetGen's points and edges in two files of one name: `.edge`, with `.node` beside it.
    TetgenEdges,
}

/// Extensions in lower case.
const EXTENSIONS: [(&str, NetworkFormat); 20] = [
    ("swc", NetworkFormat::Swc),
    ("vtp", NetworkFormat::Vtp),
    ("vtk", NetworkFormat::Vtk),
    ("am", NetworkFormat::Amira),
    ("csv", NetworkFormat::Csv),
    ("tsv", NetworkFormat::Csv),
    ("graphml", NetworkFormat::GraphXml),
    ("gxl", NetworkFormat::GraphXml),
    ("xml", NetworkFormat::GraphXml),
    ("net", NetworkFormat::Pajek),
    ("json", NetworkFormat::Json),
    ("npyd", NetworkFormat::Npy),
    ("in", NetworkFormat::Sv1d),
    ("pajek", NetworkFormat::Pajek),
    ("paj", NetworkFormat::Pajek),
    ("vtu", NetworkFormat::Vtu),
    ("vmv", NetworkFormat::Vmv),
    ("h5", NetworkFormat::Hdf5),
    ("hdf5", NetworkFormat::Hdf5),
    ("edge", NetworkFormat::TetgenEdges),
];

impl NetworkFormat {
    /// Format of a file name, by its extension.
    ///
    /// # Errors
    /// `UnknownFormat` if no format has the extension.
    pub fn of(path: &Path) -> Result<Self, NetworkFileError> {
        let (kind, known) = ("network", KNOWN);
        let unknown = || FileError::UnknownFormat { path: path.to_path_buf(), kind, known };
        Ok(by_extension(path, &EXTENSIONS).ok_or_else(unknown)?)
    }
}

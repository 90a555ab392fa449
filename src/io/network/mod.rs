//! Networks in files: which format, how radii are found, what can be wrong.

mod swc;
#[cfg(test)]
mod tests;
mod vtp;
mod write;
mod write_swc;

pub use swc::SwcError;
pub use vtp::VtpError;
pub use write::{END_RADII, NetworkArray, ensure_network_writable, refinement_arrays, write_network};
pub use write_swc::{ensure_tree_writable, write_tree};

use crate::skeleton::{NodeId, Skeleton, SkeletonError};
use serde::Serialize;
use std::fmt;
use std::path::{Path, PathBuf};

/// A format of network files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum NetworkFormat {
    /// Rows of id, type, x, y, z, radius, parent: `.swc`.
    Swc,
    /// VTK poly data with lines: `.vtp`.
    Vtp,
}

impl NetworkFormat {
    /// The format that a file name asks for by its extension.
    ///
    /// # Errors
    /// `UnknownFormat` when no format has the extension.
    pub fn of(path: &Path) -> Result<Self, NetworkFileError> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
        match extension.to_ascii_lowercase().as_str() {
            "swc" => Ok(Self::Swc),
            "vtp" => Ok(Self::Vtp),
            _ => Err(NetworkFileError::UnknownFormat { path: path.to_path_buf() }),
        }
    }
}

/// How to read a network.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NetworkOptions {
    /// Name of the array (on points, cells or both) that holds the radius; by default it is found by its name.
    pub radius_array: Option<String>,
}

/// A network as it stands in its file: `skeleton::clean` makes it usable.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NetworkFile {
    /// Nodes in the file's order, edges in the order of its lines.
    pub skeleton: Skeleton,
    /// What the reader decided.
    pub notes: Vec<NetworkNote>,
}

/// A decision of a reader that its user should know.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "note", rename_all = "snake_case")]
#[non_exhaustive]
pub enum NetworkNote {
    /// Node radii come from this array on the points.
    NodeRadii {
        /// The array.
        array: String,
    },
    /// Each line has its own radius, from this array on the cells; node radii serve for the nodes alone.
    EdgeRadii {
        /// The array.
        array: String,
    },
    /// There are no radii on the points: a node's radius is that of its thickest edge.
    NodeRadiiFromEdges,
    /// The array holds diameters, by its name: its values were halved.
    Halved {
        /// The array.
        array: String,
    },
    /// Other arrays could be radii too and were not used.
    NotUsed {
        /// The arrays.
        arrays: Vec<String>,
    },
    /// Cells that are no lines were ignored.
    OtherCells {
        /// How many.
        count: usize,
    },
}

impl fmt::Display for NetworkNote {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::NodeRadii { array } => write!(f, "radii of nodes: array '{array}' on the points"),
            Self::EdgeRadii { array } => write!(f, "radii of vessels: array '{array}' on the lines"),
            Self::NodeRadiiFromEdges => {
                write!(f, "no radii on the points: nodes have the radius of their thickest vessel")
            }
            Self::Halved { array } => write!(f, "array '{array}' holds diameters by its name: halved"),
            Self::NotUsed { arrays } => {
                write!(
                    f,
                    "arrays that could be radii too, not used: {} (choose with --radius-array)",
                    arrays.join(", ")
                )
            }
            Self::OtherCells { count } => write!(f, "{count} cells that are no lines were ignored"),
        }
    }
}

/// Why a network could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum NetworkFileError {
    /// No format has this extension.
    #[error("{}: the extension names no known network format (known: .swc, .vtp)", path.display())]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// It is a directory.
    #[error("{}: is a directory; name a network file (.swc, .vtp)", path.display())]
    Directory {
        /// The directory.
        path: PathBuf,
    },
    /// The operating system refused.
    #[error("{}: cannot be read: {source}; check the path and its permissions", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Its reason.
        source: std::io::Error,
    },
    /// Networks are not written in this format.
    #[error("{}: networks are written as .vtp; name a file with this extension", path.display())]
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
    /// There is nothing in it.
    #[error("{}: the file is empty: write or copy it again", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// It is no usable SWC file.
    #[error("{}: {source}", path.display())]
    Swc {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: SwcError,
    },
    /// It is no usable VTP file.
    #[error("{}: {source}", path.display())]
    Vtp {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: VtpError,
    },
    /// A number in it cannot be used.
    #[error("{}: {source}; correct the file", path.display())]
    Numbers {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: SkeletonError,
    },
}

/// Reads a network file; the extension gives the format.
///
/// # Errors
/// When the file cannot be read, or is no usable network.
pub fn read_network(path: &Path, options: &NetworkOptions) -> Result<NetworkFile, NetworkFileError> {
    if path.is_dir() {
        return Err(NetworkFileError::Directory { path: path.to_path_buf() });
    }
    let format = NetworkFormat::of(path)?;
    let bytes = std::fs::read(path).map_err(|source| NetworkFileError::Read { path: path.to_path_buf(), source })?;
    parse_network(&bytes, format, options, path)
}

/// Reads a network from the bytes of a file; `path` only names it in errors.
///
/// # Errors
/// When the bytes are no usable network.
pub fn parse_network(
    bytes: &[u8],
    format: NetworkFormat,
    options: &NetworkOptions,
    path: &Path,
) -> Result<NetworkFile, NetworkFileError> {
    let path = || path.to_path_buf();
    if bytes.trim_ascii().is_empty() {
        return Err(NetworkFileError::Empty { path: path() });
    }
    let network = match format {
        NetworkFormat::Swc => swc::parse(bytes).map_err(|source| NetworkFileError::Swc { path: path(), source })?,
        NetworkFormat::Vtp => {
            vtp::parse(bytes, options).map_err(|source| NetworkFileError::Vtp { path: path(), source })?
        }
    };
    network.skeleton.check_numbers().map_err(|source| NetworkFileError::Numbers { path: path(), source })?;
    Ok(network)
}

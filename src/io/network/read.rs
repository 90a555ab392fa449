//! Reads a network in any format.

use super::content::{NetworkFile, NetworkOptions};
use super::error::{NetworkFault, NetworkFileError};
use super::format::NetworkFormat;
use super::{swc, vtp};
use crate::io::file::{FileError, read_bytes};
use std::path::Path;

/// Reads a network file; the extension gives the format.
///
/// ```
/// use anastomesh::io::{NetworkOptions, read_network};
///
/// let file = read_network("fixtures/tree_30.swc".as_ref(), &NetworkOptions::default())?;
/// assert_eq!(file.skeleton.nodes.len(), 30);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the file cannot be read, or is no usable network.
pub fn read_network(path: &Path, options: &NetworkOptions) -> Result<NetworkFile, NetworkFileError> {
    if path.is_dir() {
        return Err(NetworkFileError::Directory { path: path.to_path_buf() });
    }
    let format = NetworkFormat::of(path)?;
    Ok(read_network_from(&read_bytes(path)?, format, options).map_err(FileError::content(path))?)
}

/// Reads a network from the bytes of a file.
///
/// ```
/// use anastomesh::io::NetworkOptions;
/// use anastomesh::testing::{NetworkFormat, read_network_from};
///
/// let swc = b"1 2 0 0 0 1.5 -1\n2 2 0 0 9 1.5 1\n";
/// let file = read_network_from(swc, NetworkFormat::Swc, &NetworkOptions::default())?;
/// assert_eq!((file.skeleton.nodes.len(), file.skeleton.nodes[1].radius), (2, 1.5));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the bytes are no usable network.
pub fn read_network_from(
    bytes: &[u8],
    format: NetworkFormat,
    options: &NetworkOptions,
) -> Result<NetworkFile, NetworkFault> {
    let network = match format {
        NetworkFormat::Swc => swc::read(bytes, options)?,
        NetworkFormat::Vtp => vtp::read(bytes, options)?,
    };
    if !options.any_radii {
        network.skeleton.check_numbers()?;
    }
    Ok(network)
}

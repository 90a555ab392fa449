//! Reader for all network formats.

use super::content::{NetworkFile, NetworkNote, NetworkOptions};
use super::error::{NetworkFault, NetworkFileError};
use super::format::NetworkFormat;
use super::scale::scale;
use super::{amira, csv, graph_xml, hdf5, json, npy, pajek, sv1d, swc, tetgen, vmv, vtk, vtp};
use crate::file::{FileError, read_bytes};
use crate::npy::Arrays;
use std::path::Path;

/// Reads a network file in the format of its extension. A node or edge table is read together with its partner, which
/// is located by name.
///
/// ```
/// use anastomesh_io::{NetworkOptions, read_network};
///
/// let file = read_network("../../fixtures/tree_30.swc".as_ref(), &NetworkOptions::default())?;
/// assert_eq!(file.skeleton.nodes.len(), 30);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The file cannot be read, or is not a valid network.
pub fn read_network(path: &Path, options: &NetworkOptions) -> Result<NetworkFile, NetworkFileError> {
    let format = NetworkFormat::of(path);
    if path.is_dir() && !matches!(format, Ok(NetworkFormat::Npy)) {
        return Err(NetworkFileError::Directory { path: path.to_path_buf() });
    }
    let format = format?;
    if format == NetworkFormat::TetgenEdges {
        let [nodes, edges] = tetgen::files(path);
        let read = tetgen::read(&read_bytes(&nodes)?, &read_bytes(&edges)?, options).map_err(NetworkFault::from);
        return Ok(read.and_then(|network| finished(network, options)).map_err(FileError::content(path))?);
    }
    if format == NetworkFormat::Npy {
        let arrays = Arrays::read(path, &npy::ARRAYS, None)?;
        let read = npy::read(&arrays, options).map_err(NetworkFault::from);
        return Ok(read.and_then(|network| finished(network, options)).map_err(FileError::content(path))?);
    }
    if let (NetworkFormat::Csv, Some((other, has_edges))) = (format, csv::partner(path)) {
        return read_tables(path, &other, has_edges, options);
    }
    Ok(read_network_from(&read_bytes(path)?, format, options).map_err(FileError::content(path))?)
}

/// Reads two tables; `other` contains edges if `has_edges`, else nodes.
fn read_tables(
    path: &Path,
    other: &Path,
    has_edges: bool,
    options: &NetworkOptions,
) -> Result<NetworkFile, NetworkFileError> {
    let (nodes, edges) = if has_edges { (path, other) } else { (other, path) };
    let read = csv::read_tables(&read_bytes(nodes)?, &read_bytes(edges)?, options).map_err(NetworkFault::from);
    let network = read.and_then(|network| finished(network, options));
    let mut network = network.map_err(FileError::content(nodes))?;
    let file = edges.file_name().unwrap_or_default().to_string_lossy().into_owned();
    network.notes.insert(0, NetworkNote::EdgesFrom { file });
    Ok(network)
}

/// Reads a network from the bytes of a file. Node and edge tables may share one file, separated by an empty line.
///
/// ```
/// use anastomesh_io::NetworkOptions;
/// use anastomesh_io::network::{NetworkFormat, read_network_from};
///
/// let swc = b"1 2 0 0 0 1.5 -1\n2 2 0 0 9 1.5 1\n";
/// let file = read_network_from(swc, NetworkFormat::Swc, &NetworkOptions::default())?;
/// assert_eq!((file.skeleton.nodes.len(), file.skeleton.nodes[1].radius), (2, 1.5));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The bytes are not a valid network.
pub fn read_network_from(
    bytes: &[u8],
    format: NetworkFormat,
    options: &NetworkOptions,
) -> Result<NetworkFile, NetworkFault> {
    let network = match format {
        NetworkFormat::Swc => swc::read(bytes, options)?,
        NetworkFormat::Vtp => vtp::read(bytes, options)?,
        NetworkFormat::Vtk => vtk::read(bytes, options)?,
        NetworkFormat::Amira => amira::read(bytes, options)?,
        NetworkFormat::Csv => csv::read(bytes, options)?,
        NetworkFormat::GraphXml => graph_xml::read(bytes, options)?,
        NetworkFormat::Pajek => pajek::read(bytes, options)?,
        NetworkFormat::Json => json::read(bytes, options)?,
        NetworkFormat::Npy | NetworkFormat::TetgenEdges => return Err(NetworkFault::SeveralFiles),
        NetworkFormat::Sv1d => sv1d::read(bytes, options)?,
        NetworkFormat::Vtu => vtp::read_grid(bytes, options)?,
        NetworkFormat::Vmv => vmv::read(bytes, options)?,
        NetworkFormat::Hdf5 => hdf5::read(bytes, options)?,
    };
    finished(network, options)
}

/// Reads a network from the bytes of the files in a folder `.npyd`.
///
/// # Errors
/// The files are not a valid network.
pub fn read_network_arrays(files: &[(&str, &[u8])], options: &NetworkOptions) -> Result<NetworkFile, NetworkFault> {
    finished(npy::read(&Arrays::of(files), options)?, options)
}

/// Common final steps: scales lengths as requested and checks all numbers.
fn finished(mut network: NetworkFile, options: &NetworkOptions) -> Result<NetworkFile, NetworkFault> {
    if let Some(wanted) = options.node_array.as_ref().filter(|_| network.node_values.is_empty()) {
        return Err(NetworkFault::NoNodeArrays { wanted: wanted.clone() });
    }
    if let Some(radius) = options.radius.filter(|_| network.notes.contains(&NetworkNote::NoRadii)) {
        network.skeleton.nodes.iter_mut().for_each(|node| node.radius = radius);
        network.skeleton.edges.iter_mut().for_each(|edge| edge.radii = [radius; 2]);
    }
    scale(&mut network, options);
    if !options.any_radii {
        network.skeleton.check_numbers()?;
    }
    Ok(network)
}

//! Writer for all network formats.

use super::content::NetworkArray;
use super::error::NetworkFileError;
use super::format::NetworkFormat;
use super::reduced::{ReducedFault, ReducedModel};
use super::{npy, sv1d, svzerod, swc, vtp};
use crate::file::{AtomicFile, OutputError, OutputSet, stage_whole, write_whole};
use anastomesh_skeleton::Skeleton;
use std::io::{self, Write};
use std::path::Path;

/// Writes a network to a `.vtp` file or a folder `.npyd`, atomically.
///
/// Points have `Radius`. Lines (one per edge) have `EdgeRadius`, the mean radius of their ends, and `EndRadii`, both
/// radii. The reader prefers `EndRadii`.
///
/// ```
/// use anastomesh_io::{NetworkOptions, read_network, write_network};
///
/// let file = read_network("../../fixtures/tree_30.swc".as_ref(), &NetworkOptions::default())?;
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("tree.vtp");
/// write_network(&path, &file.skeleton, &[])?;
/// assert_eq!(read_network(&path, &NetworkOptions::default())?.skeleton.edges.len(), file.skeleton.edges.len());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The extension is not supported, or the file cannot be written.
pub fn write_network(path: &Path, skeleton: &Skeleton, arrays: &[NetworkArray]) -> Result<(), NetworkFileError> {
    let placed = stage_network(path, skeleton, arrays)?.place();
    placed.map_err(|OutputError { path, source }| NetworkFileError::Write { path, source })
}

/// Writes a network like [`write_network`] under a temporary name. [`OutputSet::place`] moves it to its path.
///
/// # Errors
/// See [`write_network`].
pub fn stage_network(path: &Path, skeleton: &Skeleton, arrays: &[NetworkArray]) -> Result<OutputSet, NetworkFileError> {
    let staged = if is(path, NetworkFormat::Npy) {
        npy::stage(path, skeleton, arrays)
    } else {
        ensure_vtp(path)?;
        stage_whole(path, |file| file.write_all(&vtp::bytes_of(skeleton, arrays)?))
    };
    staged.map_err(|source| unwritten(path, source))
}

/// Writes a tree whose edges lead away from its root, atomically. Extension `.swc` keeps node radii but no edge radii;
/// others are as in `write_network`.
///
/// ```
/// use anastomesh_io::network::write_tree;
/// use anastomesh_io::{NetworkOptions, read_network};
///
/// let tree = read_network("../../fixtures/tree_30.swc".as_ref(), &NetworkOptions::default())?.skeleton;
/// let folder = tempfile::tempdir()?;
/// write_tree(&folder.path().join("tree.swc"), &tree, &[])?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The extension is not supported, the file cannot be written, or two edges of an SWC file lead to one node.
pub fn write_tree(path: &Path, tree: &Skeleton, arrays: &[NetworkArray]) -> Result<(), NetworkFileError> {
    if !is(path, NetworkFormat::Swc) {
        return write_network(path, tree, arrays);
    }
    let not_a_tree = |node| NetworkFileError::NotATree { path: path.to_path_buf(), node };
    let parents = swc::parents(tree).map_err(not_a_tree)?;
    write(path, |file| swc::write(file, tree, &parents))
}

/// Writes a zero-dimensional model for `svZeroDSolver` (`.json`) or a one-dimensional one for `svOneDSolver` (`.in`),
/// atomically. Both are read as networks.
///
/// ```
/// use anastomesh_io::network::{ModelEnd, ReducedModel, ReducedVessel, Stiffness, read_network, write_reduced};
/// use anastomesh_io::{NetworkOptions, flow::OutletModel};
/// use anastomesh_mesh::Point3;
///
/// let vessel = ReducedVessel { path: vec![0, 1], radii: vec![1.0; 2], length: 9.0, resistance: 2.0, ..ReducedVessel::default() };
/// let ends = [(0, ModelEnd::Inlet { rate: 3.0, waveform: None }), (1, ModelEnd::Outlet(OutletModel::default()))];
/// let model = ReducedModel::new(1060.0, 3.5e-3, Stiffness::default())
///     .nodes(vec![(Point3::origin(), 1.0), (Point3::new(0.0, 0.0, 9.0), 1.0)])
///     .vessels(vec![vessel])
///     .ends(ends.into());
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("tube.json");
/// write_reduced(&path, &model)?;
/// assert_eq!(read_network(&path, &NetworkOptions::default())?.skeleton.edges[0].radii, [1.0; 2]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The extension is not supported, the solver does not take the model, or the file cannot be written.
pub fn write_reduced(path: &Path, model: &ReducedModel) -> Result<(), NetworkFileError> {
    let one_dimensional = is_one_dimensional(path)?;
    let fault = if one_dimensional { sv1d::check(model) } else { svzerod::check(model) };
    fault.map_err(|fault: ReducedFault| NetworkFileError::Model { path: path.to_path_buf(), fault })?;
    write(path, |file| if one_dimensional { sv1d::write(file, model) } else { svzerod::write(file, model) })
}

/// Checks in advance that a reduced-order model can be written to a path.
///
/// # Errors
/// The extension is neither `.json` nor `.in`, or the parent folder does not exist.
pub fn ensure_reduced_writable(path: &Path) -> Result<(), NetworkFileError> {
    is_one_dimensional(path)?;
    ensure_folder(path)
}

/// True for the format of `svOneDSolver`, false for that of `svZeroDSolver`.
fn is_one_dimensional(path: &Path) -> Result<bool, NetworkFileError> {
    match NetworkFormat::of(path) {
        Ok(NetworkFormat::Json) => Ok(false),
        Ok(NetworkFormat::Sv1d) => Ok(true),
        _ => Err(NetworkFileError::NotAModel { path: path.to_path_buf() }),
    }
}

/// Checks in advance that a network can be written to a path.
///
/// # Errors
/// The extension is neither `.vtp` nor `.npyd`, or the parent folder does not exist.
pub fn ensure_network_writable(path: &Path) -> Result<(), NetworkFileError> {
    if is(path, NetworkFormat::Npy) {
        return npy::ensure_writable(path).map_err(|source| unwritten(path, source));
    }
    ensure_vtp(path)?;
    ensure_folder(path)
}

/// Checks in advance that a tree can be written to a path.
///
/// # Errors
/// The extension is neither `.vtp`, `.npyd` nor `.swc`, or the parent folder does not exist.
pub fn ensure_tree_writable(path: &Path) -> Result<(), NetworkFileError> {
    if is(path, NetworkFormat::Swc) { ensure_folder(path) } else { ensure_network_writable(path) }
}

fn write(path: &Path, write: impl FnOnce(&mut AtomicFile) -> io::Result<()>) -> Result<(), NetworkFileError> {
    write_whole(path, write).map_err(|source| unwritten(path, source))
}

fn unwritten(path: &Path, source: io::Error) -> NetworkFileError {
    NetworkFileError::Write { path: path.to_path_buf(), source }
}

fn is(path: &Path, format: NetworkFormat) -> bool {
    NetworkFormat::of(path).is_ok_and(|found| found == format)
}

fn ensure_vtp(path: &Path) -> Result<(), NetworkFileError> {
    if is(path, NetworkFormat::Vtp) { Ok(()) } else { Err(NetworkFileError::NotWritten { path: path.to_path_buf() }) }
}

/// Checks that a file can be created at a path.
fn ensure_folder(path: &Path) -> Result<(), NetworkFileError> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if path.is_dir() || !folder.is_dir() {
        let kind = if path.is_dir() { io::ErrorKind::IsADirectory } else { io::ErrorKind::NotFound };
        return Err(unwritten(path, kind.into()));
    }
    Ok(())
}

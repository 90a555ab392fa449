//! Writes a network in any format.

use super::content::NetworkArray;
use super::error::NetworkFileError;
use super::format::NetworkFormat;
use super::{npy, swc, vtp};
use crate::file::{AtomicFile, write_whole};
use anastomesh_skeleton::Skeleton;
use std::io::{self, Write};
use std::path::Path;

/// Writes a network to a `.vtp` file or a folder `.npyd`: whole or not at all.
///
/// Points carry `Radius`, lines (one per edge) `EdgeRadius`, the mean of the radii at their ends, and `EndRadii`, both of
/// them; the reader prefers the latter.
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
/// When the name has another extension, or the file cannot be written.
pub fn write_network(path: &Path, skeleton: &Skeleton, arrays: &[NetworkArray]) -> Result<(), NetworkFileError> {
    if is(path, NetworkFormat::Npy) {
        return npy::write(path, skeleton, arrays).map_err(|source| unwritten(path, source));
    }
    ensure_vtp(path)?;
    write(path, |file| file.write_all(&vtp::bytes_of(skeleton, arrays)?))
}

/// Writes a tree whose edges lead away from its root, by the extension of the name: `.vtp` (as `write_network`), or
/// `.swc`, which keeps the radii of the nodes but not those of the edges. Whole or not at all.
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
/// When the name has another extension, the file cannot be written, or two edges of an SWC file lead to one node.
pub fn write_tree(path: &Path, tree: &Skeleton, arrays: &[NetworkArray]) -> Result<(), NetworkFileError> {
    if !is(path, NetworkFormat::Swc) {
        return write_network(path, tree, arrays);
    }
    let not_a_tree = |node| NetworkFileError::NotATree { path: path.to_path_buf(), node };
    let parents = swc::parents(tree).map_err(not_a_tree)?;
    write(path, |file| swc::write(file, tree, &parents))
}

/// Checks, before any work, that a network can be written to a path.
///
/// # Errors
/// When the name has another extension than `.vtp` or `.npyd`, or its folder does not exist.
pub fn ensure_network_writable(path: &Path) -> Result<(), NetworkFileError> {
    if is(path, NetworkFormat::Npy) {
        return npy::ensure_writable(path).map_err(|source| unwritten(path, source));
    }
    ensure_vtp(path)?;
    ensure_folder(path)
}

/// Checks, before any work, that a tree can be written to a path.
///
/// # Errors
/// When the name has another extension than `.vtp`, `.npyd` or `.swc`, or its folder does not exist.
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

/// Checks that a file can be made at a path.
fn ensure_folder(path: &Path) -> Result<(), NetworkFileError> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if path.is_dir() || !folder.is_dir() {
        let kind = if path.is_dir() { io::ErrorKind::IsADirectory } else { io::ErrorKind::NotFound };
        return Err(unwritten(path, kind.into()));
    }
    Ok(())
}

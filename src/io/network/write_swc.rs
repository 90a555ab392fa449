//! Trees as SWC: rows of nodes, each with the one before it.

use super::write::ensure_folder;
use super::{NetworkArray, NetworkFileError, NetworkFormat, ensure_network_writable, write_network};
use crate::io::atomic::AtomicFile;
use crate::skeleton::{NodeId, Skeleton};
use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;

/// Rows are written when they are as many characters.
const CHUNK: usize = 1 << 20;

/// Writes a tree whose edges lead away from its root, by the extension of the name: `.vtp` (as `write_network`), or
/// `.swc`, which keeps the radii of the nodes but not those of the edges. Whole or not at all.
///
/// # Errors
/// When the name has another extension, the file cannot be written, or two edges of an SWC file lead to one node.
pub fn write_tree(path: &Path, tree: &Skeleton, arrays: &[NetworkArray]) -> Result<(), NetworkFileError> {
    if !matches!(NetworkFormat::of(path), Ok(NetworkFormat::Swc)) {
        return write_network(path, tree, arrays);
    }
    let parents = parents(path, tree)?;
    let write = || -> io::Result<()> {
        let mut file = AtomicFile::create(path)?;
        let mut rows = String::from("# id type x y z radius parent\n");
        for (id, (node, parent)) in (1..).zip(tree.nodes.iter().zip(parents)) {
            let [x, y, z]: [f64; 3] = node.position.into();
            let parent = parent.map_or(-1, |p| i64::from(p.0) + 1);
            // Writing to a string cannot fail. Type 0: not said.
            let _ = writeln!(rows, "{id} 0 {x} {y} {z} {} {parent}", node.radius);
            if rows.len() > CHUNK {
                file.write_all(rows.as_bytes())?;
                rows.clear();
            }
        }
        file.write_all(rows.as_bytes())?;
        file.commit()
    };
    write().map_err(|source| NetworkFileError::Write { path: path.to_path_buf(), source })
}

/// Checks, before any work, that a tree can be written to a path.
///
/// # Errors
/// When the name has another extension than `.vtp` or `.swc`, or its folder does not exist.
pub fn ensure_tree_writable(path: &Path) -> Result<(), NetworkFileError> {
    match NetworkFormat::of(path) {
        Ok(NetworkFormat::Swc) => ensure_folder(path),
        _ => ensure_network_writable(path),
    }
}

/// The node before each node.
fn parents(path: &Path, tree: &Skeleton) -> Result<Vec<Option<NodeId>>, NetworkFileError> {
    let mut parents = vec![None; tree.nodes.len()];
    for edge in &tree.edges {
        let [from, to] = edge.nodes;
        if parents[to.index()].replace(from).is_some() {
            return Err(NetworkFileError::NotATree { path: path.to_path_buf(), node: to });
        }
    }
    Ok(parents)
}

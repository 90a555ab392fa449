//! Writer of nodes and edges, and of refinement data per node.

use super::read::{EDGE_RADII, EDGES, NODES, RADII};
use crate::file::{AtomicFolder, OutputSet};
use crate::network::content::NetworkArray;
use crate::npy::{Item, write_array};
use anastomesh_skeleton::{Edge, Node, Skeleton};
use std::io::{self, Write};
use std::path::Path;

/// Names of additional arrays, and their files in the folder.
const BESIDE: [(&str, &str); 2] = [("OriginalNode", "original_node"), ("Displacement", "displacement")];

fn is_ours(file: &str) -> bool {
    let known = [NODES, EDGES, RADII, EDGE_RADII].into_iter().chain(BESIDE.map(|(_, file)| file));
    known.into_iter().any(|name| file.strip_suffix(".npy") == Some(name))
}

/// Checks that the folder can be created or replaced, without side effects.
pub(in crate::network) fn ensure_writable(path: &Path) -> io::Result<()> {
    AtomicFolder::create(path, is_ours).map(drop)
}

/// Writes the folder of a network under a temporary name, with edge radii at both ends.
pub(in crate::network) fn stage(path: &Path, skeleton: &Skeleton, arrays: &[NetworkArray]) -> io::Result<OutputSet> {
    let folder = AtomicFolder::create(path, is_ours)?;
    let Skeleton { nodes, edges, .. } = skeleton;
    let position = |node: &Node| <[f64; 3]>::from(node.position);
    put(&folder, NODES, &nodes.iter().map(position).collect::<Vec<_>>())?;
    put(&folder, RADII, &nodes.iter().map(|node| [node.radius]).collect::<Vec<_>>())?;
    let ends = |edge: &Edge| edge.nodes.map(|node| node.0);
    put(&folder, EDGES, &edges.iter().map(ends).collect::<Vec<_>>())?;
    put(&folder, EDGE_RADII, &edges.iter().map(|edge| edge.radii).collect::<Vec<_>>())?;
    for array in arrays {
        let file = |name: &str| BESIDE.into_iter().find(|(known, _)| *known == name).map(|(_, file)| file);
        match array {
            NetworkArray::NodeInts(name, values) => {
                file(name).map_or(Ok(()), |f| put(&folder, f, values.as_chunks::<1>().0))
            }
            NetworkArray::NodeVectors(name, values) => file(name).map_or(Ok(()), |f| put(&folder, f, values)),
            NetworkArray::NodeFloats(name, values) | NetworkArray::EdgeFloats(name, values) => {
                file(name).map_or(Ok(()), |f| put(&folder, f, values.as_chunks::<1>().0))
            }
        }?;
    }
    Ok(folder.stage())
}

fn put<T: Item, const N: usize>(folder: &AtomicFolder, name: &str, rows: &[[T; N]]) -> io::Result<()> {
    let mut file = folder.quick_file(&format!("{name}.npy"))?;
    write_array(&mut file, rows)?;
    file.flush()
}

//! Manifest of a work directory: a run continues only with blocks of the same network, options and version.

use std::fs;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::error::Difference;
use super::key::{Key, KeyMaker};
use anastomesh_skeleton::Skeleton;

/// Version of the format of work directories.
const FORMAT: u32 = 8;

pub(crate) const MANIFEST: &str = "anastomesh.json";

/// Identity of the run that owns a work directory.
///
/// ```
/// use anastomesh::io::{NetworkOptions, read_network};
/// use anastomesh::meshing::{Manifest, MeshPlan, Store, mesh_into};
/// use anastomesh::network::clean;
///
/// let file = read_network("fixtures/tree_30.swc".as_ref(), &NetworkOptions::default())?;
/// let (network, _) = clean(&file.skeleton)?;
/// let folder = tempfile::tempdir()?;
/// let run = || -> Result<usize, Box<dyn std::error::Error>> {
///     let options = serde_json::json!({ "mesh": MeshPlan::default() });
///     let store = Store::in_folder(folder.path(), &Manifest::new(&network, options), false)?;
///     Ok(mesh_into(&store, &network, &MeshPlan::default(), &|_| Ok(()), &())?.report.mesh.tets)
/// };
/// // The second run finds all blocks.
/// assert_eq!(run()?, run()?);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    format: u32,
    program: String,
    network: String,
    options: serde_json::Value,
}

impl Manifest {
    /// Creates the manifest of a network as read. `options` is an object with all other inputs of the mesh.
    pub fn new(network: &Skeleton, options: serde_json::Value) -> Self {
        let program = concat!("anastomesh ", env!("CARGO_PKG_VERSION")).into();
        Self { format: FORMAT, program, network: format!("{:032x}", fingerprint(network).0), options }
    }

    /// Reads the manifest of a folder.
    pub(super) fn begun(&self, folder: &Path) -> io::Result<Begun> {
        let text = match fs::read(folder.join(MANIFEST)) {
            Ok(text) => text,
            // Blocks without a manifest: the run was killed before it was written, or another program wrote them.
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Begun::Nothing),
            Err(error) => return Err(error),
        };
        Ok(match serde_json::from_slice::<Self>(&text) {
            Ok(before) => self.difference(&before).map_or(Begun::Same, Begun::Other),
            Err(_) => Begun::Other(Difference::Version("its manifest cannot be read".into())),
        })
    }

    fn difference(&self, before: &Self) -> Option<Difference> {
        if (before.format, &before.program) != (self.format, &self.program) {
            return Some(Difference::Version(format!("{}, format {}", before.program, before.format)));
        }
        if before.network != self.network {
            return Some(Difference::Network);
        }
        first_difference("", &before.options, &self.options)
    }
}

/// Hash of all data of a network.
pub fn fingerprint(network: &Skeleton) -> Key {
    let mut key = KeyMaker::new("network");
    key.count(network.nodes.len());
    for node in &network.nodes {
        key.point(&node.position);
        key.float(node.radius);
        key.id(node.original);
    }
    key.count(network.edges.len());
    for edge in &network.edges {
        edge.nodes.iter().for_each(|node| key.id(node.0));
        edge.radii.iter().for_each(|&radius| key.float(radius));
    }
    key.finish()
}

/// First position at which two values differ.
fn first_difference(name: &str, was: &serde_json::Value, is: &serde_json::Value) -> Option<Difference> {
    if was == is {
        return None;
    }
    if let (Some(before), Some(now)) = (was.as_object(), is.as_object()) {
        let mut names: Vec<&String> = before.keys().chain(now.keys()).collect();
        names.sort_unstable();
        let missing = serde_json::Value::Null;
        return names.into_iter().find_map(|key| {
            let full = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
            first_difference(&full, before.get(key).unwrap_or(&missing), now.get(key).unwrap_or(&missing))
        });
    }
    Some(Difference::Option { name: name.into(), was: was.to_string(), is: is.to_string() })
}

/// Manifest as stored in a work directory.
pub(super) enum Begun {
    Nothing,
    Same,
    Other(Difference),
}

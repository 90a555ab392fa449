//! What a work directory was begun with: a run goes on only with blocks of the same network, options and version.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::error::{Difference, StoreError};
use super::key::{Key, KeyMaker};
use super::log::LogFile;
use crate::skeleton::Skeleton;

/// Version of what is in a work directory.
const FORMAT: u32 = 3;

const MANIFEST: &str = "anastomesh.json";
const LOCK: &str = "anastomesh.lock";
const BLOCKS: &str = "anastomesh.blocks";

/// What a work directory belongs to.
///
/// ```
/// use anastomesh::io::{NetworkOptions, read_network};
/// use anastomesh::network::{Manifest, MeshPlan, Store, clean, mesh_into};
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
    /// Of a network as it was read; `options` is an object with everything else that the mesh depends on.
    pub fn new(network: &Skeleton, options: serde_json::Value) -> Self {
        let program = concat!("anastomesh ", env!("CARGO_PKG_VERSION")).into();
        Self { format: FORMAT, program, network: format!("{:032x}", fingerprint(network).0), options }
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

/// A key of all that a network holds.
fn fingerprint(network: &Skeleton) -> Key {
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

/// The first place in which two values differ.
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

/// Takes hold of a work directory: its log, and the keys of what is in there.
pub(super) fn claim(folder: &Path, manifest: &Manifest, restart: bool) -> Result<(LogFile, Vec<Key>), StoreError> {
    let failed = |source| StoreError::Folder { path: folder.to_path_buf(), source };
    fs::create_dir_all(folder).map_err(failed)?;
    let lock = File::options().write(true).create(true).truncate(false).open(folder.join(LOCK)).map_err(failed)?;
    match lock.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => return Err(StoreError::Locked { path: folder.to_path_buf() }),
        Err(TryLockError::Error(source)) => return Err(failed(source)),
    }
    match difference(folder, manifest).map_err(failed)? {
        Found::Same => {}
        Found::Nothing => begin(folder, manifest).map_err(failed)?,
        Found::Other(_) if restart => begin(folder, manifest).map_err(failed)?,
        Found::Other(difference) => return Err(StoreError::Other { path: folder.to_path_buf(), difference }),
    }
    LogFile::open(&folder.join(BLOCKS), lock).map_err(failed)
}

enum Found {
    Nothing,
    Same,
    Other(Difference),
}

fn difference(folder: &Path, manifest: &Manifest) -> io::Result<Found> {
    let text = match fs::read(folder.join(MANIFEST)) {
        Ok(text) => text,
        // Blocks without a manifest: killed between the two, or not ours; nothing says what they belong to.
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(Found::Nothing),
        Err(error) => return Err(error),
    };
    Ok(match serde_json::from_slice::<Manifest>(&text) {
        Ok(before) => manifest.difference(&before).map_or(Found::Same, Found::Other),
        Err(_) => Found::Other(Difference::Version("its manifest cannot be read".into())),
    })
}

/// Empties the directory of blocks, then says what the next ones belong to.
fn begin(folder: &Path, manifest: &Manifest) -> io::Result<()> {
    for name in [MANIFEST, BLOCKS] {
        match fs::remove_file(folder.join(name)) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
    }
    let text = serde_json::to_vec_pretty(manifest)?;
    // Under its name only when it is whole: half a manifest would look like another version's.
    let part = folder.join("anastomesh.json.part");
    fs::write(&part, text)?;
    fs::rename(part, folder.join(MANIFEST))
}

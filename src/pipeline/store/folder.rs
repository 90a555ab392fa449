//! Work directories: locks, and the check of the manifest.
//!
//! Every run holds the directory's lock: shards share it, other runs hold it alone. A second lock protects the files that
//! all runs use (the manifest, the number of shards). It is held only while one of them is written.

use std::fs::{self, File};
use std::io;
use std::path::Path;

use super::error::StoreError;
use super::key::Key;
use super::locks::{LockMode, try_lock, wait_for};
use super::log::{LogFile, scan_path};
use super::manifest::{Begun, MANIFEST, Manifest};
use super::shard::Shard;
use super::shards;
use super::shelf::Shelf;
use super::whole_file::write_whole;

const LOCK: &str = "anastomesh.lock";
const BEGIN: &str = "anastomesh.begin.lock";
const BLOCKS: &str = "anastomesh.blocks";

/// Role of a run in a work directory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Role {
    /// One run alone, with the blocks of earlier runs and shards.
    Alone {
        /// Delete blocks of another network, other options or another version instead of refusing them.
        restart: bool,
        /// Make the blocks that shards have not finished, instead of failing.
        make_missing: bool,
    },
    /// One of several runs that each make a share of the blocks.
    Shard(Shard),
}

/// Contents of a work directory.
pub(super) struct Opened {
    /// The file that this run writes to.
    pub own: LogFile,
    /// Records of other runs.
    pub others: Shelf,
    /// Keys of the records of other runs, then of those in the own file.
    pub keys: Vec<Key>,
}

/// Locks and opens a work directory.
pub(super) fn open(folder: &Path, manifest: &Manifest, role: Role) -> Result<Opened, StoreError> {
    let failed = |source| StoreError::Folder { path: folder.to_path_buf(), source };
    fs::create_dir_all(folder).map_err(failed)?;
    let hold = match role {
        Role::Alone { .. } => LockMode::Alone,
        Role::Shard(_) => LockMode::Shared,
    };
    let lock = try_lock(folder, LOCK, hold)?.ok_or_else(|| StoreError::Locked { path: folder.to_path_buf() })?;
    let begin_lock = wait_for(folder, BEGIN, &())?;
    let restart = matches!(role, Role::Alone { restart: true, .. });
    match manifest.begun(folder).map_err(failed)? {
        Begun::Same => {}
        Begun::Nothing => begin(folder, manifest).map_err(failed)?,
        Begun::Other(_) if restart => begin(folder, manifest).map_err(failed)?,
        Begun::Other(difference) => return Err(StoreError::Other { path: folder.to_path_buf(), difference }),
    }
    if let Role::Shard(shard) = role {
        shards::join(folder, shard)?;
    }
    drop(begin_lock);
    match role {
        Role::Alone { make_missing, .. } => alone(folder, lock, make_missing),
        Role::Shard(shard) => shard_of(folder, lock, shard),
    }
}

fn alone(folder: &Path, lock: File, make_missing: bool) -> Result<Opened, StoreError> {
    let failed = |source| StoreError::Folder { path: folder.to_path_buf(), source };
    let (others, mut keys) = shards::read_all(folder, make_missing)?;
    let (own, found) = LogFile::open(&folder.join(BLOCKS), vec![lock]).map_err(failed)?;
    keys.extend(found);
    Ok(Opened { own, others, keys })
}

/// A shard finds the blocks of an earlier run that was alone.
fn shard_of(folder: &Path, lock: File, shard: Shard) -> Result<Opened, StoreError> {
    let failed = |source| StoreError::Folder { path: folder.to_path_buf(), source };
    let busy = || StoreError::ShardLocked { path: folder.to_path_buf(), shard };
    let own_lock = try_lock(folder, &shard.lock(), LockMode::Alone)?.ok_or_else(busy)?;
    shards::unmark(folder, shard).map_err(failed)?;
    let path = folder.join(BLOCKS);
    let (mut keys, extents): (Vec<Key>, Vec<_>) = scan_path(&path).map_err(failed)?.records.into_iter().unzip();
    let mut others = Shelf::default();
    others.add(path, extents.into_iter());
    let (own, found) = LogFile::open(&folder.join(shard.records()), vec![lock, own_lock]).map_err(failed)?;
    keys.extend(found);
    Ok(Opened { own, others, keys })
}

/// Deletes all files of this program from the directory, then writes the manifest of the next blocks.
fn begin(folder: &Path, manifest: &Manifest) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if name.starts_with("anastomesh.") && !name.ends_with(".lock") {
            fs::remove_file(&path)?;
        }
    }
    write_whole(&folder.join(MANIFEST), &serde_json::to_vec_pretty(manifest)?)
}

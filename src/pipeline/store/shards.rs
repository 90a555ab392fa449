//! Shards. Each has a share of the blocks, its own file of records, and a mark once all its records exist.

use std::fs;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::error::StoreError;
use super::key::Key;
use super::log::{Scanned, scan_path};
use super::shard::{MOST, Shard};
use super::shelf::Shelf;
use super::whole_file::write_whole;

/// Record of the number of shards.
const SHARDS: &str = "anastomesh.shards";

/// Record of a shard whose blocks have all been made or failed.
#[derive(Debug, Serialize, Deserialize)]
struct ShardRecord {
    /// Bytes of its records.
    bytes: u64,
}

fn read_json<T: for<'a> Deserialize<'a>>(path: &Path) -> io::Result<Option<T>> {
    match fs::read(path) {
        Ok(text) => Ok(serde_json::from_slice(&text).ok()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

/// Joins the shards of a folder. The first shard writes their number.
///
/// # Errors
/// The folder has another number of shards, or cannot be used.
pub(super) fn join(folder: &Path, shard: Shard) -> Result<(), StoreError> {
    let failed = |source| StoreError::Folder { path: folder.to_path_buf(), source };
    match read_json::<u32>(&folder.join(SHARDS)).map_err(failed)? {
        Some(was) if was as usize != shard.of() => {
            Err(StoreError::OtherShards { path: folder.to_path_buf(), was, shard })
        }
        Some(_) => Ok(()),
        None => write_whole(&folder.join(SHARDS), shard.of().to_string().as_bytes()).map_err(failed),
    }
}

/// Removes the mark of a shard, because its blocks are made again.
pub(super) fn unmark(folder: &Path, shard: Shard) -> io::Result<()> {
    match fs::remove_file(folder.join(shard.mark())) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Marks a shard as done, with the size of its records in bytes.
pub(super) fn mark(folder: &Path, shard: Shard, bytes: u64) -> io::Result<()> {
    write_whole(&folder.join(shard.mark()), &serde_json::to_vec(&ShardRecord { bytes })?)
}

/// Records of all shards of a folder, and their keys; empty without shards. With `make_missing`, missing or damaged records
/// are left to the run that reads them.
///
/// # Errors
/// A shard is missing or damaged, or a file cannot be read.
pub(super) fn read_all(folder: &Path, make_missing: bool) -> Result<(Shelf, Vec<Key>), StoreError> {
    let failed = |source| StoreError::Folder { path: folder.to_path_buf(), source };
    let (mut shelf, mut keys, mut missing) = (Shelf::default(), Vec::new(), Vec::new());
    let of = read_json::<u32>(&folder.join(SHARDS)).map_err(failed)?.unwrap_or(0).min(MOST);
    for shard in Shard::all(of) {
        let path = folder.join(shard.records());
        let mark = read_json::<ShardRecord>(&folder.join(shard.mark())).map_err(failed)?;
        if mark.is_none() {
            missing.push(shard);
            if !make_missing {
                continue;
            }
        }
        let Scanned { records, end, length } = scan_path(&path).map_err(failed)?;
        if let Some(ShardRecord { bytes }) = mark.filter(|mark| !make_missing && (mark.bytes != end || end < length)) {
            return Err(StoreError::Damaged { path, shard, end, bytes: bytes.max(length) });
        }
        let (found, extents): (Vec<Key>, Vec<_>) = records.into_iter().unzip();
        keys.extend(found);
        shelf.add(path, extents.into_iter());
    }
    if !missing.is_empty() && !make_missing {
        return Err(StoreError::Missing { path: folder.to_path_buf(), shards: missing });
    }
    Ok((shelf, keys))
}

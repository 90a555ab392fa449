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

/// Says how many shards there are.
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

/// Joins the shards of a folder: the first one says how many there are.
///
/// # Errors
/// When they are of another number, or the folder cannot be used.
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

/// Takes a shard's mark away, as it is made again.
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

/// The records of all shards of a folder, none if there were no shards, and their keys. With `make_missing` what is not
/// there, or damaged, is left to the run that reads them.
///
/// # Errors
/// When a shard is missing or damaged, or a file cannot be read.
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

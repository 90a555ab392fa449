//! Shards: a share of the blocks each, with a file of records of its own, and a mark once all of them are there.

use std::fmt;
use std::fs;
use std::io;
use std::path::Path;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::error::StoreError;
use super::folder::write_whole;
use super::key::Key;
use super::log::{Scanned, scan_path};
use super::shelf::Shelf;

/// Says how many shards there are.
const SHARDS: &str = "anastomesh.shards";

/// One of so many shares of the blocks: `3/8` is the third of eight.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Shard {
    number: u32,
    of: u32,
}

/// No shard.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NoShard {
    /// Not two numbers.
    #[error("'{0}' is no shard: give its number and how many there are, such as 3/8")]
    Text(String),
    /// A number that is none of these.
    #[error("shard {0}/{1} is out of range: with {1} shards they are 1/{1} to {1}/{1}")]
    Range(u32, u32),
    /// None, or too many.
    #[error("{0} shards: there can be 1 to {MOST}")]
    Count(u32),
}

/// More shards than a scheduler starts.
const MOST: u32 = 1_000_000;

impl Shard {
    /// The share of this number, counted from 1.
    ///
    /// # Errors
    /// When there is no such share.
    pub fn new(number: u32, of: u32) -> Result<Self, NoShard> {
        match () {
            () if !(1..=MOST).contains(&of) => Err(NoShard::Count(of)),
            () if !(1..=of).contains(&number) => Err(NoShard::Range(number, of)),
            () => Ok(Self { number, of }),
        }
    }

    /// Its number, counted from 0.
    pub fn index(self) -> usize {
        self.number as usize - 1
    }

    /// How many there are.
    pub fn of(self) -> usize {
        self.of as usize
    }

    pub(super) fn records(self) -> String {
        format!("anastomesh.shard_{}_of_{}.blocks", self.number, self.of)
    }

    pub(super) fn lock(self) -> String {
        format!("anastomesh.shard_{}_of_{}.lock", self.number, self.of)
    }

    fn mark(self) -> String {
        format!("anastomesh.shard_{}_of_{}.done", self.number, self.of)
    }

    fn all(of: u32) -> impl Iterator<Item = Self> {
        (1..=of).map(move |number| Self { number, of })
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

/// The two numbers alone: whether there is such a shard is told by [`Shard::new`].
pub fn two_numbers(text: &str) -> Result<(u32, u32), NoShard> {
    let number = |text: &str| u32::from_str(text).ok();
    let both = text.split_once('/').and_then(|(i, n)| number(i).zip(number(n)));
    both.ok_or_else(|| NoShard::Text(text.into()))
}

/// What a shard leaves when all of its blocks have been made, or have failed.
#[derive(Debug, Serialize, Deserialize)]
struct Mark {
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
        Some(was) if was != shard.of => Err(StoreError::OtherShards { path: folder.to_path_buf(), was, shard }),
        Some(_) => Ok(()),
        None => write_whole(&folder.join(SHARDS), shard.of.to_string().as_bytes()).map_err(failed),
    }
}

/// Takes a shard's mark away, as it is made again.
pub(super) fn unmark(folder: &Path, shard: Shard) -> io::Result<()> {
    match fs::remove_file(folder.join(shard.mark())) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Marks a shard as done, with so many bytes of records.
pub(super) fn mark(folder: &Path, shard: Shard, bytes: u64) -> io::Result<()> {
    write_whole(&folder.join(shard.mark()), &serde_json::to_vec(&Mark { bytes })?)
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
        let mark = read_json::<Mark>(&folder.join(shard.mark())).map_err(failed)?;
        if mark.is_none() {
            missing.push(shard);
            if !make_missing {
                continue;
            }
        }
        let Scanned { records, end, length } = scan_path(&path).map_err(failed)?;
        if let Some(Mark { bytes }) = mark.filter(|mark| !make_missing && (mark.bytes != end || end < length)) {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_counted_from_one() {
        assert_eq!(two_numbers("3/8"), Ok((3, 8)));
        for text in ["", "3", "3/", "/8", "-1/8", "3/8/2", "a/b", "3 / 8", "99999999999/8"] {
            assert_eq!(two_numbers(text), Err(NoShard::Text(text.into())));
        }
        assert_eq!(Shard::new(1, 1).map(Shard::index), Ok(0));
        assert_eq!(Shard::new(8, 8).map(|s| (s.index(), s.of(), s.to_string())), Ok((7, 8, "8/8".into())));
        assert_eq!(Shard::new(0, 8), Err(NoShard::Range(0, 8)));
        assert_eq!(Shard::new(9, 8), Err(NoShard::Range(9, 8)));
        assert_eq!(Shard::new(1, 0), Err(NoShard::Count(0)));
        assert_eq!(Shard::new(1, u32::MAX), Err(NoShard::Count(u32::MAX)));
    }
}

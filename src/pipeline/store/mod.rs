//! Store of finished blocks outside main memory. The key of a block is a hash of all its inputs.
//!
//! A block is looked up by its key before it is meshed. So a block that does not change when others are cut again is not
//! meshed again. A run that was killed is repeated from the start, and finds nearly all blocks in the store.

mod blocks;
mod error;
mod extents;
mod folder;
mod key;
mod locks;
mod log;
mod manifest;
mod once;
mod shard;
mod shards;
mod shelf;
#[cfg(test)]
mod tests;
mod tissue;
mod whole_file;

use std::collections::hash_map::Entry;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicUsize;
use std::sync::{Arc, Mutex, PoisonError, RwLock};

use rustc_hash::FxHashMap;
use serde::Serialize;
use serde::de::DeserializeOwned;

pub use blocks::BlockRecords;
pub use error::{Difference, StoreError};
pub(crate) use extents::Extents;
pub use folder::Role;
use key::ShortKey;
pub use key::{Key, KeyMaker};
use log::LogFile;
pub(crate) use manifest::MANIFEST;
pub use manifest::{Manifest, fingerprint};
pub use shard::{NoShard, Shard};
use shelf::Shelf;

use super::effort::Ledger;
use crate::block::{Bytes, Piece};
use anastomesh_mesh::progress::Progress;

/// Record of the store.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct RecordId(u32);

impl RecordId {
    /// Number of the record; numbers are consecutive.
    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}

/// Keeps finished blocks, in memory or in a file.
#[derive(Debug)]
pub struct Store {
    place: Backend,
    known: Mutex<FxHashMap<ShortKey, RecordId>>,
    /// Number of blocks that were added.
    made: AtomicUsize,
    /// Work of the run that uses the store.
    ledger: Ledger,
}

#[derive(Debug)]
enum Backend {
    Memory(RwLock<Vec<Arc<Vec<u8>>>>),
    File(LogFile),
    /// Work directory: its path, the records of other runs, and the file that this run writes to.
    Folder(PathBuf, Shelf, LogFile),
    /// Records of other runs, read-only.
    Shelf(Shelf),
}

impl Store {
    /// In memory.
    pub fn in_memory() -> Self {
        Self::new(Backend::Memory(RwLock::default()), FxHashMap::default())
    }

    fn new(place: Backend, known: FxHashMap<ShortKey, RecordId>) -> Self {
        Self { place, known: Mutex::new(known), made: AtomicUsize::new(0), ledger: Ledger::default() }
    }

    /// True if the run has spent so much on failed blocks that another network is not worth trying.
    pub(crate) fn is_hopeless(&self) -> bool {
        self.ledger.is_hopeless()
    }

    /// Work of the run that uses the store.
    pub(crate) fn ledger(&self) -> &Ledger {
        &self.ledger
    }

    /// Opens a store in an unnamed file of `folder`, which disappears when the store is dropped or the program ends.
    ///
    /// # Errors
    /// The file cannot be created.
    pub fn in_passing(folder: &Path) -> Result<Self, StoreError> {
        let failed = |source| StoreError::Folder { path: folder.to_path_buf(), source };
        let log = LogFile::in_passing(folder).map_err(failed)?;
        Ok(Self::new(Backend::File(log), FxHashMap::default()))
    }

    /// Opens the store of a work directory, with its blocks. `restart` deletes the blocks of another network, other options
    /// or another version instead of refusing them.
    ///
    /// # Errors
    /// The folder cannot be used, is in use, or belongs to another run; or its shards are not finished.
    pub fn in_folder(folder: &Path, manifest: &Manifest, restart: bool) -> Result<Self, StoreError> {
        Self::in_folder_as(Role::Alone { restart, make_missing: false }, folder, manifest)
    }

    /// Opens the store of a work directory, alone or as one of several shards.
    ///
    /// # Errors
    /// The folder cannot be used, is in use, or belongs to another run; or its shards are not finished.
    pub(crate) fn in_folder_as(role: Role, folder: &Path, manifest: &Manifest) -> Result<Self, StoreError> {
        let folder::Opened { own, others, keys } = folder::open(folder, manifest, role)?;
        let known = keys.into_iter().zip(0..).map(|(key, i)| (key.short(), RecordId(i))).collect();
        Ok(Self::new(Backend::Folder(folder.to_path_buf(), others, own), known))
    }

    /// Returns a value that all runs in a work directory share: the stored one, or that of `make`, which is then stored. `of`
    /// has its name and everything that it depends on. Without a work directory, `make` is called.
    ///
    /// # Errors
    /// That of `make`, or the folder cannot be used.
    pub(crate) fn once<T: Serialize + DeserializeOwned, E: From<StoreError>>(
        &self,
        (what, key): (&str, impl FnOnce() -> Key),
        progress: &dyn Progress,
        make: impl FnOnce() -> Result<T, E>,
    ) -> Result<T, E> {
        match &self.place {
            Backend::Folder(folder, ..) => once::once(folder, (what, key()), progress, make),
            Backend::Memory(_) | Backend::File(_) | Backend::Shelf(_) => make(),
        }
    }

    /// Marks a shard as done: all its blocks have been made or have failed.
    ///
    /// # Errors
    /// The mark cannot be written.
    pub(crate) fn mark_done(&self, shard: Shard) -> Result<(), StoreError> {
        let Backend::Folder(folder, _, own) = &self.place else { return Ok(()) };
        let write = || {
            own.sync()?;
            shards::mark(folder, shard, own.length())
        };
        write().map_err(|source| StoreError::Write { place: own.place(), source })
    }

    /// Returns the record of a key.
    pub(crate) fn find(&self, key: Key) -> Option<RecordId> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner).get(&key.short()).copied()
    }

    /// Stores a record, unless one with this key exists.
    ///
    /// # Errors
    /// The record cannot be written.
    pub(crate) fn keep(&self, key: Key, bytes: Vec<u8>) -> Result<RecordId, StoreError> {
        self.add(key, bytes).map(|(record, _)| record)
    }

    /// Stores a record, unless one with this key exists. The second value is true if it is new.
    fn add(&self, key: Key, bytes: Vec<u8>) -> Result<(RecordId, bool), StoreError> {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let slot = match known.entry(key.short()) {
            Entry::Occupied(record) => return Ok((*record.get(), false)),
            Entry::Vacant(slot) => slot,
        };
        let id = match &self.place {
            Backend::Memory(records) => {
                let mut records = records.write().unwrap_or_else(PoisonError::into_inner);
                records.push(Arc::new(bytes));
                records.len() - 1
            }
            Backend::File(log) => append(log, key, &bytes)?,
            Backend::Folder(_, others, own) => others.len() + append(own, key, &bytes)?,
            Backend::Shelf(_) => return Err(io::Error::from(io::ErrorKind::PermissionDenied).into()),
        };
        Ok((*slot.insert(RecordId(id as u32)), true))
    }

    /// Size of the records on disk, in bytes.
    pub fn bytes_on_disk(&self) -> u64 {
        match &self.place {
            Backend::Memory(_) => 0,
            Backend::File(log) => log.length(),
            Backend::Folder(_, others, own) => others.bytes() + own.length(),
            Backend::Shelf(others) => others.bytes(),
        }
    }

    /// The bytes of a record.
    pub(crate) fn bytes(&self, id: RecordId) -> StoredBytes<'_> {
        StoredBytes { store: self, id }
    }
}

fn append(log: &LogFile, key: Key, bytes: &[u8]) -> Result<usize, StoreError> {
    log.append(key, bytes).map_err(|source| StoreError::Write { place: log.place(), source })
}

/// The bytes of a record in a store.
#[derive(Clone, Copy, Debug)]
pub struct StoredBytes<'a> {
    store: &'a Store,
    id: RecordId,
}

impl Bytes for StoredBytes<'_> {
    fn count(&self) -> io::Result<u64> {
        let id = self.id.0 as usize;
        let count = match &self.store.place {
            Backend::Memory(records) => {
                let records = records.read().unwrap_or_else(PoisonError::into_inner);
                records.get(id).map(|record| record.len() as u64)
            }
            Backend::File(log) => log.bytes_of(id),
            Backend::Folder(_, others, own) => match id.checked_sub(others.len()) {
                None => others.bytes_of(id),
                Some(record) => own.bytes_of(record),
            },
            Backend::Shelf(others) => others.bytes_of(id),
        };
        count.ok_or_else(|| io::ErrorKind::NotFound.into())
    }

    fn get(&self, range: Range<u64>) -> io::Result<Piece> {
        let id = self.id.0 as usize;
        let bytes = match &self.store.place {
            Backend::Memory(records) => {
                let records = records.read().unwrap_or_else(PoisonError::into_inner);
                let record = Arc::clone(records.get(id).ok_or(io::ErrorKind::NotFound)?);
                return Piece::from(record).part(range).ok_or_else(|| io::ErrorKind::UnexpectedEof.into());
            }
            Backend::File(log) => log.read(id, range)?,
            Backend::Folder(_, others, own) => match id.checked_sub(others.len()) {
                None => others.read(id, range)?,
                Some(record) => own.read(record, range)?,
            },
            Backend::Shelf(others) => others.read(id, range)?,
        };
        Ok(bytes.into())
    }
}

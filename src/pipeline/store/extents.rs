//! Positions of records in the files of a work directory, for readers without the keys.
//!
//! Records are never moved nor changed. Positions stay valid while the files exist, even if other runs append records.

use std::ops::Range;
use std::path::{Path, PathBuf};

use rustc_hash::FxHashMap;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::error::StoreError;
use super::shelf::Shelf;
use super::{Backend, RecordId, Store, once};

/// Files, and the position of each record: its file, start and end.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Extents {
    /// Their names, as bytes.
    files: Vec<Vec<u8>>,
    places: Vec<(u32, u64, u64)>,
}

impl Extents {
    /// Number of records.
    pub(crate) fn len(&self) -> usize {
        self.places.len()
    }

    /// Returns the record with a number.
    pub(crate) fn record(number: usize) -> RecordId {
        RecordId(number as u32)
    }

    /// Files in a folder, and records in them. `None` if a name leads out of the folder.
    fn shelf(&self, folder: &Path) -> Option<Shelf> {
        let path = |name: &Vec<u8>| {
            let name = Path::new(std::str::from_utf8(name).ok()?);
            (name.file_name() == Some(name.as_os_str())).then(|| folder.join(name))
        };
        let files: Vec<PathBuf> = self.files.iter().map(path).collect::<Option<_>>()?;
        let extents = self.places.iter().map(|&(file, start, end)| {
            let is_sound = (file as usize) < files.len() && start <= end;
            is_sound.then_some((file, start..end))
        });
        let extents: Vec<(u32, Range<u64>)> = extents.collect::<Option<_>>()?;
        Some(Shelf::of(files, extents))
    }
}

impl Store {
    /// Positions of the records; `None` without a work directory.
    pub(crate) fn extents(&self, records: impl Iterator<Item = RecordId>) -> Option<Extents> {
        let Backend::Folder(_, others, own) = &self.place else { return None };
        let own_path = PathBuf::from(own.place());
        let mut numbers: FxHashMap<PathBuf, u32> = FxHashMap::default();
        let mut out = Extents::default();
        for RecordId(id) in records {
            let (path, extent) = match (id as usize).checked_sub(others.len()) {
                None => others.extent(id as usize)?,
                Some(record) => (own_path.as_path(), own.extent(record)?),
            };
            let known = numbers.len() as u32;
            let file = *numbers.entry(path.to_path_buf()).or_insert(known);
            if file == known {
                out.files.push(path.file_name()?.to_str()?.as_bytes().to_vec());
            }
            out.places.push((file, extent.start, extent.end));
        }
        Some(out)
    }

    /// Opens the records in the files of a folder, read-only. `None` if such files cannot exist.
    pub(crate) fn of_extents(folder: &Path, extents: &Extents) -> Option<Self> {
        Some(Self::new(Backend::Shelf(extents.shelf(folder)?), FxHashMap::default()))
    }

    /// Writes the positions to a work directory, replacing earlier ones.
    ///
    /// # Errors
    /// The file cannot be written.
    pub(crate) fn leave<T: Serialize>(&self, what: &str, value: &T) -> Result<(), StoreError> {
        let Backend::Folder(folder, ..) = &self.place else { return Ok(()) };
        let path = folder.join(format!("anastomesh.{what}"));
        once::write(&path, value).map_err(|source| StoreError::Write { place: path.display().to_string(), source })
    }

    /// Reads the positions from a folder; `None` if missing or damaged.
    pub(crate) fn left<T: DeserializeOwned>(folder: &Path, what: &str) -> Option<T> {
        once::read(&folder.join(format!("anastomesh.{what}")))
    }
}

//! Records in files that others have written: a run that joins shards reads those of all of them.

use std::fs::File;
use std::io;
use std::ops::Range;
use std::path::Path;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use super::log::read_exact_at;

/// Maximum number of open files. Systems allow few, and shards may be many.
const OPEN: usize = 128;

/// Records of any number of files, numbered through.
#[derive(Debug, Default)]
pub(super) struct Shelf {
    files: Vec<PathBuf>,
    /// File and place of each record.
    extents: Vec<(u32, Range<u64>)>,
    open: Mutex<Vec<(u32, Arc<File>)>>,
}

impl Shelf {
    /// Adds a file and the places of its records.
    pub(super) fn add(&mut self, path: PathBuf, records: impl Iterator<Item = Range<u64>>) {
        let file = self.files.len() as u32;
        self.files.push(path);
        self.extents.extend(records.map(|extent| (file, extent)));
    }

    /// The file of a record, and where it lies there.
    pub(super) fn extent(&self, record: usize) -> Option<(&Path, Range<u64>)> {
        let (file, extent) = self.extents.get(record)?;
        Some((self.files.get(*file as usize)?, extent.clone()))
    }

    /// Of records that lie in these files.
    pub(super) fn of(files: Vec<PathBuf>, extents: Vec<(u32, Range<u64>)>) -> Self {
        Self { files, extents, open: Mutex::default() }
    }

    /// Number of records.
    pub(super) fn len(&self) -> usize {
        self.extents.len()
    }

    /// Bytes of a record.
    pub(super) fn bytes_of(&self, record: usize) -> Option<u64> {
        self.extents.get(record).map(|(_, extent)| extent.end - extent.start)
    }

    /// Bytes of all records.
    pub(super) fn bytes(&self) -> u64 {
        self.extents.iter().map(|(_, extent)| extent.end - extent.start).sum()
    }

    /// Some bytes of a record.
    pub(super) fn read(&self, record: usize, range: Range<u64>) -> io::Result<Vec<u8>> {
        let fits = |(_, e): &&(u32, Range<u64>)| range.start <= range.end && range.end <= e.end - e.start;
        let place = self.extents.get(record).filter(fits);
        let (file, extent) = place.ok_or_else(|| io::Error::from(io::ErrorKind::UnexpectedEof))?;
        let mut bytes = vec![0; (range.end - range.start) as usize];
        self.read_at(*file, &mut bytes, extent.start + range.start)?;
        Ok(bytes)
    }

    #[cfg(unix)]
    fn read_at(&self, file: u32, bytes: &mut [u8], offset: u64) -> io::Result<()> {
        read_exact_at(&*self.file(file)?, bytes, offset)
    }

    /// Without reads at a place, a file of its own for each reader.
    #[cfg(not(unix))]
    fn read_at(&self, file: u32, bytes: &mut [u8], offset: u64) -> io::Result<()> {
        read_exact_at(&File::open(&self.files[file as usize])?, bytes, offset)
    }

    #[cfg(unix)]
    /// A file, opened unless it is open; the one that was opened longest ago is closed for it.
    fn file(&self, number: u32) -> io::Result<Arc<File>> {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, file)) = open.iter().find(|(n, _)| *n == number) {
            return Ok(Arc::clone(file));
        }
        let file = Arc::new(File::open(&self.files[number as usize])?);
        if open.len() == OPEN {
            open.remove(0);
        }
        open.push((number, Arc::clone(&file)));
        Ok(file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_files_than_may_be_open_are_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut shelf = Shelf::default();
        for i in 0..3 * OPEN {
            let path = folder.path().join(i.to_string());
            std::fs::write(&path, format!("file {i:04}")).expect("written");
            shelf.add(path, [0..4, 5..9].into_iter());
        }
        for i in (0..3 * OPEN).rev().chain(0..3 * OPEN) {
            assert_eq!(shelf.read(2 * i, 0..4).expect("readable"), b"file");
            assert_eq!(shelf.read(2 * i + 1, 1..4).expect("readable"), format!("{i:04}").as_bytes()[1..]);
        }
        let (path, extent) = shelf.extent(7).expect("a record");
        assert_eq!((path.to_path_buf(), extent), (folder.path().join("3"), 5..9));
        assert!(shelf.extent(6 * OPEN).is_none());
        assert!(shelf.read(0, 0..5).is_err() && shelf.read(6 * OPEN, 0..1).is_err());
        assert_eq!((shelf.len(), shelf.bytes()), (6 * OPEN, 24 * OPEN as u64));
    }
}

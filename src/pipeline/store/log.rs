//! Records in a file, one behind the other.
//!
//! A checksum detects a record that was not written completely. Such a record is cut off when the file is opened again, so
//! the program may be killed at any moment.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::Path;
use std::sync::{Mutex, PoisonError, RwLock};

use xxhash_rust::xxh3::xxh3_64_with_seed;

use super::key::Key;

/// Head of a record: a mark, the length of the data, its key, its checksum.
const HEAD: usize = 4 + 8 + 16 + 8;
const MARK: [u8; 4] = *b"blk1";

/// File of records.
#[derive(Debug)]
pub(super) struct LogFile {
    name: String,
    writer: Mutex<Writer>,
    reader: File,
    /// End of each record, which is the start of the next.
    ends: RwLock<Vec<u64>>,
    /// Held as long as the file is in use.
    _locks: Vec<File>,
}

#[derive(Debug)]
struct Writer {
    file: File,
    end: u64,
}

impl LogFile {
    /// Creates an unnamed file.
    pub(super) fn in_passing(folder: &Path) -> io::Result<Self> {
        let file = tempfile::tempfile_in(folder)?;
        Self::new(format!("{} (a file without a name)", folder.display()), file, 0, Vec::new(), Vec::new())
    }

    /// Opens a file, and returns it with the keys of its records in order. `locks` are held until it is closed.
    pub(super) fn open(path: &Path, locks: Vec<File>) -> io::Result<(Self, Vec<Key>)> {
        let file = File::options().read(true).write(true).create(true).truncate(false).open(path)?;
        let length = file.metadata()?.len();
        let Scanned { records, end, length } = scan(&file, length)?;
        if end < length {
            file.set_len(end)?;
        }
        let (keys, ends) = records.into_iter().map(|(key, extent)| (key, extent.end)).unzip();
        Ok((Self::new(path.display().to_string(), file, end, ends, locks)?, keys))
    }

    fn new(name: String, file: File, end: u64, ends: Vec<u64>, locks: Vec<File>) -> io::Result<Self> {
        let reader = file.try_clone()?;
        Ok(Self { name, writer: Mutex::new(Writer { file, end }), reader, ends: RwLock::new(ends), _locks: locks })
    }

    /// Name of the file in messages.
    pub(super) fn place(&self) -> String {
        self.name.clone()
    }

    /// Position of a record.
    pub(super) fn extent(&self, record: usize) -> Option<Range<u64>> {
        let ends = self.ends.read().unwrap_or_else(PoisonError::into_inner);
        let before = record.checked_sub(1).map_or(0, |before| ends.get(before).copied().unwrap_or(0));
        Some(before + HEAD as u64..*ends.get(record)?)
    }

    /// Bytes of a record.
    pub(super) fn bytes_of(&self, record: usize) -> Option<u64> {
        self.extent(record).map(|extent| extent.end - extent.start)
    }

    /// Size of its valid part, in bytes.
    pub(super) fn length(&self) -> u64 {
        self.writer.lock().unwrap_or_else(PoisonError::into_inner).end
    }

    /// Flushes the file to disk.
    pub(super) fn sync(&self) -> io::Result<()> {
        self.writer.lock().unwrap_or_else(PoisonError::into_inner).file.sync_data()
    }

    /// Appends a record, and returns its number. After an error, the file is unchanged.
    pub(super) fn append(&self, key: Key, bytes: &[u8]) -> io::Result<usize> {
        let head = head_of(key, bytes);
        let mut writer = self.writer.lock().unwrap_or_else(PoisonError::into_inner);
        let start = writer.end;
        // Locks of some file systems hold on one machine only.
        if writer.file.metadata()?.len() != start {
            return Err(io::Error::other("another run has written to it, too; its locks hold on one machine only"));
        }
        let written = write_at(&mut writer.file, start, &[&head, bytes]);
        if let Err(error) = written {
            // The next run would cut off the incomplete record as well.
            let _ = writer.file.set_len(start);
            return Err(error);
        }
        let first = start + HEAD as u64;
        writer.end = first + bytes.len() as u64;
        let mut ends = self.ends.write().unwrap_or_else(PoisonError::into_inner);
        ends.push(writer.end);
        Ok(ends.len() - 1)
    }

    /// Reads some bytes of a record.
    pub(super) fn read(&self, record: usize, range: Range<u64>) -> io::Result<Vec<u8>> {
        let extent = self.extent(record).filter(|e| range.start <= range.end && range.end <= e.end - e.start);
        let extent = extent.ok_or_else(|| io::Error::from(io::ErrorKind::UnexpectedEof))?;
        let mut bytes = vec![0; (range.end - range.start) as usize];
        self.read_at(&mut bytes, extent.start + range.start)?;
        Ok(bytes)
    }

    #[cfg(unix)]
    fn read_at(&self, bytes: &mut [u8], offset: u64) -> io::Result<()> {
        read_exact_at(&self.reader, bytes, offset)
    }

    /// Without positioned reads, readers and the writer share one position and take turns.
    #[cfg(not(unix))]
    fn read_at(&self, bytes: &mut [u8], offset: u64) -> io::Result<()> {
        let _turn = self.writer.lock().unwrap_or_else(PoisonError::into_inner);
        read_exact_at(&self.reader, bytes, offset)
    }
}

/// Reads at a position.
#[cfg(unix)]
pub(super) fn read_exact_at(file: &File, bytes: &mut [u8], offset: u64) -> io::Result<()> {
    std::os::unix::fs::FileExt::read_exact_at(file, bytes, offset)
}

/// Reads at a position, and moves the position of the file. Callers must take turns.
#[cfg(not(unix))]
pub(super) fn read_exact_at(mut file: &File, bytes: &mut [u8], offset: u64) -> io::Result<()> {
    file.seek(SeekFrom::Start(offset))?;
    file.read_exact(bytes)
}

fn write_at(file: &mut File, start: u64, pieces: &[&[u8]]) -> io::Result<()> {
    file.seek(SeekFrom::Start(start))?;
    pieces.iter().try_for_each(|piece| file.write_all(piece))
}

pub(super) fn checksum(key: Key, bytes: &[u8]) -> u64 {
    // Length and both halves of the key count too.
    let seed = key.0 as u64 ^ ((key.0 >> 64) as u64).rotate_left(32) ^ bytes.len() as u64;
    xxh3_64_with_seed(bytes, seed)
}

fn head_of(key: Key, bytes: &[u8]) -> [u8; HEAD] {
    let mut head = [0; HEAD];
    head[..4].copy_from_slice(&MARK);
    head[4..12].copy_from_slice(&(bytes.len() as u64).to_le_bytes());
    head[12..28].copy_from_slice(&key.0.to_le_bytes());
    head[28..].copy_from_slice(&checksum(key, bytes).to_le_bytes());
    head
}

/// Valid records at the beginning of a file.
pub(super) struct Scanned {
    pub records: Vec<(Key, Range<u64>)>,
    /// End of the records.
    pub end: u64,
    /// End of the file.
    pub length: u64,
}

/// Reads the records of a file; empty if the file does not exist.
pub(super) fn scan_path(path: &Path) -> io::Result<Scanned> {
    match File::open(path) {
        Ok(file) => scan(&file, file.metadata()?.len()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Scanned { records: Vec::new(), end: 0, length: 0 }),
        Err(error) => Err(error),
    }
}

fn scan(file: &File, length: u64) -> io::Result<Scanned> {
    let mut input = BufReader::with_capacity(1 << 20, file);
    input.seek(SeekFrom::Start(0))?;
    let (mut found, mut end, mut bytes) = (Vec::new(), 0, Vec::new());
    while length - end >= HEAD as u64 {
        let mut head = [0; HEAD];
        input.read_exact(&mut head)?;
        let (mark, rest) = head.split_at(4);
        let [size, low, high, sum] =
            [0, 8, 16, 24].map(|i| u64::from_le_bytes(rest[i..i + 8].try_into().unwrap_or_default()));
        if mark != MARK || size > length - end - HEAD as u64 {
            break;
        }
        bytes.resize(size as usize, 0);
        input.read_exact(&mut bytes)?;
        let key = Key(u128::from(high) << 64 | u128::from(low));
        if checksum(key, &bytes) != sum {
            break;
        }
        let first = end + HEAD as u64;
        end = first + size;
        found.push((key, first..end));
    }
    Ok(Scanned { records: found, end, length })
}

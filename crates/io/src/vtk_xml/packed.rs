//! Random access to raw or zlib-compressed arrays in a file, the counterpart of `blocks`.

use flate2::read::ZlibDecoder;
use rustc_hash::FxHashMap;
use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, Read};
use std::ops::Range;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// Values per block of a raw array.
const RAW_BLOCK: u64 = 98_304;

/// Maximum block size in bytes, as a block is held in memory as a whole.
const LARGEST_BLOCK: u64 = 1 << 28;

/// File with a cache of decompressed blocks.
#[derive(Debug)]
pub struct BlockFile {
    file: File,
    length: u64,
    kept: Mutex<Kept>,
}

/// Cached blocks by file offset, oldest first.
#[derive(Debug)]
struct Kept {
    blocks: FxHashMap<u64, Arc<Vec<u8>>>,
    order: VecDeque<u64>,
    bytes: usize,
    limit: usize,
}

/// Locations of an array's blocks.
#[derive(Clone, Debug)]
pub struct PackedArray {
    /// Start of each block, and end of the last one.
    starts: Vec<u64>,
    /// Decompressed bytes of each block except the last.
    block: u64,
    /// Decompressed bytes of all blocks.
    bytes: u64,
    /// Bytes per value.
    width: u64,
    /// True if the blocks are compressed.
    zlib: bool,
}

fn damaged(what: &'static str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what)
}

impl BlockFile {
    /// Opens a file with a block cache of about `limit` bytes.
    pub fn open(path: &Path, limit: usize) -> io::Result<Self> {
        let file = File::open(path)?;
        let length = file.metadata()?.len();
        let kept = Kept { blocks: FxHashMap::default(), order: VecDeque::new(), bytes: 0, limit };
        Ok(Self { file, length, kept: Mutex::new(kept) })
    }

    /// File size in bytes.
    pub fn length(&self) -> u64 {
        self.length
    }

    /// Reads a range of the file.
    pub fn bytes(&self, range: Range<u64>) -> io::Result<Vec<u8>> {
        if range.start > range.end || range.end > self.length {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        let mut bytes = vec![0; (range.end - range.start) as usize];
        self.read_at(&mut bytes, range.start)?;
        Ok(bytes)
    }

    #[cfg(unix)]
    fn read_at(&self, bytes: &mut [u8], offset: u64) -> io::Result<()> {
        std::os::unix::fs::FileExt::read_exact_at(&self.file, bytes, offset)
    }

    /// Without positioned reads, readers are serialized.
    #[cfg(not(unix))]
    fn read_at(&self, bytes: &mut [u8], offset: u64) -> io::Result<()> {
        let _turn = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let mut file = &self.file;
        io::Seek::seek(&mut file, io::SeekFrom::Start(offset))?;
        file.read_exact(bytes)
    }

    /// Locates the blocks of an array of `values` values of `width` bytes, from the little-endian 64-bit sizes before
    /// them.
    pub fn array(&self, offset: u64, values: u64, width: u64, zlib: bool) -> io::Result<PackedArray> {
        let bytes = values.checked_mul(width).ok_or_else(|| damaged("an array is too long"))?;
        let [count] = self.words::<1>(offset)?;
        if !zlib {
            return self.raw_array(offset, count, bytes, width);
        }
        if count == 0 && bytes == 0 {
            return Ok(PackedArray { starts: vec![offset], block: 1, bytes, width, zlib });
        }
        let [_, block, last] = self.words::<3>(offset)?;
        let full = count.checked_sub(u64::from(last > 0)).and_then(|full| full.checked_mul(block));
        let is_whole = full.and_then(|full| full.checked_add(last)) == Some(bytes);
        if !is_whole || last >= block.max(1) || block > LARGEST_BLOCK || block == 0 || block % width != 0 {
            return Err(damaged("the blocks of an array have other sizes than its values"));
        }
        let table = offset + 24;
        let end = count.checked_mul(8).and_then(|bytes| bytes.checked_add(table));
        let sizes = self.bytes(table..end.ok_or(io::ErrorKind::UnexpectedEof)?)?;
        let (sizes, _) = sizes.as_chunks::<8>();
        let mut starts = vec![table + 8 * count];
        for size in sizes.iter().map(|size| u64::from_le_bytes(*size)) {
            // Incompressible data grow by less than this.
            if size > 2 * block + 1024 {
                return Err(damaged("a block of an array is larger than its values"));
            }
            let start = starts[starts.len() - 1].checked_add(size);
            starts.push(start.filter(|&end| end <= self.length).ok_or(io::ErrorKind::UnexpectedEof)?);
        }
        Ok(PackedArray { starts, block, bytes, width, zlib })
    }

    /// Locates a raw array, whose size must match the number before it.
    fn raw_array(&self, offset: u64, said: u64, bytes: u64, width: u64) -> io::Result<PackedArray> {
        if said != bytes {
            return Err(damaged("an array has another size than its values"));
        }
        let (first, block) = (offset + 8, RAW_BLOCK * width);
        let end = first.checked_add(bytes).filter(|&end| end <= self.length).ok_or(io::ErrorKind::UnexpectedEof)?;
        let starts = (first..end).step_by(block as usize).chain([end]).collect();
        Ok(PackedArray { starts, block, bytes, width, zlib: false })
    }

    fn words<const N: usize>(&self, offset: u64) -> io::Result<[u64; N]> {
        let end = offset.checked_add(8 * N as u64).ok_or(io::ErrorKind::UnexpectedEof)?;
        let bytes = self.bytes(offset..end)?;
        let (words, _) = bytes.as_chunks::<8>();
        let mut out = [0; N];
        for (out, word) in out.iter_mut().zip(words) {
            *out = u64::from_le_bytes(*word);
        }
        Ok(out)
    }

    /// Reads a range of values.
    pub fn values(&self, array: &PackedArray, values: Range<u64>) -> io::Result<Vec<u8>> {
        let (mut start, end) = (values.start * array.width, values.end * array.width);
        if start > end || end > array.bytes {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        let mut out = Vec::with_capacity((end - start) as usize);
        while start < end {
            let index = start / array.block;
            let first = index * array.block;
            let block = self.kept_block(array, index)?;
            let upto = (end - first).min(block.len() as u64);
            out.extend_from_slice(&block[(start - first) as usize..upto as usize]);
            start = first + upto;
        }
        Ok(out)
    }

    fn kept_block(&self, array: &PackedArray, index: u64) -> io::Result<Arc<Vec<u8>>> {
        let key = array.starts[index as usize];
        if let Some(block) = self.kept.lock().unwrap_or_else(PoisonError::into_inner).blocks.get(&key) {
            return Ok(Arc::clone(block));
        }
        let block = Arc::new(self.block(array, index)?);
        self.kept.lock().unwrap_or_else(PoisonError::into_inner).keep(key, &block);
        Ok(block)
    }

    /// Reads and decompresses a block.
    pub fn block(&self, array: &PackedArray, index: u64) -> io::Result<Vec<u8>> {
        let i = index as usize;
        let packed = self.bytes(array.starts[i]..array.starts[i + 1])?;
        if !array.zlib {
            return Ok(packed);
        }
        let expected = (array.bytes - index * array.block).min(array.block);
        let mut out = Vec::new();
        // The buffer grows with the actual data, so a damaged file allocates no more.
        ZlibDecoder::new(&packed[..]).take(expected + 1).read_to_end(&mut out)?;
        if out.len() as u64 == expected {
            Ok(out)
        } else {
            Err(damaged("a block has another size than its array says"))
        }
    }
}

impl PackedArray {
    /// Number of blocks.
    pub fn blocks(&self) -> u64 {
        self.starts.len() as u64 - 1
    }

    /// Index of the first value of a block.
    pub fn first_value(&self, block: u64) -> u64 {
        block * (self.block / self.width)
    }
}

impl Kept {
    fn keep(&mut self, key: u64, block: &Arc<Vec<u8>>) {
        if self.blocks.insert(key, Arc::clone(block)).is_some() {
            return;
        }
        self.order.push_back(key);
        self.bytes += block.len();
        while self.bytes > self.limit
            && let Some(oldest) = self.order.pop_front()
        {
            self.bytes -= self.blocks.remove(&oldest).map_or(0, |block| block.len());
        }
    }
}

#[cfg(test)]
#[path = "packed_tests.rs"]
mod tests;

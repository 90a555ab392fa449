//! Bytes of a record, read in pieces.

use std::io;
use std::ops::{Deref, Range};
use std::sync::Arc;

use anastomesh_mesh::geometry::Point3;

/// Source of a record's bytes.
pub trait Bytes {
    /// Number of bytes.
    ///
    /// # Errors
    /// The record does not exist.
    fn count(&self) -> io::Result<u64>;

    /// Reads a range of bytes.
    ///
    /// # Errors
    /// The range cannot be read or does not exist.
    fn get(&self, range: Range<u64>) -> io::Result<Piece>;
}

impl Bytes for &[u8] {
    fn count(&self) -> io::Result<u64> {
        Ok(self.len() as u64)
    }

    fn get(&self, range: Range<u64>) -> io::Result<Piece> {
        let bytes = <[u8]>::get(self, range.start as usize..range.end as usize).ok_or_else(cut_short)?;
        Ok(Piece::from(bytes.to_vec()))
    }
}

/// Some bytes of a record. A record in memory is not copied.
#[derive(Clone, Debug)]
pub struct Piece {
    whole: Arc<Vec<u8>>,
    range: Range<usize>,
}

impl Piece {
    /// A range of it; `None` if it is out of bounds.
    pub fn part(&self, range: Range<u64>) -> Option<Self> {
        let range =
            self.range.start.checked_add(range.start as usize)?..self.range.start.checked_add(range.end as usize)?;
        let is_within = range.start <= range.end && range.end <= self.range.end;
        is_within.then(|| Self { whole: Arc::clone(&self.whole), range })
    }
}

impl From<Arc<Vec<u8>>> for Piece {
    fn from(whole: Arc<Vec<u8>>) -> Self {
        Self { range: 0..whole.len(), whole }
    }
}

impl From<Vec<u8>> for Piece {
    fn from(bytes: Vec<u8>) -> Self {
        Arc::new(bytes).into()
    }
}

impl Deref for Piece {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.whole[self.range.clone()]
    }
}

/// Bytes read at once: all of most records, and the most requested sections of large ones.
const FIRST: u64 = 1 << 14;

/// Record whose first bytes have been read.
#[derive(Clone, Debug)]
pub(super) struct Opened<B> {
    bytes: B,
    first: Piece,
    count: u64,
}

impl<B: Bytes> Opened<B> {
    pub fn new(bytes: B) -> io::Result<Self> {
        let count = bytes.count()?;
        let first = bytes.get(0..count.min(FIRST))?;
        Ok(Self { bytes, first, count })
    }

    /// Fails if the record ends before `end`. So no later request allocates more than a record has.
    pub fn reaches(&self, end: u64) -> io::Result<()> {
        if end <= self.count { Ok(()) } else { Err(cut_short()) }
    }

    /// Reads a range of bytes.
    pub fn range(&self, range: Range<u64>) -> io::Result<Piece> {
        self.first.part(range.clone()).map_or_else(|| self.bytes.get(range), Ok)
    }
}

/// Ranges of the sections after a head, from their counts and the bytes of each item.
pub(super) fn sections<const N: usize>(head: usize, lengths: [(u32, usize); N]) -> [Range<u64>; N] {
    let mut end = head as u64;
    lengths.map(|(count, width)| {
        let start = end;
        end += u64::from(count) * width as u64;
        start..end
    })
}

pub(super) fn cut_short() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "the record of a block is cut short")
}

pub(super) fn damaged() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "the record of a block does not fit together")
}

pub(super) fn put(out: &mut Vec<u8>, values: &[u32]) {
    put_each(out, values, u32::to_le_bytes);
}

pub(super) fn put_each<const N: usize>(out: &mut Vec<u8>, values: &[u32], bytes: impl Fn(u32) -> [u8; N]) {
    let start = out.len();
    out.resize(start + N * values.len(), 0);
    let slots = out[start..].as_chunks_mut().0;
    slots.iter_mut().zip(values).for_each(|(slot, &v)| *slot = bytes(v));
}

pub(super) fn put_point(out: &mut Vec<u8>, p: &Point3) {
    p.iter().for_each(|x| out.extend_from_slice(&x.to_le_bytes()));
}

pub(super) fn words(bytes: &[u8]) -> Vec<u32> {
    bytes.as_chunks().0.iter().map(|&b| u32::from_le_bytes(b)).collect()
}

pub(super) fn doubles(bytes: &[u8]) -> Vec<f64> {
    bytes.as_chunks().0.iter().map(|&b| f64::from_le_bytes(b)).collect()
}

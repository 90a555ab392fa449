//! Filled pieces of tissue in the store of blocks.

use std::io;
use std::ops::Range;

use anastomesh_domain::Shelf;

use super::{Key, RecordId, Store};
use crate::block::Bytes;

impl Shelf for Store {
    fn find(&self, key: u128) -> Option<u64> {
        Self::find(self, Key(key)).map(|record| record.index() as u64)
    }

    fn keep(&self, key: u128, bytes: Vec<u8>) -> io::Result<u64> {
        Self::keep(self, Key(key), bytes).map(|record| record.index() as u64).map_err(io::Error::other)
    }

    fn read(&self, record: u64, range: Range<u64>) -> io::Result<Vec<u8>> {
        self.bytes(RecordId(record as u32)).get(range).map(|piece| piece.to_vec())
    }
}

//! Finished blocks in the store. A block has a record of its geometry, and shares that of its connectivity with others.

use std::io;
use std::sync::atomic::Ordering;

use super::{Key, RecordId, Store, StoreError, StoredBytes};
use crate::block::{Connectivity, Encoded, Finished, Geometry, Record};

/// Both records of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BlockRecords {
    pub geometry: RecordId,
    pub connectivity: RecordId,
}

impl Store {
    /// Stores a block, unless one with this key exists. Its connectivity comes first, so that every complete block has one.
    ///
    /// # Errors
    /// The block cannot be written.
    pub(crate) fn keep_block(&self, key: Key, block: &Finished) -> Result<BlockRecords, StoreError> {
        let Encoded { connectivity, hash, geometry } = Encoded::of(block)?;
        let connectivity = self.keep(Key(hash), connectivity)?;
        let (geometry, is_new) = self.add(key, geometry)?;
        self.made.fetch_add(usize::from(is_new), Ordering::Relaxed);
        Ok(BlockRecords { geometry, connectivity })
    }

    /// Number of blocks that this run has added.
    pub(crate) fn blocks_made(&self) -> usize {
        self.made.load(Ordering::Relaxed)
    }

    /// Returns the block of a key; `None` if it or its connectivity is missing.
    ///
    /// # Errors
    /// The block cannot be read.
    pub(crate) fn find_block(&self, key: Key) -> io::Result<Option<BlockRecords>> {
        let Some(geometry) = self.find(key) else { return Ok(None) };
        let connectivity = self.find(Key(self.geometry(geometry)?.connectivity()));
        Ok(connectivity.map(|connectivity| BlockRecords { geometry, connectivity }))
    }

    /// Reads the head of a block's geometry.
    ///
    /// # Errors
    /// The record cannot be read.
    pub(crate) fn geometry(&self, geometry: RecordId) -> io::Result<Geometry<StoredBytes<'_>>> {
        Geometry::open(self.bytes(geometry))
    }

    /// Reads the head of a block's connectivity.
    ///
    /// # Errors
    /// The record cannot be read.
    pub(crate) fn connectivity(&self, connectivity: RecordId) -> io::Result<Connectivity<StoredBytes<'_>>> {
        Connectivity::open(self.bytes(connectivity))
    }

    /// Reads the heads of a block.
    ///
    /// # Errors
    /// A record cannot be read.
    pub(crate) fn block(&self, records: BlockRecords) -> io::Result<Record<StoredBytes<'_>>> {
        Record::open(self.bytes(records.connectivity), self.bytes(records.geometry))
    }
}

#[cfg(test)]
mod tests {
    use super::super::Manifest;
    use super::super::key::KeyMaker;
    use super::*;
    use anastomesh_mesh::TetMesh;
    use anastomesh_mesh::geometry::Point3;
    use anastomesh_skeleton::Skeleton;

    fn key(i: u32) -> Key {
        let mut maker = KeyMaker::new("test");
        maker.id(i);
        maker.finish()
    }

    fn open(folder: &std::path::Path) -> Store {
        Store::in_folder(folder, &Manifest::new(&Skeleton::default(), serde_json::Value::Null), false)
            .expect("a folder")
    }

    /// One tetrahedron of a given size, with another wall for odd sizes.
    fn block(size: u32) -> Finished {
        let edge = f64::from(size + 1);
        let points = [[0.0; 3], [edge, 0.0, 0.0], [0.0, edge, 0.0], [0.0, 0.0, edge]].map(Point3::from).to_vec();
        let wall = (size % 2..4).collect();
        Finished { mesh: TetMesh { points, tets: vec![[0, 1, 2, 3]] }, wall, ..Finished::default() }
    }

    #[test]
    fn equal_connectivity_is_stored_once() {
        let folder = tempfile::tempdir().expect("a folder");
        for store in [Store::in_memory(), open(folder.path())] {
            let kept = [0, 1, 2, 3, 2].map(|i| store.keep_block(key(i), &block(i)).expect("kept"));
            assert_eq!(store.blocks_made(), 4);
            assert_eq!(kept[4], kept[2]);
            let same = |a: usize, b: usize| kept[a].connectivity == kept[b].connectivity;
            assert!(same(0, 2) && same(1, 3) && !same(0, 1));
            for (i, records) in (0..).zip(&kept[..4]) {
                assert_eq!(store.find_block(key(i)).expect("readable"), Some(*records));
                assert_eq!(store.block(*records).and_then(|record| record.block()).expect("readable"), block(i));
            }
            assert_eq!(store.find_block(key(4)).expect("readable"), None);
        }
    }

    #[test]
    fn blocks_that_were_not_written_completely_are_not_found() {
        let folder = tempfile::tempdir().expect("a folder");
        open(folder.path()).keep_block(key(0), &block(0)).expect("kept");
        let path = folder.path().join("anastomesh.blocks");
        let whole = std::fs::read(&path).expect("blocks");
        for length in 0..whole.len() {
            std::fs::write(&path, &whole[..length]).expect("written");
            let store = open(folder.path());
            assert_eq!(store.find_block(key(0)).expect("readable"), None, "{length}");
            let kept = store.keep_block(key(0), &block(0)).expect("kept");
            assert_eq!(store.find_block(key(0)).expect("readable"), Some(kept));
            drop(store);
            assert_eq!(std::fs::read(&path).expect("blocks"), whole);
        }
        // A geometry without connectivity, as in a damaged shard.
        let Encoded { connectivity, hash, geometry } = Encoded::of(&block(1)).expect("encoded");
        let store = open(folder.path());
        store.keep(key(1), geometry).expect("kept");
        assert_eq!(store.find_block(key(1)).expect("readable"), None);
        store.keep(Key(hash), connectivity).expect("kept");
        assert!(store.find_block(key(1)).expect("readable").is_some());
    }
}

//! Storage for filled pieces of tissue.

use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::Point3;
use rustc_hash::FxHashMap;
use std::io;
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};
use xxhash_rust::xxh3::Xxh3;

/// Storage of records, which are found by a key. `read` may be called for all records that are kept or found.
pub trait Shelf: Sync {
    /// Record with a key, if one is kept.
    fn find(&self, key: u128) -> Option<u64>;

    /// Keeps a record.
    ///
    /// # Errors
    /// Errors of writing.
    fn keep(&self, key: u128, bytes: Vec<u8>) -> io::Result<u64>;

    /// Some bytes of a record.
    ///
    /// # Errors
    /// Errors of reading.
    fn read(&self, record: u64, range: Range<u64>) -> io::Result<Vec<u8>>;
}

/// Storage in memory.
#[derive(Debug, Default)]
pub struct MemoryShelf(Mutex<Records>);

#[derive(Debug, Default)]
struct Records {
    all: Vec<Vec<u8>>,
    known: FxHashMap<u128, u64>,
}

impl MemoryShelf {
    fn records(&self) -> MutexGuard<'_, Records> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Shelf for MemoryShelf {
    fn find(&self, key: u128) -> Option<u64> {
        self.records().known.get(&key).copied()
    }

    fn keep(&self, key: u128, bytes: Vec<u8>) -> io::Result<u64> {
        let mut records = self.records();
        let record = records.all.len() as u64;
        records.all.push(bytes);
        records.known.insert(key, record);
        Ok(record)
    }

    fn read(&self, record: u64, range: Range<u64>) -> io::Result<Vec<u8>> {
        let records = self.records();
        let bytes = records.all.get(record as usize).and_then(|all| all.get(range.start as usize..range.end as usize));
        bytes.map(<[u8]>::to_vec).ok_or_else(|| io::ErrorKind::UnexpectedEof.into())
    }
}

/// Key of a filled surface, with the options in `text`.
pub fn key_of(text: &str, surface: &TriMesh) -> u128 {
    let mut hash = Xxh3::new();
    hash.update(text.as_bytes());
    for p in &surface.points {
        p.iter().for_each(|x| hash.update(&x.to_le_bytes()));
    }
    for v in surface.triangles.as_flattened() {
        hash.update(&v.to_le_bytes());
    }
    hash.digest128()
}

/// Filled piece in a shelf.
#[derive(Clone, Copy, Debug)]
pub struct Filled {
    record: u64,
    /// Points inside.
    pub points: u32,
    /// Tetrahedra.
    pub tets: u32,
}

/// Bytes of the numbers of points and tetrahedra, of a point, and of a tetrahedron. All numbers are little-endian.
const HEAD: u64 = 8;
const POINT: u64 = 24;
const TET: u64 = 16;

impl Filled {
    /// Keeps the points inside a piece and its tetrahedra.
    ///
    /// # Errors
    /// Errors of writing.
    pub fn keep(shelf: &dyn Shelf, key: u128, points: &[Point3], tets: &[[u32; 4]]) -> io::Result<Self> {
        let size = HEAD + POINT * points.len() as u64 + TET * tets.len() as u64;
        let mut bytes = Vec::with_capacity(size as usize);
        bytes.extend((points.len() as u32).to_le_bytes());
        bytes.extend((tets.len() as u32).to_le_bytes());
        bytes.extend(points.iter().flat_map(|p| [p.x, p.y, p.z]).flat_map(f64::to_le_bytes));
        bytes.extend(tets.as_flattened().iter().flat_map(|v| v.to_le_bytes()));
        let record = shelf.keep(key, bytes)?;
        Ok(Self { record, points: points.len() as u32, tets: tets.len() as u32 })
    }

    /// Finds the piece with a key.
    ///
    /// # Errors
    /// Errors of reading.
    pub fn find(shelf: &dyn Shelf, key: u128) -> io::Result<Option<Self>> {
        let Some(record) = shelf.find(key) else { return Ok(None) };
        match shelf.read(record, 0..HEAD)?.as_chunks::<4>().0 {
            [points, tets] => {
                let [points, tets] = [points, tets].map(|n| u32::from_le_bytes(*n));
                Ok(Some(Self { record, points, tets }))
            }
            _ => Err(io::ErrorKind::UnexpectedEof.into()),
        }
    }

    /// Points inside.
    ///
    /// # Errors
    /// Errors of reading.
    pub fn points(&self, shelf: &dyn Shelf) -> io::Result<Vec<Point3>> {
        let bytes = shelf.read(self.record, HEAD..self.end_of_points())?;
        let (numbers, _) = bytes.as_chunks::<8>();
        Ok(numbers.as_chunks::<3>().0.iter().map(|p| Point3::from(p.map(f64::from_le_bytes))).collect())
    }

    /// Tetrahedra. Points of the surface come before those inside.
    ///
    /// # Errors
    /// Errors of reading.
    pub fn tets(&self, shelf: &dyn Shelf) -> io::Result<Vec<[u32; 4]>> {
        let first = self.end_of_points();
        let bytes = shelf.read(self.record, first..first + TET * u64::from(self.tets))?;
        let (numbers, _) = bytes.as_chunks::<4>();
        Ok(numbers.as_chunks::<4>().0.iter().map(|tet| tet.map(u32::from_le_bytes)).collect())
    }

    fn end_of_points(&self) -> u64 {
        HEAD + POINT * u64::from(self.points)
    }
}

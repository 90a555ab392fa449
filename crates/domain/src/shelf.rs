//! Storage for filled pieces of tissue.

use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::Point3;
use std::io;
use std::ops::Range;

/// Storage of records, which are found by a key.
pub trait Shelf: Sync {
    /// Key of the result for a surface with the options in `text`.
    fn key(&self, text: &str, surface: &TriMesh) -> u128;

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

/// Layout of a record: the numbers of points and tetrahedra, the points, and the tetrahedra. All numbers are little-endian.
pub struct Filled;

impl Filled {
    /// Bytes before the points.
    pub const HEAD: u64 = 8;
    /// Bytes of a point.
    pub const POINT: u64 = 24;
    /// Bytes of a tetrahedron.
    pub const TET: u64 = 16;

    /// Record of these points and tetrahedra.
    pub fn bytes(points: &[Point3], tets: &[[u32; 4]]) -> Vec<u8> {
        let size = Self::HEAD + Self::POINT * points.len() as u64 + Self::TET * tets.len() as u64;
        let mut bytes = Vec::with_capacity(size as usize);
        bytes.extend((points.len() as u32).to_le_bytes());
        bytes.extend((tets.len() as u32).to_le_bytes());
        bytes.extend(points.iter().flat_map(|p| [p.x, p.y, p.z]).flat_map(f64::to_le_bytes));
        bytes.extend(tets.as_flattened().iter().flat_map(|v| v.to_le_bytes()));
        bytes
    }

    /// Numbers of points and tetrahedra of a record that begins with these bytes.
    ///
    /// # Errors
    /// `UnexpectedEof` for fewer bytes.
    pub fn counts(head: &[u8]) -> io::Result<[u32; 2]> {
        match Self::numbers(head)[..] {
            [points, tets, ..] => Ok([points, tets]),
            _ => Err(io::ErrorKind::UnexpectedEof.into()),
        }
    }

    /// Points in their bytes.
    pub fn points(bytes: &[u8]) -> Vec<Point3> {
        let (numbers, _) = bytes.as_chunks::<8>();
        let (points, _) = numbers.as_chunks::<3>();
        points.iter().map(|p| Point3::from(p.map(f64::from_le_bytes))).collect()
    }

    /// Tetrahedra in their bytes.
    pub fn tets(bytes: &[u8]) -> Vec<[u32; 4]> {
        let (tets, _) = bytes.as_chunks::<4>();
        tets.as_chunks::<4>().0.iter().map(|tet| tet.map(u32::from_le_bytes)).collect()
    }

    fn numbers(bytes: &[u8]) -> Vec<u32> {
        bytes.as_chunks::<4>().0.iter().map(|x| u32::from_le_bytes(*x)).collect()
    }
}

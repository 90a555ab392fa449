//! Binary records of finished blocks, with access to single sections.
//!
//! A block has two records: its [`Connectivity`], and its [`Geometry`], which begins with a hash of the connectivity. All images
//! of a template have the same connectivity, so it is stored once. It is more than half of a block.
//!
//! Format: little-endian. A head of counts precedes the sections, whose lengths follow from the counts.

mod bytes;
mod connectivity;
mod geometry;
#[cfg(test)]
mod tests;

use std::io;

use xxhash_rust::xxh3::xxh3_128_with_seed;

use super::finished::{Finished, FinishedCap};
use anastomesh_mesh::TetMesh;
pub use bytes::{Bytes, Piece};
pub use connectivity::{Connectivity, Sizes};
pub use geometry::Geometry;

/// Seed of the hash, which keeps it apart from hashes of other data.
const SEED: u64 = 0x636f_6e6e_6563_7473;

/// Encoded block.
#[derive(Clone, Debug)]
pub struct Encoded {
    pub connectivity: Vec<u8>,
    /// Hash of the connectivity.
    pub hash: u128,
    pub geometry: Vec<u8>,
}

impl Encoded {
    /// Encodes a block.
    ///
    /// # Errors
    /// The report data cannot be serialized.
    pub fn of(block: &Finished) -> io::Result<Self> {
        let connectivity = connectivity::encode(block);
        let hash = xxh3_128_with_seed(&connectivity, SEED);
        Ok(Self { geometry: geometry::encode(block, hash)?, connectivity, hash })
    }
}

/// Both records of a block.
#[derive(Clone, Debug)]
pub struct Record<B> {
    pub connectivity: Connectivity<B>,
    pub geometry: Geometry<B>,
}

impl<B: Bytes> Record<B> {
    /// Reads the heads.
    ///
    /// # Errors
    /// A head cannot be read, a record is shorter than its head says, or the records do not belong together.
    pub fn open(connectivity: B, geometry: B) -> io::Result<Self> {
        let record = Self { connectivity: Connectivity::open(connectivity)?, geometry: Geometry::open(geometry)? };
        let Sizes { points, caps, .. } = record.connectivity.sizes();
        let belong = (points, caps) == (record.geometry.points, record.geometry.caps);
        if belong { Ok(record) } else { Err(bytes::damaged()) }
    }

    /// Reads the caps.
    ///
    /// # Errors
    /// The sections cannot be read.
    pub fn caps(&self) -> io::Result<Vec<FinishedCap>> {
        let caps = self.geometry.caps()?.into_iter().zip(self.connectivity.caps()?);
        Ok(caps.map(|((node, section), faces)| FinishedCap { node, section, faces }).collect())
    }

    /// Reads the whole block.
    ///
    /// # Errors
    /// A section cannot be read.
    pub fn block(&self) -> io::Result<Finished> {
        let Self { connectivity, geometry } = self;
        let (certificate, about) = geometry.notes()?;
        Ok(Finished {
            mesh: TetMesh { points: geometry.points()?, tets: connectivity.tets()? },
            hull: connectivity.hull()?,
            shared: connectivity.sizes().shared,
            wall: connectivity.wall()?,
            joints: connectivity.joints()?,
            caps: self.caps()?,
            certificate,
            about,
        })
    }
}

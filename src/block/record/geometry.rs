//! Record of what a block shares with no other: its points, caps, certificate and report data.
//!
//! A head has the hash of the connectivity and three counts. The sections are
//!
//! - certificate and report data (postcard)
//! - caps: node, origin, axis, radius
//! - points (3 × f64)

use std::io;

use super::bytes::{Bytes, Opened, damaged, doubles, put, put_point, sections, words};
use crate::block::finished::{About, Finished, FinishedCap};
use anastomesh_mesh::check::parts::Certificate;
use anastomesh_mesh::geometry::{Point3, Section, Vec3};
use anastomesh_skeleton::NodeId;

const HASH: usize = 16;
const HEAD: usize = HASH + 3 * 4;
const CAP: usize = 4 + 7 * 8;

/// Encodes the geometry of a block. `connectivity`: hash of its connectivity.
pub(super) fn encode(block: &Finished, connectivity: u128) -> io::Result<Vec<u8>> {
    let notes = postcard::to_stdvec(&(&block.certificate, &block.about)).map_err(io::Error::other)?;
    let counts = [notes.len(), block.caps.len(), block.mesh.points.len()];
    let mut out = Vec::with_capacity(HEAD + notes.len() + CAP * counts[1] + 24 * counts[2]);
    out.extend_from_slice(&connectivity.to_le_bytes());
    put(&mut out, &counts.map(|count| count as u32));
    out.extend_from_slice(&notes);
    for FinishedCap { node, section: Section { origin, axis, radius, .. }, .. } in &block.caps {
        put(&mut out, &[node.0]);
        put_point(&mut out, origin);
        put_point(&mut out, &Point3::from(*axis));
        out.extend_from_slice(&radius.to_le_bytes());
    }
    block.mesh.points.iter().for_each(|p| put_point(&mut out, p));
    Ok(out)
}

/// Geometry whose sections are read on demand.
#[derive(Clone, Debug)]
pub struct Geometry<B> {
    record: Opened<B>,
    connectivity: u128,
    notes: u32,
    pub(super) caps: u32,
    pub(super) points: u32,
}

impl<B: Bytes> Geometry<B> {
    /// Reads the head.
    ///
    /// # Errors
    /// The head cannot be read, or the record is shorter than it says.
    pub fn open(bytes: B) -> io::Result<Self> {
        let record = Opened::new(bytes)?;
        let head = record.range(0..HEAD as u64)?;
        let (hash, counts) = head.split_at(HASH);
        let connectivity = u128::from_le_bytes(hash.try_into().map_err(|_| damaged())?);
        let [notes, caps, points] = words(counts).try_into().map_err(|_| damaged())?;
        let opened = Self { record, connectivity, notes, caps, points };
        opened.record.reaches(opened.sections()[2].end)?;
        Ok(opened)
    }

    fn sections(&self) -> [std::ops::Range<u64>; 3] {
        sections(HEAD, [(self.notes, 1), (self.caps, CAP), (self.points, 24)])
    }

    /// Hash of the connectivity.
    pub fn connectivity(&self) -> u128 {
        self.connectivity
    }

    /// Reads certificate and report data.
    ///
    /// # Errors
    /// The section cannot be read.
    pub fn notes(&self) -> io::Result<(Certificate, About)> {
        let [notes, ..] = self.sections();
        postcard::from_bytes(&self.record.range(notes)?).map_err(io::Error::other)
    }

    /// Reads the caps, without their faces.
    ///
    /// # Errors
    /// The section cannot be read.
    pub(super) fn caps(&self) -> io::Result<Vec<(NodeId, Section)>> {
        let [_, caps, _] = self.sections();
        let bytes = self.record.range(caps)?;
        let cap = |bytes: &[u8; CAP]| {
            let (node, floats) = bytes.split_at(4);
            let [ox, oy, oz, ax, ay, az, radius] = doubles(floats)[..] else { return Err(damaged()) };
            let section = Section::new(Point3::new(ox, oy, oz), Vec3::new(ax, ay, az), radius);
            Ok((NodeId(words(node)[0]), section))
        };
        bytes.as_chunks().0.iter().map(cap).collect()
    }

    /// Reads the points.
    ///
    /// # Errors
    /// The section cannot be read.
    pub fn points(&self) -> io::Result<Vec<Point3>> {
        let [_, _, points] = self.sections();
        Ok(self.record.range(points)?.as_chunks().0.iter().map(point).collect())
    }

    /// Reads some points.
    ///
    /// # Errors
    /// The section cannot be read, or a point is missing.
    pub fn points_at(&self, vertices: &[u32]) -> io::Result<Vec<Point3>> {
        let [_, _, points] = self.sections();
        let bytes = self.record.range(points)?;
        let all = bytes.as_chunks().0;
        let mut points = Vec::with_capacity(vertices.len());
        for &v in vertices {
            points.push(all.get(v as usize).map(point).ok_or_else(damaged)?);
        }
        Ok(points)
    }
}

fn point(bytes: &[u8; 24]) -> Point3 {
    let [x, y, z] = [0, 8, 16].map(|i| f64::from_le_bytes(std::array::from_fn(|k| bytes[i + k])));
    Point3::new(x, y, z)
}

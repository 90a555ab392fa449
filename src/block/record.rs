//! Binary records of finished blocks, with access to single sections.
//!
//! Format: little-endian. A head of [`HEAD`] counts precedes the sections, whose lengths follow from the counts.
//! The sections are
//!
//! - certificate and report data (postcard)
//! - sizes of the joints, their vertices, their faces
//! - caps and their faces
//! - wall
//! - points (3 × f64)
//! - tetrahedra and hull triangles (u16 for small point counts, else u32)

use std::io;
use std::ops::{Deref, Range};
use std::sync::Arc;

use super::finished::{About, Finished, FinishedCap};
use super::topology::FinishedJoint;
use anastomesh_mesh::TetMesh;
use anastomesh_mesh::adjacency::face_vertices;
use anastomesh_mesh::check::parts::Certificate;
use anastomesh_mesh::geometry::{Point3, Section, Vec3};
use anastomesh_skeleton::NodeId;

/// Number of counts in the head.
const HEAD: usize = 11;

/// Bytes of a cap before its faces: node, number of faces, origin, axis, radius.
const CAP: usize = 2 * 4 + 7 * 8;

/// Sizes of a finished block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Sizes {
    /// Points, including shared ones.
    pub points: u32,
    /// Points that other blocks refer to.
    pub shared: u32,
    /// Tetrahedra.
    pub tets: u32,
    /// Faces of the wall.
    pub wall: u32,
    pub joints: u32,
    /// Vertices of all joints.
    pub joint_vertices: u32,
    /// Faces of all joints.
    pub joint_faces: u32,
    pub caps: u32,
    /// Faces of all caps.
    pub cap_faces: u32,
    /// Hull triangles of a hollow block.
    pub hull: u32,
    notes: u32,
}

impl Sizes {
    fn of(block: &Finished, notes: usize) -> Self {
        let sum = |lengths: &mut dyn Iterator<Item = usize>| lengths.sum::<usize>() as u32;
        Self {
            points: block.mesh.points.len() as u32,
            shared: block.shared,
            tets: block.mesh.tets.len() as u32,
            wall: block.wall.len() as u32,
            joints: block.joints.len() as u32,
            joint_vertices: sum(&mut block.joints.iter().map(|j| j.vertices.len())),
            joint_faces: sum(&mut block.joints.iter().map(|j| j.faces.len())),
            caps: block.caps.len() as u32,
            cap_faces: sum(&mut block.caps.iter().map(|c| c.faces.len())),
            hull: block.hull.len() as u32,
            notes: notes as u32,
        }
    }

    fn counts(&self) -> [u32; HEAD] {
        let Self { points, shared, tets, wall, joints, joint_vertices, joint_faces, caps, cap_faces, hull, notes } =
            *self;
        [points, shared, tets, wall, joints, joint_vertices, joint_faces, caps, cap_faces, hull, notes]
    }

    fn from_counts(counts: [u32; HEAD]) -> Self {
        let [points, shared, tets, wall, joints, joint_vertices, joint_faces, caps, cap_faces, hull, notes] = counts;
        Self { points, shared, tets, wall, joints, joint_vertices, joint_faces, caps, cap_faces, hull, notes }
    }

    fn narrow(&self) -> bool {
        self.points <= 1 << 16
    }

    /// Byte ranges of the sections: notes, joint sizes, joint vertices, joint faces, caps, cap faces, wall, points,
    /// tetrahedra, hull.
    fn sections(&self) -> [Range<u64>; 10] {
        let number = if self.narrow() { 2 } else { 4 };
        let lengths: [(u32, u64); 10] = [
            (self.notes, 1),
            (self.joints, 8),
            (self.joint_vertices, 4),
            (self.joint_faces, 4),
            (self.caps, CAP as u64),
            (self.cap_faces, 4),
            (self.wall, 4),
            (self.points, 24),
            (self.tets, 4 * number),
            (self.hull, 3 * number),
        ];
        let mut end = 4 * HEAD as u64;
        lengths.map(|(count, width)| {
            let start = end;
            end += u64::from(count) * width;
            start..end
        })
    }

    /// Bytes of the whole record.
    pub fn bytes(&self) -> u64 {
        self.sections()[9].end
    }

    /// Number of boundary faces that belong to no joint.
    pub fn outer_faces(&self) -> u32 {
        self.wall + self.cap_faces
    }
}

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

impl Bytes for [u8] {
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

fn cut_short() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "the record of a block is cut short")
}

fn damaged() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "the record of a block does not fit together")
}

/// Encodes a block.
///
/// # Errors
/// The report data cannot be serialized.
pub fn encode(block: &Finished) -> io::Result<Vec<u8>> {
    let notes = postcard::to_stdvec(&(&block.certificate, &block.about)).map_err(io::Error::other)?;
    let sizes = Sizes::of(block, notes.len());
    let mut out = Vec::with_capacity(sizes.bytes() as usize);
    put(&mut out, &sizes.counts());
    out.extend_from_slice(&notes);
    for joint in &block.joints {
        put(&mut out, &[joint.vertices.len() as u32, joint.faces.len() as u32]);
    }
    block.joints.iter().for_each(|joint| put(&mut out, &joint.vertices));
    block.joints.iter().for_each(|joint| put(&mut out, &joint.faces));
    for FinishedCap { node, section, faces } in &block.caps {
        put(&mut out, &[node.0, faces.len() as u32]);
        let Section { origin: o, axis: a, radius, .. } = section;
        for x in [o.x, o.y, o.z, a.x, a.y, a.z, *radius] {
            out.extend_from_slice(&x.to_le_bytes());
        }
    }
    block.caps.iter().for_each(|cap| put(&mut out, &cap.faces));
    put(&mut out, &block.wall);
    for p in &block.mesh.points {
        for x in [p.x, p.y, p.z] {
            out.extend_from_slice(&x.to_le_bytes());
        }
    }
    for numbers in [block.mesh.tets.as_flattened(), block.hull.as_flattened()] {
        if sizes.narrow() {
            put_each(&mut out, numbers, |v| (v as u16).to_le_bytes());
        } else {
            put(&mut out, numbers);
        }
    }
    Ok(out)
}

fn put(out: &mut Vec<u8>, values: &[u32]) {
    put_each(out, values, u32::to_le_bytes);
}

fn put_each<const N: usize>(out: &mut Vec<u8>, values: &[u32], bytes: impl Fn(u32) -> [u8; N]) {
    let start = out.len();
    out.resize(start + N * values.len(), 0);
    let slots = out[start..].as_chunks_mut().0;
    slots.iter_mut().zip(values).for_each(|(slot, &v)| *slot = bytes(v));
}

/// Bytes read at once: all of most blocks, and the most requested sections of large ones.
const FIRST: u64 = 1 << 14;

/// Record whose sections are read on demand.
#[derive(Clone, Debug)]
pub struct Record<'a, B: ?Sized> {
    bytes: &'a B,
    first: Piece,
    sizes: Sizes,
}

impl<'a, B: Bytes + ?Sized> Record<'a, B> {
    /// Reads the head.
    ///
    /// # Errors
    /// The head cannot be read, or the record is shorter than it says. So no later request allocates more than a record has.
    pub fn open(bytes: &'a B) -> io::Result<Self> {
        let count = bytes.count()?;
        let first = bytes.get(0..count.min(FIRST))?;
        let head = words(first.get(..4 * HEAD).ok_or_else(cut_short)?);
        let counts: [u32; HEAD] = head.try_into().map_err(|_| cut_short())?;
        let sizes = Sizes::from_counts(counts);
        if sizes.bytes() > count {
            return Err(cut_short());
        }
        if sizes.shared > sizes.points {
            return Err(damaged());
        }
        Ok(Self { bytes, first, sizes })
    }

    /// Sizes of the block.
    pub fn sizes(&self) -> Sizes {
        self.sizes
    }

    fn section(&self, index: usize) -> io::Result<Piece> {
        self.range(self.sizes.sections()[index].clone())
    }

    fn range(&self, range: Range<u64>) -> io::Result<Piece> {
        self.first.part(range.clone()).map_or_else(|| self.bytes.get(range), Ok)
    }

    /// Reads certificate and report data.
    ///
    /// # Errors
    /// The section cannot be read.
    pub fn notes(&self) -> io::Result<(Certificate, About)> {
        postcard::from_bytes(&self.section(0)?).map_err(io::Error::other)
    }

    /// Reads the joints.
    ///
    /// # Errors
    /// The sections cannot be read.
    pub fn joints(&self) -> io::Result<Vec<FinishedJoint>> {
        let [_, sizes, vertices, faces, ..] = self.sizes.sections();
        let bytes = self.range(sizes.start..faces.end)?;
        let values = words(&bytes);
        let (sizes, rest) = values.split_at(2 * self.sizes.joints as usize);
        let (mut vertices, mut faces) = rest.split_at(((vertices.end - vertices.start) / 4) as usize);
        sizes
            .chunks_exact(2)
            .map(|size| {
                let own = vertices.split_off(..size[0] as usize).ok_or_else(damaged)?;
                let own_faces = faces.split_off(..size[1] as usize).ok_or_else(damaged)?;
                Ok(FinishedJoint { vertices: own.to_vec(), faces: own_faces.to_vec() })
            })
            .collect()
    }

    /// Reads the caps.
    ///
    /// # Errors
    /// The sections cannot be read.
    pub fn caps(&self) -> io::Result<Vec<FinishedCap>> {
        let (heads, faces) = (self.section(4)?, words(&self.section(5)?));
        let mut faces = &faces[..];
        heads
            .chunks_exact(CAP)
            .map(|head| {
                let (ids, floats) = (words(&head[..8]), doubles(&head[8..]));
                let own = faces.split_off(..ids[1] as usize).ok_or_else(damaged)?;
                let [ox, oy, oz, ax, ay, az, radius] = floats[..] else { return Err(damaged()) };
                let section = Section::new(Point3::new(ox, oy, oz), Vec3::new(ax, ay, az), radius);
                Ok(FinishedCap { node: NodeId(ids[0]), section, faces: own.to_vec() })
            })
            .collect()
    }

    /// Reads the wall.
    ///
    /// # Errors
    /// The section cannot be read.
    pub fn wall(&self) -> io::Result<Vec<u32>> {
        Ok(words(&self.section(6)?))
    }

    /// Reads the points.
    ///
    /// # Errors
    /// The section cannot be read.
    pub fn points(&self) -> io::Result<Vec<Point3>> {
        let bytes = self.section(7)?;
        Ok(bytes.as_chunks().0.iter().map(point).collect())
    }

    /// Reads some points.
    ///
    /// # Errors
    /// The section cannot be read, or a point is missing.
    pub fn points_at(&self, vertices: &[u32]) -> io::Result<Vec<Point3>> {
        let bytes = self.section(7)?;
        let all = bytes.as_chunks().0;
        let mut points = Vec::with_capacity(vertices.len());
        for &v in vertices {
            points.push(all.get(v as usize).map(point).ok_or_else(damaged)?);
        }
        Ok(points)
    }

    /// Reads the tetrahedra.
    ///
    /// # Errors
    /// The section cannot be read or refers to a missing point.
    pub fn tets(&self) -> io::Result<Vec<[u32; 4]>> {
        self.cells(8)
    }

    /// Reads the hull; it is empty if the block is not hollow.
    ///
    /// # Errors
    /// The section cannot be read or refers to a missing point.
    pub fn hull(&self) -> io::Result<Vec<[u32; 3]>> {
        self.cells(9)
    }

    /// Vertices of faces.
    ///
    /// # Errors
    /// The cells of the faces cannot be read.
    pub fn triangles(&self, faces: &[u32]) -> io::Result<Vec<[u32; 3]>> {
        let mut triangles = Vec::with_capacity(faces.len());
        if self.sizes.hull == 0 {
            let bytes = self.section(8)?;
            for &face in faces {
                triangles.push(face_vertices(&[self.cell(&bytes, face >> 2)?], face & 3));
            }
        } else {
            let bytes = self.section(9)?;
            for &face in faces {
                triangles.push(self.cell(&bytes, face)?);
            }
        }
        Ok(triangles)
    }

    /// Reads all cells of a section, with `N` vertices each.
    fn cells<const N: usize>(&self, section: usize) -> io::Result<Vec<[u32; N]>> {
        let bytes = self.section(section)?;
        let numbers: Vec<u32> = if self.sizes.narrow() {
            bytes.as_chunks().0.iter().map(|&b| u32::from(u16::from_le_bytes(b))).collect()
        } else {
            words(&bytes)
        };
        let all_there = numbers.iter().all(|&v| v < self.sizes.points);
        if all_there { Ok(numbers.as_chunks().0.to_vec()) } else { Err(damaged()) }
    }

    /// Cell with `N` vertices at a place in its section.
    fn cell<const N: usize>(&self, section: &[u8], index: u32) -> io::Result<[u32; N]> {
        let first = N * index as usize;
        let mut cell = [0; N];
        if self.sizes.narrow() {
            let numbers = section.as_chunks().0.get(first..first + N).ok_or_else(damaged)?;
            cell.iter_mut().zip(numbers).for_each(|(v, &b)| *v = u32::from(u16::from_le_bytes(b)));
        } else {
            let numbers = section.as_chunks().0.get(first..first + N).ok_or_else(damaged)?;
            cell.iter_mut().zip(numbers).for_each(|(v, &b)| *v = u32::from_le_bytes(b));
        }
        if cell.iter().all(|&v| v < self.sizes.points) { Ok(cell) } else { Err(damaged()) }
    }

    /// Reads the whole block.
    ///
    /// # Errors
    /// A section cannot be read.
    pub fn block(&self) -> io::Result<Finished> {
        let (certificate, about) = self.notes()?;
        Ok(Finished {
            mesh: TetMesh { points: self.points()?, tets: self.tets()? },
            hull: self.hull()?,
            shared: self.sizes.shared,
            wall: self.wall()?,
            joints: self.joints()?,
            caps: self.caps()?,
            certificate,
            about,
        })
    }
}

fn words(bytes: &[u8]) -> Vec<u32> {
    bytes.as_chunks().0.iter().map(|&b| u32::from_le_bytes(b)).collect()
}

fn point(bytes: &[u8; 24]) -> Point3 {
    let [x, y, z] = [0, 8, 16].map(|i| f64::from_le_bytes(std::array::from_fn(|k| bytes[i + k])));
    Point3::new(x, y, z)
}

fn doubles(bytes: &[u8]) -> Vec<f64> {
    bytes.as_chunks().0.iter().map(|&b| f64::from_le_bytes(b)).collect()
}

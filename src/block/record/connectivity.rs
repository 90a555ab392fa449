//! Record of a block's vertex numbers: tetrahedra, and the faces of its wall, joints and caps. Images of a template have the same.
//!
//! A head has [`HEAD`] counts. The sections are
//!
//! - numbers of vertices and faces of each joint, then these vertices and faces
//! - number of faces of each cap, then these faces
//! - wall
//! - tetrahedra and hull triangles (u16 for small point counts, else u32)

use std::io;
use std::ops::Range;

use super::bytes::{Bytes, Opened, cut_short, damaged, put, put_each, sections, words};
use crate::block::finished::Finished;
use crate::block::topology::FinishedJoint;
use anastomesh_mesh::adjacency::face_vertices;

/// Number of counts in the head.
const HEAD: usize = 10;

/// Sizes of a finished block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
}

impl Sizes {
    fn of(block: &Finished) -> Self {
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
        }
    }

    fn counts(&self) -> [u32; HEAD] {
        let Self { points, shared, tets, wall, joints, joint_vertices, joint_faces, caps, cap_faces, hull } = *self;
        [points, shared, tets, wall, joints, joint_vertices, joint_faces, caps, cap_faces, hull]
    }

    fn from_counts(counts: [u32; HEAD]) -> Self {
        let [points, shared, tets, wall, joints, joint_vertices, joint_faces, caps, cap_faces, hull] = counts;
        Self { points, shared, tets, wall, joints, joint_vertices, joint_faces, caps, cap_faces, hull }
    }

    fn narrow(&self) -> bool {
        self.points <= 1 << 16
    }

    /// Byte ranges of the sections: joint sizes, joint vertices, joint faces, cap sizes, cap faces, wall, tetrahedra, hull.
    fn sections(&self) -> [Range<u64>; 8] {
        let number = if self.narrow() { 2 } else { 4 };
        let lengths = [
            (self.joints, 8),
            (self.joint_vertices, 4),
            (self.joint_faces, 4),
            (self.caps, 4),
            (self.cap_faces, 4),
            (self.wall, 4),
            (self.tets, 4 * number),
            (self.hull, 3 * number),
        ];
        sections(4 * HEAD, lengths)
    }

    /// Bytes of the whole record.
    pub(super) fn bytes(&self) -> u64 {
        self.sections()[7].end
    }

    /// Number of boundary faces that belong to no joint.
    pub fn outer_faces(&self) -> u32 {
        self.wall + self.cap_faces
    }
}

/// Encodes the connectivity of a block.
pub(super) fn encode(block: &Finished) -> Vec<u8> {
    let sizes = Sizes::of(block);
    let mut out = Vec::with_capacity(sizes.bytes() as usize);
    put(&mut out, &sizes.counts());
    for joint in &block.joints {
        put(&mut out, &[joint.vertices.len() as u32, joint.faces.len() as u32]);
    }
    block.joints.iter().for_each(|joint| put(&mut out, &joint.vertices));
    block.joints.iter().for_each(|joint| put(&mut out, &joint.faces));
    block.caps.iter().for_each(|cap| put(&mut out, &[cap.faces.len() as u32]));
    block.caps.iter().for_each(|cap| put(&mut out, &cap.faces));
    put(&mut out, &block.wall);
    for numbers in [block.mesh.tets.as_flattened(), block.hull.as_flattened()] {
        if sizes.narrow() {
            put_each(&mut out, numbers, |v| (v as u16).to_le_bytes());
        } else {
            put(&mut out, numbers);
        }
    }
    out
}

/// Connectivity whose sections are read on demand.
#[derive(Clone, Debug)]
pub struct Connectivity<B> {
    record: Opened<B>,
    sizes: Sizes,
}

impl<B: Bytes> Connectivity<B> {
    /// Reads the head.
    ///
    /// # Errors
    /// The head cannot be read, or the record is shorter than it says.
    pub fn open(bytes: B) -> io::Result<Self> {
        let record = Opened::new(bytes)?;
        let head = words(&record.range(0..4 * HEAD as u64)?);
        let sizes = Sizes::from_counts(head.try_into().map_err(|_| cut_short())?);
        record.reaches(sizes.bytes())?;
        if sizes.shared > sizes.points {
            return Err(damaged());
        }
        Ok(Self { record, sizes })
    }

    /// Sizes of the block.
    pub fn sizes(&self) -> Sizes {
        self.sizes
    }

    fn section(&self, index: usize) -> io::Result<super::Piece> {
        self.record.range(self.sizes.sections()[index].clone())
    }

    /// Reads the joints.
    ///
    /// # Errors
    /// The sections cannot be read.
    pub fn joints(&self) -> io::Result<Vec<FinishedJoint>> {
        let [sizes, vertices, faces, ..] = self.sizes.sections();
        let bytes = self.record.range(sizes.start..faces.end)?;
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

    /// Reads the faces of each cap.
    ///
    /// # Errors
    /// The sections cannot be read.
    pub(super) fn caps(&self) -> io::Result<Vec<Vec<u32>>> {
        let (sizes, faces) = (words(&self.section(3)?), words(&self.section(4)?));
        let mut faces = &faces[..];
        sizes.iter().map(|&n| faces.split_off(..n as usize).map(<[u32]>::to_vec).ok_or_else(damaged)).collect()
    }

    /// Reads the wall.
    ///
    /// # Errors
    /// The section cannot be read.
    pub fn wall(&self) -> io::Result<Vec<u32>> {
        Ok(words(&self.section(5)?))
    }

    /// Reads the tetrahedra.
    ///
    /// # Errors
    /// The section cannot be read or refers to a missing point.
    pub fn tets(&self) -> io::Result<Vec<[u32; 4]>> {
        self.cells(6)
    }

    /// Reads the hull; it is empty if the block is not hollow.
    ///
    /// # Errors
    /// The section cannot be read or refers to a missing point.
    pub fn hull(&self) -> io::Result<Vec<[u32; 3]>> {
        self.cells(7)
    }

    /// Vertices of faces.
    ///
    /// # Errors
    /// The cells of the faces cannot be read.
    pub fn triangles(&self, faces: &[u32]) -> io::Result<Vec<[u32; 3]>> {
        let mut triangles = Vec::with_capacity(faces.len());
        if self.sizes.hull == 0 {
            let bytes = self.section(6)?;
            for &face in faces {
                triangles.push(face_vertices(&[self.cell(&bytes, face >> 2)?], face & 3));
            }
        } else {
            let bytes = self.section(7)?;
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
}

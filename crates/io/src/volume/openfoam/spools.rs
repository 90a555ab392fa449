//! Faces of each processor, in a temporary file.

use super::joined::{Inner, Outer};
use crate::volume::parts::{Lookup, Partition};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

/// List of faces in the mesh of a processor, in the order of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum FaceList {
    /// Faces between two cells of the processor.
    Inner,
    /// Faces of a patch, by its position in the list of patches.
    Patch(u32),
    /// Faces shared with another processor.
    Processor(u32),
}

/// Face of a processor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ProcessorFace {
    pub(super) list: FaceList,
    /// Cells by their numbers in the processor; the second one is 0 except for inner faces.
    pub(super) cells: [u32; 2],
    /// Number in the undivided mesh.
    pub(super) number: u32,
    /// Vertices in the undivided mesh, of a triangle the last one twice.
    pub(super) corners: [u32; 4],
    /// True if it is oriented against the face of the undivided mesh.
    pub(super) is_flipped: bool,
}

impl ProcessorFace {
    /// Vertices as in the file.
    pub(super) fn vertices(&self) -> &[u32] {
        if self.corners[2] == self.corners[3] { &self.corners[..3] } else { &self.corners }
    }

    /// Number from 1 in the undivided mesh, negative if flipped.
    pub(super) fn address(&self) -> u32 {
        let number = (self.number + 1).cast_signed();
        (if self.is_flipped { -number } else { number }).cast_unsigned()
    }

    fn to_words(self) -> [u32; WORDS] {
        let (kind, index) = match self.list {
            FaceList::Inner => (0, 0),
            FaceList::Patch(patch) => (1, patch),
            FaceList::Processor(processor) => (2, processor),
        };
        let [a, b] = self.cells;
        let [v, w, x, y] = self.corners;
        [kind | u32::from(self.is_flipped) << 2, index, a, b, self.number, v, w, x, y]
    }

    fn of_words([kind, index, a, b, number, v, w, x, y]: [u32; WORDS]) -> Self {
        let list = match kind & 3 {
            0 => FaceList::Inner,
            1 => FaceList::Patch(index),
            _ => FaceList::Processor(index),
        };
        Self { list, cells: [a, b], number, corners: [v, w, x, y], is_flipped: kind & 4 != 0 }
    }
}

const WORDS: usize = 9;

/// Memory for faces before they are written to the file, of all processors together.
const BUFFERS: usize = 64 << 20;

/// Numbers of faces and of their vertices in each list.
pub(super) type ListSizes = BTreeMap<FaceList, [u64; 2]>;

/// Faces of one processor.
#[derive(Default)]
struct Spool {
    /// Faces not yet written.
    buffer: Vec<u8>,
    /// Positions of its faces in the file.
    chunks: Vec<(u64, usize)>,
    sizes: ListSizes,
}

/// Faces of all processors, in the order of the undivided mesh, in one temporary file without a name.
pub(super) struct Spools<'a> {
    file: File,
    /// Length of the file.
    end: u64,
    lookup: Lookup<'a>,
    parts: Vec<Spool>,
    /// Bytes after which a buffer is written.
    limit: usize,
}

impl<'a> Spools<'a> {
    /// Creates the file on the disk of `beside`.
    pub(super) fn new(partition: &'a Partition, beside: &Path) -> io::Result<Self> {
        let folder = beside.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let parts = (0..partition.parts()).map(|_| Spool::default()).collect();
        let limit = (BUFFERS / partition.parts()).clamp(1 << 14, 1 << 20);
        Ok(Self { file: tempfile::tempfile_in(folder)?, end: 0, lookup: partition.lookup(), parts, limit })
    }

    /// Adds faces between cells, numbered from `first`.
    pub(super) fn put_inner(&mut self, faces: &[Inner], first: u64) -> io::Result<()> {
        for (face, number) in faces.iter().zip(first as u32..) {
            let [a, b] = face.cells.map(|cell| self.lookup.locate(cell));
            let corners = face.face.corners();
            let whole = ProcessorFace { list: FaceList::Inner, cells: [a.1, b.1], number, corners, is_flipped: false };
            if a.0 == b.0 {
                self.put(a.0, whole)?;
                continue;
            }
            // Each side is oriented out of its own cell.
            let [of_a, of_b] = [a.0, b.0].map(FaceList::Processor);
            self.put(a.0, ProcessorFace { list: of_b, cells: [a.1, 0], ..whole })?;
            let corners = flipped(corners);
            self.put(b.0, ProcessorFace { list: of_a, cells: [b.1, 0], corners, is_flipped: true, ..whole })?;
        }
        Ok(())
    }

    /// Adds faces of the patch at this position, numbered from `first`.
    pub(super) fn put_outer(&mut self, faces: &[Outer], patch: u32, first: u64) -> io::Result<()> {
        for (face, number) in faces.iter().zip(first as u32..) {
            let (part, cell) = self.lookup.locate(face.cell);
            let (list, corners) = (FaceList::Patch(patch), face.face.corners());
            self.put(part, ProcessorFace { list, cells: [cell, 0], number, corners, is_flipped: false })?;
        }
        Ok(())
    }

    fn put(&mut self, part: u32, face: ProcessorFace) -> io::Result<()> {
        let spool = &mut self.parts[part as usize];
        let [faces, corners] = spool.sizes.entry(face.list).or_default();
        (*faces, *corners) = (*faces + 1, *corners + face.vertices().len() as u64);
        spool.buffer.extend(face.to_words().into_iter().flat_map(u32::to_le_bytes));
        if spool.buffer.len() >= self.limit {
            self.file.write_all(&spool.buffer)?;
            spool.chunks.push((self.end, spool.buffer.len()));
            self.end += spool.buffer.len() as u64;
            spool.buffer.clear();
        }
        Ok(())
    }

    /// Sizes of the lists of a processor.
    pub(super) fn sizes(&self, part: u32) -> &ListSizes {
        &self.parts[part as usize].sizes
    }

    /// Passes on the faces of a processor in batches, in the order of the undivided mesh.
    pub(super) fn each(&self, part: u32, mut each: impl FnMut(Vec<ProcessorFace>) -> io::Result<()>) -> io::Result<()> {
        let spool = &self.parts[part as usize];
        let mut file = &self.file;
        let mut bytes = Vec::new();
        for &(start, length) in &spool.chunks {
            file.seek(SeekFrom::Start(start))?;
            bytes.resize(length, 0);
            file.read_exact(&mut bytes)?;
            each(faces_of(&bytes))?;
        }
        each(faces_of(&spool.buffer))
    }
}

fn faces_of(bytes: &[u8]) -> Vec<ProcessorFace> {
    let (words, _) = bytes.as_chunks::<4>();
    let (faces, _) = words.as_chunks::<WORDS>();
    faces.iter().map(|face| ProcessorFace::of_words(face.map(u32::from_le_bytes))).collect()
}

/// Face seen from the other side, from the same vertex on.
fn flipped([a, b, c, d]: [u32; 4]) -> [u32; 4] {
    if c == d { [a, c, b, b] } else { [a, d, c, b] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_survive_as_words() {
        let face = ProcessorFace {
            list: FaceList::Processor(7),
            cells: [3, 0],
            number: 5,
            corners: flipped([1, 2, 3, 3]),
            is_flipped: true,
        };
        assert_eq!(ProcessorFace::of_words(face.to_words()), face);
        assert_eq!((face.vertices(), face.address().cast_signed()), (&[1, 3, 2][..], -6));
        assert_eq!(flipped([1, 2, 3, 4]), [1, 4, 3, 2]);
    }
}

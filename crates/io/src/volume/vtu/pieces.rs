//! Blockwise reader of large VTU files written by this program, which store tetrahedra and faces block by block.

use super::layout::{Counts, Head, Piece, VtuPiecesError, check_offsets, count_tets, pieces, runs};
use crate::volume::content::MeshNotes;
use crate::vtk_xml::{BlockFile, PackedArray};
use anastomesh_mesh::Patch;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::source::{FacePiece, MeshSource, SourceCounts, TetPiece};
use std::borrow::Cow;
use std::io;
use std::ops::Range;
use std::path::Path;

/// Maximum gap in point numbers within one read.
const GAP: u32 = 64;

/// Mesh in a file, accessed by blocks.
#[derive(Debug)]
pub struct VtuPieces {
    file: BlockFile,
    points: PackedArray,
    connectivity: PackedArray,
    patch: PackedArray,
    /// True if vertex numbers have 8 bytes.
    wide: bool,
    /// True if coordinates have 8 bytes.
    double: bool,
    counts: Counts,
    pieces: Vec<Piece>,
    patches: Vec<Patch>,
    notes: MeshNotes,
}

impl VtuPieces {
    /// Opens a file with a data cache of about `memory` bytes.
    ///
    /// # Errors
    /// `Layout` if the mesh cannot be read in pieces, which does not mean that it is invalid. `Read` with the error of
    /// the operating system, or `InvalidData` if an array cannot be decompressed.
    pub fn open(path: &Path, memory: usize) -> Result<Self, VtuPiecesError> {
        let file = BlockFile::open(path, memory)?;
        let head = Head::read(&file, memory)?;
        let counts = head.counts;
        let array = |offset, values, width| file.array(offset, values, width, head.zlib);
        let index = if head.wide { 8 } else { 4 };
        let ends = array(head.offsets, counts.cells, index)?;
        let types = array(head.types, counts.cells, 1)?;
        let block = array(head.block, counts.cells, 4)?;
        let counts = Counts { tets: count_tets(&file, &types, counts.cells)?, ..counts };
        check_offsets(&file, &ends, head.wide, counts.tets)?;
        // Without faces, the boundary and the interfaces of blocks are unknown.
        if counts.tets == counts.cells && counts.cells > 0 {
            return Err(VtuPiecesError::Layout { what: "it labels no boundary" });
        }
        let pieces = pieces(&runs(&file, &block)?, counts)?;
        Ok(Self {
            points: array(head.points, 3 * counts.points, head.coordinate)?,
            connectivity: array(head.connectivity, 4 * counts.tets + 3 * (counts.cells - counts.tets), index)?,
            patch: array(head.patch, counts.cells, 4)?,
            file,
            wide: head.wide,
            double: head.coordinate == 8,
            counts,
            pieces,
            patches: head.patches,
            notes: head.notes,
        })
    }

    /// Additional information of the file.
    pub fn notes(&self) -> &MeshNotes {
        &self.notes
    }

    /// Reads a range of points.
    fn points_at(&self, points: Range<u64>) -> io::Result<Vec<Point3>> {
        let bytes = self.file.values(&self.points, 3 * points.start..3 * points.end)?;
        let values: Vec<f64> = if self.double {
            bytes.as_chunks().0.iter().map(|w| f64::from_le_bytes(*w)).collect()
        } else {
            bytes.as_chunks().0.iter().map(|w| f64::from(f32::from_le_bytes(*w))).collect()
        };
        Ok(values.as_chunks::<3>().0.iter().map(|&p| Point3::from(p)).collect())
    }

    /// Reads vertices of cells, `N` per cell.
    fn corners<const N: usize>(&self, values: Range<u64>) -> io::Result<Vec<[u32; N]>> {
        let bytes = self.file.values(&self.connectivity, values)?;
        let ids: Vec<u32> = if self.wide {
            // Invalid point numbers stay invalid.
            bytes.as_chunks().0.iter().map(|w| u32::try_from(u64::from_le_bytes(*w)).unwrap_or(u32::MAX)).collect()
        } else {
            bytes.as_chunks().0.iter().map(|w| u32::from_le_bytes(*w)).collect()
        };
        Ok(ids.as_chunks().0.to_vec())
    }
}

impl MeshSource for VtuPieces {
    fn counts(&self) -> SourceCounts {
        let Counts { points, tets, cells } = self.counts;
        SourceCounts { points: points as usize, tets: tets as usize, boundary: (cells - tets) as usize }
    }

    fn patches(&self) -> &[Patch] {
        &self.patches
    }

    fn parts(&self) -> u32 {
        self.pieces.len() as u32
    }

    /// Points are stored independently of blocks, so every part gets an equal share.
    fn points(&self, part: u32) -> io::Result<Cow<'_, [Point3]>> {
        let (parts, part) = (u64::from(self.parts()), u64::from(part));
        let share = |part: u64| part * self.counts.points / parts;
        self.points_at(share(part)..share(part + 1)).map(Cow::Owned)
    }

    fn tets(&self, part: u32) -> io::Result<TetPiece<'_>> {
        let Piece { block, tets, .. } = &self.pieces[part as usize];
        let tets = self.corners(4 * tets.start..4 * tets.end)?;
        Ok(TetPiece { blocks: vec![*block; tets.len()].into(), tets: tets.into() })
    }

    fn boundary(&self, part: u32) -> io::Result<FacePiece<'_>> {
        let Piece { block, faces, .. } = &self.pieces[part as usize];
        let at = |cell: u64| 4 * self.counts.tets + 3 * (cell - self.counts.tets);
        let patches = self.file.values(&self.patch, faces.clone())?;
        let patches: Vec<i32> = patches.as_chunks().0.iter().map(|w| i32::from_le_bytes(*w)).collect();
        let faces = self.corners(at(faces.start)..at(faces.end))?;
        Ok(FacePiece { blocks: vec![*block; faces.len()].into(), faces: faces.into(), patches: patches.into() })
    }

    fn points_of(&self, ids: &[u32]) -> io::Result<Vec<Point3>> {
        let mut points = Vec::with_capacity(ids.len());
        for run in ids.chunk_by(|a, b| b - a <= GAP) {
            let (first, last) = (u64::from(run[0]), u64::from(run[run.len() - 1]));
            let there = self.points_at(first..last + 1)?;
            points.extend(run.iter().map(|&id| there[(id - run[0]) as usize]));
        }
        Ok(points)
    }
}

#[cfg(test)]
#[path = "pieces_tests.rs"]
mod tests;

//! Layout of a blockwise VTU file: positions of its arrays and blocks.

use super::fields::Fields;
use super::names::{VTK_TETRA, VTK_TRIANGLE};
use crate::volume::content::MeshNotes;
use crate::vtk_xml::{BlockFile, ElementId, PackedArray, VtkXml};
use anastomesh_mesh::Patch;
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use std::io;
use std::ops::Range;

#[derive(Clone, Copy, Debug)]
pub(super) struct Counts {
    pub points: u64,
    pub tets: u64,
    pub cells: u64,
}

/// Cells of one block of the mesh.
#[derive(Clone, Debug)]
pub(super) struct BlockPiece {
    pub block: i32,
    pub tets: Range<u64>,
    pub faces: Range<u64>,
}

/// Reasons why a file cannot be opened in pieces.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VtuPiecesError {
    /// The layout differs from that of files written by this program.
    #[error("the file is not stored in blocks ({what})")]
    Layout {
        /// Difference of the layout.
        what: &'static str,
    },
    /// The file cannot be read.
    #[error(transparent)]
    Read(#[from] io::Error),
}

fn layout(what: &'static str) -> VtuPiecesError {
    VtuPiecesError::Layout { what }
}

/// Header of a file, before the arrays of the mesh.
pub(super) struct VtuHeader {
    pub counts: Counts,
    pub wide: bool,
    /// True if the arrays are compressed.
    pub zlib: bool,
    /// Bytes of a coordinate.
    pub coordinate: u64,
    pub points: u64,
    pub connectivity: u64,
    pub offsets: u64,
    pub types: u64,
    pub patch: u64,
    pub block: u64,
    pub patches: Vec<Patch>,
    pub notes: MeshNotes,
}

impl VtuHeader {
    /// Reads the header and the field arrays, which precede all others.
    pub(super) fn read(file: &BlockFile, memory: usize) -> Result<Self, VtuPiecesError> {
        let bytes = text_of(file)?;
        let end = {
            let xml = VtkXml::parse(&bytes, "UnstructuredGrid").map_err(|_| layout("no VTU file"))?;
            Self::of(&xml)?.first_array()
        };
        if end > memory as u64 {
            return Err(layout("its field data are larger than the memory"));
        }
        let bytes = file.bytes(0..end.min(file.length()))?;
        let xml = VtkXml::parse(&bytes, "UnstructuredGrid").map_err(|_| layout("no VTU file"))?;
        let mut head = Self::of(&xml)?;
        let grid = grid(&xml)?;
        let fields = Fields::read(&xml, grid).map_err(|_| layout("its field data cannot be read"))?;
        head.notes = fields.notes();
        head.patches = fields.named_patches("patch").ok_or_else(|| layout("it names no patches"))?;
        Ok(head)
    }

    /// Start of the first array of points or cells, after the field arrays.
    fn first_array(&self) -> u64 {
        let Self { points, connectivity, offsets, types, patch, block, .. } = *self;
        [connectivity, offsets, types, patch, block].into_iter().fold(points, u64::min)
    }

    /// Parses the XML.
    fn of(xml: &VtkXml) -> Result<Self, VtuPiecesError> {
        let (data, zlib) = xml.packed_data().ok_or_else(|| layout("its data are not appended as bytes"))?;
        let grid = grid(xml)?;
        let mut pieces = xml.children(grid, "Piece");
        let (Some(piece), None) = (pieces.next(), pieces.next()) else {
            return Err(layout("it has several pieces"));
        };
        let array = |section: &str, name: &str, kinds: &[&str]| {
            let found = xml.child(piece, section).and_then(|section| xml.arrays(section).find(|(n, _)| *n == name));
            let (_, array) = found?;
            let offset = xml.attribute(array, "offset")?.trim().parse::<u64>().ok()?;
            let kind = kinds.iter().position(|kind| xml.attribute(array, "type") == Some(*kind))?;
            let is_appended = xml.attribute(array, "format") == Some("appended");
            Some((offset.checked_add(data as u64)?, kind)).filter(|_| is_appended)
        };
        let needed = |section, name, kind| {
            let what = || layout("it lacks an array of points, cells, patches or blocks");
            array(section, name, &[kind]).map(|(offset, _)| offset).ok_or_else(what)
        };
        if array("CellData", "vtkGhostType", &["UInt8"]).is_some() {
            return Err(layout("it has ghost cells"));
        }
        let indices = ["Int32", "Int64"];
        let (connectivity, wide) =
            array("Cells", "connectivity", &indices).ok_or_else(|| layout("it has no connectivity"))?;
        let (offsets, wide_offsets) = array("Cells", "offsets", &indices).ok_or_else(|| layout("it has no offsets"))?;
        let (points_at, double) =
            array("Points", "Points", &["Float32", "Float64"]).ok_or_else(|| layout("it has no points"))?;
        let count = |name| xml.count(piece, name).map_err(|_| layout("its counts are no numbers"));
        let (points, cells) = (count("NumberOfPoints")? as u64, count("NumberOfCells")? as u64);
        // Point numbers have 32 bits; twice as many cells cannot belong to these points.
        if wide != wide_offsets || points >= u64::from(u32::MAX) || cells >= 1 << 40 {
            return Err(layout("its counts or kinds of numbers are others"));
        }
        Ok(Self {
            counts: Counts { points, tets: 0, cells },
            wide: wide == 1,
            zlib,
            coordinate: 4 * (1 + double as u64),
            points: points_at,
            connectivity,
            offsets,
            types: needed("Cells", "types", "UInt8")?,
            patch: needed("CellData", "patch", "Int32")?,
            block: needed("CellData", "block", "Int32")?,
            patches: Vec::new(),
            notes: MeshNotes::default(),
        })
    }
}

fn grid(xml: &VtkXml) -> Result<ElementId, VtuPiecesError> {
    xml.child(VtkXml::ROOT, "UnstructuredGrid").ok_or_else(|| layout("no VTU file"))
}

/// XML before the data, with some data bytes.
fn text_of(file: &BlockFile) -> Result<Vec<u8>, VtuPiecesError> {
    const TAG: &[u8] = b"<AppendedData";
    /// Maximum length of the XML in bytes; typical files have some thousand.
    const LONGEST: u64 = 1 << 20;
    let bytes = file.bytes(0..LONGEST.min(file.length()))?;
    match bytes.windows(TAG.len()).position(|window| window == TAG) {
        Some(_) => Ok(bytes),
        None => Err(layout("no VTU file, or its data are not appended")),
    }
}

/// Maps all blocks of an array in parallel; results are in order.
fn each_block<T: Send>(
    file: &BlockFile,
    array: &PackedArray,
    look: impl Fn(u64, &[u8]) -> T + Sync,
) -> io::Result<Vec<T>> {
    (0..array.blocks()).into_par_iter().map(|i| Ok(look(array.first_value(i), &file.block(array, i)?))).collect()
}

/// Number of tetrahedra, which come first; all other cells must be triangles.
pub(super) fn count_tets(file: &BlockFile, types: &PackedArray, cells: u64) -> Result<u64, VtuPiecesError> {
    let look = |_, kinds: &[u8]| {
        let tets = kinds.iter().take_while(|&&kind| kind == VTK_TETRA).count();
        kinds[tets..].iter().all(|&kind| kind == VTK_TRIANGLE).then_some((tets as u64, kinds.len() as u64))
    };
    let (mut tets, mut seen) = (0, 0);
    for found in each_block(file, types, look)? {
        let (here, all) = found.ok_or_else(|| layout("its cells are not tetrahedra and then triangles"))?;
        if here > 0 && tets != seen {
            return Err(layout("its cells are not tetrahedra and then triangles"));
        }
        tets += here;
        seen += all;
    }
    if seen == cells { Ok(tets) } else { Err(layout("it has fewer types than cells")) }
}

/// Checks that cell offsets match the cell sizes.
pub(super) fn check_offsets(file: &BlockFile, ends: &PackedArray, wide: bool, tets: u64) -> Result<(), VtuPiecesError> {
    let end_of = |cell: u64| if cell < tets { 4 * (cell + 1) } else { 4 * tets + 3 * (cell - tets + 1) };
    let fit = |first: u64, bytes: &[u8]| {
        if wide {
            (first..).zip(bytes.as_chunks().0).all(|(cell, w)| u64::from_le_bytes(*w) == end_of(cell))
        } else {
            (first..).zip(bytes.as_chunks().0).all(|(cell, w)| u64::from(u32::from_le_bytes(*w)) == end_of(cell))
        }
    };
    let all = each_block(file, ends, fit)?.into_iter().all(|fit| fit);
    if all { Ok(()) } else { Err(layout("its cells have other sizes than their types")) }
}

/// Runs of cells with equal block: block and length.
pub(super) fn runs(file: &BlockFile, block: &PackedArray) -> io::Result<Vec<(i32, u64)>> {
    let look = |_, bytes: &[u8]| {
        let (words, _) = bytes.as_chunks::<4>();
        words.chunk_by(|a, b| a == b).map(|run| (i32::from_le_bytes(run[0]), run.len() as u64)).collect::<Vec<_>>()
    };
    let mut runs: Vec<(i32, u64)> = Vec::new();
    for (block, count) in each_block(file, block, look)?.into_iter().flatten() {
        match runs.last_mut() {
            Some((last, all)) if *last == block => *all += count,
            _ => runs.push((block, count)),
        }
    }
    Ok(runs)
}

/// Cells of each block, which must be contiguous among tetrahedra and among faces.
pub(super) fn pieces(runs: &[(i32, u64)], counts: Counts) -> Result<Vec<BlockPiece>, VtuPiecesError> {
    let scattered = || layout("the cells of a block do not stand together");
    let mut pieces: Vec<BlockPiece> = Vec::new();
    let mut place: FxHashMap<i32, usize> = FxHashMap::default();
    let mut start = 0;
    for &(block, count) in runs {
        let (end, tets) = (start + count, counts.tets);
        if start < tets {
            let here = start..end.min(tets);
            if place.insert(block, pieces.len()).is_some() {
                return Err(scattered());
            }
            pieces.push(BlockPiece { block, tets: here, faces: tets..tets });
        }
        if end > tets {
            let here = start.max(tets)..end;
            let piece = place.get(&block).and_then(|&i| pieces.get_mut(i)).ok_or_else(scattered)?;
            if !piece.faces.is_empty() {
                return Err(scattered());
            }
            piece.faces = here;
        }
        start = end;
    }
    if start == counts.cells { Ok(pieces) } else { Err(layout("it has fewer blocks than cells")) }
}

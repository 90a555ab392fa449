//! Writer of meshes in pieces, as many at a time as memory permits.

use super::folder::PieceFolder;
use super::order::Reordered;
use super::plan::Plan;
use crate::file::{Asked, AtomicFile, OutputSet, write_whole};
use crate::volume::content::MeshNotes;
use crate::volume::layers::LayerNumbers;
use crate::volume::options::GridOptions;
use crate::volume::vtu::{CELL_IDS, GHOSTS, GLOBAL_IDS, Grid, LAYER, REGION};
use anastomesh_mesh::VolumeMesh;
use anastomesh_mesh::beside::{Beside, Column};
use anastomesh_mesh::bits::Bits;
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::source::MeshSource;
use rayon::prelude::*;
use std::io::{self, Write};
use std::path::Path;

/// Options of the partition into pieces.
#[derive(Clone, Copy)]
pub(in crate::volume) struct Pieces<'a> {
    /// Maximum tetrahedra per piece. Cuts lie between blocks, unless a block exceeds it.
    pub tets: usize,
    /// Approximate memory for pieces in bytes; at least one piece is held.
    pub memory: usize,
    /// Options of each piece.
    pub grid: GridOptions,
    /// Additional values of the mesh.
    pub values: Option<&'a dyn Beside>,
    /// Layer of each tetrahedron, if known.
    pub layers: Option<&'a [i32]>,
}

impl Default for Pieces<'_> {
    fn default() -> Self {
        Self { tets: 2_000_000, memory: 512 << 20, grid: GridOptions::default(), values: None, layers: None }
    }
}

/// Writes a mesh in pieces for `path` and the folder with its name minus the extension. Pieces of an earlier
/// mesh are replaced; a folder with other files is not.
///
/// Separate blocks are ordered so that pieces cut few joints. For a multi-pass source, `pieces.memory` limits the
/// number of pieces held. Tetrahedra are read three times; points and boundary once, and once more per batch of pieces.
///
/// # Errors
/// The operating system or the mesh source fails; `InvalidData` if a cell refers to a missing point.
pub(in crate::volume) fn stage(
    path: &Path,
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
    pieces: Pieces,
    progress: &dyn Progress,
) -> io::Result<OutputSet> {
    let mut index = AtomicFile::create(path)?;
    let folder = PieceFolder::create(path)?;
    let mesh: &dyn MeshSource = &Reordered::along_the_tree(mesh)?;
    let plan = Plan::of(mesh, pieces.tets)?;
    let layers = LayerNumbers::of(mesh, pieces.layers)?;
    let room = pieces.memory / bytes_of_piece(mesh, pieces.tets).max(1);
    let points = mesh.counts().points;
    PieceWriter {
        mesh,
        notes,
        plan: &plan,
        folder: &folder,
        room,
        grid: pieces.grid,
        values: pieces.values,
        layers,
        progress,
        piece: Bits::new(points),
        used: Bits::new(points),
    }
    .write()?;
    let of_regions = (!notes.regions.is_empty()).then_some(REGION);
    let labels: Vec<&str> = of_regions.into_iter().chain(layers.map(|_| LAYER)).collect();
    write_index(&mut index, Extent { pieces: plan.ends.len(), has_ghosts: false }, &folder, pieces, &labels)?;
    folder.stage(index, path)
}

/// Approximate memory of a piece: its share of points and faces, plus half for those on its rim.
pub(super) fn bytes_of_piece(mesh: &dyn MeshSource, tets: usize) -> usize {
    let counts = mesh.counts();
    let shared = (28 * counts.points + 20 * counts.boundary) as f64 * 1.5 / counts.tets.max(1) as f64;
    ((20.0 + shared) * tets.min(counts.tets.max(1)) as f64) as usize
}

/// Pieces of an index.
#[derive(Clone, Copy)]
pub(super) struct Extent {
    pub pieces: usize,
    /// True if the pieces have ghost cells.
    pub has_ghosts: bool,
}

/// Writes the index. `labels` are further integers of cells.
pub(super) fn write_index(
    out: &mut impl Write,
    Extent { pieces, has_ghosts }: Extent,
    folder: &PieceFolder,
    how: Pieces,
    labels: &[&'static str],
) -> io::Result<()> {
    let grid = how.grid;
    let compressor = if grid.raw { "" } else { " compressor=\"vtkZLibDataCompressor\"" };
    let float = if grid.float32 { "Float32" } else { "Float64" };
    let mut columns = how.values.map_or(&[][..], Beside::columns).to_vec();
    columns.extend(labels.iter().map(|name| Column { name, at_points: false, is_integer: true }));
    let ghosts = if has_ghosts { format!("<PDataArray type=\"UInt8\" Name=\"{GHOSTS}\"/>\n") } else { String::new() };
    let (of_cells, cell_ids) = if has_ghosts {
        let ids = format!("<PDataArray type=\"Int64\" IdType=\"1\" Name=\"{CELL_IDS}\"/>\n");
        (format!(" GlobalIds=\"{CELL_IDS}\""), ids)
    } else {
        (String::new(), String::new())
    };
    writeln!(
        out,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\"{compressor}>\n<PUnstructuredGrid GhostLevel=\"{}\">\n\
         <PPointData GlobalIds=\"{GLOBAL_IDS}\">\n<PDataArray type=\"Int64\" IdType=\"1\" Name=\"{GLOBAL_IDS}\"/>\n{ghosts}{}\
         </PPointData>\n<PPoints>\n<PDataArray type=\"{float}\" Name=\"Points\" NumberOfComponents=\"3\"/>\n</PPoints>\n\
         <PCellData Scalars=\"patch\"{of_cells}>\n<PDataArray type=\"Int32\" Name=\"patch\"/>\n\
         <PDataArray type=\"Int32\" Name=\"block\"/>\n{ghosts}{cell_ids}{}</PCellData>",
        u8::from(has_ghosts),
        announced(&columns, true),
        announced(&columns, false)
    )?;
    for piece in 0..pieces {
        let source = folder.source(piece);
        writeln!(out, "<Piece Source=\"{}\"/>", quick_xml::escape::escape(source.as_str()))?;
    }
    out.write_all(b"</PUnstructuredGrid>\n</VTKFile>\n")
}

/// Declarations in the index of the columns at points, or of those in cells.
fn announced(columns: &[Column], at_points: bool) -> String {
    let line = |column: &Column| {
        let kind = if column.is_integer { "Int32" } else { "Float64" };
        format!("<PDataArray type=\"{kind}\" Name=\"{}\"/>\n", column.name)
    };
    columns.iter().filter(|column| column.at_points == at_points).map(line).collect()
}

/// Writer of pieces, with one batch per pass over points and boundary.
struct PieceWriter<'a> {
    mesh: &'a dyn MeshSource,
    notes: &'a MeshNotes,
    plan: &'a Plan,
    folder: &'a PieceFolder,
    /// Maximum number of pieces held.
    room: usize,
    grid: GridOptions,
    values: Option<&'a dyn Beside>,
    layers: Option<LayerNumbers<'a>>,
    progress: &'a dyn Progress,
    /// Points of the current piece.
    piece: Bits,
    /// Points of all pieces so far.
    used: Bits,
}

/// Piece: a separate mesh, first with global, then with local numbers.
#[derive(Default)]
struct MeshPiece {
    volume: VolumeMesh,
    /// Global point numbers, ascending.
    ids: Vec<u32>,
    /// Layer of each tetrahedron, if the mesh has layers.
    layers: Vec<i32>,
}

/// Pieces held at a time.
#[derive(Default)]
struct Batch {
    /// Number of the first piece.
    first: usize,
    pieces: Vec<MeshPiece>,
}

impl PieceWriter<'_> {
    fn write(mut self) -> io::Result<()> {
        let mut batch = Batch { first: 0, pieces: vec![self.piece_of(0)] };
        let (mut at, mesh) = (0, self.mesh);
        let mut parts = 0..mesh.parts();
        mesh.each_tets(|part| {
            let mut taken = 0;
            let number = parts.next().unwrap_or_default();
            let layers = self.layers.map(|layers| layers.of_part(number, part, at)).transpose()?;
            while taken < part.tets.len() {
                let number = batch.first + batch.pieces.len() - 1;
                let end = self.plan.ends.get(number).copied().unwrap_or(usize::MAX);
                if at == end {
                    self.open_next(&mut batch)?;
                    continue;
                }
                let range = taken..part.tets.len().min(taken + end - at);
                let Some(piece) = batch.pieces.last_mut() else { continue };
                piece.volume.mesh.tets.extend_from_slice(&part.tets[range.clone()]);
                let blocks = range.clone().map(|i| part.blocks.get(i).copied().unwrap_or(0));
                piece.volume.tet_block.extend(blocks);
                piece.layers.extend(layers.as_ref().and_then(|all| all.get(range.clone())).unwrap_or_default());
                at += range.len();
                taken = range.end;
            }
            Ok(())
        })?;
        self.write_batch(&mut batch)
    }

    /// Starts another piece; writes the batch if it is full.
    fn open_next(&mut self, batch: &mut Batch) -> io::Result<()> {
        if batch.pieces.len() >= self.room {
            self.write_batch(batch)?;
        }
        batch.pieces.push(self.piece_of(batch.first + batch.pieces.len()));
        Ok(())
    }

    /// Creates an empty piece.
    fn piece_of(&self, number: usize) -> MeshPiece {
        let before = number.checked_sub(1).and_then(|n| self.plan.ends.get(n)).copied().unwrap_or(0);
        let tets = self.plan.ends.get(number).map_or(0, |end| end - before);
        let mut piece = MeshPiece::default();
        piece.volume.mesh.tets.reserve_exact(tets);
        piece.volume.tet_block.reserve_exact(tets);
        piece
    }

    fn write_batch(&mut self, batch: &mut Batch) -> io::Result<()> {
        self.read_faces(batch)?;
        let count = batch.pieces.len();
        let last = batch.first + count == self.plan.ends.len();
        for (i, piece) in batch.pieces.iter_mut().enumerate() {
            self.number(piece, last && i + 1 == count)?;
        }
        self.read_points(batch)?;
        for (i, piece) in batch.pieces.drain(..).enumerate() {
            self.write_piece(batch.first + i, piece)?;
        }
        batch.first += count;
        Ok(())
    }

    fn read_faces(&self, batch: &mut Batch) -> io::Result<()> {
        let mut places = self.plan.faces();
        self.mesh.each_faces(|part| {
            for (i, &face) in part.faces.iter().enumerate() {
                let block = part.blocks.get(i).copied().unwrap_or(0);
                let place = places.next(block).checked_sub(batch.first);
                let Some(piece) = place.and_then(|place| batch.pieces.get_mut(place)) else { continue };
                piece.volume.boundary.push(face);
                piece.volume.boundary_patch.push(part.patches.get(i).copied().unwrap_or(0));
                piece.volume.boundary_block.push(block);
            }
            Ok(())
        })
    }

    /// Assigns local numbers to the points of a piece. Unused points go to the last piece.
    fn number(&mut self, piece: &mut MeshPiece, last: bool) -> io::Result<()> {
        let (tets, faces) = (&mut piece.volume.mesh.tets, &mut piece.volume.boundary);
        self.piece.clear();
        for &v in tets.as_flattened().iter().chain(faces.as_flattened()) {
            if !self.piece.insert(v) {
                let text = format!("a cell names the point {v}, which does not exist");
                return Err(io::Error::new(io::ErrorKind::InvalidData, text));
            }
        }
        self.used.unite(&self.piece);
        if last {
            self.used.invert();
            self.piece.unite(&self.used);
        }
        piece.ids = self.piece.ids();
        let ranks = self.piece.ranks();
        tets.par_iter_mut().for_each(|tet| *tet = tet.map(|v| ranks.rank(v)));
        faces.par_iter_mut().for_each(|face| *face = face.map(|v| ranks.rank(v)));
        Ok(())
    }

    fn read_points(&self, batch: &mut Batch) -> io::Result<()> {
        for piece in &mut batch.pieces {
            piece.volume.mesh.points.reserve_exact(piece.ids.len());
        }
        let mut before = 0_usize;
        self.mesh.each_points(|points| {
            batch.pieces.par_iter_mut().for_each(|piece| {
                let known = &mut piece.volume.mesh.points;
                for &v in piece.ids.get(known.len()..).unwrap_or_default() {
                    let Some(&p) = points.get(v as usize - before) else { break };
                    known.push(p);
                }
            });
            before += points.len();
            Ok(())
        })
    }

    fn write_piece(&self, number: usize, mut piece: MeshPiece) -> io::Result<()> {
        let notes = (number == 0).then_some(self.notes);
        if notes.is_some() {
            piece.volume.patches = self.mesh.patches().to_vec();
        }
        let grid = Grid {
            notes,
            global_ids: Some(&piece.ids),
            layers: self.layers.map(|_| LayerNumbers::Given(&piece.layers)),
            values: self.values,
            ..Grid::of(&piece.volume, self.notes, self.grid)
        };
        write_whole(&self.folder.piece(number), |out| grid.write(&mut Asked { out, progress: self.progress }))
    }
}

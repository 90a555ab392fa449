//! Writer of a given number of pieces, with ghost cells.

use super::folder::PieceFolder;
use super::write::{Extent, Pieces, bytes_of_piece, write_index};
use crate::file::{Asked, AtomicFile, OutputSet, write_whole};
use crate::volume::content::MeshNotes;
use crate::volume::parts::{PartReader, PartsError};
use crate::volume::vtu::{Grid, PieceArrays, REGION};
use anastomesh_mesh::VolumeMesh;
use anastomesh_mesh::bits::Bits;
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::source::MeshSource;
use std::io;
use std::num::NonZeroUsize;
use std::path::Path;

/// Value of `vtkGhostType` for copies of cells and points of other pieces.
const DUPLICATE: u8 = 1;

/// Writes a mesh in `parts` balanced pieces, like [`stage`](super::stage). Each has a layer of ghost cells: copies of the
/// tetrahedra of others that share a point with it. `vtkGhostType` marks them, and the points of which another piece
/// has the original. Cells have the numbers `GlobalCellIds`, tetrahedra before boundary faces.
///
/// One piece is in memory at a time, and 4 bytes per point of the mesh.
///
/// # Errors
/// The operating system or the mesh source fails; `InvalidData` if a cell refers to a missing point. `PartsError` if there are
/// more parts than cells, or a part of a mesh that is not in memory exceeds `pieces.memory`.
pub(in crate::volume) fn stage_parts(
    path: &Path,
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
    (parts, pieces): (NonZeroUsize, Pieces),
    progress: &dyn Progress,
) -> io::Result<OutputSet> {
    let mut index = AtomicFile::create(path)?;
    let folder = PieceFolder::create(path)?;
    let reader = PartReader::of(mesh, parts)?;
    let needed = bytes_of_piece(mesh, reader.largest() as usize);
    if mesh.whole().is_none() && needed > pieces.memory {
        let [needed, limit] = [needed, pieces.memory].map(|bytes| bytes.div_ceil(1 << 20));
        return Err(PartsError::Memory { cells: reader.largest() as usize, needed, limit }.into());
    }
    let mut used = Bits::new(mesh.counts().points);
    for part in 0..reader.parts() {
        let piece = Piece::of(mesh, &reader, part, &mut used)?;
        let first = part == 0;
        let grid = Grid {
            notes: first.then_some(notes),
            global_ids: Some(&piece.ids),
            piece: Some(PieceArrays {
                point_ghosts: &piece.point_ghosts,
                tet_ghosts: &piece.tet_ghosts,
                tets: &piece.tets,
                faces: &piece.faces,
                all_tets: mesh.counts().tets,
            }),
            values: pieces.values,
            ..Grid::of(&piece.volume, notes, pieces.grid)
        };
        write_whole(&folder.piece(part as usize), |out| grid.write(&mut Asked { out, progress }))?;
    }
    let labels = if notes.regions.is_empty() { &[][..] } else { &[REGION] };
    write_index(&mut index, Extent { pieces: parts.get(), has_ghosts: true }, &folder, pieces, labels)?;
    folder.stage(index, path)
}

/// Piece with local numbers of points.
struct Piece {
    volume: VolumeMesh,
    /// Numbers of points in the whole mesh, ascending.
    ids: Vec<u32>,
    point_ghosts: Vec<u8>,
    tet_ghosts: Vec<u8>,
    /// Numbers in the whole mesh of tetrahedra and of boundary faces.
    tets: Vec<u32>,
    faces: Vec<u32>,
}

impl Piece {
    fn of(mesh: &dyn MeshSource, reader: &PartReader, part: u32, used: &mut Bits) -> io::Result<Self> {
        let shared = reader.shared();
        let (mut own, faces) = (reader.tets(part)?, reader.faces(part)?);
        let mut tet_ghosts = vec![0; own.tets.len()];
        for ghost in shared.ghosts_of(part) {
            own.ids.push(ghost.tet);
            own.tets.push(ghost.vertices);
            own.blocks.push(ghost.block);
            tet_ghosts.push(DUPLICATE);
        }
        let mut volume = VolumeMesh {
            tet_block: own.blocks,
            boundary: faces.faces,
            boundary_patch: faces.patches,
            boundary_block: faces.blocks,
            ..VolumeMesh::default()
        };
        volume.mesh.tets = own.tets;
        used.clear();
        let is_last = part + 1 == reader.parts();
        let unused = shared.unused().filter(|_| is_last);
        let corners = volume.mesh.tets.as_flattened().iter().chain(volume.boundary.as_flattened());
        for v in corners.copied().chain(unused) {
            if !used.insert(v) {
                let text = format!("a cell names the point {v}, which does not exist");
                return Err(io::Error::new(io::ErrorKind::InvalidData, text));
            }
        }
        let (ids, ranks) = (used.ids(), used.ranks());
        volume.mesh.tets.iter_mut().for_each(|tet| *tet = tet.map(|v| ranks.rank(v)));
        volume.boundary.iter_mut().for_each(|face| *face = face.map(|v| ranks.rank(v)));
        volume.mesh.points = mesh.points_of(&ids)?;
        if part == 0 {
            volume.patches = mesh.patches().to_vec();
        }
        let is_copy = |v: &u32| shared.owner(*v).is_some_and(|owner| owner != part);
        let point_ghosts = ids.iter().map(|v| if is_copy(v) { DUPLICATE } else { 0 }).collect();
        Ok(Self { volume, ids, point_ghosts, tet_ghosts, tets: own.ids, faces: faces.ids })
    }
}

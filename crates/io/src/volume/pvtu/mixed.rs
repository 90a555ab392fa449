//! Writer of pieces with prisms and pyramids.

use super::folder::PieceFolder;
use super::order::Reordered;
use super::plan::Plan;
use super::write::{Extent, Pieces, write_index};
use crate::file::{Asked, AtomicFile, OutputSet, write_whole};
use crate::volume::content::MeshNotes;
use crate::volume::vtu::{LAYER, MixedGrid, REGION, write_mixed as write_grid};
use anastomesh_mesh::bits::Bits;
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::source::{MeshSource, gather};
use anastomesh_mesh::stacks::{MixedCell, MixedFace, MixedMesh};
use std::io;
use std::path::Path;

/// Writes a mesh with mixed cells in pieces, like [`stage`](super::stage). The mesh is held in memory.
///
/// # Errors
/// The operating system or the mesh source fails; `InvalidData` if a cell refers to a missing point.
pub(in crate::volume) fn stage_mixed(
    path: &Path,
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
    pieces: Pieces,
    progress: &dyn Progress,
) -> io::Result<OutputSet> {
    let mut index = AtomicFile::create(path)?;
    let folder = PieceFolder::create(path)?;
    let volume = gather(&Reordered::along_the_tree(mesh)?)?;
    let mixed = MixedMesh::of(&volume);
    let blocks = (mixed.cells.iter().map(|cell| cell.block), mixed.faces.iter().map(|face| face.block));
    let plan = Plan::of_blocks(blocks.0, blocks.1, pieces.tets);
    let mut faces: Vec<Vec<MixedFace>> = vec![Vec::new(); plan.ends.len()];
    let mut places = plan.faces();
    mixed.faces.iter().for_each(|face| faces[places.next(face.block)].push(*face));
    let points = &volume.mesh.points;
    let (mut own, mut used) = (Bits::new(points.len()), Bits::new(points.len()));
    let mut start = 0;
    for ((number, faces), &end) in faces.into_iter().enumerate().zip(&plan.ends) {
        let cells = &mixed.cells[start..end];
        start = end;
        own.clear();
        for &v in cells.iter().flat_map(MixedCell::vertices).chain(faces.iter().flat_map(MixedFace::vertices)) {
            if !own.insert(v) {
                let text = format!("a cell names the point {v}, which does not exist");
                return Err(io::Error::new(io::ErrorKind::InvalidData, text));
            }
        }
        used.unite(&own);
        // Unused points go to the last piece.
        if number + 1 == plan.ends.len() {
            used.invert();
            own.unite(&used);
        }
        let (ids, ranks) = (own.ids(), own.ranks());
        let piece = MixedMesh {
            cells: cells.iter().map(|cell| cell.renumbered(|v| ranks.rank(v))).collect(),
            faces: faces.iter().map(|face| face.renumbered(|v| ranks.rank(v))).collect(),
        };
        let grid = MixedGrid {
            points: &ids.iter().map(|&v| points[v as usize]).collect::<Vec<_>>(),
            mixed: &piece,
            notes: (number == 0).then_some((&volume.patches[..], notes)),
            has_regions: !notes.regions.is_empty(),
            global_ids: Some(&ids),
            options: pieces.grid,
        };
        write_whole(&folder.piece(number), |out| write_grid(&mut Asked { out, progress }, &grid))?;
    }
    let labels = if notes.regions.is_empty() { &[LAYER][..] } else { &[LAYER, REGION] };
    write_index(&mut index, Extent { pieces: plan.ends.len(), has_ghosts: false }, &folder, pieces, labels)?;
    folder.stage(index, path)
}

//! Elements of a mesh with prisms and pyramids.

use super::names::{kind_of_cell, kind_of_face};
use super::surfaces::Surfaces;
use super::tags::Tags;
use super::write::{ints, sizes, volumes_of, write_before_elements, write_extra};
use crate::volume::content::MeshNotes;
use anastomesh_mesh::VolumeMesh;
use anastomesh_mesh::stacks::MixedMesh;
use std::collections::BTreeMap;
use std::io::{self, Write};

/// Elements of one type in an entity: dimension, number of the entity, type.
type ElementBlock = (i32, i32, i32);

/// Writes a mesh with mixed cells as MSH 4.1. Tags follow the mesh, cells first.
///
/// # Errors
/// The output `out` fails; `InvalidData` if a face refers to a missing point.
pub(in crate::volume) fn write_mixed(
    out: &mut impl Write,
    volume: &VolumeMesh,
    mixed: &MixedMesh,
    notes: &MeshNotes,
) -> io::Result<()> {
    let surfaces = Surfaces::of(volume)?;
    let volumes = volumes_of(volume, notes, &surfaces)?;
    write_before_elements(out, volume, &surfaces, &volumes, &Tags::new(&surfaces, false))?;
    let mut blocks: BTreeMap<ElementBlock, Vec<(usize, &[u32])>> = BTreeMap::new();
    let surface_of: BTreeMap<i32, i32> = surfaces.list.iter().map(|surface| surface.patch).zip(1..).collect();
    let volume_of: BTreeMap<Option<i32>, i32> = volumes.iter().map(|volume| volume.region).zip(1..).collect();
    for (tag, face) in (mixed.cells.len() + 1..).zip(&mixed.faces) {
        let surface = surface_of.get(&face.patch).copied().unwrap_or(1);
        let kind = kind_of_face(face.vertices());
        blocks.entry((2, surface, kind)).or_default().push((tag, face.vertices()));
    }
    for (tag, cell) in (1..).zip(&mixed.cells) {
        let region = volume_of.get(&Some(cell.block)).copied().unwrap_or(1);
        blocks.entry((3, region, kind_of_cell(cell.vertices()))).or_default().push((tag, cell.vertices()));
    }
    let count = mixed.cells.len() + mixed.faces.len();
    out.write_all(b"$Elements\n")?;
    sizes(out, &[blocks.len(), count, usize::from(count > 0), count])?;
    for ((dimension, entity, kind), elements) in blocks {
        ints(out, &[dimension, entity, kind])?;
        sizes(out, &[elements.len()])?;
        for (tag, vertices) in elements {
            sizes(out, &[tag])?;
            vertices.iter().try_for_each(|&v| sizes(out, &[v as usize + 1]))?;
        }
    }
    out.write_all(b"\n$EndElements\n")?;
    write_extra(out, &volume.patches, notes)
}

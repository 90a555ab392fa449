//! Writer of partitioned meshes, with ghost cells.
//!
//! Each part has an entity of the volume and of each of its surfaces, which refer to the undivided ones. Nodes belong to the
//! undivided entities. Parts are numbered from 1.

use super::names::{MSH_TETRA, MSH_TRIANGLE};
use super::surfaces::Surfaces;
use super::tags::Tags;
use super::write::{Volume, corners, floats, ints, sizes, volumes_of, write_extra, write_head, write_nodes};
use crate::volume::content::MeshNotes;
use crate::volume::parts::{Ghost, PartReader, PartsError};
use anastomesh_mesh::source::MeshSource;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::num::NonZeroUsize;

/// Entity of the undivided volume.
const VOLUME: i32 = 1;

/// Writes a mesh as MSH 4.1 in `parts` balanced partitions. Each has a layer of ghost cells: the tetrahedra of others that
/// share a point with it. Node and element tags are those of the undivided mesh.
///
/// One part is in memory at a time, 4 bytes per point of the mesh, and what [`write`](super::write) needs.
///
/// # Errors
/// The output `out` or the mesh source fails; `PartsError` if there are more parts than cells, or the mesh has regions.
pub(in crate::volume) fn write_parts(
    out: &mut impl Write,
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
    parts: NonZeroUsize,
) -> io::Result<()> {
    if !notes.regions.is_empty() {
        return Err(
            PartsError::Content { what: "regions of an MSH file", instead: "write .pvtu, or the lumen alone" }.into()
        );
    }
    let reader = PartReader::of(mesh, parts)?;
    let surfaces = Surfaces::of(mesh)?;
    let volumes = volumes_of(mesh, notes, &surfaces)?;
    let layout = Layout::of(&reader, &surfaces);
    let tags = Tags::new(&surfaces, false);
    write_head(out, mesh, &surfaces, &volumes)?;
    layout.write_entities(out, &surfaces, &volumes)?;
    write_nodes(out, mesh, &surfaces, &tags)?;
    layout.write_elements(out, mesh, &reader)?;
    write_ghosts(out, reader.shared().ghosts())?;
    write_extra(out, mesh.patches(), notes)
}

/// Entities of the parts.
struct Layout {
    parts: u32,
    /// Entities of surfaces by part and patch, in ascending order: tag, and number of faces.
    surfaces: BTreeMap<(u32, i32), (i32, usize)>,
}

impl Layout {
    fn of(reader: &PartReader, surfaces: &Surfaces) -> Self {
        let first = surfaces.list.len() as i32 + 1;
        let counts = reader.face_counts().iter();
        let surfaces = counts.zip(first..).map(|((&place, &faces), tag)| (place, (tag, faces)));
        Self { parts: reader.parts(), surfaces: surfaces.collect() }
    }

    /// Entity of the volume of a part.
    fn volume(part: u32) -> i32 {
        VOLUME + 1 + part as i32
    }

    fn surfaces_of(&self, part: u32) -> impl Iterator<Item = (i32, &(i32, usize))> {
        self.surfaces.range((part, i32::MIN)..=(part, i32::MAX)).map(|(&(_, patch), surface)| (patch, surface))
    }

    fn write_entities(&self, out: &mut impl Write, surfaces: &Surfaces, volumes: &[Volume]) -> io::Result<()> {
        out.write_all(b"$PartitionedEntities\n")?;
        // Ghost entities: one per part.
        sizes(out, &[self.parts as usize, self.parts as usize])?;
        for part in 0..self.parts {
            ints(out, &[Self::volume(self.parts + part), part as i32 + 1])?;
        }
        sizes(out, &[0, 0, self.surfaces.len(), self.parts as usize])?;
        for (&(part, patch), &(tag, _)) in &self.surfaces {
            let place = surfaces.list.partition_point(|surface| surface.patch < patch);
            let bounds = surfaces.list.get(place).map_or([0.0; 6], |surface| corners(&surface.bounds));
            write_entity(out, tag, [2, place as i32 + 1], part, bounds)?;
            let groups: &[i32] = if patch > 0 { &[patch] } else { &[] };
            sizes(out, &[groups.len()])?;
            ints(out, groups)?;
            sizes(out, &[0])?;
        }
        let group: Vec<i32> = volumes.iter().take(1).filter_map(Volume::group).collect();
        for part in 0..self.parts {
            write_entity(out, Self::volume(part), [3, VOLUME], part, corners(&surfaces.bounds))?;
            sizes(out, &[group.len()])?;
            ints(out, &group)?;
            let bounding: Vec<i32> = self.surfaces_of(part).map(|(_, (tag, _))| *tag).collect();
            sizes(out, &[bounding.len()])?;
            ints(out, &bounding)?;
        }
        out.write_all(b"\n$EndPartitionedEntities\n")
    }

    /// Writes the elements of one part after the other.
    fn write_elements(&self, out: &mut impl Write, mesh: &dyn MeshSource, reader: &PartReader) -> io::Result<()> {
        let counts = mesh.counts();
        let count = counts.tets + counts.boundary;
        out.write_all(b"$Elements\n")?;
        sizes(out, &[self.surfaces.len() + self.parts as usize, count, usize::from(count > 0), count])?;
        for part in 0..self.parts {
            let faces = reader.faces(part)?;
            for (patch, &(tag, count)) in self.surfaces_of(part) {
                ints(out, &[2, tag, MSH_TRIANGLE])?;
                sizes(out, &[count])?;
                let labels = faces.patches.iter();
                let own = faces.ids.iter().zip(&faces.faces).zip(labels).filter(|(_, label)| **label == patch);
                for ((&id, face), _) in own {
                    write_element(out, counts.tets + id as usize, face)?;
                }
            }
            let tets = reader.tets(part)?;
            ints(out, &[3, Self::volume(part), MSH_TETRA])?;
            sizes(out, &[tets.tets.len()])?;
            for (&id, tet) in tets.ids.iter().zip(&tets.tets) {
                write_element(out, id as usize, tet)?;
            }
        }
        out.write_all(b"\n$EndElements\n")
    }
}

/// Writes the head of an entity of a part, whose parent is given by dimension and tag.
fn write_entity(out: &mut impl Write, tag: i32, parent: [i32; 2], part: u32, bounds: [f64; 6]) -> io::Result<()> {
    ints(out, &[tag, parent[0], parent[1]])?;
    sizes(out, &[1])?;
    ints(out, &[part as i32 + 1])?;
    floats(out, &bounds)
}

/// Writes an element, given by the indices of itself and its corners.
fn write_element(out: &mut impl Write, index: usize, vertices: &[u32]) -> io::Result<()> {
    sizes(out, &[index + 1])?;
    vertices.iter().try_for_each(|&v| sizes(out, &[v as usize + 1]))
}

/// Writes the parts that see each ghost cell.
fn write_ghosts(out: &mut impl Write, ghosts: &[Ghost]) -> io::Result<()> {
    let mut by_tet: Vec<(u32, u32, u32)> = ghosts.iter().map(|ghost| (ghost.tet, ghost.owner, ghost.part)).collect();
    by_tet.sort_unstable();
    let elements = || by_tet.chunk_by(|a, b| a.0 == b.0);
    out.write_all(b"$GhostElements\n")?;
    sizes(out, &[elements().count()])?;
    for same in elements() {
        let (tet, owner, _) = same[0];
        sizes(out, &[tet as usize + 1])?;
        ints(out, &[owner as i32 + 1])?;
        sizes(out, &[same.len()])?;
        for &(_, _, part) in same {
            ints(out, &[part as i32 + 1])?;
        }
    }
    out.write_all(b"\n$EndGhostElements\n")
}

//! Writer of Gmsh's older format 2.2 as text, read by MFEM, NGSolve, OpenFOAM's converter and others.

use super::elements::ElementNodes;
use super::names::{Extra, RegionGroups, SECTION, VOLUME_NAME, kind_of_cell, kind_of_face};
use super::values::write_values_2;
use crate::volume::content::MeshNotes;
use crate::volume::second::WithMiddles;
use anastomesh_mesh::NamedRegion;
use anastomesh_mesh::beside::Beside;
use anastomesh_mesh::second_order::SecondOrder;
use anastomesh_mesh::source::MeshSource;
use anastomesh_mesh::stacks::MixedMesh;
use anastomesh_mesh::{Patch, VolumeMesh};
use std::collections::BTreeSet;
use std::io::{self, Write};

/// Physical groups of a mesh.
struct Groups {
    /// Regions, which are groups of tetrahedra; empty for one group of all.
    regions: BTreeSet<i32>,
    /// Names of the regions.
    names: Vec<NamedRegion>,
    /// Physical groups of the regions.
    numbers: RegionGroups,
    /// Group of all tetrahedra, above all patches.
    lumen: i32,
}

impl Groups {
    /// Collects the groups in one pass over the labels.
    fn of(mesh: &dyn MeshSource, notes: &MeshNotes) -> io::Result<Self> {
        let mut largest = mesh.patches().iter().map(|p| p.id).max().unwrap_or(0);
        mesh.each_face_labels(|piece| {
            largest = piece.patches.iter().copied().max().unwrap_or(0).max(largest);
            Ok(())
        })?;
        let mut regions = BTreeSet::new();
        if !notes.regions.is_empty() {
            mesh.each_tet_labels(|piece| {
                regions.extend(piece.blocks.iter().copied());
                Ok(())
            })?;
        }
        let numbers = RegionGroups::of(&notes.regions);
        Ok(Self { regions, names: notes.regions.clone(), numbers, lumen: largest.max(0).saturating_add(1) })
    }

    /// Group of a tetrahedron; 0 (none) for regions that have no positive number and no name.
    fn of_tet(&self, block: i32) -> i32 {
        if self.regions.is_empty() { self.lumen } else { self.numbers.of_region(block).unwrap_or(0) }
    }

    /// Groups of tetrahedra with their names.
    fn named(&self) -> Vec<(i32, String)> {
        if self.regions.is_empty() {
            return vec![(self.lumen, VOLUME_NAME.into())];
        }
        let named = |&id: &i32| Some((self.numbers.of_region(id)?, NamedRegion::name_of(&self.names, id)));
        self.regions.iter().filter_map(named).collect()
    }
}

/// Writes a mesh as MSH 2.2. Points, boundary faces and tetrahedra are each read in one pass, their labels in another.
/// Memory does not grow with the mesh. Faces come first, as in Gmsh.
///
/// # Errors
/// The output `out` or the mesh source fails.
pub(in crate::volume) fn write(
    out: &mut impl Write,
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
    (values, second): (Option<&dyn Beside>, Option<&SecondOrder>),
) -> io::Result<()> {
    let elements = ElementNodes::of(second);
    let with_middles = second.map(|second| WithMiddles { mesh, second });
    let mesh: &dyn MeshSource = with_middles.as_ref().map_or(mesh, |mesh| mesh);
    let (counts, groups) = (mesh.counts(), Groups::of(mesh, notes)?);
    write_before_elements(out, mesh, &groups)?;
    writeln!(out, "$Elements\n{}", counts.boundary + counts.tets)?;
    let mut tag = 0_u64;
    mesh.each_faces(|piece| {
        for (i, &face) in piece.faces.iter().enumerate() {
            tag += 1;
            let patch = piece.patches.get(i).map_or(0, |&id| id.max(0));
            elements.face(face, |kind, nodes| write_element(out, tag, kind, [patch, patch.max(1)], nodes))?;
        }
        Ok(())
    })?;
    mesh.each_tets(|piece| {
        for (i, &tet) in piece.tets.iter().enumerate() {
            tag += 1;
            let group = groups.of_tet(piece.blocks.get(i).copied().unwrap_or(0));
            elements.tet(tet, |kind, nodes| write_element(out, tag, kind, [group, group.max(1)], nodes))?;
        }
        Ok(())
    })?;
    writeln!(out, "$EndElements")?;
    if let Some(values) = values {
        write_values_2(out, mesh, values)?;
    }
    write_extra(out, mesh.patches(), notes)
}

/// Writes a mesh with mixed cells as MSH 2.2, faces first.
///
/// # Errors
/// The output `out` fails.
pub(in crate::volume) fn write_mixed(
    out: &mut impl Write,
    volume: &VolumeMesh,
    mixed: &MixedMesh,
    notes: &MeshNotes,
) -> io::Result<()> {
    let groups = Groups::of(volume, notes)?;
    write_before_elements(out, volume, &groups)?;
    writeln!(out, "$Elements\n{}", mixed.faces.len() + mixed.cells.len())?;
    for (tag, face) in (1..).zip(&mixed.faces) {
        let patch = face.patch.max(0);
        write_element(out, tag, kind_of_face(face.vertices()), [patch, patch.max(1)], face.vertices())?;
    }
    for (tag, cell) in (mixed.faces.len() as u64 + 1..).zip(&mixed.cells) {
        let group = groups.of_tet(cell.block);
        write_element(out, tag, kind_of_cell(cell.vertices()), [group, group.max(1)], cell.vertices())?;
    }
    writeln!(out, "$EndElements")?;
    write_extra(out, &volume.patches, notes)
}

/// Writes the sections before the elements.
fn write_before_elements(out: &mut impl Write, mesh: &dyn MeshSource, groups: &Groups) -> io::Result<()> {
    writeln!(out, "$MeshFormat\n2.2 0 8\n$EndMeshFormat")?;
    let named: Vec<_> = mesh.patches().iter().filter(|p| p.id > 0).collect();
    let volumes = groups.named();
    writeln!(out, "$PhysicalNames\n{}", named.len() + volumes.len())?;
    for patch in named {
        writeln!(out, "2 {} \"{}\"", patch.id, patch.name.replace('"', "'"))?;
    }
    for (id, name) in volumes {
        writeln!(out, "3 {id} \"{}\"", name.replace('"', "'"))?;
    }
    writeln!(out, "$EndPhysicalNames\n$Nodes\n{}", mesh.counts().points)?;
    let mut tag = 0_u64;
    mesh.each_points(|points| {
        for p in points {
            tag += 1;
            writeln!(out, "{tag} {:?} {:?} {:?}", p.x, p.y, p.z)?;
        }
        Ok(())
    })?;
    writeln!(out, "$EndNodes")
}

/// Writes the section of this program.
fn write_extra(out: &mut impl Write, patches: &[Patch], notes: &MeshNotes) -> io::Result<()> {
    writeln!(out, "${SECTION}")?;
    serde_json::to_writer(&mut *out, &Extra::of(patches, notes))?;
    write!(out, "\n$End{SECTION}\n")
}

/// Writes an element: tag, type, and two further tags, the physical group and the number of the surface or volume.
fn write_element(out: &mut impl Write, tag: u64, kind: i32, tags: [i32; 2], corners: &[u32]) -> io::Result<()> {
    write!(out, "{tag} {kind} 2 {} {}", tags[0], tags[1])?;
    for &v in corners {
        write!(out, " {}", u64::from(v) + 1)?;
    }
    out.write_all(b"\n")
}

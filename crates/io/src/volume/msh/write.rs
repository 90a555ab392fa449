//! Writer of Gmsh's binary format.

use super::elements::ElementNodes;
use super::names::{Extra, RegionGroups, SECTION, VOLUME_NAME};
use super::surfaces::{Surfaces, run};
use super::tags::Tags;
use super::values::write_values;
use crate::volume::content::MeshNotes;
use crate::volume::second::WithMiddles;
use anastomesh_mesh::beside::Beside;
use anastomesh_mesh::geometry::Aabb;
use anastomesh_mesh::second_order::SecondOrder;
use anastomesh_mesh::source::MeshSource;
use anastomesh_mesh::{NamedRegion, Patch, VolumeMesh};
use std::collections::BTreeMap;
use std::io::{self, Write};

/// Volume entity with a part of the tetrahedra.
pub(super) struct Volume {
    /// Physical group and its name; `None` for regions that have no positive number and no name.
    group: Option<(i32, String)>,
    /// Number of tetrahedra.
    tets: usize,
    /// Region of the tetrahedra; `None` for all.
    pub region: Option<i32>,
}

impl Volume {
    /// Physical group.
    pub(super) fn group(&self) -> Option<i32> {
        self.group.as_ref().map(|group| group.0)
    }
}

/// One volume in total, or one per region.
pub(super) fn volumes_of(mesh: &dyn MeshSource, notes: &MeshNotes, surfaces: &Surfaces) -> io::Result<Vec<Volume>> {
    if !notes.regions.is_empty() {
        let mut sizes: BTreeMap<i32, usize> = BTreeMap::new();
        mesh.each_tets(|piece| {
            piece.blocks.iter().for_each(|&region| *sizes.entry(region).or_default() += 1);
            Ok(())
        })?;
        if !sizes.is_empty() {
            let groups = RegionGroups::of(&notes.regions);
            let volume = |(id, tets)| Volume {
                group: groups.of_region(id).map(|group| (group, NamedRegion::name_of(&notes.regions, id))),
                tets,
                region: Some(id),
            };
            return Ok(sizes.into_iter().map(volume).collect());
        }
    }
    let largest = mesh.patches().iter().map(|p| p.id).chain(surfaces.largest).max();
    let tag = largest.map_or(1, |id| id.max(0).saturating_add(1));
    let tets = mesh.counts().tets;
    Ok(vec![Volume { group: Some((tag, VOLUME_NAME.into())), tets, region: None }])
}

/// Writes a mesh as MSH 4.1. Blocks that are regions become volumes; other blocks have no representation in the format
/// and are not written.
///
/// Points and boundary are read three times, tetrahedra once, and each once more per column of values. Memory holds two
/// bits per point, and the faces and points of all surfaces except the first (the wall). Each region takes a pass over
/// the tetrahedra; for a mesh in memory, all regions take 8 bytes per tetrahedron instead.
///
/// # Errors
/// The output `out` or the mesh source fails.
pub(in crate::volume) fn write(
    out: &mut impl Write,
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
    (values, second): (Option<&dyn Beside>, Option<&SecondOrder>),
) -> io::Result<()> {
    let with_middles = second.map(|second| WithMiddles { mesh, second });
    let mesh: &dyn MeshSource = with_middles.as_ref().map_or(mesh, |mesh| mesh);
    let surfaces = Surfaces::of(mesh)?;
    let volumes = volumes_of(mesh, notes, &surfaces)?;
    let mut tags = Tags::new(&surfaces, values.is_some());
    write_before_elements(out, mesh, &surfaces, &volumes, &tags)?;
    write_elements(out, mesh, ElementNodes::of(second), (&surfaces, &volumes), &mut tags)?;
    if let Some(values) = values {
        let regions: Vec<Option<i32>> = volumes.iter().map(|volume| volume.region).collect();
        write_values(out, mesh, values, &surfaces, &regions)?;
    }
    write_extra(out, mesh.patches(), notes)
}

/// Writes the sections before the elements.
pub(super) fn write_before_elements(
    out: &mut impl Write,
    mesh: &dyn MeshSource,
    surfaces: &Surfaces,
    volumes: &[Volume],
    tags: &Tags,
) -> io::Result<()> {
    write_head(out, mesh, surfaces, volumes)?;
    write_nodes(out, mesh, surfaces, tags)
}

/// Writes the sections before the nodes.
pub(super) fn write_head(
    out: &mut impl Write,
    mesh: &dyn MeshSource,
    surfaces: &Surfaces,
    volumes: &[Volume],
) -> io::Result<()> {
    out.write_all(b"$MeshFormat\n4.1 1 8\n")?;
    ints(out, &[1])?;
    out.write_all(b"\n$EndMeshFormat\n")?;
    write_names(out, mesh.patches(), volumes)?;
    write_entities(out, surfaces, volumes)
}

/// Writes the custom section.
pub(super) fn write_extra(out: &mut impl Write, patches: &[Patch], notes: &MeshNotes) -> io::Result<()> {
    writeln!(out, "${SECTION}")?;
    serde_json::to_writer(&mut *out, &Extra::of(patches, notes))?;
    write!(out, "\n$End{SECTION}\n")
}

pub(super) fn corners(bounds: &Aabb) -> [f64; 6] {
    if bounds.min.x > bounds.max.x {
        return [0.0; 6];
    }
    [bounds.min.x, bounds.min.y, bounds.min.z, bounds.max.x, bounds.max.y, bounds.max.z]
}

fn write_names(out: &mut impl Write, patches: &[Patch], volumes: &[Volume]) -> io::Result<()> {
    let named = || patches.iter().filter(|p| p.id > 0);
    let groups = || volumes.iter().filter_map(|volume| volume.group.as_ref());
    writeln!(out, "$PhysicalNames\n{}", named().count() + groups().count())?;
    for patch in named() {
        writeln!(out, "2 {} \"{}\"", patch.id, patch.name.replace('"', "'"))?;
    }
    for (tag, name) in groups() {
        writeln!(out, "3 {tag} \"{}\"", name.replace('"', "'"))?;
    }
    writeln!(out, "$EndPhysicalNames")
}

fn write_entities(out: &mut impl Write, surfaces: &Surfaces, volumes: &[Volume]) -> io::Result<()> {
    let count = surfaces.list.len();
    out.write_all(b"$Entities\n")?;
    sizes(out, &[0, 0, count, volumes.len()])?;
    for (i, surface) in surfaces.list.iter().enumerate() {
        ints(out, &[i as i32 + 1])?;
        floats(out, &corners(&surface.bounds))?;
        // Physical tags are positive: a patch with another id is in no group.
        let groups: &[i32] = if surface.patch > 0 { &[surface.patch] } else { &[] };
        sizes(out, &[groups.len()])?;
        ints(out, groups)?;
        sizes(out, &[0])?;
    }
    for (i, volume) in volumes.iter().enumerate() {
        ints(out, &[i as i32 + 1])?;
        floats(out, &corners(&surfaces.bounds))?;
        let group = volume.group.as_ref().map(|group| group.0);
        sizes(out, &[usize::from(group.is_some())])?;
        ints(out, group.as_slice())?;
        // The surfaces of each region are unknown here.
        let bounding = if volumes.len() == 1 { count } else { 0 };
        sizes(out, &[bounding])?;
        for i in 0..bounding {
            ints(out, &[i as i32 + 1])?;
        }
    }
    out.write_all(b"\n$EndEntities\n")
}

/// Writes the nodes of all surfaces and of the inside.
pub(super) fn write_nodes(
    out: &mut impl Write,
    mesh: &dyn MeshSource,
    surfaces: &Surfaces,
    tags: &Tags,
) -> io::Result<()> {
    let count = mesh.counts().points;
    let inner = count - surfaces.outer.count();
    let blocks = surfaces.list.iter().filter(|surface| surface.points > 0).count() + usize::from(inner > 0);
    out.write_all(b"$Nodes\n")?;
    sizes(out, &[blocks, count, usize::from(count > 0), count])?;
    for (i, surface) in surfaces.list.iter().enumerate().filter(|(_, surface)| surface.points > 0) {
        ints(out, &[2, i as i32 + 1, 0])?;
        sizes(out, &[surface.points])?;
        if i == 0 {
            write_chosen_points(out, mesh, tags, |v| surfaces.first.has(v))?;
            continue;
        }
        for &(v, _) in surfaces.points_of(surface.patch) {
            sizes(out, &[tags.node(v)])?;
        }
        for (_, p) in surfaces.points_of(surface.patch) {
            floats(out, &[p.x, p.y, p.z])?;
        }
    }
    if inner > 0 {
        ints(out, &[3, 1, 0])?;
        sizes(out, &[inner])?;
        write_chosen_points(out, mesh, tags, |v| !surfaces.outer.has(v))?;
    }
    out.write_all(b"\n$EndNodes\n")
}

/// Writes the tags of the selected points, then their positions.
fn write_chosen_points(
    out: &mut impl Write,
    mesh: &dyn MeshSource,
    tags: &Tags,
    chosen: impl Fn(u32) -> bool,
) -> io::Result<()> {
    for v in (0..mesh.counts().points as u32).filter(|&v| chosen(v)) {
        sizes(out, &[tags.node(v)])?;
    }
    let mut before = 0;
    mesh.each_points(|points| {
        for (_, p) in (before..).zip(points).filter(|&(v, _)| chosen(v)) {
            floats(out, &[p.x, p.y, p.z])?;
        }
        before += points.len() as u32;
        Ok(())
    })
}

fn write_elements(
    out: &mut impl Write,
    mesh: &dyn MeshSource,
    elements: ElementNodes,
    (surfaces, volumes): (&Surfaces, &[Volume]),
    tags: &mut Tags,
) -> io::Result<()> {
    let tets = mesh.counts().tets;
    let count = tets + surfaces.list.iter().map(|surface| surface.faces).sum::<usize>();
    out.write_all(b"$Elements\n")?;
    let filled = if tets == 0 { 0 } else { volumes.len() };
    sizes(out, &[surfaces.list.len() + filled, count, usize::from(count > 0), count])?;
    for (i, surface) in surfaces.list.iter().enumerate() {
        ints(out, &[2, i as i32 + 1, elements.face_kind()])?;
        sizes(out, &[surface.faces])?;
        if i == 0 {
            write_faces(out, mesh, elements, surface.patch, tags)?;
            continue;
        }
        for held in surfaces.faces_of(surface.patch) {
            let index = tets + held.face;
            elements.face(held.corners, |_, nodes| write_element(out, tags, index, nodes))?;
        }
    }
    let by_region = match mesh.whole() {
        Some(whole) if volumes.iter().any(|volume| volume.region.is_some()) => by_region(whole),
        _ => Vec::new(),
    };
    for (i, volume) in volumes.iter().enumerate().take(filled) {
        ints(out, &[3, i as i32 + 1, elements.tet_kind()])?;
        sizes(out, &[volume.tets])?;
        match (mesh.whole(), volume.region) {
            (Some(whole), Some(region)) => {
                for &(_, tet) in run(&by_region, region, |tet| tet.0) {
                    let corners = whole.mesh.tets[tet as usize];
                    elements.tet(corners, |_, nodes| write_element(out, tags, tet as usize, nodes))?;
                }
            }
            _ => write_tets(out, mesh, elements, volume.region, tags)?,
        }
    }
    out.write_all(b"\n$EndElements\n")
}

/// Tetrahedra of a mesh in memory sorted by region, which avoids one pass per region.
fn by_region(mesh: &VolumeMesh) -> Vec<(i32, u32)> {
    let mut tets: Vec<(i32, u32)> = mesh.tet_block.iter().copied().zip(0..mesh.mesh.tets.len() as u32).collect();
    tets.sort_unstable();
    tets
}

fn write_faces(
    out: &mut impl Write,
    mesh: &dyn MeshSource,
    elements: ElementNodes,
    patch: i32,
    tags: &mut Tags,
) -> io::Result<()> {
    let mut before = mesh.counts().tets;
    mesh.each_faces(|piece| {
        for (i, (&face, _)) in piece.faces.iter().zip(&*piece.patches).enumerate().filter(|(_, (_, id))| **id == patch)
        {
            elements.face(face, |_, nodes| write_element(out, tags, before + i, nodes))?;
        }
        before += piece.faces.len();
        Ok(())
    })
}

/// Writes the tetrahedra of one region, or all.
fn write_tets(
    out: &mut impl Write,
    mesh: &dyn MeshSource,
    elements: ElementNodes,
    region: Option<i32>,
    tags: &mut Tags,
) -> io::Result<()> {
    let mut before = 0;
    mesh.each_tets(|piece| {
        let chosen = |i: usize| region.is_none_or(|id| piece.blocks.get(i) == Some(&id));
        for (i, &tet) in piece.tets.iter().enumerate().filter(|&(i, _)| chosen(i)) {
            elements.tet(tet, |_, nodes| write_element(out, tags, before + i, nodes))?;
        }
        before += piece.tets.len();
        Ok(())
    })
}

/// Writes an element, given by the indices of itself and its nodes.
fn write_element(out: &mut impl Write, tags: &mut Tags, index: usize, nodes: &[u32]) -> io::Result<()> {
    sizes(out, &[tags.element(index)])?;
    nodes.iter().try_for_each(|&v| sizes(out, &[tags.node(v)]))
}

pub(super) fn ints(out: &mut impl Write, values: &[i32]) -> io::Result<()> {
    values.iter().try_for_each(|v| out.write_all(&v.to_le_bytes()))
}

pub(super) fn sizes(out: &mut impl Write, values: &[usize]) -> io::Result<()> {
    values.iter().try_for_each(|&v| out.write_all(&(v as u64).to_le_bytes()))
}

pub(super) fn floats(out: &mut impl Write, values: &[f64]) -> io::Result<()> {
    values.iter().try_for_each(|v| out.write_all(&v.to_le_bytes()))
}

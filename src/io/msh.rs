//! Gmsh's MSH 4.1, binary: one volume, one surface per patch, physical groups of the patches' names.
//!
//! Node and element tags count from 1 in the order of the mesh (tetrahedra first), so that reading restores the order.
//! What a later check needs to know has no place in the format; it goes into a section of our own, which Gmsh and
//! others pass over.

use super::mesh_file::MeshNotes;
use crate::geometry::Point3;
use crate::mesh::VolumeMesh;
use crate::mesh::check::Expectation;
use std::io::{self, Write};

pub use super::msh_read::read_msh;

/// Gmsh's element types.
pub(super) const MSH_TRIANGLE: i32 = 2;
pub(super) const MSH_TETRA: i32 = 4;

/// Name of the volume's physical group.
pub(super) const VOLUME_NAME: &str = "lumen";

/// Name of our own section.
pub(super) const SECTION: &str = "Anastomesh";

/// What our own section holds, as JSON.
#[derive(Debug, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Extra {
    pub generator: String,
    pub options: String,
    pub loops: Option<Vec<u32>>,
    pub terminals: Option<Vec<u32>>,
    pub caps: Vec<ExtraCap>,
}

/// A cap in our own section.
#[derive(Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct ExtraCap {
    pub patch: i32,
    pub node: u32,
    pub center: [f64; 3],
    pub normal: [f64; 3],
    pub radius: f64,
}

impl Extra {
    fn of(mesh: &VolumeMesh, notes: &MeshNotes) -> Self {
        let cap = |id: i32, cap: &crate::mesh::Cap| ExtraCap {
            patch: id,
            node: cap.node,
            center: cap.center.coords.into(),
            normal: cap.normal.into(),
            radius: cap.radius,
        };
        Self {
            generator: notes.generator.clone(),
            options: notes.options.clone(),
            loops: notes.expectation.as_ref().map(|expected| expected.loops.clone()),
            terminals: notes.expectation.as_ref().map(|expected| expected.terminals.clone()),
            caps: mesh.patches.iter().filter_map(|p| p.cap.as_ref().map(|c| cap(p.id, c))).collect(),
        }
    }

    pub(super) fn into_notes(self) -> (MeshNotes, Vec<ExtraCap>) {
        let terminals = self.terminals.unwrap_or_default();
        let expectation = self.loops.map(|loops| Expectation { loops, terminals });
        let notes = MeshNotes { expectation, generator: self.generator, options: self.options, regions: false };
        (notes, self.caps)
    }
}

/// A surface: the boundary faces of one patch.
struct Surface {
    patch: i32,
    faces: Vec<u32>,
    /// Nodes that are on this surface and on none before it.
    nodes: Vec<u32>,
    /// Corners of the box round it.
    bounds: [f64; 6],
}

/// Part of the tetrahedra: a volume.
struct Volume {
    /// The physical group, and the name of it; none for regions whose id can be no physical tag.
    group: Option<(i32, String)>,
    /// Its tetrahedra; none for all.
    tets: Option<Vec<u32>>,
}

/// One volume for all, or one for each region.
fn volumes_of(mesh: &VolumeMesh, notes: &MeshNotes) -> Vec<Volume> {
    let mut of_region: Vec<(i32, u32)> = mesh.tet_block.iter().copied().zip(0..).collect();
    of_region.sort_unstable();
    if notes.regions && of_region.first().map(|r| r.0) != of_region.last().map(|r| r.0) {
        let volume = |run: &[(i32, u32)]| Volume {
            group: Some((run[0].0, format!("region_{}", run[0].0))).filter(|group| group.0 > 0),
            tets: Some(run.iter().map(|&(_, tet)| tet).collect()),
        };
        return of_region.chunk_by(|a, b| a.0 == b.0).map(volume).collect();
    }
    let patches = mesh.boundary_patch.iter().chain(mesh.patches.iter().map(|p| &p.id));
    let tag = patches.max().map_or(1, |&id| id.max(0).saturating_add(1));
    vec![Volume { group: Some((tag, VOLUME_NAME.into())), tets: None }]
}

/// Writes a mesh as MSH 4.1. Blocks that are regions become volumes; other blocks are not written: the format has no
/// place for them.
///
/// # Errors
/// What the writer `out` reports.
pub fn write_msh(out: &mut impl Write, mesh: &VolumeMesh, notes: &MeshNotes) -> io::Result<()> {
    let mut owned = vec![false; mesh.mesh.points.len()];
    let surfaces = surfaces_of(mesh, &mut owned);
    let volumes = volumes_of(mesh, notes);
    out.write_all(b"$MeshFormat\n4.1 1 8\n")?;
    ints(out, &[1])?;
    out.write_all(b"\n$EndMeshFormat\n")?;
    write_names(out, mesh, &volumes)?;
    write_entities(out, mesh, &surfaces, &volumes)?;
    write_nodes(out, mesh, &surfaces, &owned)?;
    write_elements(out, mesh, &surfaces, &volumes)?;
    writeln!(out, "${SECTION}")?;
    serde_json::to_writer(&mut *out, &Extra::of(mesh, notes))?;
    write!(out, "\n$End{SECTION}\n")
}

/// The patches that have faces, in ascending order; marks the points that lie on them in `owned`.
fn surfaces_of(mesh: &VolumeMesh, owned: &mut [bool]) -> Vec<Surface> {
    let mut by_patch: Vec<(i32, u32)> =
        mesh.boundary_patch.iter().enumerate().map(|(face, &id)| (id, face as u32)).collect();
    by_patch.sort_unstable();
    let mut surfaces = Vec::new();
    for run in by_patch.chunk_by(|a, b| a.0 == b.0) {
        let faces: Vec<u32> = run.iter().map(|&(_, face)| face).collect();
        let mut nodes = Vec::new();
        let vertices = || faces.iter().flat_map(|&face| mesh.boundary[face as usize]);
        for v in vertices() {
            if !std::mem::replace(&mut owned[v as usize], true) {
                nodes.push(v);
            }
        }
        nodes.sort_unstable();
        let bounds = bounds(vertices().map(|v| &mesh.mesh.points[v as usize]));
        surfaces.push(Surface { patch: run[0].0, faces, nodes, bounds });
    }
    surfaces
}

fn bounds<'a>(points: impl Iterator<Item = &'a Point3>) -> [f64; 6] {
    let aabb = crate::geometry::Aabb::of_points(points);
    if aabb.min.x > aabb.max.x {
        return [0.0; 6];
    }
    [aabb.min.x, aabb.min.y, aabb.min.z, aabb.max.x, aabb.max.y, aabb.max.z]
}

fn write_names(out: &mut impl Write, mesh: &VolumeMesh, volumes: &[Volume]) -> io::Result<()> {
    let named = || mesh.patches.iter().filter(|p| p.id > 0);
    let groups = || volumes.iter().filter_map(|volume| volume.group.as_ref());
    writeln!(out, "$PhysicalNames\n{}", named().count() + groups().count())?;
    for patch in named() {
        writeln!(out, "2 {} \"{}\"", patch.id, patch.name.replace('"', "'"))?;
    }
    for (tag, name) in groups() {
        writeln!(out, "3 {tag} \"{name}\"")?;
    }
    writeln!(out, "$EndPhysicalNames")
}

fn write_entities(out: &mut impl Write, mesh: &VolumeMesh, surfaces: &[Surface], volumes: &[Volume]) -> io::Result<()> {
    out.write_all(b"$Entities\n")?;
    sizes(out, &[0, 0, surfaces.len(), volumes.len()])?;
    for (i, surface) in surfaces.iter().enumerate() {
        ints(out, &[i as i32 + 1])?;
        floats(out, &surface.bounds)?;
        // Physical tags are positive: a patch without such an id stays outside the groups.
        let groups: &[i32] = if surface.patch > 0 { &[surface.patch] } else { &[] };
        sizes(out, &[groups.len()])?;
        ints(out, groups)?;
        sizes(out, &[0])?;
    }
    for (i, volume) in volumes.iter().enumerate() {
        ints(out, &[i as i32 + 1])?;
        floats(out, &bounds(mesh.mesh.points.iter()))?;
        let group = volume.group.as_ref().map(|group| group.0);
        sizes(out, &[usize::from(group.is_some())])?;
        ints(out, group.as_slice())?;
        // Which surfaces bound which region is not known here.
        let bounding = if volumes.len() == 1 { surfaces.len() } else { 0 };
        sizes(out, &[bounding])?;
        for i in 0..bounding {
            ints(out, &[i as i32 + 1])?;
        }
    }
    out.write_all(b"\n$EndEntities\n")
}

fn write_nodes(out: &mut impl Write, mesh: &VolumeMesh, surfaces: &[Surface], owned: &[bool]) -> io::Result<()> {
    let count = mesh.mesh.points.len();
    let inner: Vec<u32> = (0..count as u32).filter(|&v| !owned[v as usize]).collect();
    let blocks = || {
        let on_surfaces = surfaces.iter().enumerate().map(|(i, surface)| (2, i as i32 + 1, &surface.nodes));
        on_surfaces.chain([(3, 1, &inner)]).filter(|(_, _, nodes)| !nodes.is_empty())
    };
    out.write_all(b"$Nodes\n")?;
    sizes(out, &[blocks().count(), count, usize::from(count > 0), count])?;
    for (dimension, tag, nodes) in blocks() {
        ints(out, &[dimension, tag, 0])?;
        sizes(out, &[nodes.len()])?;
        for &v in nodes {
            sizes(out, &[v as usize + 1])?;
        }
        for &v in nodes {
            let p = &mesh.mesh.points[v as usize];
            floats(out, &[p.x, p.y, p.z])?;
        }
    }
    out.write_all(b"\n$EndNodes\n")
}

fn write_elements(out: &mut impl Write, mesh: &VolumeMesh, surfaces: &[Surface], volumes: &[Volume]) -> io::Result<()> {
    let (tets, faces) = (&mesh.mesh.tets, &mesh.boundary);
    let count = tets.len() + surfaces.iter().map(|surface| surface.faces.len()).sum::<usize>();
    out.write_all(b"$Elements\n")?;
    let filled = if tets.is_empty() { 0 } else { volumes.len() };
    sizes(out, &[surfaces.len() + filled, count, usize::from(count > 0), count])?;
    for (i, surface) in surfaces.iter().enumerate() {
        ints(out, &[2, i as i32 + 1, MSH_TRIANGLE])?;
        sizes(out, &[surface.faces.len()])?;
        for &face in &surface.faces {
            let [a, b, c] = faces[face as usize].map(|v| v as usize + 1);
            sizes(out, &[tets.len() + face as usize + 1, a, b, c])?;
        }
    }
    for (i, volume) in volumes.iter().enumerate().take(filled) {
        ints(out, &[3, i as i32 + 1, MSH_TETRA])?;
        sizes(out, &[volume.tets.as_ref().map_or(tets.len(), Vec::len)])?;
        let mut write = |tet: usize| {
            let [a, b, c, d] = tets[tet].map(|v| v as usize + 1);
            sizes(out, &[tet + 1, a, b, c, d])
        };
        match &volume.tets {
            Some(list) => list.iter().try_for_each(|&tet| write(tet as usize))?,
            None => (0..tets.len()).try_for_each(&mut write)?,
        }
    }
    out.write_all(b"\n$EndElements\n")
}

fn ints(out: &mut impl Write, values: &[i32]) -> io::Result<()> {
    values.iter().try_for_each(|v| out.write_all(&v.to_le_bytes()))
}

fn sizes(out: &mut impl Write, values: &[usize]) -> io::Result<()> {
    values.iter().try_for_each(|&v| out.write_all(&(v as u64).to_le_bytes()))
}

fn floats(out: &mut impl Write, values: &[f64]) -> io::Result<()> {
    values.iter().try_for_each(|v| out.write_all(&v.to_le_bytes()))
}

#[cfg(test)]
#[path = "msh_tests.rs"]
mod tests;

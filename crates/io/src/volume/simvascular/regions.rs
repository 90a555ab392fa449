//! Folder of a mesh with regions: a `mesh-complete` folder for each, and a case of fluid–structure interaction.

use super::complete::{MeshComplete, Numbers, caps, write_sheet};
use super::layout::{SOLVER, surface_path};
use super::sheet::CapSheet;
use super::spool::Spool;
use super::steps::Steps;
use super::{fsi, inflow};
use crate::file::AtomicFolder;
use crate::flow::{Role, plain};
use crate::patches::usual_name;
use crate::volume::content::MeshNotes;
use crate::volume::second::CellNodes;
use anastomesh_mesh::Patch;
use anastomesh_mesh::progress::{Progress, ask};
use anastomesh_mesh::region::{NamedRegion, RegionMesh, RegionMeshes};
use anastomesh_mesh::source::{MeshSource, gather};
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Cursor};
use std::path::Path;

/// Writes the files of a folder. Nodes and elements have their numbers in the whole mesh, so that points on an interface
/// have equal numbers on both sides. The mesh is held in memory, and one region.
///
/// # Errors
/// The operating system or the mesh source fails; `InvalidInput` if no region is named `lumen`.
pub(super) fn write(
    folder: &AtomicFolder,
    path: &Path,
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
    progress: &dyn Progress,
) -> io::Result<()> {
    if NamedRegion::id_of(&notes.regions, NamedRegion::LUMEN).is_none() {
        let text = "no region is named 'lumen', which the flow needs; write .vtu or .msh, or rename a region";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, text));
    }
    let volume = mesh.whole().map_or_else(|| gather(mesh).map(Cow::Owned), |volume| Ok(Cow::Borrowed(volume)))?;
    let meshes = RegionMeshes::of(&volume, &notes.regions);
    let mut solids = Vec::new();
    let mut fluid = None;
    let flow = &notes.flow_of(mesh.patches());
    for region in &notes.regions {
        let part = meshes.mesh(region);
        if part.tets.is_empty() {
            continue;
        }
        write_region(folder, path, &part, progress)?;
        if region.name == NamedRegion::LUMEN {
            let steps = write_inflow(folder, path, &part, notes, progress)?;
            fluid = Some((fsi::Part::of(&part), steps));
        } else {
            solids.push(fsi::Part::of(&part));
        }
    }
    if let Some((lumen, steps)) = fluid {
        folder.put(SOLVER, fsi::text(&lumen, &solids, flow, &steps).as_bytes())?;
    }
    Ok(())
}

/// Writes the mesh of a region with its surfaces.
fn write_region(folder: &AtomicFolder, path: &Path, part: &RegionMesh, progress: &dyn Progress) -> io::Result<()> {
    let mesh = &part.volume;
    let name = format!("{}/", plain(&part.region.name));
    let numbers = Numbers { points: Some(&part.points), tets: Some(&part.tets), region: part.region.id };
    let (spool, nodes) = (Spool::of(mesh, path, progress)?, CellNodes::default());
    let complete = MeshComplete { folder, prefix: &name, mesh, nodes, spool: &spool, numbers, progress };
    let ends = ends(&mesh.patches);
    complete.write(&|face| !ends.contains(&face.patch))?;
    for (id, faces) in caps(&spool, |_| true)? {
        let named = mesh.patches.iter().find(|patch| patch.id == id);
        let surface = surface_path(&named.map_or_else(|| usual_name(id), |patch| plain(&patch.name)));
        let mut bytes = Cursor::new(Vec::new());
        write_sheet(&mut bytes, &CapSheet::new(mesh, nodes, &faces)?, &numbers)?;
        folder.put(&format!("{name}{surface}"), bytes.get_ref())?;
        ask(progress)?;
    }
    Ok(())
}

/// Inlets and outlets.
fn ends(patches: &[Patch]) -> Vec<i32> {
    patches.iter().filter(|patch| Role::of(patch) != Role::Wall).map(|patch| patch.id).collect()
}

/// Writes the flow into the inlets of the lumen; returns the time steps.
fn write_inflow(
    folder: &AtomicFolder,
    path: &Path,
    lumen: &RegionMesh,
    notes: &MeshNotes,
    progress: &dyn Progress,
) -> io::Result<Steps> {
    let mesh = &lumen.volume;
    let flow = &notes.flow_of(&mesh.patches);
    let ends = ends(&mesh.patches);
    let spool = Spool::of(mesh, path, progress)?;
    let faces = caps(&spool, |patch| ends.contains(&patch))?;
    let mut edges = BTreeMap::new();
    for (&id, faces) in &faces {
        edges.insert(id, CapSheet::new(mesh, CellNodes::default(), faces)?.edge());
    }
    let steps = Steps::of(&mesh.patches, flow, &edges);
    for patch in mesh.patches.iter().filter(|patch| patch.is_inlet()) {
        let cap = CapSheet::new(mesh, CellNodes::default(), faces.get(&patch.id).map_or(&[], Vec::as_slice))?;
        if let Some((name, text)) = inflow::file(patch, &cap, flow, &steps) {
            folder.put(&name, text.as_bytes())?;
        }
        ask(progress)?;
    }
    Ok(steps)
}

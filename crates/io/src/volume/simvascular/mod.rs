//! `SimVascular` folder `mesh-complete` for `svMultiPhysics`: tetrahedra, whole boundary, patches, flow rates of
//! inlets, and `solver.xml`.
//! All numbers count from 1 in 32 bits. Of a mesh with regions, each has such a folder, and `solver.xml` couples them.
//! Second-order elements have ten nodes, faces six, and the solver gets velocities of second and pressures of first order.

#[cfg(test)]
mod case_tests;
mod complete;
mod fsi;
mod inflow;
mod layout;
mod regions;
#[cfg(test)]
mod regions_tests;
mod sheet;
mod solver;
mod spool;
mod steps;
#[cfg(test)]
mod tests;

use super::content::MeshNotes;
use super::second::{CellNodes, WithMiddles};
use crate::file::{AtomicFolder, OutputSet};
use crate::flow::plain;
use crate::patches::usual_name;
use anastomesh_mesh::WALL;
use anastomesh_mesh::progress::{Progress, ask};
use anastomesh_mesh::second_order::SecondOrder;
use anastomesh_mesh::source::MeshSource;
use complete::{MeshComplete, Numbers, caps, ensure_countable, write_sheet};
use layout::{SOLVER, WALLS, is_ours, surface_path};
use sheet::CapSheet;
use spool::Spool;
use std::collections::BTreeMap;
use std::io::{self, Cursor};
use std::path::Path;
use steps::Steps;

/// Checks that the folder can be created or replaced, without side effects.
pub(super) fn ensure_writable(path: &Path) -> io::Result<()> {
    AtomicFolder::create(path, is_ours).map(drop)
}

/// Writes a folder under a temporary name.
///
/// The boundary is stored in a temporary file, with the tetrahedron at each face, and read from it. Memory holds the
/// faces of inlets and outlets, those between parts of the mesh, and a bit per point.
///
/// # Errors
/// The operating system or the mesh source fails; `InvalidData` if the labelled faces are not its boundary.
pub(super) fn stage(
    path: &Path,
    mesh: &dyn MeshSource,
    second: Option<&SecondOrder>,
    notes: &MeshNotes,
    progress: &dyn Progress,
) -> io::Result<OutputSet> {
    let folder = AtomicFolder::create(path, is_ours)?;
    ensure_countable(mesh, CellNodes(second))?;
    if !notes.regions.is_empty() {
        if second.is_some() {
            let text = "second-order meshes with regions are written to .vtu, .msh, .msh2 and .npyd";
            return Err(io::Error::new(io::ErrorKind::Unsupported, text));
        }
        regions::write(&folder, path, mesh, notes, progress)?;
        return Ok(folder.stage());
    }
    let (spool, nodes) = (Spool::of(mesh, path, progress)?, CellNodes(second));
    let with_middles = second.map(|second| WithMiddles { mesh, second });
    let mesh: &dyn MeshSource = with_middles.as_ref().map_or(mesh, |mesh| mesh);
    let numbers = Numbers::default();
    MeshComplete { folder: &folder, prefix: "", mesh, nodes, spool: &spool, numbers, progress }
        .write(&|face| face.patch == WALL)?;
    let names: BTreeMap<i32, String> = mesh.patches().iter().map(|p| (p.id, plain(&p.name))).collect();
    let surface = |id: i32| surface_path(names.get(&id).map_or(&usual_name(id), |name| name));
    folder.copy(WALLS, &surface(WALL))?;
    let caps = caps(&spool, |patch| patch != WALL)?;
    let mut edges = BTreeMap::new();
    for (&id, faces) in &caps {
        let cap = CapSheet::new(mesh, nodes, faces)?;
        edges.insert(id, cap.edge());
        let mut bytes = Cursor::new(Vec::new());
        write_sheet(&mut bytes, &cap, &numbers)?;
        folder.put(&surface(id), bytes.get_ref())?;
        ask(progress)?;
    }
    let flow = &notes.flow_of(mesh.patches());
    let steps = Steps::of(mesh.patches(), flow, &edges);
    for patch in mesh.patches().iter().filter(|patch| patch.is_inlet()) {
        let cap = CapSheet::new(mesh, nodes, caps.get(&patch.id).map_or(&[], Vec::as_slice))?;
        if let Some((name, text)) = inflow::file(patch, &cap, flow, &steps) {
            folder.put(&name, text.as_bytes())?;
        }
        ask(progress)?;
    }
    folder.put(SOLVER, solver::text(mesh.patches(), flow, &steps, second.is_some()).as_bytes())?;
    Ok(folder.stage())
}

//! `OpenFOAM` cases: a folder with the mesh in `constant/polyMesh` and all dictionaries for `simpleFoam`, or for
//! `pimpleFoam` if the flow has a time. Meshes with regions have zones, and dictionaries for `laplacianFoam`.

mod boundary;
mod case;
mod diffusion;
mod fields;
mod figures;
mod head;
mod inflow;
mod joined;
#[cfg(test)]
mod layered_tests;
mod lists;
mod outer;
mod outlets;
mod poly_mesh;
mod processors;
#[cfg(test)]
mod processors_tests;
mod profile;
mod rules;
mod spools;
mod system;
#[cfg(test)]
mod tests;
mod zones;
#[cfg(test)]
mod zones_tests;

use super::content::MeshNotes;
use super::parts::{Partition, PartsError};
use crate::file::{AtomicFolder, OutputSet};
use crate::flow::{Flow, Role};
use anastomesh_mesh::faces::Faces;
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::source::MeshSource;
use anastomesh_mesh::stacks::Cells;
use boundary::Boundary;
use outlets::Outlets;
use processors::Processors;
use profile::InletFaces;
use rules::Settings;
use spools::Spools;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::io;
use std::num::NonZeroUsize;
use std::path::Path;

/// Data of the text files.
struct Case<'a> {
    boundary: &'a Boundary,
    flow: &'a Flow,
    settings: &'a Settings,
    /// Number of parts, if the case is decomposed.
    parts: Option<usize>,
}

/// Writer of a text file in the folder.
type Text = fn(&Case) -> String;

const TEXTS: [(&str, Text); 9] = [
    ("constant/polyMesh/boundary", |case| case::boundary(case.boundary)),
    ("constant/transportProperties", |case| case::transport(case.flow)),
    ("constant/turbulenceProperties", |_| case::turbulence()),
    ("system/controlDict", |case| system::control(case.flow)),
    ("system/fvSchemes", |case| system::schemes(case.flow, case.settings)),
    ("system/fvSolution", |case| system::solution(case.flow, case.settings)),
    ("system/decomposeParDict", |case| case::decompose(case.parts)),
    ("0/U", |case| fields::velocity(case.boundary, case.flow, case.parts)),
    ("0/p", |case| fields::pressure(case.boundary, case.flow, case.settings, case.parts)),
];

/// Empty marker file that `ParaView` opens.
const FOR_PARAVIEW: &str = "case.foam";

/// Checks that the folder can be created or replaced, without side effects.
pub(super) fn ensure_writable(path: &Path) -> io::Result<()> {
    AtomicFolder::create(path, is_ours).map(drop)
}

fn is_ours(name: &str) -> bool {
    let in_folder = |folder: &str| name.strip_prefix(folder).is_some_and(|rest| rest.starts_with('/'));
    name == FOR_PARAVIEW
        || poly_mesh::FILES.contains(&name)
        || TEXTS.iter().any(|(text, _)| *text == name)
        || [zones::CELL_ZONES, zones::FACE_ZONES].contains(&name)
        || diffusion::FILES.contains(&name)
        || processors::is_ours(name)
        || in_folder(inflow::WAVEFORMS)
        || in_folder(inflow::VELOCITIES)
}

/// Writes a case under a temporary name. A mesh with regions becomes cell zones and a case of diffusion ([`zones`]). Solver results in an existing folder are an error. `remark` receives each reason why the
/// case is not expected to converge.
///
/// Tetrahedra are read twice, points twice, the boundary three times. A mesh with layers is read once more. Memory holds
/// the faces between parts of the mesh, about 50 bytes each, and the position of every patch. With layers it also holds a
/// byte per face.
///
/// With `parts`, the folders of processors are written beside the undivided mesh, which `reconstructPar` and other serial
/// programs need. Their faces are first stored in a temporary file, 36 bytes each.
///
/// # Errors
/// The operating system or the mesh source fails; `InvalidData` if the labelled faces are not its boundary. `PartsError`
/// if there are more parts than cells, or the mesh has regions.
pub(super) fn stage(
    path: &Path,
    mesh: &dyn MeshSource,
    notes: &MeshNotes,
    parts: Option<NonZeroUsize>,
    remark: &dyn Fn(&str),
    progress: &dyn Progress,
) -> io::Result<OutputSet> {
    let folder = AtomicFolder::create(path, is_ours)?;
    if !notes.regions.is_empty() {
        if parts.is_some() {
            let (what, instead) = ("regions of an OpenFOAM case", "run decomposePar in the case");
            return Err(PartsError::Content { what, instead }.into());
        }
        zones::write(&folder, mesh, notes, remark, progress)?;
        folder.put(FOR_PARAVIEW, b"")?;
        return Ok(folder.stage());
    }
    let cells = Cells::of(mesh)?;
    let cells = cells.as_ref();
    let faces = Faces::of(mesh)?;
    let boundary = Boundary::of(mesh, &faces, cells)?;
    let partition = parts.map(|parts| Partition::of(mesh, parts, cells)).transpose()?;
    let mut spools = partition.as_ref().map(|partition| Spools::new(partition, path)).transpose()?;
    let figures = poly_mesh::write(&folder, mesh, &faces, cells, &boundary, spools.as_mut(), progress)?;
    let flow = &*notes.flow_of(mesh.patches());
    let coupled = Outlets::of(&boundary, flow).are_coupled();
    let settings =
        Settings::of(&figures, cells.is_some(), reynolds(&boundary, flow), coupled, flow.transient.is_some());
    settings.doubts.iter().for_each(|doubt| remark(doubt));
    let parts = parts.map(NonZeroUsize::get);
    let case = Case { boundary: &boundary, flow, settings: &settings, parts };
    for (name, text) in TEXTS {
        folder.put(name, text(&case).as_bytes())?;
    }
    if let (Some(spools), Some(partition)) = (spools, &partition) {
        let fields = [fields::velocity(&boundary, flow, parts), fields::pressure(&boundary, flow, &settings, parts)];
        let processors = Processors { mesh, boundary: &boundary, partition, spools };
        processors.write(&folder, [&fields[0], &fields[1]], progress)?;
    }
    let inlets = if inflow::is_mapped(flow) { InletFaces::of(mesh, &faces, cells)? } else { BTreeMap::new() };
    inflow::write(&folder, &boundary, flow, &inlets)?;
    folder.put(FOR_PARAVIEW, b"")?;
    Ok(folder.stage())
}

/// Highest Reynolds number of the inlets, by mean velocity and diameter; of their peak flow rate in pulsatile flow.
fn reynolds(boundary: &Boundary, flow: &Flow) -> f64 {
    let of_inlet = |patch: &boundary::FoamPatch| {
        let cap = flow.at(&patch.patch);
        let rate = flow.transient.and(cap.waveform.as_ref()).map_or(cap.flow.abs(), crate::flow::Waveform::peak);
        let radius = patch.patch.cap.as_ref().map_or(f64::INFINITY, |cap| cap.radius);
        2.0 * rate * flow.density / (PI * radius * flow.viscosity)
    };
    boundary.with_role(Role::Inlet).map(of_inlet).fold(0.0, f64::max)
}

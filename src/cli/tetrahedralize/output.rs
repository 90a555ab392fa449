//! Writing of the mesh.

use std::io::Write;
use std::num::NonZeroUsize;
use std::path::PathBuf;

use super::format::Target;
use super::input::Input;
use super::plan::{TetPlan, Wanted};
use crate::cli::exit::Failure;
use crate::cli::stop::NOTHING_KEPT;
use anastomesh_io::OutputSet;
use anastomesh_io::tetgen::{Extent, MeshFamily};
use anastomesh_io::volume::{MeshNotes, WriteOptions, stage_mesh, write_mesh_to};
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::region::{NamedRegion, label_faces};
use anastomesh_mesh::second_order::SecondOrder;
use anastomesh_mesh::{Patch, VolumeMesh};
use anastomesh_tet::Tetrahedralization;

/// Marker of all faces of an unmarked input.
const UNMARKED: i32 = 1;

/// Mesh for the writers: regions are blocks, markers are patches.
pub fn volume(made: Tetrahedralization, input: &Input) -> VolumeMesh {
    let boundary = made.faces;
    let marked = input.marked && made.face_markers.len() == boundary.len();
    let boundary_patch = if marked { made.face_markers } else { vec![UNMARKED; boundary.len()] };
    let mut ids = boundary_patch.clone();
    ids.sort_unstable();
    ids.dedup();
    let named = |id: i32| input.names.iter().find(|named| named.0 == id).map(|named| named.1.clone());
    let name = |id: i32| match named(id) {
        Some(name) if marked => name,
        _ if marked => format!("marker_{id}"),
        _ => "boundary".into(),
    };
    let mut volume = VolumeMesh {
        tet_block: made.regions,
        boundary_block: vec![0; boundary.len()],
        patches: ids.into_iter().map(|id| Patch { id, name: name(id), cap: None }).collect(),
        mesh: made.mesh,
        boundary,
        boundary_patch,
    };
    if volume.tet_block.is_empty() {
        volume.tet_block = vec![0; volume.mesh.tets.len()];
    } else {
        label_faces(&mut volume);
    }
    volume
}

/// Mesh to write.
#[derive(Clone, Copy)]
pub struct MeshParts<'a> {
    pub volume: &'a VolumeMesh,
    /// Layer of each tetrahedron.
    pub layers: &'a [i32],
    /// Midpoints of second-order elements.
    pub second_order: Option<&'a SecondOrder>,
}

/// Writes the mesh under temporary names or to the standard output, in parts on request. Returns the files.
pub fn stage(
    (target, parts): (&Target, Option<NonZeroUsize>),
    MeshParts { volume, layers, second_order }: MeshParts,
    input: &Input,
    plan: &TetPlan,
    progress: &dyn Progress,
) -> Result<(Vec<PathBuf>, OutputSet), Failure> {
    let is_labelled = volume.tet_block.iter().any(|&region| region != 0);
    let regions = if is_labelled { NamedRegion::all_numbered(volume.tet_block.iter().copied()) } else { Vec::new() };
    let generator = concat!("anastomesh ", env!("CARGO_PKG_VERSION")).into();
    // Only options that affect the mesh: neither threads nor paths.
    let options = serde_json::to_string(plan).map_err(|e| Failure::stage(format!("cannot write JSON: {e}")))?;
    let notes =
        MeshNotes { expectation: None, generator, options: format!("tetrahedralize {options}"), regions, flow: None };
    let failed = |e: &dyn std::error::Error| {
        if progress.is_cancelled() { Failure::stopped(NOTHING_KEPT) } else { Failure::input(e.to_string()) }
    };
    match target {
        Target::File(path) => {
            let options = WriteOptions::default().parts(parts).layers(layers).second_order(second_order);
            let outputs = stage_mesh(&options, path, volume, &notes, progress).map_err(|e| failed(&e))?;
            Ok((vec![path.clone()], outputs))
        }
        Target::Family(base) => {
            let family = family(volume, input, plan, is_labelled).progress(progress);
            family.stage(base).map_err(|e| failed(&e))
        }
        Target::Stream(format) => {
            let mut out = std::io::stdout().lock();
            let written = write_mesh_to(&mut out, *format, volume, &notes).and_then(|()| out.flush());
            match written {
                // A closed pipe is not an error.
                Err(e) if e.kind() != std::io::ErrorKind::BrokenPipe => {
                    Err(Failure::input(format!("standard output: {e}")))
                }
                _ => Ok((Vec::new(), OutputSet::default())),
            }
        }
    }
}

fn family<'a>(volume: &'a VolumeMesh, input: &'a Input, plan: &TetPlan, regions: bool) -> MeshFamily<'a> {
    let extent = |wanted: Wanted| match wanted {
        Wanted::Nothing => Extent::Nothing,
        Wanted::Boundary => Extent::Boundary,
        Wanted::All => Extent::All,
    };
    let mut family = MeshFamily::new(&volume.mesh)
        .boundary(&volume.boundary, &volume.boundary_patch)
        .point_attributes(&input.point_attributes, input.attribute_count)
        .segments(&input.plc.segments)
        .faces(extent(plan.family.faces))
        .edges(extent(plan.family.edges))
        .neighbors(plan.family.neighbors)
        .first_number(plan.family.first.unwrap_or(input.first));
    if regions {
        family = family.regions(&volume.tet_block).region_attributes(&input.attributes);
    }
    if !input.point_markers.is_empty() {
        family = family.point_markers(&input.point_markers);
    }
    family
}

//! `anastomesh check`: a volume mesh verified line by line.

use std::path::PathBuf;

use super::exit::{Exit, Failure};
use crate::io::mesh_file::read_mesh;
use crate::mesh::check::{Verdict, check_tets, check_volume};
use crate::mesh::{TET_FACES, VolumeMesh};
use rustc_hash::FxHashMap;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// The mesh: VTU, PVTU, MSH 4.1, Medit .mesh, or TetGen's .ele
    #[arg(value_name = "MESH")]
    mesh: PathBuf,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Checks a mesh file and prints the result of every line.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let mut file = read_mesh(&args.mesh).map_err(|e| Failure::input(e.to_string()))?;
    if file.notes.expectation.is_none() {
        drop_interior_faces(&mut file.volume);
    }
    let expectation = file.notes.expectation.as_ref();
    let report = if file.labelled {
        check_volume(&file.volume, expectation)
    } else {
        check_tets(&file.volume.mesh, expectation)
    };
    super::print(args.json, &report, || crate::report::check::text(&report))?;
    Ok(if report.verdict == Verdict::Invalid { Exit::GateNotMet } else { Exit::Fine })
}

/// Leaves out the labelled faces that lie between two tetrahedra: meshes of others, and of complexes of facets, label
/// surfaces inside as well. A network's mesh has none, and would be wrong if it had.
fn drop_interior_faces(volume: &mut VolumeMesh) {
    let sorted = |mut face: [u32; 3]| {
        face.sort_unstable();
        face
    };
    let mut owners: FxHashMap<[u32; 3], u32> = volume.boundary.iter().map(|&face| (sorted(face), 0)).collect();
    for t in &volume.mesh.tets {
        for side in TET_FACES {
            if let Some(count) = owners.get_mut(&sorted(side.map(|corner| t[corner]))) {
                *count += 1;
            }
        }
    }
    let inside = |face: &[u32; 3]| owners.get(&sorted(*face)).is_some_and(|&count| count >= 2);
    let keep: Vec<bool> = volume.boundary.iter().map(|face| !inside(face)).collect();
    retain(&mut volume.boundary, &keep);
    retain(&mut volume.boundary_patch, &keep);
    retain(&mut volume.boundary_block, &keep);
}

fn retain<T>(list: &mut Vec<T>, keep: &[bool]) {
    let mut kept = keep.iter();
    list.retain(|_| kept.next().copied().unwrap_or(true));
}

//! `anastomesh check`: a volume mesh verified line by line.

use std::path::PathBuf;

use super::common::print;
use super::exit::{Exit, Failure};
use super::kind::OpenedMesh;
use super::page::ReportArgs;
use super::room;
use crate::io::volume::{MeshFormat, read_mesh};
use crate::io::volume::{VtuPieces, VtuPiecesError};
use crate::mesh::check::parts::{PiecesError, check_pieces};
use crate::mesh::check::{CheckReport, Verdict, check_tets, check_volume};
use crate::mesh::dihedral::DihedralHistogram;
use crate::mesh::{TET_FACES, VolumeMesh};
use crate::report::page::{self, Section};
use rustc_hash::FxHashMap;

/// Bytes of memory that the check of a whole takes for each byte of its file.
const MEMORY_PER_BYTE: u64 = 8;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// The mesh: VTU, PVTU, MSH 4.1, Medit .mesh, TetGen's .ele, or .npyd (`NumPy`'s arrays)
    #[arg(value_name = "MESH")]
    mesh: PathBuf,
    /// Memory to keep to with a VTU file of the verb mesh: when it needs more, it is checked block by block. All other
    /// files are held as a whole
    #[arg(long, value_name = "SIZE", default_value = "2GiB", value_parser = room::size)]
    memory: u64,
    #[command(flatten)]
    report: ReportArgs,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Checks a mesh file and prints the result of every line.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    args.report.ensure_writable()?;
    let (report, mesh) = match by_blocks(args)? {
        Some(checked) => checked,
        None => as_a_whole(args)?,
    };
    print(args.json, &report, || report.to_string())?;
    write_page(args, &report, mesh)?;
    Ok(if report.verdict == Verdict::Invalid { Exit::GateNotMet } else { Exit::Fine })
}

/// Writes the page of `--report`.
fn write_page(args: &Args, report: &CheckReport, mut mesh: OpenedMesh) -> Result<(), Failure> {
    mesh.label_boundary();
    let (mesh, notes) = (mesh.source(), mesh.notes());
    args.report.write(&args.mesh, Some(page::headline(report)), &notes.options, |page| {
        page.add(page::summary(report));
        page.add(Section::new("At a glance").pictures(&page::mesh_pictures(mesh)?, false)?);
        page.add(page::validity(report, mesh)?);
        if let Some(quality) = &report.quality {
            page.add(page::quality(quality, &DihedralHistogram::of(mesh)?));
        }
        page.add(page::named_patches(mesh.patches()));
        Ok(())
    })
}

fn as_a_whole(args: &Args) -> Result<(CheckReport, OpenedMesh), Failure> {
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
    Ok((report, OpenedMesh::Whole(file)))
}

/// Checks a large file without holding the mesh; none when it is not large, or has to be held.
fn by_blocks(args: &Args) -> Result<Option<(CheckReport, OpenedMesh)>, Failure> {
    let length = std::fs::metadata(&args.mesh).map_or(0, |data| data.len());
    if length.saturating_mul(MEMORY_PER_BYTE) <= args.memory || MeshFormat::of(&args.mesh).ok() != Some(MeshFormat::Vtu)
    {
        return Ok(None);
    }
    let path = args.mesh.display();
    let held = |why: &dyn std::fmt::Display| {
        eprintln!("anastomesh: {path} is held as a whole, which may need more than --memory: {why}");
        Ok(None)
    };
    let refused = |source| Failure::input(format!("{path}: cannot be read: {source}; write or copy it again"));
    // A share for blocks of the file, one for walls; what is known of each block takes the rest.
    let share = (args.memory / 4) as usize;
    let pieces = match VtuPieces::open(&args.mesh, share) {
        Ok(pieces) => pieces,
        Err(VtuPiecesError::Read(source)) => return Err(refused(source)),
        Err(why) => return held(&why),
    };
    let expectation = pieces.notes().expectation.as_ref();
    if expectation.is_none() {
        return held(&"it does not say what is expected of it");
    }
    match check_pieces(&pieces, expectation, share) {
        Ok(report) => Ok(Some((report, OpenedMesh::Pieces(pieces)))),
        Err(PiecesError::Read(source)) => Err(refused(source)),
        Err(why) => held(&why),
    }
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

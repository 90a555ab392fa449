//! `anastomesh check`: a volume mesh verified line by line.

use std::path::{Path, PathBuf};

use super::common::{Common, ended, print, thread_pool};
use super::exit::{Exit, Failure};
use super::kind::{OpenedMesh, held, unreadable};
use super::limits;
use super::log;
use super::page::ReportArgs;
use super::progress::Bars;
use super::stop::Stop;
use crate::report::page::{self, Section};
use crate::report::summary::{of_check, of_mesh};
use anastomesh_io::volume::{MeshFile, MeshFormat, VtuPieces, VtuPiecesError, read_mesh};
use anastomesh_mesh::check::parts::{PiecesError, check_pieces};
use anastomesh_mesh::check::text::conditions;
use anastomesh_mesh::check::{CheckReport, Verdict, check_tets, check_volume};
use anastomesh_mesh::dihedral::DihedralHistogram;
use anastomesh_mesh::progress::Stage;
use anastomesh_mesh::{TET_FACES, VolumeMesh};
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
    #[arg(long, value_name = "SIZE", default_value = "2GiB", value_parser = limits::size)]
    memory: u64,
    #[command(flatten)]
    report: ReportArgs,
    #[command(flatten)]
    common: Common,
}

/// Checks a mesh file and prints the result of every line.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    args.report.ensure_writable()?;
    let pool = thread_pool(args.common.threads)?;
    let bar = Bars::new(args.common.quiet, args.common.progress, Stop::deaf());
    let (report, mesh) = bar.during(Stage::Check, || pool.install(|| checked(args)))?;
    let is_wrong = report.verdict == Verdict::Invalid;
    pool.install(|| write_page(args, &report, mesh))?;
    if args.common.json || is_wrong || !args.common.quiet {
        print(args.common.json, &report, || text(&report, args))?;
    }
    Ok(if is_wrong { Exit::GateNotMet } else { Exit::Fine })
}

fn checked(args: &Args) -> Result<(CheckReport, OpenedMesh), Failure> {
    by_blocks(args)?.map_or_else(|| as_a_whole(args), Ok)
}

/// For people: how large the mesh is, how many conditions hold, and which do not; with `-v` all of them.
fn text(report: &CheckReport, args: &Args) -> String {
    let verbose = args.common.verbose;
    let page: Vec<&Path> = args.report.page().into_iter().map(PathBuf::as_path).collect();
    let all = if verbose { conditions(report) } else { String::new() };
    format!("{all}{}{}{}", of_mesh(report), ended(&page).rows(&[]), of_check(report, verbose))
}

/// Writes the page of `--report`.
fn write_page(args: &Args, report: &CheckReport, mut mesh: OpenedMesh) -> Result<(), Failure> {
    mesh.label_boundary();
    let (mesh, notes) = (mesh.source(), mesh.notes());
    args.report.write(&args.mesh, Some(page::headline(report)), &notes.options, |page| {
        page.add(page::summary(report, page::LengthUnit::default()));
        page.add(Section::new("Overview").pictures(&page::mesh_pictures(mesh)?, false)?);
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
    Ok((of_whole(&file), OpenedMesh::Whole(file)))
}

fn of_whole(file: &MeshFile) -> CheckReport {
    let expectation = file.notes.expectation.as_ref();
    if file.labelled { check_volume(&file.volume, expectation) } else { check_tets(&file.volume.mesh, expectation) }
}

/// Checks a large file without holding the mesh; none when it is not large, or has to be held.
fn by_blocks(args: &Args) -> Result<Option<(CheckReport, OpenedMesh)>, Failure> {
    let length = std::fs::metadata(&args.mesh).map_or(0, |data| data.len());
    if length.saturating_mul(MEMORY_PER_BYTE) <= args.memory || MeshFormat::of(&args.mesh).ok() != Some(MeshFormat::Vtu)
    {
        return Ok(None);
    }
    // A share for blocks of the file, one for walls; what is known of each block takes the rest.
    let report = match VtuPieces::open(&args.mesh, share(args.memory)) {
        Ok(pieces) => of_pieces(&args.mesh, &pieces, args.memory)?.map(|report| (report, OpenedMesh::Pieces(pieces))),
        Err(VtuPiecesError::Read(source)) => return Err(unreadable(&args.mesh, &source)),
        Err(why) => Err(why.to_string()),
    };
    Ok(report.map_err(|why| held(&args.mesh, &why)).ok())
}

fn share(memory: u64) -> usize {
    (memory / 4) as usize
}

/// Checks pieces; or why they cannot be checked as such.
fn of_pieces(path: &Path, pieces: &VtuPieces, memory: u64) -> Result<Result<CheckReport, String>, Failure> {
    let expectation = pieces.notes().expectation.as_ref();
    if expectation.is_none() {
        return Ok(Err("it does not say what is expected of it".into()));
    }
    match check_pieces(pieces, expectation, share(memory)) {
        Ok(report) => Ok(Ok(report)),
        Err(PiecesError::Read(source)) => Err(unreadable(path, &source)),
        Err(why) => Ok(Err(why.to_string())),
    }
}

/// Checks a mesh that is open, without holding it if it is not held; none, with a word, where that cannot be done.
pub fn check_opened(path: &Path, opened: &OpenedMesh, memory: u64) -> Result<Option<CheckReport>, Failure> {
    let report = match opened {
        OpenedMesh::Whole(file) => Ok(of_whole(file)),
        OpenedMesh::Pieces(pieces) => of_pieces(path, pieces, memory)?,
    };
    let unchecked =
        |why| log::warning(&format!("{} is not checked: {why}; `anastomesh check` does it", path.display()));
    Ok(report.map_err(unchecked).ok())
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

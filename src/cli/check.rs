//! `anastomesh check`: validity check of a volume mesh.

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
use crate::report::verdict::Verdict;
use anastomesh_io::volume::{MeshFile, MeshFormat, VtuPieces, VtuPiecesError, read_mesh};
use anastomesh_mesh::check::parts::{PiecesError, check_pieces};
use anastomesh_mesh::check::text::conditions;
use anastomesh_mesh::check::{CheckReport, check_regions, check_tets, check_volume};
use anastomesh_mesh::dihedral::DihedralHistogram;
use anastomesh_mesh::progress::Stage;
use anastomesh_mesh::{TET_FACES, VolumeMesh, face_key};
use rustc_hash::FxHashMap;

/// Memory of an in-memory check per byte of the file, in bytes.
const MEMORY_PER_BYTE: u64 = 8;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Mesh file: .vtu, .pvtu, .msh (Gmsh 4.1), .mesh (Medit), .ele (TetGen) or .npyd (folder of `NumPy` arrays)
    #[arg(value_name = "MESH")]
    mesh: PathBuf,
    /// Memory limit for VTU files of `mesh`, which are then checked block by block. Other files are loaded completely
    #[arg(long, value_name = "SIZE", default_value = "2GiB", value_parser = limits::size)]
    memory: u64,
    #[command(flatten)]
    report: ReportArgs,
    #[command(flatten)]
    common: Common,
}

/// Checks a mesh file and prints the result.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    args.report.ensure_writable()?;
    let pool = thread_pool(args.common.threads)?;
    let bar = Bars::new(args.common.quiet, args.common.progress, Stop::deaf());
    let (report, mesh) = bar.during(Stage::Check, || pool.install(|| checked(args)))?;
    let verdict = Verdict::of_check(&report);
    pool.install(|| write_page(args, &report, &verdict, mesh))?;
    if args.common.json || !args.common.quiet {
        print(args.common.json, &report, || text(&report, &verdict, args))?;
    } else if !verdict.is_good {
        log::error(&format!("{}: {}", args.mesh.display(), verdict.text));
    }
    Ok(if verdict.is_good { Exit::Fine } else { Exit::GateNotMet })
}

fn checked(args: &Args) -> Result<(CheckReport, OpenedMesh), Failure> {
    by_blocks(args)?.map_or_else(|| as_a_whole(args), Ok)
}

/// Text report: size of the mesh, failed conditions, verdict; all conditions with `-v`.
fn text(report: &CheckReport, verdict: &Verdict, args: &Args) -> String {
    let verbose = args.common.verbose;
    let page: Vec<&Path> = args.report.page().into_iter().map(PathBuf::as_path).collect();
    let all = if verbose { conditions(report) } else { String::new() };
    let (mesh, ended, check) = (of_mesh(report), ended(&page).rows(&[]), of_check(report, verbose));
    format!("{all}{mesh}{ended}{check}{}", verdict.text)
}

/// Writes the HTML report.
fn write_page(args: &Args, report: &CheckReport, verdict: &Verdict, mut mesh: OpenedMesh) -> Result<(), Failure> {
    mesh.label_boundary();
    let (mesh, notes) = (mesh.source(), mesh.notes());
    args.report.write(&args.mesh, Some(page::headline(report, verdict)), &notes.options, |page| {
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
        drop_interior_faces(&mut file.volume, !file.notes.regions.is_empty());
    }
    Ok((of_whole(&file), OpenedMesh::Whole(file)))
}

fn of_whole(file: &MeshFile) -> CheckReport {
    let report = of_corners(file);
    match &file.second_order {
        Some(second) => report.with_second_order(&file.volume, second),
        None => report,
    }
}

/// Checks the mesh without midpoints.
fn of_corners(file: &MeshFile) -> CheckReport {
    let expectation = file.notes.expectation.as_ref();
    if !file.notes.regions.is_empty() {
        return check_regions(&file.volume, &file.notes.regions, expectation);
    }
    if file.labelled { check_volume(&file.volume, expectation) } else { check_tets(&file.volume.mesh, expectation) }
}

/// Checks a large file block by block; `None` if the file is small or must be loaded completely.
fn by_blocks(args: &Args) -> Result<Option<(CheckReport, OpenedMesh)>, Failure> {
    let length = std::fs::metadata(&args.mesh).map_or(0, |data| data.len());
    if length.saturating_mul(MEMORY_PER_BYTE) <= args.memory || MeshFormat::of(&args.mesh).ok() != Some(MeshFormat::Vtu)
    {
        return Ok(None);
    }
    // A quarter each for blocks of the file and for walls; facts about blocks take the rest.
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

/// Checks pieces; the inner error is the reason why they cannot be checked separately.
fn of_pieces(path: &Path, pieces: &VtuPieces, memory: u64) -> Result<Result<CheckReport, String>, Failure> {
    let expectation = pieces.notes().expectation.as_ref();
    if !pieces.notes().regions.is_empty() {
        return Ok(Err("regions are checked as a whole".into()));
    }
    if expectation.is_none() {
        return Ok(Err("it does not contain the expected loops and terminals".into()));
    }
    match check_pieces(pieces, expectation, share(memory)) {
        Ok(report) => Ok(Ok(report)),
        Err(PiecesError::Read(source)) => Err(unreadable(path, &source)),
        Err(why) => Ok(Err(why.to_string())),
    }
}

/// Checks an opened mesh; `None` with a warning if it cannot be checked block by block.
pub fn check_opened(path: &Path, opened: &OpenedMesh, memory: u64) -> Result<Option<CheckReport>, Failure> {
    let report = match opened {
        OpenedMesh::Whole(file) => Ok(of_whole(file)),
        OpenedMesh::Pieces(pieces) => of_pieces(path, pieces, memory)?,
    };
    let unchecked = |why| log::warning(&format!("{}: check skipped: {why}; run `anastomesh check`", path.display()));
    Ok(report.map_err(unchecked).ok())
}

/// Removes labelled faces between two tetrahedra, of one region if the mesh has regions. Meshes of other programs and of
/// facet complexes also label interior surfaces; in a mesh of a network they are an error.
fn drop_interior_faces(volume: &mut VolumeMesh, has_regions: bool) {
    let mut owners: FxHashMap<[u32; 3], Vec<i32>> =
        volume.boundary.iter().map(|&face| (face_key(face), Vec::new())).collect();
    for (i, t) in volume.mesh.tets.iter().enumerate() {
        let region = volume.tet_block.get(i).copied().filter(|_| has_regions).unwrap_or(0);
        for side in TET_FACES {
            if let Some(regions) = owners.get_mut(&face_key(side.map(|corner| t[corner]))) {
                regions.push(region);
            }
        }
    }
    let is_one = |regions: &Vec<i32>| regions.len() >= 2 && regions.windows(2).all(|pair| pair[0] == pair[1]);
    let inside = |face: &[u32; 3]| owners.get(&face_key(*face)).is_some_and(is_one);
    let keep: Vec<bool> = volume.boundary.iter().map(|face| !inside(face)).collect();
    retain(&mut volume.boundary, &keep);
    retain(&mut volume.boundary_patch, &keep);
    retain(&mut volume.boundary_block, &keep);
}

fn retain<T>(list: &mut Vec<T>, keep: &[bool]) {
    let mut kept = keep.iter();
    list.retain(|_| kept.next().copied().unwrap_or(true));
}

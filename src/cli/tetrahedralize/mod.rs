//! `anastomesh tetrahedralize`: tetrahedral mesh of a surface, a facet complex or points.

mod args;
mod fault;
mod format;
mod input;
mod join;
mod numbers;
mod output;
mod plan;
mod seed;
mod switches;
mod watch;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::Serialize;

use super::common;
use super::common::Common;
use super::exit::{Exit, Failure};
use super::fidelity::conclude;
use super::format::NO_PARTS;
use super::log;
use super::stop::{NOTHING_KEPT, Stop};
use crate::report::page::{self, Mark, Section};
use crate::report::rows::row;
use crate::report::tetrahedralize::{
    BoundResult, InputSize, LayerReport, LeftOut, OutputSize, Recovery, RemeshReport, SizeUnmet, TetReport,
    region_sizes, volume_of,
};
use crate::report::verdict::Verdict;
use anastomesh_io::OutputSet;
use anastomesh_mesh::VolumeMesh;
use anastomesh_mesh::dihedral::DihedralHistogram;
use anastomesh_mesh::quality::TetQuality;
use anastomesh_mesh::units::counted;
use anastomesh_tet::parts::Names;
use anastomesh_tet::{Boundary, LeftOut as LeftOutIds, TetError, Tetrahedralization};
pub use args::Args;
use format::{InputFormat, Target, is_stream};
use input::Input;
use output::MeshParts;
use plan::TetPlan;
use watch::{Listener, Watch};

/// Output of `--json`.
#[derive(Serialize)]
struct Output<'a> {
    program: &'static str,
    plan: &'a TetPlan,
    report: &'a TetReport,
}

/// Makes a mesh and writes it.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let format = InputFormat::of(&args.input, args.from)?;
    let (plan, notes) = TetPlan::resolve(args, format)?;
    let target = match &args.output {
        Some(path) if !plan.check_only => Some(Target::of(path, args.to)?),
        _ => None,
    };
    if args.parts.is_some() && !target.as_ref().is_some_and(Target::has_parts) {
        return Err(Failure::usage(NO_PARTS));
    }
    if let Some(target) = &target {
        args.order.check(target.file_format(), &[("--parts", args.parts.is_some())])?;
    }
    plan::ensure_fits(&plan, args, target.as_ref())?;
    args.report.ensure_writable()?;
    if !plan.quiet {
        for note in &notes {
            log::note(note);
        }
    }
    let pool = common::thread_pool(args.common.threads)?;
    let watch = Arc::new(Watch::new(plan.quiet, args.common.progress));
    let mut input = watch.time("read", || read(args, format, &plan))?;
    if plan.remesh_surface.is_some() && input.only_points {
        return Err(Failure::usage("--remesh-surface needs triangles, and the input has only points"));
    }
    input.limit_regions(&plan)?;
    target.as_ref().map_or(Ok(()), |target| target.ensure_apart(&input.files))?;
    let layers_on = input.markers_of(&args.layers_on)?;
    let from = match args.others.len() {
        _ if is_stream(&args.input) => "standard input".into(),
        0 => args.input.display().to_string(),
        others => format!("{} and {}", args.input.display(), counted(others, "other file")),
    };
    for note in input.notes.iter().filter(|_| !plan.quiet) {
        log::warning(&format!("{from}: {note}"));
    }
    let mut report = TetReport { input: size_of(&input), notes: input.notes.clone(), ..TetReport::default() };
    if plan.repair {
        report.repaired = watch.time("repair", || input.repair(plan.plc));
    }
    let stop = Stop::listen(plan.quiet)?;
    let listener = Listener(Arc::clone(&watch), stop.clone());
    let made = pool.install(|| make(&plan, &input, layers_on, listener.clone()));
    watch.leave();
    let made = made.map_err(|e| fault::failure(&e, &from, &input, plan.repair))?;
    stop.keep();
    if let (Some(mut made), Some(target)) = (made, target) {
        for [seed, earlier] in made.summary.ignored_seeds.iter().filter(|_| !plan.quiet) {
            let [seed, earlier] = [seed, earlier].map(|&index| input.numbers.seed(index));
            log::warning(&format!("{from}: region point {seed} lies in the region of point {earlier}: ignored"));
        }
        fill_report(&mut report, &made, &input, &plan, args);
        if let Some(change) = &made.summary.remesh
            && input.take_remeshed(&change.segments)
            && !plan.quiet
        {
            log::warning(&format!("{from}: attributes and markers of points dropped: remeshing makes other points"));
        }
        input.leave_out(&made.summary.left_out.segments);
        let layers = std::mem::take(&mut made.layers);
        let volume = output::volume(made, &input);
        let midpoints = watch.time("write", || pool.install(|| args.order.midpoints(&volume, &listener)));
        let midpoints = midpoints.map_err(|_| Failure::stopped(NOTHING_KEPT))?;
        report.second_order = midpoints.as_ref().map(|midpoints| midpoints.1);
        let mesh =
            MeshParts { volume: &volume, layers: &layers, second_order: midpoints.as_ref().map(|found| &found.0) };
        let stage = || output::stage((&target, args.parts), mesh, &input, &plan, &listener);
        let (written, mut outputs) = watch.time("write", || pool.install(stage))?;
        report.files = written.iter().map(|path| path.display().to_string()).collect();
        pool.install(|| stage_page(args, &plan, (&report, &volume), &mut outputs))?;
        outputs.place()?;
    }
    report.stages = watch.stages();
    report.peak_memory = common::peak_memory();
    print(args, &plan, &report)?;
    let common = Common { quiet: plan.quiet, ..args.common };
    Ok(conclude(&common, &report.verdict(plan.check_only)))
}

/// Reads all files, and adds the points of regions and holes.
fn read(args: &Args, format: InputFormat, plan: &TetPlan) -> Result<Input, Failure> {
    let mut input = Input::read(&args.input, format, plan)?;
    if !args.others.is_empty() {
        let other = |path: &PathBuf| Input::read(path, InputFormat::of(path, args.from)?, plan);
        let others = args.others.iter().map(other).collect::<Result<Vec<_>, _>>()?;
        let parts: Vec<Input> = std::iter::once(input).chain(others).collect();
        if let Some(part) = parts.iter().find(|part| part.facets.is_some() || part.plc.surface.triangles.is_empty()) {
            let file = part.files.first().map(|path| path.display().to_string()).unwrap_or_default();
            return Err(Failure::usage(format!("{file} is not a surface: only surfaces combine with other files")));
        }
        input = join::join(parts);
    }
    let next = input.plc.regions.iter().map(|region| region.id).max().unwrap_or(0).max(0);
    let numbered = (next + 1..).zip(&args.region).map(|(id, &region)| {
        let mut region = region;
        region.id = if region.id == 0 { id } else { region.id };
        region
    });
    input.plc.regions.extend(numbered);
    input.plc.holes.extend(&args.hole);
    Ok(input)
}

/// Makes the mesh; `None` if the input is only checked.
fn make(
    plan: &TetPlan,
    input: &Input,
    layers_on: Vec<i32>,
    listener: Listener,
) -> Result<Option<Tetrahedralization>, TetError> {
    let tetrahedralizer = plan.tetrahedralizer(&input.plc.regions).layers_on(layers_on).progress(listener);
    if plan.check_only && !input.only_points {
        return tetrahedralizer.check(&input.plc).map(|()| None);
    }
    let mut made = if input.only_points {
        tetrahedralizer.delaunay(&input.plc.surface.points)?
    } else {
        tetrahedralizer.run(&input.plc)?
    };
    if !plan.regions {
        made.regions.clear();
    }
    Ok(Some(made).filter(|_| !plan.check_only))
}

/// Adds the HTML report to the outputs.
fn stage_page(
    args: &Args,
    plan: &TetPlan,
    (report, mesh): (&TetReport, &VolumeMesh),
    outputs: &mut OutputSet,
) -> Result<(), Failure> {
    let Verdict { is_good, text } = report.verdict(plan.check_only);
    let verdict = (if is_good { Mark::Good } else { Mark::Bad }, text);
    args.report.stage((&args.input, outputs), Some(verdict), plan, |page| {
        page.add(Section::new("Summary").folded("Terminal output", &report.text(true, &common::ended(&[]))));
        page.add(Section::new("Overview").pictures(&page::mesh_pictures(mesh)?, false)?);
        if let Some(quality) = &report.quality {
            page.add(page::quality(quality, &DihedralHistogram::of(mesh)?));
        }
        page.add(page::named_patches(&mesh.patches));
        Ok(())
    })
}

fn size_of(input: &Input) -> InputSize {
    InputSize {
        points: input.plc.surface.points.len(),
        facets: input.facets.filter(|&facets| facets != input.plc.surface.triangles.len()),
        triangles: input.plc.surface.triangles.len(),
        segments: input.plc.segments.len(),
        holes: input.plc.holes.len(),
    }
}

fn fill_report(report: &mut TetReport, made: &Tetrahedralization, input: &Input, plan: &TetPlan, args: &Args) {
    let mesh = &made.mesh;
    report.mesh = OutputSize {
        points: mesh.points.len(),
        added_points: mesh.points.len().saturating_sub(surface_points(made, input)),
        tets: mesh.tets.len(),
        faces: made.faces.len(),
        interior_faces: made.summary.interior_faces,
        volume: mesh.tets.iter().map(|t| volume_of(mesh, t)).sum(),
    };
    report.left_out = left_out(made, input);
    report.quality = Some(TetQuality::of(mesh));
    let is_remeshed = made.summary.remesh.is_some();
    let number = |v: u32| if is_remeshed { v.saturating_add(input.numbers.first) } else { input.numbers.point(v) };
    let of_layers = |layers| LayerReport::of(layers, mesh, number);
    report.remeshed = made.summary.remesh.as_ref().map(RemeshReport::of);
    report.layers = made.summary.layers.as_ref().map(of_layers);
    if !input.only_points {
        report.bounds = BoundResult::of(&plan.bounds, mesh, &made.faces);
        let plc = Some(&input.plc).filter(|_| plan.keeps_triangles());
        let unmet = |size| {
            plc.and_then(|plc| {
                SizeUnmet::of(size, Boundary::LONGER, &plc.surface.points, &plc.surface.triangles, &plc.segments)
            })
        };
        report.size_unmet = plan.size.and_then(unmet);
        let how = if args.tetgen.is_some() { "leaving out Y" } else { "--split" };
        report.to_split = plan.keeps_triangles().then_some(how);
    }
    report.regions = region_sizes(mesh, &made.regions);
    let recovery = &made.summary.recovery;
    report.recovery = Recovery {
        missing_edges: recovery.missing_edges,
        missing_triangles: recovery.missing_triangles,
        steiner_points: recovery.steiner_points,
    };
}

/// Number of points of the surface that was filled.
fn surface_points(made: &Tetrahedralization, input: &Input) -> usize {
    made.summary.remesh.as_ref().map_or(input.plc.surface.points.len(), |change| change.points)
}

/// Input elements that the mesh does not have, numbered as in the file.
fn left_out(made: &Tetrahedralization, input: &Input) -> LeftOut {
    let LeftOutIds { triangles, segments, .. } = &made.summary.left_out;
    let mut faces: Vec<u32> = triangles.iter().map(|&t| input.numbers.triangle(t)).collect();
    faces.dedup();
    let ends = segments.iter().filter_map(|&s| input.plc.segments.get(s as usize));
    let mut used = vec![false; surface_points(made, input)];
    for &v in made.mesh.tets.iter().flatten() {
        if let Some(used) = used.get_mut(v as usize) {
            *used = true;
        }
    }
    LeftOut {
        triangles: triangles.len(),
        triangles_of: input.numbers.triangles_of(),
        faces,
        segments: ends.map(|edge| edge.map(|v| input.numbers.point(v))).collect(),
        counted_from: input.numbers.first,
        unused_points: used.iter().filter(|used| !**used).count(),
    }
}

fn print(args: &Args, plan: &TetPlan, report: &TetReport) -> Result<(), Failure> {
    if args.common.json {
        let program = concat!("anastomesh ", env!("CARGO_PKG_VERSION"));
        return common::print(true, &Output { program, plan, report }, String::new);
    }
    let files: Vec<&Path> =
        report.files.iter().map(Path::new).chain(args.report.page().map(PathBuf::as_path)).collect();
    let ended = common::ended(&files);
    if plan.check_only {
        if !plan.quiet {
            let InputSize { points, triangles, segments, .. } = report.input;
            let counts = [(points, "point"), (triangles, "triangle"), (segments, "additional segment")];
            let input = row("input", &counts.map(|(count, what)| counted(count, what)).join(", "));
            log::result(&format!("{input}{}", ended.rows(&report.stages)));
        }
        return Ok(());
    }
    if !plan.quiet {
        log::result(&report.text(args.common.verbose, &ended));
    }
    Ok(())
}

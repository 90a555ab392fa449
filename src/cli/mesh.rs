//! `anastomesh mesh`: from a network to a volume mesh.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::before::{Before, Made, Meshing};
use super::blocks::BlockArgs;
use super::common::{Common, ended, print, thread_pool};
use super::exit::{Exit, Failure};
use super::flow::FlowArgs;
use super::format::FormatArgs;
use super::grid::GridArgs;
use super::hint;
use super::layers::LayerArgs;
use super::limits::{self, BlockPlace};
use super::log;
use super::network::{NetworkArgs, PreparedNetwork};
use super::page::ReportArgs;
use super::prepare::CureArgs;
use super::progress::Bars;
use super::refine::RefineArgs;
use super::stop::{self, Stop};
use super::work::{self, WorkArgs, WorkDir};
use crate::fidelity::{Along, Fidelity};
use crate::pipeline::RunReport;
use crate::pipeline::{
    self, Caps, Clock, Datum, Estimate, Forecast, JointStyle, MeshPlan, Outlets, RunError, Shard, Stored, TooLarge,
    VesselData,
};
use crate::refine::{RefineParams, Refined};
use crate::report::caps;
use crate::report::page::{self, Mark, Section};
use crate::report::summary::{Summary, forecast};
use anastomesh_io::network::{NodeNames, ensure_network_writable};
use anastomesh_io::volume::{MeshNotes, WriteOptions, ensure_writable_as, write_mesh_with};
use anastomesh_io::{ensure_text_writable, write_text};
use anastomesh_mesh::beside::Beside;
use anastomesh_mesh::check::text::conditions;
use anastomesh_mesh::check::{CheckReport, Expectation};
use anastomesh_mesh::dihedral::DihedralHistogram;
use anastomesh_mesh::progress::{Progress, Stage};
use anastomesh_mesh::source::MeshSource;
use anastomesh_skeleton::Skeleton;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    network: NetworkArgs,
    /// Where the mesh goes: .vtu, .pvtu (pieces in a folder beside it), .msh (Gmsh 4.1), .msh2 (Gmsh 2.2, text),
    /// .mesh (Medit), .foam (a case for `OpenFOAM`, a folder), .svmesh (the mesh-complete folder of `SimVascular`), .ele
    /// (TetGen's family of files), or .npyd (a folder of `NumPy`'s arrays)
    #[arg(short, long, value_name = "MESH", help_heading = "Output")]
    output: PathBuf,
    #[command(flatten)]
    format: FormatArgs,
    #[command(flatten)]
    blocks: BlockArgs,
    /// How much longer edges are on the axes of vessels than at the wall: 0.5 to 4 (default: 1; with `--stretch S` and no
    /// layers, √S up to 2)
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true)]
    core: Option<f64>,
    #[command(flatten)]
    layers: LayerArgs,
    /// How blocks meet where vessels are cut: disc, in one pass, every block ending in discs that the vessel alone gives;
    /// woven, each connector between the ends of its two clusters, joints smoothed, the whole mesh in memory; none, no
    /// vessel is cut
    #[arg(long, help_heading = "Run", value_enum, default_value_t = JointArg::Disc)]
    joint: JointArg,
    /// Leave woven joints as the blocks have them instead of smoothing across them
    #[arg(long, help_heading = "Run")]
    frozen_joints: bool,
    #[command(flatten)]
    work: WorkArgs,
    /// Write the refined network
    #[arg(long, help_heading = "Run", value_name = "NETWORK.vtp", requires = "refine")]
    refined: Option<PathBuf>,
    /// Node that is an inlet, as the file calls it (where it has no names, counted from 0); may be given several times
    /// (default: the file's own roots, else in each component the terminal of largest radius)
    #[arg(long, help_heading = "Run", value_name = "NODE")]
    root: Vec<String>,
    /// How far the meshed axis may be from the given one, in radii: more is exit code 1 (default: 1 in a network whose vessels
    /// are polylines, but where an overlap demands more; no bound in others)
    #[arg(long, help_heading = "Run", value_name = "R")]
    max_displacement: Option<f64>,
    /// Say so where the axis is further off, and exit as if it were not
    #[arg(long, help_heading = "Run")]
    allow_displaced: bool,
    /// Folder for the inputs of blocks that fail (default: MESH with `.failed` appended)
    #[arg(long, help_heading = "Run", value_name = "DIR")]
    dump_dir: Option<PathBuf>,
    /// What VTU, PVTU, MSH and .npyd say of each place: radius and distance along the branch at points; branch, generation, strahler, node
    /// (the nearer one) and ratio (the cell's radius ratio) in cells; several with commas between them
    #[arg(long, help_heading = "Run", value_name = "DATA", value_delimiter = ',', value_parser = datum)]
    data: Vec<Datum>,
    /// Say what it would take (blocks, tetrahedra, time, memory, disk), and mesh nothing
    #[arg(long, help_heading = "Run")]
    dry_run: bool,
    #[command(flatten)]
    grid: GridArgs,
    #[command(flatten)]
    report: ReportArgs,
    #[command(flatten)]
    common: Common,
    #[command(flatten)]
    flow: FlowArgs,
    #[command(flatten)]
    cures: CureArgs,
    #[command(flatten)]
    how: RefineArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum JointArg {
    Disc,
    Woven,
    None,
}

/// How much longer edges are on axes than at walls, at most, unless it is asked for.
const COARSEST_CORE: f64 = 2.0;

/// Bytes of memory per tetrahedron of a mesh that is held while its joints are smoothed and it is checked.
const HELD_PER_TET: f64 = 150.0;

fn datum(name: &str) -> Result<Datum, String> {
    let known = || Datum::ALL.map(Datum::name).join(", ");
    Datum::ALL.into_iter().find(|d| d.name() == name).ok_or_else(|| format!("what is known is {}", known()))
}

/// A mesh that is there, and what is known of it.
struct Done<'a> {
    mesh: &'a dyn MeshSource,
    expectation: Expectation,
    check: &'a CheckReport,
    report: RunReport,
}

/// What is known of a mesh that is written.
struct Found<'a> {
    mesh: &'a dyn MeshSource,
    check: &'a CheckReport,
    fidelity: &'a Fidelity,
    caps: &'a Caps,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Output<'a> {
    program: &'static str,
    plan: &'a MeshPlan,
    #[serde(flatten)]
    before: &'a Before,
    run: &'a RunReport,
    check: Option<&'a CheckReport>,
    fidelity: Option<&'a Fidelity>,
}

/// Meshes a network and writes the mesh.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let mut plan = args.plan()?;
    plan.validate().map_err(|e| Failure::usage(e.to_string()))?;
    if plan.smooths_joints() && args.work.dir.is_some() {
        return Err(Failure::usage(
            "--work-dir cannot keep joints that are smoothed: give --joint disc or --frozen-joints",
        ));
    }
    let shard = args.work.shard(&plan)?;
    let format = args.format.of(&args.output)?;
    if !args.data.is_empty() && !format.holds_values() {
        return Err(Failure::usage(
            "--data is for .vtu, .pvtu, .msh, .msh2 and .npyd; the other formats have no place for it",
        ));
    }
    ensure_writable_as(format, &args.output).map_err(|e| Failure::input(e.to_string()))?;
    ensure_text_writable(&args.table()).map_err(|e| args.no_table(&e))?;
    args.report.ensure_writable()?;
    if let Some(path) = &args.refined {
        ensure_network_writable(path).map_err(|e| Failure::input(e.to_string()))?;
    }
    let pool = thread_pool(args.common.threads)?;
    let read = || args.blocks.read(&args.network, &args.cures.params(true), &mut plan);
    let mut network = pool.install(read)?;
    let inlets = network.inlets(&args.root)?;
    let cut_short = pool.install(|| args.flow.extend(&mut network, &inlets));
    plan.roots.clone_from(&inlets.roots);
    let stop = Stop::listen(args.common.quiet)?;
    let bars = Bars::new(args.common.quiet, args.common.progress, stop.clone());
    for remark in network.remarks(args.common.verbose).into_iter().chain(inlets.remarks()).chain(cut_short) {
        bars.note(&remark);
    }
    let work = if args.dry_run { None } else { args.work.open(shard, &network.skeleton, || args.options(&plan))? };
    let refined = pool.install(|| args.refined(&network, work.as_ref(), shard, &stop))?;
    if let (Some(work), Some(shard)) = (&work, shard) {
        let prepared = network.into_skeleton();
        let skeleton = refined.map_or(prepared, |(refined, _)| refined.skeleton);
        return args.run_shard(work, shard, (skeleton, &plan), &pool, (&stop, &bars));
    }
    let before = Before::new(network, refined);
    if args.dry_run {
        let found = pool.install(|| Forecast::of(&before.network, &plan));
        let found = found.map_err(|e| Failure::stage(e.to_string()))?;
        print(args.common.json, &found, || forecast(&found, pool.current_num_threads()))?;
        return Ok(Exit::Fine);
    }
    // Blocks are kept as soon as they are done.
    stop.keep();
    if let Some(dir) = &args.work.dir {
        work::note(dir, &bars);
    }
    pool.install(|| match work {
        _ if plan.smooths_joints() => args.run_in_memory(&plan, &before, &bars),
        work => args.run_in_store(work, &plan, before, &bars),
    })
}

impl Args {
    fn plan(&self) -> Result<MeshPlan, Failure> {
        let mut beside = self.output.clone().into_os_string();
        beside.push(".failed");
        Ok(MeshPlan {
            core: self.core.unwrap_or_else(|| self.usual_core()),
            layers: self.layers.asked()?,
            joint: match self.joint {
                JointArg::Woven => JointStyle::Woven,
                JointArg::Disc => JointStyle::Disc,
                JointArg::None => JointStyle::None,
            },
            frozen_joints: self.frozen_joints,
            dump_dir: Some(self.dump_dir.clone().unwrap_or_else(|| beside.into())),
            ..self.blocks.plan(self.how.fuses())
        })
    }

    /// Where edges are longer along vessels than across, the core need not be fine; with layers linear elements are meant, which
    /// need it for the flow.
    fn usual_core(&self) -> f64 {
        if self.layers.layers.is_some() { 1.0 } else { self.blocks.stretch.max(1.0).sqrt().min(COARSEST_CORE) }
    }

    /// A share of the blocks, of which nothing but the network has to be known.
    fn run_shard(
        &self,
        work: &WorkDir,
        shard: Shard,
        (network, plan): (Skeleton, &MeshPlan),
        pool: &rayon::ThreadPool,
        (stop, bars): (&Stop, &Bars),
    ) -> Result<Exit, Failure> {
        stop.keep();
        if let Some(dir) = &self.work.dir {
            work::note(dir, bars);
        }
        let made = pool.install(|| work.make_shard(shard, (network, plan), bars));
        work::told(shard, &made.map_err(|e| self.explain_alone(&e))?, self.common.json, self.common.quiet)
    }

    /// Joints are to be smoothed: the mesh is held.
    fn run_in_memory(&self, plan: &MeshPlan, before: &Before, bars: &Bars) -> Result<Exit, Failure> {
        let estimate = Estimate::rough(&before.network, plan);
        let bytes = (estimate.tets * HELD_PER_TET) as u64;
        if bytes > plan.memory {
            let (why, instead) = ("woven joints", "--joint disc");
            let refused = TooLarge::Whole { estimate, why, instead, bytes, memory: plan.memory };
            return Err(Failure::input(hint::of_size(&refused)));
        }
        let result = pipeline::mesh_network(&before.network, plan, bars);
        let result = result.map_err(|e| self.explain(e, plan, before))?;
        let done =
            Done { mesh: &result.mesh, expectation: result.expectation, check: &result.check, report: result.report };
        self.finish(done, plan, before, bars)
    }

    /// Blocks go to where they are kept, and the mesh from there to its file.
    fn run_in_store(
        &self,
        work: Option<WorkDir>,
        plan: &MeshPlan,
        before: Before,
        bars: &Bars,
    ) -> Result<Exit, Failure> {
        let (place, store) = match work {
            Some(WorkDir { place, store }) => (place, store),
            None => BlockPlace::beside(&self.output, &Estimate::rough(&before.network, plan), plan.memory)?,
        };
        let kept = store.bytes_on_disk();
        let format = self.format.of(&self.output)?;
        let fits = |estimate: &Estimate| limits::fits(estimate, plan, &place, kept, (&self.output, format));
        let how = Meshing { store: &store, plan, fits: &fits, touches: self.cures.touches(), bars };
        let Made { stored, before } = before.mesh(how).map_err(|(e, before)| self.explain(e, plan, &before))?;
        let Stored { whole, expectation, check, report } = stored;
        self.finish(Done { mesh: &whole, expectation, check: &check, report }, plan, &before, bars)
    }

    /// Everything that the mesh depends on, beside the network.
    fn options(&self, plan: &MeshPlan) -> serde_json::Value {
        let refine = self.blocks.refine.map(|iterations| format!("{:?}", self.how.params(iterations)));
        // Whether failed blocks are left out says nothing about those that are done.
        let plan = MeshPlan { keep_going: false, ..plan.clone() };
        serde_json::json!({ "mesh": plan, "refine": refine })
    }

    /// Writes the mesh, holds it against its network and says what was done.
    fn finish(&self, done: Done, plan: &MeshPlan, before: &Before, bars: &Bars) -> Result<Exit, Failure> {
        let Done { mesh, expectation, check, mut report } = done;
        let asked = Some(&self.data).filter(|data| !data.is_empty());
        let data = asked.map(|data| VesselData::new(data.clone(), before.compared().meshed, mesh)).transpose()?;
        let options = WriteOptions::default()
            .format(self.format.format)
            .memory((self.blocks.memory / 4) as usize)
            .grid(self.grid.options())
            .values(data.as_ref().map(|data| data as &dyn Beside));
        // Passes over the blocks end when the run is to end.
        let failed = |e: &dyn std::fmt::Display| {
            if bars.is_cancelled() { self.stopped() } else { Failure::input(e.to_string()) }
        };
        let mut clock = Clock::default();
        let compare = || Fidelity::of(before.compared(), mesh, check.counts.volume);
        let fidelity = clock.time(bars, Stage::Check, 0, compare).map_err(|e| failed(&e))?;
        let mut caps = Caps::of(mesh, before.compared().meshed, self.flow.fluid()).map_err(|e| failed(&e))?;
        let grouped = caps.group(mesh, self.flow.outlets());
        let written = grouped.as_ref().map_or(mesh, |grouped| grouped);
        let notes = self.notes(expectation, &caps);
        let write = || write_mesh_with(&options, &self.output, written, &notes, bars);
        clock.time(bars, Stage::Write, 0, write).map_err(|e| failed(&e))?;
        self.write_table(&caps, &before.names)?;
        report.stages.extend(clock.stages());
        let found = Found { mesh: written, check, fidelity: &fidelity, caps: &caps };
        self.write_page(plan, before, &report, Some(&found))?;
        self.print(plan, before, &report, Some((check, &fidelity)))?;
        let invalid = !check.is_valid() || !report.keeps_vessels(plan.fuse);
        self.blocks.advise(&report, invalid);
        let unfaithful = before.unfaithful(&fidelity, self.max_displacement);
        if let Some(words) = &unfaithful {
            log::note(words);
        }
        Ok(match () {
            () if !report.failed.is_empty() => Exit::StageFailed,
            () if invalid => Exit::GateNotMet,
            () if unfaithful.is_some() && !self.allow_displaced => Exit::GateNotMet,
            () => Exit::Fine,
        })
    }

    /// What went wrong, for people.
    fn explain(&self, error: RunError, plan: &MeshPlan, before: &Before) -> Failure {
        match error {
            RunError::BlocksFailed(report) => {
                let paged = self.write_page(plan, before, &report, None);
                if let Err(failure) = paged.and_then(|()| self.print(plan, before, &report, None)) {
                    return failure;
                }
                self.blocks.advise(&report, true);
                Failure::stage(format!(
                    "{} block(s) could not be meshed; their inputs are named above. --keep-going leaves them out",
                    report.failed.len()
                ))
            }
            error => self.explain_alone(&error),
        }
    }

    /// The same of what ends a run before there are blocks to speak of.
    fn explain_alone(&self, error: &RunError) -> Failure {
        match error {
            RunError::Cancelled => self.stopped(),
            RunError::Root(_) | RunError::Plan(_) => Failure::usage(error.to_string()),
            RunError::TooLarge(_) | RunError::Store(_) => Failure::input(hint::of_run(error)),
            _ => Failure::stage(error.to_string()),
        }
    }

    /// What is left of a run that was stopped, and how it goes on.
    fn stopped(&self) -> Failure {
        Failure::stopped(match &self.work.dir {
            Some(dir) => {
                let (dir, command) = (dir.display(), stop::command_line());
                format!("stopped; finished blocks are kept in {dir}. Go on from there with\n  {command}")
            }
            None => {
                "stopped; nothing is kept. With --work-dir DIR finished blocks are, and the same command goes on".into()
            }
        })
    }

    /// Writes the page of `--report`.
    fn write_page(
        &self,
        plan: &MeshPlan,
        before: &Before,
        run: &RunReport,
        found: Option<&Found>,
    ) -> Result<(), Failure> {
        let failed = || (Mark::Bad, format!("{} blocks could not be meshed", run.failed.len()));
        let verdict = found.map_or_else(failed, |found| page::headline(found.check));
        self.report.write(&self.output, Some(verdict), plan, |page| {
            let Some(&Found { mesh, check, fidelity, caps }) = found else {
                page.add(page::failed_blocks(&before.network, run)?);
                page.add(page::run(run, &[]));
                return Ok(());
            };
            page.add(page::summary(check));
            let mut pictures = page::mesh_pictures(mesh)?;
            pictures.insert(0, page::network_picture(&before.network, &[], "The network by radius."));
            page.add(Section::new("At a glance").pictures(&pictures, false)?);
            if !run.failed.is_empty() {
                page.add(page::failed_blocks(&before.network, run)?);
            }
            page.add(page::validity(check, mesh)?);
            if let Some(quality) = &check.quality {
                page.add(page::quality(quality, &DihedralHistogram::of(mesh)?));
            }
            page.add(page::fidelity(fidelity, &Along::of(before.compared().meshed, mesh)?));
            if let Some((report, network)) = before.refinement() {
                page.add(page::refinement(report, network, &before.network)?);
            }
            page.add(page::run(run, &page::block_sizes(mesh)?));
            page.add(page::terminals(caps, &before.names));
            Ok(())
        })
    }

    /// Writes what is known of inlets and outlets beside the mesh.
    fn write_table(&self, caps: &Caps, names: &NodeNames) -> Result<(), Failure> {
        let text = caps::table(caps, names).map_err(|e| self.no_table(&e))?;
        write_text(&self.table(), &text).map_err(|e| self.no_table(&e))
    }

    /// Where the table of inlets and outlets goes.
    fn table(&self) -> PathBuf {
        let mut name = self.output.file_stem().unwrap_or_default().to_owned();
        name.push("_patches.csv");
        self.output.with_file_name(name)
    }

    fn no_table(&self, why: &dyn std::fmt::Display) -> Failure {
        Failure::unwritable(&self.table(), why)
    }

    fn notes(&self, mut expectation: Expectation, caps: &Caps) -> MeshNotes {
        if self.flow.outlets() != Outlets::Separate {
            expectation.terminals = caps.alone();
        }
        let core = self.core.map_or_else(String::new, |core| format!(" --core {core}"));
        MeshNotes {
            expectation: Some(expectation),
            generator: concat!("anastomesh ", env!("CARGO_PKG_VERSION")).into(),
            options: format!("mesh {}{core}{}", self.blocks.typed(), self.layers.typed()),
            regions: false,
            flow: Some(caps.flow()),
        }
    }

    /// The network refined, if that was asked for. Shards write to no file that others write to.
    fn refined(
        &self,
        network: &PreparedNetwork,
        work: Option<&WorkDir>,
        shard: Option<Shard>,
        stop: &Stop,
    ) -> Result<Option<(Refined, RefineParams)>, Failure> {
        let Some(iterations) = self.blocks.refine else { return Ok(None) };
        let params = super::refine::fitting(network, self.how.params(iterations));
        let make = || super::refine::moved_so(network, &params, &self.common, stop);
        let refined = match work {
            Some(work) => work.refined(&network.skeleton, &params, &Bars::new(true, None, stop.clone()), make)?,
            None => make()?,
        };
        if shard.is_none() {
            if let Some(path) = &self.refined {
                stop.keep();
                super::refine::write(path, &refined)?;
            }
            if self.common.verbose && !self.common.json {
                log::note(&refined.report.to_string());
            }
        }
        Ok(Some((refined, params)))
    }

    fn print(
        &self,
        plan: &MeshPlan,
        before: &Before,
        run: &RunReport,
        found: Option<(&CheckReport, &Fidelity)>,
    ) -> Result<(), Failure> {
        let (check, fidelity) = found.unzip();
        if self.common.json {
            let program = concat!("anastomesh ", env!("CARGO_PKG_VERSION"));
            return print(true, &Output { program, plan, before, run, check, fidelity }, String::new);
        }
        // Blocks that failed and a mesh that is not valid are errors, which --quiet does not silence.
        if !self.common.quiet
            || !run.failed.is_empty()
            || !run.keeps_vessels(plan.fuse)
            || check.is_some_and(|c| !c.is_valid())
        {
            if self.common.verbose {
                let all = [Some(run.to_string()), check.map(conditions), fidelity.map(ToString::to_string)];
                log::result(&all.into_iter().flatten().collect::<String>());
            }
            let table = self.table();
            let mut files: Vec<&Path> = if found.is_some() { vec![&self.output, &table] } else { Vec::new() };
            files.extend(self.report.page().map(PathBuf::as_path));
            let summary = Summary { run, check, fidelity, ended: ended(&files), listed: self.common.verbose };
            log::result(&summary.to_string());
        }
        Ok(())
    }
}

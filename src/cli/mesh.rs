//! `anastomesh mesh`: volume mesh of a network.

mod failures;

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::blocks::BlockArgs;
use super::certificate::{CertificateArgs, Certified};
use super::common::{Common, ended, print, thread_pool};
use super::domain::DomainArgs;
use super::embed::EmbedRun;
use super::exit::{Exit, Failure};
use super::fidelity::{FidelityArgs, conclude};
use super::flow::FlowArgs;
use super::format::FormatArgs;
use super::grid::GridArgs;
use super::layers::LayerArgs;
use super::limits::{self, BlockPlace};
use super::log;
use super::network::NetworkArgs;
use super::numbers::number;
use super::order::OrderArgs;
use super::page::ReportArgs;
use super::prepare::CureArgs;
use super::progress::Bars;
use super::refine::RefineArgs;
use super::regions::{self, Lumen, Regions, with_regions};
use super::run::remarks;
use super::stop::Stop;
use super::work::{self, WorkArgs, WorkDir};
use crate::fidelity::{Along, Changes, Fidelity};
use crate::pipeline::{Estimate, JointStyle, MeshPlan, RunReport, Shard, Store};
use crate::report::caps;
use crate::report::inlets;
use crate::report::page::{self, Mark, Section};
use crate::report::summary::{Summary, forecast};
use crate::report::verdict::{Verdict, missing};
use crate::run::{Attempt, Defect, NetworkMesh, Networks, PreparedRun, Run};
use anastomesh_domain::{DomainError, DomainPlan, ShellsReport};
use anastomesh_flow::{Caps, Datum, FlowPlan, VesselData};
use anastomesh_io::network::ensure_network_writable;
use anastomesh_io::volume::{MeshFormat, WriteOptions, ensure_writable_as, stage_mesh, stage_regions};
use anastomesh_io::{OutputSet, ensure_text_writable};
use anastomesh_mesh::beside::Beside;
use anastomesh_mesh::check::text::conditions;
use anastomesh_mesh::check::{CheckReport, Expectation};
use anastomesh_mesh::dihedral::DihedralHistogram;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::progress::{Progress, Stage};
use anastomesh_mesh::second_order::Curving;
use anastomesh_mesh::source::MeshSource;
use anastomesh_network::PrepareReport;
use anastomesh_network::RefineReport;
use anastomesh_skeleton::{NodeId, Skeleton};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    network: NetworkArgs,
    /// Output file: .vtu, .pvtu (with a folder of pieces), .msh (Gmsh 4.1), .msh2 (Gmsh 2.2), .mesh (Medit), .foam
    /// (`OpenFOAM` case), .svmesh (`SimVascular` mesh-complete folder), .ele (TetGen files), or .npyd (folder of `NumPy` arrays)
    #[arg(short, long, value_name = "MESH", help_heading = "Output")]
    output: PathBuf,
    #[command(flatten)]
    format: FormatArgs,
    #[command(flatten, next_help_heading = "Output")]
    order: OrderArgs,
    #[command(flatten)]
    blocks: BlockArgs,
    /// Ratio of edge lengths on the axis to those at the wall: 0.5 to 4 (default: 1; with `--stretch S` and no layers,
    /// √S up to 2)
    #[arg(long, value_name = "FACTOR", allow_negative_numbers = true, value_parser = number)]
    core: Option<f64>,
    #[command(flatten)]
    layers: LayerArgs,
    /// Joint style where vessels are cut
    #[arg(long, help_heading = "Run", value_enum, default_value_t = JointArg::Disc)]
    joint: JointArg,
    /// Do not smooth woven joints
    #[arg(long, help_heading = "Run")]
    frozen_joints: bool,
    #[command(flatten)]
    work: WorkArgs,
    /// Write the refined network. It is written before meshing, so also if that fails
    #[arg(long, help_heading = "Run", value_name = "NETWORK.vtp", requires = "refine")]
    refined: Option<PathBuf>,
    /// Inlet node, by its name or number in the file; repeatable (default: the roots of the file, or else the widest
    /// terminal of each component)
    #[arg(long, help_heading = "Run", value_name = "NODE")]
    root: Vec<String>,
    /// Folder for the inputs of failed blocks (default: MESH with `.failed` appended)
    #[arg(long, help_heading = "Run", value_name = "DIR")]
    dump_dir: Option<PathBuf>,
    /// Data arrays to write, comma-separated. Point data: radius, distance (along the branch). Cell data: branch, generation,
    /// strahler, node (nearest), ratio (radius ratio). Formats: VTU, PVTU, MSH and .npyd
    #[arg(long, help_heading = "Run", value_name = "DATA", value_delimiter = ',', value_parser = datum)]
    data: Vec<Datum>,
    /// Print an estimate of blocks, tetrahedra, time, memory and disk space, without meshing
    #[arg(long, help_heading = "Run")]
    dry_run: bool,
    #[command(flatten)]
    domain: DomainArgs,
    #[command(flatten)]
    fidelity: FidelityArgs,
    #[command(flatten)]
    grid: GridArgs,
    #[command(flatten)]
    certificate: CertificateArgs,
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
    /// Blocks end in planar discs and are meshed independently
    Disc,
    /// Connectors are fitted to the ends of meshed clusters and joints are smoothed, with the whole mesh in memory
    Woven,
    /// No vessel is cut
    None,
}

/// Maximum default ratio of edge lengths on the axis to those at the wall.
const COARSEST_CORE: f64 = 2.0;

fn datum(name: &str) -> Result<Datum, String> {
    let known = || Datum::ALL.map(Datum::name).join(", ");
    Datum::ALL.into_iter().find(|d| d.name() == name).ok_or_else(|| format!("known arrays: {}", known()))
}

/// Remark on a second-order mesh whose volume differs from the linear one.
const UNBALANCED: &str =
    "vertices on the curved wall would add faults to the mesh: the wall passes outside of the vessels' radius";

/// Facts about a written mesh.
struct Found<'a> {
    mesh: &'a dyn MeshSource,
    network: &'a Skeleton,
    check: &'a CheckReport,
    shells: Option<&'a ShellsReport>,
    midpoints: Option<&'a Curving>,
    fidelity: Option<&'a Fidelity>,
    changes: &'a Changes,
    caps: Option<&'a Caps>,
    defects: &'a [Defect],
    /// Files of the regions.
    parts: &'a [PathBuf],
    /// Passes over the network, and the index of the one that gave the mesh.
    attempts: (&'a [Attempt], usize),
    verdict: &'a Verdict,
}

/// Output of `--json`.
#[derive(Serialize)]
struct Output<'a> {
    program: &'static str,
    plan: &'a MeshPlan,
    prepare: &'a PrepareReport,
    #[serde(skip_serializing_if = "Option::is_none")]
    refine: Option<&'a RefineReport>,
    run: &'a RunReport,
    check: Option<&'a CheckReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    shells: Option<&'a ShellsReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    second_order: Option<&'a Curving>,
    fidelity: Option<&'a Fidelity>,
    #[serde(skip_serializing_if = "Option::is_none")]
    changes: Option<&'a Changes>,
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    attempts: &'a [Attempt],
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    defects: &'a [Defect],
    #[serde(skip_serializing_if = "Option::is_none")]
    verdict: Option<&'a str>,
}

/// Meshes a network and writes the mesh.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    if args.domain.embeds() {
        return args.embedding().run();
    }
    let plan = args.plan()?;
    plan.validate().map_err(|e| Failure::usage(e.to_string()))?;
    if plan.smooths_joints() && args.work.dir.is_some() {
        return Err(Failure::usage("--work-dir cannot store smoothed joints: give --joint disc or --frozen-joints"));
    }
    let flow = args.flow.plan()?;
    let mut domain = args.domain.plan(&args.network)?;
    args.fidelity.limits()?;
    let shard = args.work.shard(&plan)?;
    let format = args.format.of(&args.output)?;
    if !args.data.is_empty() && !format.holds_values() {
        return Err(Failure::usage("--data is not supported by this format: use .vtu, .pvtu, .msh, .msh2 or .npyd"));
    }
    if args.format.prisms && (plan.layers.is_none() || !args.data.is_empty()) {
        return Err(Failure::usage("--prisms needs --layers, and does not combine with --data"));
    }
    if args.format.prisms && !domain.is_plain() {
        return Err(Failure::usage("--prisms does not combine with regions around the lumen"));
    }
    if args.format.parts.is_some() && !domain.is_plain() && format != MeshFormat::Pvtu {
        return Err(Failure::usage("--parts with regions around the lumen needs .pvtu"));
    }
    let coupled = format == MeshFormat::SimVascular && !domain.is_plain();
    let others = [&args.besides_order()[..], &[("regions around the lumen in .svmesh", coupled)]].concat();
    args.order.check(Some(format), &others)?;
    ensure_writable_as(format, &args.output).map_err(|e| Failure::input(e.to_string()))?;
    ensure_text_writable(&args.table()).map_err(|e| args.no_table(&e))?;
    args.certificate.ensure_writable(format)?;
    args.report.ensure_writable()?;
    if let Some(path) = &args.refined {
        ensure_network_writable(path).map_err(|e| Failure::input(e.to_string()))?;
    }
    let pool = thread_pool(args.common.threads)?;
    let prepared = pool.install(|| args.prepared(plan, flow, &mut domain))?;
    regions::limit(&mut domain, &prepared.rough_estimate(), args.blocks.memory);
    let Networks { prepared: network, names, .. } = &prepared.networks;
    let checked = pool.install(|| domain.check(network, &|node| names.of(NodeId(node))));
    checked.map_err(|e| args.no_regions(&e))?;
    let stop = Stop::listen(args.common.quiet)?;
    let bars = Bars::new(args.common.quiet, args.common.progress, stop.clone());
    let PreparedRun { notes, networks, inlets, cut_short, .. } = &prepared;
    let read = remarks(notes, &networks.prepare, &networks.names, args.common.verbose);
    for remark in read.into_iter().chain(inlets::remarks(inlets)).chain(FlowArgs::remark(cut_short, &networks.names)) {
        bars.note(&remark);
    }
    let work = if args.dry_run { None } else { args.work.open(shard, || prepared.manifest())? };
    let refined = || prepared.refined(work.as_ref().map(|work| &work.store), &bars);
    let prepared = pool.install(refined).map_err(|e| args.explain_alone(e))?;
    // Shards do not write shared files.
    if shard.is_none() && !args.dry_run && args.refined.is_some() && prepared.networks.refine.is_some() {
        stop.keep();
        args.stage_refined(&prepared.networks)?.place()?;
    }
    if args.dry_run {
        let mut found = pool.install(|| prepared.forecast()).map_err(|e| Failure::stage(e.to_string()))?;
        found.estimate = with_regions(&found.estimate, &domain);
        print(args.common.json, &found, || forecast(&found, pool.current_num_threads()))?;
        return Ok(Exit::Fine);
    }
    // From here on finished blocks are stored.
    stop.explain(args.stopped_text());
    if let Some(dir) = &args.work.dir {
        work::note(dir, &bars);
    }
    pool.install(|| match (work, shard) {
        (Some(work), Some(shard)) => args.run_shard(&work, shard, prepared, &bars),
        _ if prepared.plan.smooths_joints() => {
            let plan = prepared.plan.clone();
            let made = prepared.mesh(&bars).map_err(|e| args.explain(e, &plan, &bars))?;
            args.finish(made, &plan, (&domain, None), &bars)
        }
        (work, _) => args.run_in_store(work, prepared, &domain, &bars),
    })
}

impl Args {
    /// Options that do not combine with second-order elements, and whether they are given.
    fn besides_order(&self) -> [(&'static str, bool); 4] {
        [
            ("--prisms", self.format.prisms),
            ("--parts", self.format.parts.is_some()),
            ("--cells tets", self.grid.options().tets_alone),
            ("--split-regions", self.domain.splits()),
        ]
    }

    /// Options of an embedding.
    fn embedding(&self) -> EmbedRun<'_> {
        EmbedRun {
            network: &self.network,
            output: &self.output,
            format: self.format,
            grid: self.grid,
            domain: &self.domain,
            cures: &self.cures,
            memory: self.blocks.memory(),
            certificate: &self.certificate,
            common: &self.common,
        }
    }

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

    /// Default of `--core`. Stretched meshes need no fine core; with layers, linear elements resolve the flow only with one.
    fn usual_core(&self) -> f64 {
        if self.layers.layers.is_some() { 1.0 } else { self.blocks.stretch.max(1.0).sqrt().min(COARSEST_CORE) }
    }

    /// Reads and prepares the network. Vessels that leave the organ are cut.
    fn prepared(&self, mut plan: MeshPlan, flow: FlowPlan, domain: &mut DomainPlan) -> Result<PreparedRun, Failure> {
        let cures = self.cures.params(true);
        let mut file = self.blocks.read(&self.network, cures.radii, &mut plan)?;
        plan.unfolded = !domain.shells.is_empty();
        self.domain.cut(&mut file, domain, &self.root).map_err(|e| self.no_regions(&e))?;
        let [inlets, outlets] = self.flow.extension();
        let mut run = Run::new(file).plan(plan).prepare(cures).roots(&self.root).extend(inlets, outlets);
        run = run.flow(flow);
        if let Some(iterations) = self.blocks.refine {
            run = run.refine(self.how.params(iterations));
        }
        run.limits(self.fidelity.limits()?).prepared().map_err(|e| self.explain_alone(e))
    }

    /// Makes the blocks of a shard.
    fn run_shard(&self, work: &WorkDir, shard: Shard, run: PreparedRun, bars: &Bars) -> Result<Exit, Failure> {
        let plan = run.plan.clone();
        let fits = |estimate: &_| limits::block_fits(estimate, &plan);
        let made = run.make_share(&work.store, shard, &fits, bars).map_err(|e| self.explain_alone(e))?;
        work::told(shard, &made, self.common.json, self.common.quiet)
    }

    /// Meshes through a block store.
    fn run_in_store(
        &self,
        work: Option<WorkDir>,
        run: PreparedRun,
        domain: &DomainPlan,
        bars: &Bars,
    ) -> Result<Exit, Failure> {
        let plan = run.plan.clone();
        let (place, store) = match work {
            Some(WorkDir { place, store }) => (place, store),
            None => BlockPlace::beside(&self.output, &run.rough_estimate(), plan.memory)?,
        };
        let kept = store.bytes_on_disk();
        let format = self.format.of(&self.output)?;
        let fits = |lumen: &Estimate| {
            let whole = with_regions(lumen, domain);
            self.order.fits(&whole, plan.memory)?;
            self.blocks.regions_fit(&whole)?;
            limits::fits(&whole, &plan, &place, kept, (&self.output, format))
        };
        let made = run.mesh_into(&store, &fits, bars).map_err(|e| self.explain(e, &plan, bars))?;
        self.finish(made, &plan, (domain, Some(&store)), bars)
    }

    /// Writes the mesh and the reports.
    fn finish<M: MeshSource>(
        &self,
        mut made: NetworkMesh<M>,
        plan: &MeshPlan,
        (domain, store): (&DomainPlan, Option<&Store>),
        bars: &Bars,
    ) -> Result<Exit, Failure> {
        bars.keep();
        let mut outputs = self.stage_refined(&made.networks)?;
        self.tell_refined(&made.networks);
        let asked = Some(&self.data).filter(|data| !data.is_empty());
        let data = asked.map(|data| VesselData::new(data.clone(), &made.network, &made.mesh)).transpose()?;
        let remark = |text: &str| bars.note(&format!("{}: {text}", self.output.display()));
        let options = WriteOptions::default()
            .format(self.format.format)
            .memory((self.blocks.memory() / 4) as usize)
            .grid(self.grid.options())
            .prisms(self.format.prisms)
            .parts(self.format.parts)
            .values(data.as_ref().map(|data| data as &dyn Beside))
            .remark(&remark as &dyn Fn(&str));
        // A cancelled pass over the blocks fails with an error.
        let failed = |e: &dyn std::fmt::Display| {
            if bars.is_cancelled() { self.stopped() } else { Failure::input(e.to_string()) }
        };
        let outlets = self.flow.outlets();
        let grouped = made.caps.as_mut().and_then(|caps| caps.group(&made.mesh, outlets));
        let written: &dyn MeshSource = match &grouped {
            Some(grouped) => grouped,
            None => &made.mesh,
        };
        let mut notes = made.notes(
            concat!("anastomesh ", env!("CARGO_PKG_VERSION")).into(),
            self.typed(made.networks.refine.is_some()),
        );
        let expectation = notes.expectation.as_ref().unwrap_or(&made.expectation);
        // Regions in parts have no files of their own.
        let store = store.filter(|_| !self.domain.splits());
        let domain = self.around((&made, expectation), written, (domain, store), bars)?;
        let (written, check): (&dyn MeshSource, _) = match &domain {
            Some(domain) => (domain.mesh(), domain.check()),
            None => (written, &made.check),
        };
        notes.regions = domain.as_ref().map_or_else(Vec::new, |domain| domain.list().to_vec());
        let second = bars
            .during(Stage::Check, || self.order.balanced(written, &made.network, check, &notes, bars))
            .map_err(|e| failed(&e))?;
        let options = options.second_order(second.as_ref().map(|second| &second.midpoints));
        let (written, check): (&dyn MeshSource, _) =
            second.as_ref().map_or((written, check), |second| (&second.corners, &second.check));
        if second.as_ref().is_some_and(|second| !second.is_balanced) {
            bars.note(UNBALANCED);
        }
        let stage = || stage_mesh(&options, &self.output, written, &notes, bars);
        outputs.append(bars.during(Stage::Write, stage).map_err(|e| failed(&e))?);
        let mut parts = Vec::new();
        if self.domain.splits() && domain.is_some() {
            let split = || stage_regions(&self.output, written, &notes, self.grid.options(), bars);
            let (paths, regions) = bars.during(Stage::Write, split).map_err(|e| failed(&e))?;
            outputs.append(regions);
            parts = paths;
        }
        if let Some(caps) = &made.caps {
            let text = caps::table(caps, &made.networks.names).map_err(|e| self.no_table(&e))?;
            outputs.add_bytes(&self.table(), text.as_bytes()).map_err(|e| self.no_table(&e))?;
        }
        let certified = Certified {
            input: &self.network.network,
            mesh: &self.output,
            format: self.format.of(&self.output)?,
            options: &self.typed(made.networks.refine.is_some()),
            check,
        };
        self.certificate.stage(&certified, &mut outputs)?;
        let name = |node| made.networks.names.of(NodeId(node));
        let verdict = Verdict::of_mesh(check, &made.report, &self.fidelity.refused(&made.defects), &name);
        let mut run = made.report.clone();
        run.stages = bars.stages();
        let found = Found {
            mesh: written,
            network: &made.network,
            check,
            shells: domain.as_ref().and_then(Regions::shells),
            midpoints: second.as_ref().map(|second| &second.curving),
            fidelity: made.fidelity.as_ref(),
            changes: &made.changes,
            caps: made.caps.as_ref(),
            defects: &made.defects,
            parts: &parts,
            attempts: (&made.attempts, made.kept),
            verdict: &verdict,
        };
        if self.report.page().is_some() {
            let page = || self.stage_page(plan, &made.networks, (&run, Some(&found)), &mut outputs);
            bars.during(Stage::Report, page)?;
            run.stages = bars.stages();
        }
        outputs.place()?;
        self.print(plan, &made.networks, &run, Some(&found))?;
        if !self.common.quiet {
            self.blocks.advise(&run, !made.is_valid());
        }
        self.fidelity.tell(&self.common, (&made.defects, made.excused.as_ref()), &run, &name);
        let exit = conclude(&self.common, &verdict);
        Ok(if run.failed.is_empty() { exit } else { Exit::StageFailed })
    }

    /// Regions around a lumen. `None` if none are asked for, or the lumen is not valid.
    fn around<'a, M>(
        &self,
        (made, expectation): (&'a NetworkMesh<M>, &'a Expectation),
        mesh: &'a dyn MeshSource,
        (plan, store): (&DomainPlan, Option<&'a Store>),
        bars: &Bars,
    ) -> Result<Option<Regions<'a>>, Failure> {
        if plan.is_plain() {
            return Ok(None);
        }
        if !made.is_valid() || !made.report.failed.is_empty() {
            bars.note("the lumen is not valid: it is written without regions around it");
            return Ok(None);
        }
        let lumen = Lumen { mesh, network: &made.network, expectation, check: &made.check };
        let stopped = |e: &DomainError| e.is_cancelled() || bars.is_cancelled();
        let failed = |e: DomainError| if stopped(&e) { self.stopped() } else { self.no_regions(&e) };
        Regions::around(&lumen, plan, store, bars).map(Some).map_err(failed)
    }

    /// Adds the HTML report to the outputs.
    fn stage_page(
        &self,
        plan: &MeshPlan,
        networks: &Networks,
        (run, found): (&RunReport, Option<&Found>),
        outputs: &mut OutputSet,
    ) -> Result<(), Failure> {
        let name = |node| networks.names.of(NodeId(node));
        let failed = || (Mark::Bad, missing(run, &name));
        let verdict = found.map_or_else(failed, |found| page::headline(found.check, found.verdict));
        let unit = page::LengthUnit(self.network.units.map(|units| units.names()[1]));
        let invalid = found.is_none_or(|found| !found.check.is_valid());
        self.report.stage((&self.output, outputs), Some(verdict), plan, |page| {
            page.add(page::advice(&self.blocks.advice(run, invalid)));
            let Some(&Found { mesh, network, check, fidelity, changes, caps, .. }) = found else {
                page.add(page::failed_blocks(&networks.network, run, unit)?);
                page.add(page::run(run, &[], &name));
                return Ok(());
            };
            page.add(page::summary(check, unit));
            let mut pictures = page::mesh_pictures(mesh)?;
            pictures.insert(0, page::network_picture(&networks.network, &[], "Network by vessel radius", unit));
            page.add(Section::new("Overview").pictures(&pictures, false)?);
            if !run.failed.is_empty() {
                page.add(page::failed_blocks(&networks.network, run, unit)?);
            }
            page.add(page::validity(check, mesh)?);
            if let Some(quality) = &check.quality {
                page.add(page::quality(quality, &DihedralHistogram::of(mesh)?));
            }
            if let Some(fidelity) = fidelity {
                page.add(page::fidelity(fidelity, &Along::of(network, mesh)?, changes, &name));
            }
            if let Some(report) = &networks.refine {
                page.add(page::refinement(report, &networks.prepared, &networks.network, unit)?);
            }
            page.add(page::run(run, &page::block_sizes(mesh)?, &name));
            if let Some(caps) = caps {
                page.add(page::terminals(caps, &networks.names, unit));
            }
            Ok(())
        })
    }

    /// Path of the table of inlets and outlets.
    fn table(&self) -> PathBuf {
        let mut name = self.output.file_stem().unwrap_or_default().to_owned();
        name.push("_patches.csv");
        self.output.with_file_name(name)
    }

    fn no_table(&self, why: &dyn std::fmt::Display) -> Failure {
        Failure::unwritable(&self.table(), why)
    }

    /// Options that the mesh depends on, as command-line text.
    fn typed(&self, is_refined: bool) -> String {
        let core = self.core.map_or_else(String::new, |core| format!(" --core {core}"));
        let [layers, regions] = [self.layers.typed(), self.domain.typed()];
        let order = self.order.typed();
        format!("mesh {}{core}{layers}{regions}{order}", self.blocks.typed(is_refined))
    }

    /// Outputs with the refined network, if requested: the network as given if that is meshed.
    fn stage_refined(&self, networks: &Networks) -> Result<OutputSet, Failure> {
        let Some(path) = &self.refined else { return Ok(OutputSet::default()) };
        if let Some(refined) = &networks.refined {
            return super::refine::stage(path, &refined.skeleton, &refined.origin);
        }
        let at: Vec<Point3> = networks.prepared.nodes.iter().map(|node| node.position).collect();
        super::refine::stage(path, &networks.prepared, &at)
    }

    /// Prints the report of the refined network that was meshed.
    fn tell_refined(&self, networks: &Networks) {
        if let Some(report) = networks.refine.as_ref().filter(|_| self.common.verbose && !self.common.json) {
            log::note(&report.text(&|node| networks.names.of(NodeId(node))));
        }
    }

    fn print(
        &self,
        plan: &MeshPlan,
        networks: &Networks,
        run: &RunReport,
        found: Option<&Found>,
    ) -> Result<(), Failure> {
        let check = found.map(|found| found.check);
        let shells = found.and_then(|found| found.shells);
        let midpoints = found.and_then(|found| found.midpoints);
        let fidelity = found.and_then(|found| found.fidelity);
        let changes = found.map(|found| found.changes);
        let (attempts, kept) = found.map_or((&[][..], 0), |found| found.attempts);
        let Networks { prepare, refine, names, .. } = networks;
        let refine = refine.as_ref();
        if self.common.json {
            let program = concat!("anastomesh ", env!("CARGO_PKG_VERSION"));
            let defects = found.map_or(&[][..], |found| found.defects);
            let verdict = found.map(|found| found.verdict.text.as_str());
            let output = Output {
                program,
                plan,
                prepare,
                refine,
                run,
                check,
                shells,
                second_order: midpoints,
                fidelity,
                changes,
                attempts,
                defects,
                verdict,
            };
            return print(true, &output, String::new);
        }
        if self.common.quiet {
            return Ok(());
        }
        let name = |node| names.of(NodeId(node));
        if self.common.verbose {
            let all = [Some(run.text(&name)), check.map(conditions), fidelity.map(Fidelity::lengths)];
            log::result(&all.into_iter().flatten().collect::<String>());
        }
        let table = self.table();
        let mut files: Vec<&Path> = if found.is_some() { vec![&self.output, &table] } else { Vec::new() };
        files.extend(found.into_iter().flat_map(|found| found.parts).map(PathBuf::as_path));
        files.extend(self.certificate.path().filter(|_| found.is_some()));
        files.extend(self.report.page().map(PathBuf::as_path));
        let (attempts, listed) = ((attempts, kept), self.common.verbose);
        let summary = Summary {
            run,
            refine,
            attempts,
            name: &name,
            check,
            shells,
            midpoints,
            fidelity,
            changes,
            ended: ended(&files),
            listed,
        };
        log::result(&summary.to_string());
        Ok(())
    }
}

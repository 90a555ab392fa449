//! `anastomesh surface`: wall surface of a network.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::blocks::BlockArgs;
use super::common::{Common, ended, print, thread_pool};
use super::exit::{Exit, Failure};
use super::fidelity::conclude;
use super::limits::{self, BlockPlace};
use super::log;
use super::network::NetworkArgs;
use super::prepare::CureArgs;
use super::progress::Bars;
use super::refine::RefineArgs;
use super::run::{failure, remarks};
use super::stop::{NOTHING_KEPT, Stop};
use crate::pipeline::{Estimate, MeshPlan, RunReport};
use crate::report::summary::Summary;
use crate::report::verdict::{Verdict, missing};
use crate::run::{Defect, MeshingError, NetworkMesh, Networks, PreparedRun, Run};
use anastomesh_io::surface::{ensure_boundary_writable, write_boundary_watched};
use anastomesh_io::volume::MeshNotes;
use anastomesh_mesh::boundary::{BoundaryPart, BoundarySurface};
use anastomesh_mesh::check::CheckReport;
use anastomesh_mesh::check::text::conditions;
use anastomesh_mesh::progress::{Progress, Stage};
use anastomesh_network::PrepareReport;
use anastomesh_network::RefineReport;
use anastomesh_skeleton::NodeId;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    network: NetworkArgs,
    /// Output file: .stl (binary), .ply, .obj, .off, .glb, .3mf or .vtp
    #[arg(short, long, value_name = "SURFACE", help_heading = "Output")]
    output: PathBuf,
    /// Omit the caps of inlets and outlets
    #[arg(long, help_heading = "Output")]
    no_caps: bool,
    #[command(flatten)]
    blocks: BlockArgs,
    #[command(flatten)]
    common: Common,
    #[command(flatten)]
    cures: CureArgs,
    #[command(flatten)]
    how: RefineArgs,
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
}

/// Makes and writes the wall of a network.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let plan = MeshPlan { hollow: true, ..args.blocks.plan(args.how.fuses()) };
    plan.validate().map_err(|e| Failure::usage(e.to_string()))?;
    ensure_boundary_writable(&args.output).map_err(|e| Failure::input(e.to_string()))?;
    let pool = thread_pool(args.common.threads)?;
    let prepared = pool.install(|| args.prepared(plan))?;
    let stop = Stop::listen(args.common.quiet)?;
    let bars = Bars::new(args.common.quiet, args.common.progress, stop.clone());
    let Networks { prepare, names, .. } = &prepared.networks;
    for remark in remarks(&prepared.notes, prepare, names, args.common.verbose) {
        bars.note(&remark);
    }
    let prepared = pool.install(|| prepared.refined(None, &bars)).map_err(|e| args.explain_alone(e))?;
    if let Some(report) = prepared.networks.refine.as_ref().filter(|_| args.common.verbose && !args.common.json) {
        log::note(&report.text(&|node| prepared.networks.names.of(NodeId(node))));
    }
    pool.install(|| args.make(prepared, &bars))
}

impl Args {
    /// Reads and prepares the network.
    fn prepared(&self, mut plan: MeshPlan) -> Result<PreparedRun, Failure> {
        let cures = self.cures.params(true);
        let file = self.blocks.read(&self.network, cures.radii, &mut plan)?;
        let mut run = Run::new(file).plan(plan).prepare(cures);
        if let Some(iterations) = self.blocks.refine {
            run = run.refine(self.how.params(iterations));
        }
        run.prepared().map_err(|e| self.explain_alone(e))
    }

    fn make(&self, run: PreparedRun, bars: &Bars) -> Result<Exit, Failure> {
        let plan = &run.plan.clone();
        let (_, store) = BlockPlace::beside(&self.output, &run.rough_estimate(), plan.memory)?;
        let fits = |estimate: &Estimate| limits::block_fits(estimate, plan);
        let mut made = run.mesh_into(&store, &fits, bars).map_err(|e| self.explain(e, plan))?;
        bars.keep();
        let notes = MeshNotes {
            generator: concat!("anastomesh ", env!("CARGO_PKG_VERSION")).into(),
            options: format!("surface {}", self.blocks.typed(true)),
            ..MeshNotes::default()
        };
        let faces = if self.no_caps { BoundaryPart::Wall } else { BoundaryPart::Whole };
        let failed = |e: &dyn std::fmt::Display| {
            if bars.is_cancelled() { Failure::stopped(NOTHING_KEPT) } else { Failure::input(e.to_string()) }
        };
        let write = || {
            let surface = BoundarySurface::new(&made.mesh, faces).map_err(|e| failed(&e))?;
            write_boundary_watched(&self.output, &surface, &notes, bars).map_err(|e| failed(&e))
        };
        bars.during(Stage::Write, write)?;
        made.report.stages = bars.stages();
        self.print(plan, &made.networks, &made.report, Some(&made))?;
        if !self.common.quiet {
            self.blocks.advise(&made.report, !made.is_valid());
        }
        let defects: Vec<&Defect> = made.defects.iter().collect();
        let name = |node| made.networks.names.of(NodeId(node));
        let exit = conclude(&self.common, &Verdict::of_mesh(&made.check, &made.report, &defects, &name));
        Ok(if made.report.failed.is_empty() { exit } else { Exit::StageFailed })
    }

    /// Failure of a run, after its report.
    fn explain(&self, error: MeshingError, plan: &MeshPlan) -> Failure {
        let MeshingError::Blocks { report, networks } = error else { return self.explain_alone(error) };
        if let Err(failure) = self.print::<()>(plan, &networks, &report, None) {
            return failure;
        }
        if !self.common.quiet {
            self.blocks.advise(&report, true);
        }
        let missing = missing(&report, &|node| networks.names.of(NodeId(node)));
        Failure::stage(format!("{missing}; --keep-going writes the rest"))
    }

    /// Failure of a run before its blocks.
    fn explain_alone(&self, error: MeshingError) -> Failure {
        failure(error, &self.network.network, || Failure::stopped(NOTHING_KEPT))
    }

    fn print<M>(
        &self,
        plan: &MeshPlan,
        networks: &Networks,
        run: &RunReport,
        made: Option<&NetworkMesh<M>>,
    ) -> Result<(), Failure> {
        let check = made.map(|made| &made.check);
        let Networks { prepare, refine, names, .. } = networks;
        let refine = refine.as_ref();
        if self.common.json {
            let program = concat!("anastomesh ", env!("CARGO_PKG_VERSION"));
            return print(true, &Output { program, plan, prepare, refine, run, check }, String::new);
        }
        if self.common.quiet {
            return Ok(());
        }
        let name = |node| names.of(NodeId(node));
        if self.common.verbose {
            let all = [Some(run.text(&name)), check.map(conditions)];
            log::result(&all.into_iter().flatten().collect::<String>());
        }
        let files: &[&Path] = if check.is_some() { &[&self.output] } else { &[] };
        let summary = Summary {
            run,
            refine,
            attempts: made.map_or((&[], 0), |made| (&made.attempts, made.kept)),
            name: &name,
            check,
            shells: None,
            midpoints: None,
            fidelity: None,
            changes: made.map(|made| &made.changes),
            ended: ended(files),
            listed: self.common.verbose,
        };
        log::result(&summary.to_string());
        Ok(())
    }
}

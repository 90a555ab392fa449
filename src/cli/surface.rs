//! `anastomesh surface`: the wall of a network for pictures and printers, without tetrahedra.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::before::{Before, Made, Meshing};
use super::blocks::BlockArgs;
use super::common::{Common, ended, print, thread_pool};
use super::exit::{Exit, Failure};
use super::hint;
use super::limits::{self, BlockPlace};
use super::log;
use super::network::NetworkArgs;
use super::prepare::CureArgs;
use super::progress::Bars;
use super::refine::RefineArgs;
use super::stop::{NOTHING_KEPT, Stop};
use crate::pipeline::{Clock, Estimate, MeshPlan, RunError, RunReport};
use crate::report::summary::Summary;
use anastomesh_io::surface::{ensure_boundary_writable, write_boundary_watched};
use anastomesh_io::volume::MeshNotes;
use anastomesh_mesh::boundary::{BoundaryPart, BoundarySurface};
use anastomesh_mesh::check::CheckReport;
use anastomesh_mesh::check::text::conditions;
use anastomesh_mesh::progress::{Progress, Stage};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    network: NetworkArgs,
    /// Where the wall goes: .stl (binary), .ply, .obj, .off, .glb, .3mf or .vtp
    #[arg(short, long, value_name = "SURFACE", help_heading = "Output")]
    output: PathBuf,
    /// Leave inlets and outlets open instead of closing them with flat caps
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

/// What `--json` prints.
#[derive(Serialize)]
struct Output<'a> {
    program: &'static str,
    plan: &'a MeshPlan,
    #[serde(flatten)]
    before: &'a Before,
    run: &'a RunReport,
    check: Option<&'a CheckReport>,
}

/// Makes the wall of a network and writes it.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let mut plan = MeshPlan { hollow: true, ..args.blocks.plan(args.how.fuses()) };
    plan.validate().map_err(|e| Failure::usage(e.to_string()))?;
    ensure_boundary_writable(&args.output).map_err(|e| Failure::input(e.to_string()))?;
    let pool = thread_pool(args.common.threads)?;
    let network = pool.install(|| args.blocks.read(&args.network, &args.cures.params(true), &mut plan))?;
    let stop = Stop::listen(args.common.quiet)?;
    let bars = Bars::new(args.common.quiet, args.common.progress, stop.clone());
    for remark in network.remarks(args.common.verbose) {
        bars.note(&remark);
    }
    let moved = |iterations| {
        let params = args.how.params(iterations);
        pool.install(|| super::refine::moved(&network, params, &args.common, &stop))
    };
    let refined = args.blocks.refine.map(moved).transpose()?;
    if let Some((refined, _)) = refined.as_ref().filter(|_| args.common.verbose && !args.common.json) {
        log::note(&refined.report.to_string());
    }
    let before = Before::new(network, refined);
    stop.keep();
    pool.install(|| args.make(before, &plan, &bars))
}

impl Args {
    fn make(&self, before: Before, plan: &MeshPlan, bars: &Bars) -> Result<Exit, Failure> {
        let rough = Estimate::rough(&before.network, plan);
        let (_, store) = BlockPlace::beside(&self.output, &rough, plan.memory)?;
        let fits = |estimate: &Estimate| limits::block_fits(estimate, plan);
        let how = Meshing { store: &store, plan, fits: &fits, touches: self.cures.touches(), bars };
        let Made { stored: mut made, before } =
            before.mesh(how).map_err(|(e, before)| self.explain(e, plan, &before))?;
        let notes = MeshNotes {
            generator: concat!("anastomesh ", env!("CARGO_PKG_VERSION")).into(),
            options: format!("surface {}", self.blocks.typed()),
            ..MeshNotes::default()
        };
        let faces = if self.no_caps { BoundaryPart::Wall } else { BoundaryPart::Whole };
        let failed = |e: &dyn std::fmt::Display| {
            if bars.is_cancelled() { Failure::stopped(NOTHING_KEPT) } else { Failure::input(e.to_string()) }
        };
        let mut clock = Clock::default();
        let write = || {
            let surface = BoundarySurface::new(&made.whole, faces).map_err(|e| failed(&e))?;
            write_boundary_watched(&self.output, &surface, &notes, bars).map_err(|e| failed(&e))
        };
        clock.time(bars, Stage::Write, 0, write)?;
        made.report.stages.extend(clock.stages());
        self.print(plan, &before, &made.report, Some(&made.check))?;
        let invalid = !made.check.is_valid() || !made.report.keeps_vessels(plan.fuse);
        self.blocks.advise(&made.report, invalid);
        Ok(match () {
            () if !made.report.failed.is_empty() => Exit::StageFailed,
            () if invalid => Exit::GateNotMet,
            () => Exit::Fine,
        })
    }

    /// What went wrong, for people.
    fn explain(&self, error: RunError, plan: &MeshPlan, before: &Before) -> Failure {
        match error {
            RunError::BlocksFailed(report) => {
                if let Err(failure) = self.print(plan, before, &report, None) {
                    return failure;
                }
                self.blocks.advise(&report, true);
                Failure::stage(format!(
                    "{} block(s) have no sound surface, named above. --keep-going leaves them out",
                    report.failed.len()
                ))
            }
            RunError::Cancelled => Failure::stopped(NOTHING_KEPT),
            RunError::Root(_) | RunError::Plan(_) => Failure::usage(error.to_string()),
            RunError::TooLarge(_) | RunError::Store(_) => Failure::input(hint::of_run(&error)),
            _ => Failure::stage(error.to_string()),
        }
    }

    fn print(
        &self,
        plan: &MeshPlan,
        before: &Before,
        run: &RunReport,
        check: Option<&CheckReport>,
    ) -> Result<(), Failure> {
        if self.common.json {
            let program = concat!("anastomesh ", env!("CARGO_PKG_VERSION"));
            return print(true, &Output { program, plan, before, run, check }, String::new);
        }
        // What is wrong is an error, which --quiet does not silence.
        let is_wrong = !run.failed.is_empty() || !run.keeps_vessels(plan.fuse) || check.is_some_and(|c| !c.is_valid());
        if !self.common.quiet || is_wrong {
            if self.common.verbose {
                let all = [Some(run.to_string()), check.map(conditions)];
                log::result(&all.into_iter().flatten().collect::<String>());
            }
            let files: &[&Path] = if check.is_some() { &[&self.output] } else { &[] };
            log::result(
                &Summary { run, check, fidelity: None, ended: ended(files), listed: self.common.verbose }.to_string(),
            );
        }
        Ok(())
    }
}

//! `anastomesh refine`: moves overlapping vessels of a network apart.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::common::{Common, ended, print, thread_pool};
use super::exit::{Exit, Failure};
use super::fidelity::{FidelityArgs, conclude};
use super::log;
use super::network::{NetworkArgs, PreparedNetwork};
use super::numbers::number;
use super::page::ReportArgs;
use super::prepare::CureArgs;
use super::progress::Bars;
use super::run::{refine_failure, remarks};
use super::stop::Stop;
use crate::fidelity::{Changes, Compared, Displaced, Fidelity, Repairs};
use crate::pipeline::RunReport;
use crate::report::page;
use crate::report::plot::svg;
use crate::report::refine::{brief, csv, panels};
use crate::report::summary::fidelity_rows;
use crate::report::verdict::Verdict;
use crate::run::{Defect, Limits};
use anastomesh_io::OutputSet;
use anastomesh_io::network::{ensure_network_writable, refinement_arrays, stage_network};
use anastomesh_mesh::geometry::Point3;
use anastomesh_network::PrepareReport;
use anastomesh_network::{Crowded, Freedom, Metric, RefineParams, RefineReport, Refined, Residual, refine};
use anastomesh_skeleton::{NodeId, Skeleton};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    network: NetworkArgs,
    /// Output file: .vtp or .npyd, with the arrays `OriginalNode`, `Displacement`, `Radius` and `EdgeRadius`
    #[arg(short, long, value_name = "NETWORK", help_heading = "Output")]
    output: PathBuf,
    /// Maximum number of iterations
    #[arg(long, value_name = "N", default_value_t = RefineParams::default().iterations, help_heading = "Refinement")]
    iterations: usize,
    /// Interval between measurements of the metrics, in iterations (0: only before and after). The first ten are always measured
    #[arg(long, value_name = "N", default_value_t = RefineParams::default().every, help_heading = "Refinement")]
    every: usize,
    #[command(flatten)]
    cures: CureArgs,
    #[command(flatten)]
    how: RefineArgs,
    /// Write the metrics of all measured iterations as a table
    #[arg(long, value_name = "FILE.csv", help_heading = "Output")]
    metrics: Option<PathBuf>,
    /// Plot displacement, barrier potential, lengths and angles over the iterations
    #[arg(long, value_name = "FILE.svg", help_heading = "Output")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    fidelity: FidelityArgs,
    #[command(flatten)]
    report: ReportArgs,
    #[command(flatten)]
    common: Common,
}

/// Options of the refinement, shared by commands that refine networks.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Refinement")]
pub struct RefineArgs {
    /// Rate of the barrier force, which drives overlapping vessels apart (the paper's l1)
    #[arg(long, value_name = "RATE", default_value_t = RefineParams::default().barrier_rate, allow_negative_numbers = true, value_parser = number)]
    barrier_rate: f64,
    /// Rate of the repelling force, which lengthens short vessels (the paper's l2)
    #[arg(long, value_name = "RATE", default_value_t = RefineParams::default().repel_rate, allow_negative_numbers = true, value_parser = number)]
    repel_rate: f64,
    /// Rate of the angle force, which opens narrow angles (the paper's l3)
    #[arg(long, value_name = "RATE", default_value_t = RefineParams::default().angle_rate, allow_negative_numbers = true, value_parser = number)]
    angle_rate: f64,
    /// Target distance of two vessel axes, in sums of their radii
    #[arg(long, value_name = "FACTOR", default_value_t = RefineParams::default().clearance, allow_negative_numbers = true, value_parser = number)]
    clearance: f64,
    /// Maximum displacement of a node in radii, for overlapping vessels only. Default for measured networks and those without
    /// overlaps: 1, more where an overlap needs it. Default for others, and with `inf`: as far as cuts need
    #[arg(long, value_name = "R", allow_negative_numbers = true, value_parser = number)]
    max_move: Option<f64>,
    /// Maximum displacement of terminals and roots, in the unit of the network
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_negative_numbers = true, value_parser = number)]
    free_terminals: f64,
    /// Treatment of terminals closer than the sum of their radii
    #[arg(long, value_enum, default_value_t = CrowdedArg::Part)]
    crowded_terminals: CrowdedArg,
    /// Treatment of overlaps that remain after the last iteration
    #[arg(long, value_enum, default_value_t = ResidualArg::Shrink)]
    residual: ResidualArg,
    /// Metrics that must not get worse, comma-separated; if no iteration satisfies this, nothing is moved
    #[arg(long, value_name = "METRICS", value_delimiter = ',', value_parser = metric, default_value = "overlaps,far-pairs")]
    hold: Vec<Metric>,
}

/// Treatment of terminals that are too close.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum CrowdedArg {
    /// Keep and list them; their caps do not fit
    Keep,
    /// Move both apart until two caps fit
    Part,
    /// Merge them: of two vessels from one node the thinner is removed, others are joined
    Merge,
}

fn metric(name: &str) -> Result<Metric, String> {
    let all = Metric::ALL.map(Metric::name);
    Metric::ALL.into_iter().find(|m| m.name() == name).ok_or_else(|| format!("known metrics: {}", all.join(", ")))
}

/// Treatment of overlaps that remain after the last iteration.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum ResidualArg {
    /// List them
    Report,
    /// Reduce the radii at the overlap by at most 30 %
    Shrink,
    /// Mesh both vessels as one lumen; `refine` only lists them
    Fuse,
}

impl RefineArgs {
    /// True if remaining overlaps are meshed as one lumen.
    pub fn fuses(&self) -> bool {
        matches!(self.residual, ResidualArg::Fuse)
    }

    fn freedom(&self) -> Freedom {
        match self.max_move {
            None => Freedom::Auto,
            Some(f64::INFINITY) => Freedom::Grown,
            Some(radii) => Freedom::Radii(radii),
        }
    }

    /// Parameters with this number of iterations.
    pub fn params(&self, iterations: usize) -> RefineParams {
        RefineParams::default()
            .iterations(iterations)
            .barrier_rate(self.barrier_rate)
            .repel_rate(self.repel_rate)
            .angle_rate(self.angle_rate)
            .clearance(self.clearance)
            .free_terminals(self.free_terminals)
            .freedom(self.freedom())
            .crowded(match self.crowded_terminals {
                CrowdedArg::Keep => Crowded::Keep,
                CrowdedArg::Part => Crowded::Part,
                CrowdedArg::Merge => Crowded::Merge,
            })
            .residual(match self.residual {
                ResidualArg::Report => Residual::Report,
                ResidualArg::Shrink => Residual::Shrink,
                ResidualArg::Fuse => Residual::Fuse,
            })
            .hold(self.hold.clone())
    }
}

/// Output of `--json`.
#[derive(Serialize)]
struct Output<'a> {
    program: &'static str,
    parameters: &'a RefineParams,
    prepare: &'a PrepareReport,
    report: &'a RefineReport,
    fidelity: &'a Fidelity,
    changes: &'a Changes,
    defects: &'a [Defect],
    verdict: &'a str,
}

/// Refines a network and writes it.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    ensure_network_writable(&args.output).map_err(|e| Failure::input(e.to_string()))?;
    args.report.ensure_writable()?;
    let limits = args.fidelity.limits()?;
    let pool = thread_pool(args.common.threads)?;
    let network = pool.install(|| args.network.prepared(&args.cures.params(true).lossless(true)))?;
    if !args.common.quiet {
        for remark in remarks(&network.notes, &network.report, &network.names, args.common.verbose) {
            log::note(&remark);
        }
    }
    let params = args.how.params(args.iterations).every(args.every).fitted(network.report.measured);
    let stop = Stop::listen(args.common.quiet)?;
    let bars = Bars::new(args.common.quiet, args.common.progress, stop.clone());
    let refined = pool.install(|| refine(&network.skeleton, &params, &bars)).map_err(|e| refine_failure(&e))?;
    stop.keep();
    let mut outputs = stage(&args.output, &refined.skeleton, &refined.origin)?;
    let report = &refined.report;
    for (path, text) in [(&args.metrics, csv as fn(&RefineReport) -> String), (&args.plot, |r| svg(&panels(r)))] {
        if let Some(path) = path {
            let added = outputs.add_bytes(path, text(report).as_bytes());
            added.map_err(|e| Failure::input(format!("{}: {e}", path.display())))?;
        }
    }
    let name = |node| network.names.of(NodeId(node));
    let Comparison { fidelity, changes, defects, excused } = pool.install(|| compared(&network, &refined, limits));
    let ensures = params.residual == Residual::Shrink;
    let verdict = Verdict::of_refinement(report, ensures, &args.fidelity.refused(&defects), &name);
    let unit = page::LengthUnit(args.network.units.map(|units| units.names()[1]));
    pool.install(|| {
        let headline = Some(page::of_refinement(&verdict));
        args.report.stage((&args.output, &mut outputs), headline, &params, |page| {
            page.add(page::refinement(report, &network.skeleton, &refined.skeleton, unit)?);
            Ok(())
        })
    })?;
    outputs.place()?;
    if args.common.json {
        let program = concat!("anastomesh ", env!("CARGO_PKG_VERSION"));
        let (parameters, prepare, verdict) = (&params, &network.report, &*verdict.text);
        let (fidelity, changes, defects) = (&fidelity, &changes, &*defects);
        let output = Output { program, parameters, prepare, report, fidelity, changes, defects, verdict };
        print(true, &output, String::new)?;
    } else if !args.common.quiet {
        let table = if args.common.verbose { report.text(&name) } else { String::new() };
        let files = [Some(&args.output), args.metrics.as_ref(), args.plot.as_ref(), args.report.page()];
        let files: Vec<&Path> = files.into_iter().flatten().map(PathBuf::as_path).collect();
        let rows = fidelity_rows(Some(&fidelity), Some(&changes), &name);
        log::result(&format!("{table}{}", brief(report, &rows, &name, &ended(&files))));
    }
    args.fidelity.tell(&args.common, (&defects, excused.as_ref()), &RunReport::default(), &name);
    Ok(conclude(&args.common, &verdict))
}

/// Comparison of a refined network with the given one.
struct Comparison {
    fidelity: Fidelity,
    changes: Changes,
    defects: Vec<Defect>,
    /// Furthest displacement beyond the limit that listed changes require.
    excused: Option<Displaced>,
}

/// Compares a refined network with the given one.
fn compared(network: &PreparedNetwork, refined: &Refined, limits: Limits) -> Comparison {
    let PreparedNetwork { given, outline, skeleton, report: prepare, .. } = network;
    let repairs = Repairs { prepare, refine: Some(&refined.report) };
    let fidelity = Fidelity::of_network(Compared { given, outline, meshed: &refined.skeleton });
    let changes = Changes::of(given, skeleton, &refined.skeleton, repairs, &[]);
    let defects = limits.unfaithful([given, skeleton], repairs, &fidelity, &changes);
    let excused = limits.excused(repairs, &fidelity, &defects);
    Comparison { fidelity, changes, defects, excused }
}

/// Writes a refined network under a temporary name.
pub(super) fn stage(path: &Path, network: &Skeleton, origin: &[Point3]) -> Result<OutputSet, Failure> {
    let arrays = refinement_arrays(network, origin);
    stage_network(path, network, &arrays).map_err(|e| Failure::input(e.to_string()))
}

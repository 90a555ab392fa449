//! `anastomesh refine`: moves the nodes of a network until its vessels do not overlap and can be cut.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::common::{Common, ended, print, thread_pool};
use super::exit::{Exit, Failure};
use super::log;
use super::network::NetworkArgs;
use super::page::ReportArgs;
use super::prepare::CureArgs;
use super::progress::Bars;
use super::run::{refine_failure, remarks};
use super::stop::Stop;
use crate::report::page;
use crate::report::plot::svg;
use crate::report::refine::{brief, csv, panels};
use anastomesh_io::network::{ensure_network_writable, refinement_arrays, write_network};
use anastomesh_io::write_text;
use anastomesh_mesh::geometry::Point3;
use anastomesh_network::PrepareReport;
use anastomesh_network::{Crowded, Freedom, Metric, RefineParams, RefineReport, Residual, refine};
use anastomesh_skeleton::Skeleton;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    network: NetworkArgs,
    /// Where the refined network goes: .vtp (or .npyd, arrays in a folder), with the arrays `OriginalNode`, `Displacement`, `Radius` and `EdgeRadius`
    #[arg(short, long, value_name = "NETWORK", help_heading = "Output")]
    output: PathBuf,
    /// Iterations at most; it stops earlier when nothing is left to do
    #[arg(long, value_name = "N", default_value_t = RefineParams::default().iterations, help_heading = "Refinement")]
    iterations: usize,
    /// Measure the metrics every so many iterations, and after each of the first ten (0: at both ends only)
    #[arg(long, value_name = "N", default_value_t = RefineParams::default().every, help_heading = "Refinement")]
    every: usize,
    #[command(flatten)]
    cures: CureArgs,
    #[command(flatten)]
    how: RefineArgs,
    /// Write the metrics over the iterations as a table
    #[arg(long, value_name = "FILE.csv", help_heading = "Output")]
    metrics: Option<PathBuf>,
    /// Draw them: displacement, barrier potential, lengths and angles over the iterations
    #[arg(long, value_name = "FILE.svg", help_heading = "Output")]
    plot: Option<PathBuf>,
    #[command(flatten)]
    report: ReportArgs,
    #[command(flatten)]
    common: Common,
}

/// How to refine: arguments of every verb that does.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Refinement")]
pub struct RefineArgs {
    /// Rate of the barrier force, which drives overlapping vessels apart (the paper's l1)
    #[arg(long, value_name = "RATE", default_value_t = RefineParams::default().barrier_rate, allow_negative_numbers = true)]
    barrier_rate: f64,
    /// Rate of the repelling force, which lengthens short vessels (the paper's l2)
    #[arg(long, value_name = "RATE", default_value_t = RefineParams::default().repel_rate, allow_negative_numbers = true)]
    repel_rate: f64,
    /// Rate of the angle force, which opens narrow angles (the paper's l3)
    #[arg(long, value_name = "RATE", default_value_t = RefineParams::default().angle_rate, allow_negative_numbers = true)]
    angle_rate: f64,
    /// How far the axes of two vessels are to be apart, in sums of their radii
    #[arg(long, value_name = "FACTOR", default_value_t = RefineParams::default().clearance, allow_negative_numbers = true)]
    clearance: f64,
    /// How far a node may go, in its radii: nothing moves but what overlaps (default: in a network whose vessels are
    /// polylines, or where nothing overlaps, 1, further only where an overlap is not parted by that; in others, and with
    /// `inf`, as far as room for cuts asks)
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    max_move: Option<f64>,
    /// Let terminals and roots move this far, in the unit of the network
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_negative_numbers = true)]
    free_terminals: f64,
    /// What to do with terminals that are closer to each other than the sum of their radii; all others stay where they are
    #[arg(long, value_enum, default_value_t = CrowdedArg::Part)]
    crowded_terminals: CrowdedArg,
    /// What to do with vessels that overlap in the end
    #[arg(long, value_enum, default_value_t = ResidualArg::Shrink)]
    residual: ResidualArg,
    /// Metrics in which the result must not be worse than the input: when no state is, nothing is moved
    #[arg(long, value_name = "METRICS", value_delimiter = ',', value_parser = metric, default_value = "overlaps,far-pairs")]
    hold: Vec<Metric>,
}

/// What to do with crowded terminals.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum CrowdedArg {
    /// List them: where they lie no two caps have room
    Keep,
    /// Move them apart, half the way each, as far as two caps need
    Part,
    /// Make them one: of two vessels that leave one node the thinner goes, others are joined
    Merge,
}

fn metric(name: &str) -> Result<Metric, String> {
    let all = Metric::ALL.map(Metric::name);
    Metric::ALL.into_iter().find(|m| m.name() == name).ok_or_else(|| format!("the metrics are {}", all.join(", ")))
}

/// What to do with vessels that overlap in the end.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum ResidualArg {
    /// List them
    Report,
    /// Reduce their radii where they meet, by 30 % at most
    Shrink,
    /// Mesh them together as one lumen; `refine` lists them
    Fuse,
}

impl RefineArgs {
    /// Whether vessels that overlap in the end are to be meshed together.
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

    /// The parameters for so many iterations.
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

/// What `--json` prints.
#[derive(Serialize)]
struct Output<'a> {
    program: &'static str,
    parameters: &'a RefineParams,
    prepare: &'a PrepareReport,
    report: &'a RefineReport,
}

/// Refines a network and writes it.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    ensure_network_writable(&args.output).map_err(|e| Failure::input(e.to_string()))?;
    args.report.ensure_writable()?;
    let pool = thread_pool(args.common.threads)?;
    let network = pool.install(|| args.network.prepared(&args.cures.params(true)))?;
    if !args.common.quiet {
        for remark in remarks(&network.notes, &network.report, args.common.verbose) {
            log::note(&remark);
        }
    }
    let params = args.how.params(args.iterations).every(args.every).fitted(network.report.measured);
    let stop = Stop::listen(args.common.quiet)?;
    let bars = Bars::new(args.common.quiet, args.common.progress, stop.clone());
    let refined = pool.install(|| refine(&network.skeleton, &params, &bars)).map_err(|e| refine_failure(&e))?;
    stop.keep();
    write(&args.output, &refined.skeleton, &refined.origin)?;
    let report = &refined.report;
    for (path, text) in [(&args.metrics, csv as fn(&RefineReport) -> String), (&args.plot, |r| svg(&panels(r)))] {
        if let Some(path) = path {
            write_text(path, &text(report)).map_err(|e| Failure::input(format!("{}: {e}", path.display())))?;
        }
    }
    let unit = page::LengthUnit(args.network.units.map(|units| units.names()[1]));
    pool.install(|| {
        args.report.write(&args.output, Some(page::overlaps_left(report)), &params, |page| {
            page.add(page::refinement(report, &network.skeleton, &refined.skeleton, unit)?);
            Ok(())
        })
    })?;
    if args.common.json {
        let program = concat!("anastomesh ", env!("CARGO_PKG_VERSION"));
        print(true, &Output { program, parameters: &params, prepare: &network.report, report }, String::new)?;
    } else if !args.common.quiet {
        let table = if args.common.verbose { report.to_string() } else { String::new() };
        let files = [Some(&args.output), args.metrics.as_ref(), args.plot.as_ref(), args.report.page()];
        let files: Vec<&Path> = files.into_iter().flatten().map(PathBuf::as_path).collect();
        log::result(&format!("{table}{}", brief(report, &ended(&files))));
    }
    let gate = params.residual == Residual::Shrink && report.residual.left > 0;
    Ok(if gate { Exit::GateNotMet } else { Exit::Fine })
}

/// Writes a refined network.
pub(super) fn write(path: &Path, network: &Skeleton, origin: &[Point3]) -> Result<(), Failure> {
    let arrays = refinement_arrays(network, origin);
    write_network(path, network, &arrays).map_err(|e| Failure::input(e.to_string()))
}

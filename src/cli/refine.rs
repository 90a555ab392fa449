//! `anastomesh refine`: moves the nodes of a network until its vessels do not overlap and can be cut.

use std::fmt::Write as _;
use std::path::PathBuf;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

use super::exit::{Exit, Failure};
use super::network::NetworkArgs;
use crate::io::network::{ensure_network_writable, refinement_arrays, write_network};
use crate::io::write_text;
use crate::refine::{self, Figures, Progress, RefineParams, RefineReport, Refined, Residual, Sample, Treatment};
use crate::report::plot::{Panel, Series, svg};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    network: NetworkArgs,
    /// Where the refined network goes: .vtp, with the arrays `OriginalNode`, `Displacement`, `Radius` and `EdgeRadius`
    #[arg(short, long, value_name = "NETWORK")]
    output: PathBuf,
    #[command(flatten)]
    how: RefineArgs,
    /// Write the metrics over the iterations as a table
    #[arg(long, value_name = "FILE.csv")]
    metrics: Option<PathBuf>,
    /// Draw them: displacement, barrier potential, lengths and angles over the iterations
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
    /// Number of threads (default: all cores); the output does not depend on it
    #[arg(short = 'j', long, value_name = "N")]
    threads: Option<std::num::NonZeroUsize>,
    /// Print the report as JSON on standard output
    #[arg(long)]
    json: bool,
    /// Print nothing but errors
    #[arg(short, long)]
    quiet: bool,
}

/// How to refine: arguments of every verb that does.
#[derive(Debug, clap::Args)]
pub struct RefineArgs {
    /// Iterations at most; it stops earlier when nothing is left to do
    #[arg(long, value_name = "N", default_value_t = RefineParams::default().iterations)]
    iterations: usize,
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
    /// Let terminals and roots move this far, in the unit of the network
    #[arg(long, value_name = "R", default_value_t = 0.0, allow_negative_numbers = true)]
    free_terminals: f64,
    /// What to do with vessels that overlap in the end
    #[arg(long, value_enum, default_value_t = ResidualArg::Shrink)]
    residual: ResidualArg,
    /// Measure the metrics every so many iterations
    #[arg(long, value_name = "N", default_value_t = RefineParams::default().every)]
    every: usize,
}

/// What to do with vessels that overlap in the end.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum ResidualArg {
    /// List them
    Report,
    /// Reduce their radii where they meet, by 30 % at most
    Shrink,
    /// List them as vessels that are to be meshed together
    Fuse,
}

impl RefineArgs {
    /// The parameters.
    pub fn params(&self) -> RefineParams {
        RefineParams {
            iterations: self.iterations,
            barrier_rate: self.barrier_rate,
            repel_rate: self.repel_rate,
            angle_rate: self.angle_rate,
            clearance: self.clearance,
            free_terminals: self.free_terminals,
            residual: match self.residual {
                ResidualArg::Report => Residual::Report,
                ResidualArg::Shrink => Residual::Shrink,
                ResidualArg::Fuse => Residual::Fuse,
            },
            every: self.every,
            ..RefineParams::default()
        }
    }
}

/// What `--json` prints.
#[derive(Serialize)]
struct Output<'a> {
    program: &'static str,
    parameters: &'a RefineParams,
    report: &'a RefineReport,
}

/// A bar on standard error, on a terminal only.
pub(super) struct Bar(ProgressBar);

impl Bar {
    pub(super) fn new(quiet: bool) -> Self {
        let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr_with_hz(10) };
        let bar = ProgressBar::with_draw_target(None, target);
        if let Ok(style) = ProgressStyle::with_template("{prefix:>10} {wide_bar} {pos}/{len} {per_sec} {eta}") {
            bar.set_style(style);
        }
        bar.set_prefix("refine");
        Self(bar)
    }
}

impl Progress for Bar {
    fn step(&mut self, iteration: usize, of: usize, _: Option<&Sample>) {
        self.0.set_length(of as u64);
        self.0.set_position(iteration as u64);
        if iteration == of {
            self.0.finish_and_clear();
        }
    }
}

/// Refines a network and writes it.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    ensure_network_writable(&args.output).map_err(|e| Failure::input(e.to_string()))?;
    let network = args.network.read()?;
    if !args.quiet {
        for remark in network.remarks() {
            eprintln!("{remark}");
        }
    }
    let params = args.how.params();
    let pool = super::thread_pool(args.threads)?;
    let refined = pool.install(|| refine::refine(&network.skeleton, &params, &mut Bar::new(args.quiet)));
    let refined = refined.map_err(|e| Failure::usage(e.to_string()))?;
    write(&args.output, &refined)?;
    let report = &refined.report;
    for (path, text) in
        [(&args.metrics, csv as fn(&RefineReport) -> String), (&args.plot, |r| svg(&panels(r)))]
    {
        if let Some(path) = path {
            write_text(path, &text(report)).map_err(|e| Failure::input(format!("{}: {e}", path.display())))?;
        }
    }
    if args.json {
        let program = concat!("anastomesh ", env!("CARGO_PKG_VERSION"));
        super::print(true, &Output { program, parameters: &params, report }, String::new)?;
    } else if !args.quiet {
        eprint!("{}", text(report));
    }
    let gate = params.residual == Residual::Shrink && report.residual.left > 0;
    Ok(if gate { Exit::GateNotMet } else { Exit::Fine })
}

/// Writes a refined network.
pub(super) fn write(path: &std::path::Path, refined: &Refined) -> Result<(), Failure> {
    let arrays = refinement_arrays(&refined.skeleton, &refined.origin);
    write_network(path, &refined.skeleton, &arrays).map_err(|e| Failure::input(e.to_string()))
}

/// Pairs that are spelt out for people.
const LISTED: usize = 50;

/// The report for people.
pub(super) fn text(report: &RefineReport) -> String {
    let mut out = String::new();
    let d = &report.displacement;
    // Writing to a string cannot fail.
    let _ = writeln!(
        out,
        "nodes: {} to {} ({} split, {} bends put in); edges: {} to {}",
        report.size_before[0],
        report.size_after[0],
        report.nodes_split,
        report.bends,
        report.size_before[1],
        report.size_after[1]
    );
    let iterations = report.history.last().map_or(0, |s| s.iteration);
    let _ = writeln!(
        out,
        "moved in {iterations} iterations (best after {}): mean {:.4}, median {:.4}, 95 % {:.4}, 99 % {:.4}, furthest {:.4} (a median \
         radius is {:.4})",
        report.chosen,
        d.mean,
        d.median,
        d.p95,
        d.p99,
        d.max,
        0.448 * report.unit
    );
    let _ = writeln!(out, "{:26}{:>12}{:>12}{:>12}{:>12}", "", "given", "split", "moved", "result");
    let states = [&report.given, &report.split, &report.moved, &report.result];
    type Row = (&'static str, fn(&Figures) -> String);
    let rows: [Row; 13] = [
        ("overlapping pairs", |f| f.overlaps.to_string()),
        ("  that share a node", |f| f.beside.to_string()),
        ("unconnected pairs", |f| f.unconnected.to_string()),
        ("  far from each other", |f| f.far.to_string()),
        ("barrier potential", |f| format!("{:.4e}", f.metrics.barrier)),
        ("shorter than 2 r", |f| percent(f.metrics.shorter_than_2.percent())),
        ("shorter than 2.5 r", |f| percent(f.metrics.shorter_than_2_5.percent())),
        ("shorter than 3 r", |f| percent(f.metrics.shorter_than_3.percent())),
        ("angles under pi/10", |f| percent(f.metrics.narrow.percent())),
        ("folds under 30 degrees", |f| percent(f.metrics.folds.percent())),
        ("equation 11 met", |f| percent(f.metrics.long_enough.percent())),
        ("equation 12 met", |f| percent(f.metrics.open_enough.percent())),
        ("inner branches cuttable", |f| percent(f.metrics.cuttable.percent())),
    ];
    for (name, value) in rows {
        let _ = write!(out, "{name:26}");
        for state in states {
            let _ = write!(out, "{:>12}", value(state));
        }
        out.push('\n');
    }
    if !report.worse.is_empty() {
        let _ = writeln!(out, "worse than after splitting: {}", report.worse.join(", "));
    }
    residual_text(report, &mut out);
    out
}

fn percent(value: f64) -> String {
    format!("{value:.3} %")
}

fn residual_text(report: &RefineReport, out: &mut String) {
    let r = &report.residual;
    if r.pairs.is_empty() {
        out.push_str("no vessels overlap\n");
        return;
    }
    let lost = if r.volume > 0.0 { 100.0 * r.volume_lost / r.volume } else { 0.0 };
    let _ = writeln!(
        out,
        "{} pairs overlapped when the nodes had come to rest; {} edges were shrunk ({lost:.4} % of the lumen); {} pairs \
         overlap still",
        r.pairs.len(),
        r.shrunk_edges,
        r.left
    );
    for pair in r.pairs.iter().take(LISTED) {
        let [[a, b], [c, d]] = pair.edges;
        let done = match pair.treatment {
            Treatment::Shrunk { kept } => format!("shrunk to {:.0} %", 100.0 * kept),
            Treatment::Fused => "to be meshed together".into(),
            Treatment::Left if pair.terminals_too_close => {
                "left: their terminals are too close to each other (--free-terminals lets them part)".into()
            }
            Treatment::Left => "left".into(),
        };
        let _ = writeln!(
            out,
            "  {a}-{b} and {c}-{d}: {:.4} apart, radii {:.4}: {done}",
            pair.distance, pair.radii
        );
    }
    if r.pairs.len() > LISTED {
        let _ = writeln!(out, "  and {} more (--json lists all)", r.pairs.len() - LISTED);
    }
}

/// The metrics over the iterations as a table.
fn csv(report: &RefineReport) -> String {
    let mut out = String::from(
        "iteration,displacement_mean,displacement_median,displacement_p95,displacement_p99,displacement_max,\
         barrier_potential,percent_shorter_than_2r,percent_shorter_than_2.5r,percent_shorter_than_3r,\
         percent_angles_under_pi/10,percent_folds,percent_equation_11,percent_equation_12,percent_cuttable\n",
    );
    for s in &report.history {
        let (d, m) = (&s.displacement, &s.metrics);
        let shares = [
            m.shorter_than_2,
            m.shorter_than_2_5,
            m.shorter_than_3,
            m.narrow,
            m.folds,
            m.long_enough,
            m.open_enough,
            m.cuttable,
        ];
        let _ = write!(out, "{},{},{},{},{},{},{}", s.iteration, d.mean, d.median, d.p95, d.p99, d.max, m.barrier);
        for share in shares {
            let _ = write!(out, ",{}", share.percent());
        }
        out.push('\n');
    }
    out
}

/// The four panels of the paper's Fig. 11.
fn panels(report: &RefineReport) -> Vec<Panel> {
    let line = |label: &str, value: fn(&Sample) -> f64| Series {
        label: label.into(),
        points: report.history.iter().map(|s| [s.iteration as f64, value(s)]).collect(),
    };
    let panel = |title: &str, vertical: &str, logarithmic: bool, series: Vec<Series>| Panel {
        title: title.into(),
        axes: ["iteration".into(), vertical.into()],
        logarithmic,
        series,
    };
    vec![
        panel(
            "A  Displacement of the nodes",
            "displacement (unit of the network)",
            false,
            vec![
                line("mean", |s| s.displacement.mean),
                line("median", |s| s.displacement.median),
                line("95 %", |s| s.displacement.p95),
                line("99 %", |s| s.displacement.p99),
                line("largest", |s| s.displacement.max),
            ],
        ),
        panel(
            "B  Barrier potential",
            "potential (no unit)",
            true,
            vec![line("all pairs", |s| s.metrics.barrier)],
        ),
        panel(
            "C  Short edges",
            "edges (%)",
            false,
            vec![
                line("shorter than 2.5 radii", |s| s.metrics.shorter_than_2_5.percent()),
                line("shorter than 3 radii", |s| s.metrics.shorter_than_3.percent()),
            ],
        ),
        panel(
            "D  Narrow angles",
            "pairs of edges at a node (%)",
            false,
            vec![line("under \u{3c0}/10", |s| s.metrics.narrow.percent())],
        ),
    ]
}

//! `anastomesh prepare`: repair of measured networks.

use std::path::PathBuf;

use serde::Serialize;

use super::common::{Common, ended};
use super::exit::{Exit, Failure};
use super::fidelity::conclude;
use super::log;
use super::network::NetworkArgs;
use super::numbers::fraction;
use crate::report::prepare::row_of;
use crate::report::verdict::Verdict;
use anastomesh_io::network::{NetworkArray, NetworkNote, ensure_tree_writable, write_tree};
use anastomesh_network::{PrepareParams, PrepareReport, Touching, directed};
use anastomesh_skeleton::NodeId;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    network: NetworkArgs,
    /// Output file: .vtp with the arrays `OriginalNode`, `Radius` and `EdgeRadius`, or .swc for a tree
    #[arg(short, long, value_name = "NETWORK", help_heading = "Output")]
    output: PathBuf,
    #[command(flatten)]
    cures: CureArgs,
    #[command(flatten)]
    common: Common,
}

/// Options of the preparation, shared by commands that read networks for meshing.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Preparation")]
pub struct CureArgs {
    /// Do not prepare the network
    #[arg(long, conflicts_with_all = ["drop_islands", "touching"])]
    as_is: bool,
    /// Keep outliers of the radius, and reject zero or missing radii
    #[arg(long)]
    keep_radii: bool,
    /// Keep duplicate lines
    #[arg(long)]
    keep_doubles: bool,
    /// Keep spurs
    #[arg(long)]
    keep_spurs: bool,
    /// Keep several bifurcations within one lumen, and loops between them
    #[arg(long)]
    keep_joints: bool,
    /// Keep the points (no resampling)
    #[arg(long)]
    keep_points: bool,
    /// Smooth noise of points closer than half a radius, within half of both tolerances
    #[arg(long, conflicts_with_all = ["as_is", "keep_points"])]
    smooth_noise: bool,
    /// Keep tips whose cap would lie in another vessel of their bifurcation
    #[arg(long)]
    keep_short_tips: bool,
    /// Treatment of tips that touch another vessel
    #[arg(long, value_enum, default_value_t = TouchingArg::Retract)]
    touching: TouchingArg,
    /// Remove components with fewer than N nodes
    #[arg(long, value_name = "N", default_value_t = 0)]
    drop_islands: usize,
    /// Tolerance of the axis when resampling, in radii
    #[arg(long, value_name = "R", default_value_t = PrepareParams::default().axis_tolerance, value_parser = fraction)]
    axis_tolerance: f64,
    /// Relative tolerance of the radius when resampling
    #[arg(long, value_name = "SHARE", default_value_t = PrepareParams::default().radius_tolerance, value_parser = fraction)]
    radius_tolerance: f64,
}

/// Treatment of tips that touch another vessel.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum TouchingArg {
    /// Connect them to the vessel
    Join,
    /// Shorten them until a cap fits
    Retract,
    /// Keep them
    Keep,
}

/// Output of `--json`.
#[derive(Serialize)]
struct Output<'a> {
    program: &'static str,
    notes: &'a [NetworkNote],
    parameters: &'a PrepareParams,
    report: &'a PrepareReport,
}

impl CureArgs {
    /// Parameters of the preparation. `only_measured` excludes grown networks from it.
    pub fn params(&self, only_measured: bool) -> PrepareParams {
        let mut params = if self.as_is { PrepareParams::as_is() } else { PrepareParams::default() };
        params.only_measured = only_measured;
        params.radii &= !self.keep_radii;
        params.merge &= !self.keep_doubles;
        params.spurs &= !self.keep_spurs;
        params.join &= !self.keep_joints;
        params.resample &= !self.keep_points;
        params.smooth |= self.smooth_noise;
        params.short_tips &= !self.keep_short_tips;
        params.touching = match self.touching {
            _ if self.as_is => Touching::Keep,
            TouchingArg::Join => Touching::Join,
            TouchingArg::Retract => Touching::Retract,
            TouchingArg::Keep => Touching::Keep,
        };
        params.drop_islands = self.drop_islands;
        params.axis_tolerance = self.axis_tolerance;
        params.radius_tolerance = self.radius_tolerance;
        params
    }
}

/// Prepares a network and writes it.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    ensure_tree_writable(&args.output).map_err(|e| Failure::input(e.to_string()))?;
    let params = args.cures.params(false);
    let pool = super::common::thread_pool(args.common.threads)?;
    let prepared = pool.install(|| args.network.prepared(&params))?;
    // SWC files need edges that lead away from the root.
    let network = directed(&prepared.skeleton);
    let originals = network.nodes.iter().map(|n| n.original).collect();
    write_tree(&args.output, &network, &[NetworkArray::NodeInts("OriginalNode", originals)])
        .map_err(|e| Failure::input(e.to_string()))?;
    if args.common.json {
        let program = concat!("anastomesh ", env!("CARGO_PKG_VERSION"));
        let output = Output { program, notes: &prepared.notes, parameters: &params, report: &prepared.report };
        super::common::print(true, &output, String::new)?;
    } else if !args.common.quiet {
        for note in &prepared.notes {
            log::note(&super::hint::of_note(note));
        }
        let cures = prepared.report.text(args.common.verbose, &|node| prepared.names.of(NodeId(node)));
        log::result(&format!("{cures}{}{}", row_of(&prepared.report), ended(&[&args.output]).rows(&[])));
    }
    let done = if prepared.report.changed() { "repaired" } else { "no repair needed" };
    Ok(conclude(&args.common, &Verdict::good(done)))
}

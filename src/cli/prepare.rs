//! `anastomesh prepare`: makes a measured network one graph of one line per vessel.

use std::path::PathBuf;

use serde::Serialize;

use super::common::{Common, ended};
use super::exit::{Exit, Failure};
use super::log;
use super::network::NetworkArgs;
use crate::report::prepare::row_of;
use anastomesh_io::network::{NetworkArray, NetworkNote, ensure_tree_writable, write_tree};
use anastomesh_network::{PrepareParams, PrepareReport, Touching, directed};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    network: NetworkArgs,
    /// Where the prepared network goes: .vtp, with the arrays `OriginalNode`, `Radius` and `EdgeRadius`, or .swc (a tree)
    #[arg(short, long, value_name = "NETWORK", help_heading = "Output")]
    output: PathBuf,
    #[command(flatten)]
    cures: CureArgs,
    #[command(flatten)]
    common: Common,
}

/// What is done to a network before it is used: arguments of every verb that does.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Preparation")]
pub struct CureArgs {
    /// No cure at all: the network as the file has it
    #[arg(long, conflicts_with_all = ["drop_islands", "touching"])]
    as_is: bool,
    /// Leave radii that are absurd, and refuse those that are zero or missing
    #[arg(long)]
    keep_radii: bool,
    /// Leave lines that run together
    #[arg(long)]
    keep_doubles: bool,
    /// Leave spurs
    #[arg(long)]
    keep_spurs: bool,
    /// Leave branch points beside each other in one lumen, and loops within it
    #[arg(long)]
    keep_joints: bool,
    /// Leave points as they are
    #[arg(long)]
    keep_points: bool,
    /// Even out the noise of points that are closer than half a radius, by half of the two tolerances
    #[arg(long, conflicts_with_all = ["as_is", "keep_points"])]
    smooth_noise: bool,
    /// Leave tips so close to their branch point that their cap lies in another vessel of it
    #[arg(long)]
    keep_short_tips: bool,
    /// What to do with tips that end in or on another vessel
    #[arg(long, value_enum, default_value_t = TouchingArg::Retract)]
    touching: TouchingArg,
    /// Drop components of fewer nodes than this
    #[arg(long, value_name = "N", default_value_t = 0)]
    drop_islands: usize,
    /// How far a resampled axis may be from the given one, in radii
    #[arg(long, value_name = "R", default_value_t = PrepareParams::default().axis_tolerance, value_parser = share)]
    axis_tolerance: f64,
    /// How much a resampled radius may differ from the given one, as a share of it
    #[arg(long, value_name = "SHARE", default_value_t = PrepareParams::default().radius_tolerance, value_parser = share)]
    radius_tolerance: f64,
}

/// What to do with tips that end in or on another vessel.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum TouchingArg {
    /// Join them to it
    Join,
    /// Draw them back until a cap has room
    Retract,
    /// Leave them
    Keep,
}

fn share(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|e| format!("{e}"))?;
    if (0.0..1.0).contains(&value) { Ok(value) } else { Err("from 0 to below 1".into()) }
}

/// What `--json` prints.
#[derive(Serialize)]
struct Output<'a> {
    program: &'static str,
    notes: &'a [NetworkNote],
    parameters: &'a PrepareParams,
    report: &'a PrepareReport,
}

impl CureArgs {
    /// The cures, with `only_measured` but for grown networks.
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
    // Only a tree whose edges lead away from its root can be written as SWC.
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
        let cures = prepared.report.text(args.common.verbose);
        log::result(&format!("{cures}{}{}", row_of(&prepared.report), ended(&[&args.output]).rows(&[])));
    }
    Ok(Exit::Fine)
}

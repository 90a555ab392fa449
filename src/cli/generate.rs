//! `anastomesh generate`: growth of a vessel network in an organ.

use std::fmt::Write as _;
use std::path::PathBuf;

use serde::Serialize;

use super::common::{Common, ended, print, thread_pool};
use super::exit::{Exit, Failure};
use super::log;
use crate::report::rows::row;
use anastomesh_io::network::{NetworkArray, ensure_network_writable, ensure_tree_writable, write_network, write_tree};
use anastomesh_mesh::units::{counted, grouped};
use anastomesh_network::{BedParams, GenerateParams, Looped, Morphometry, Organ, RAT_KIDNEY, generate, looped};

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Number of terminals (outlets); a rat kidney has 29566
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    terminals: u32,
    /// Shape to fill with vessels
    #[arg(long, value_enum, default_value_t = OrganArg::Kidney)]
    organ: OrganArg,
    /// Seed of the random numbers; equal seeds give equal networks
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
    /// Mean radius of the terminals, in um (default: 10.08, as in a rat kidney; 4 with capillaries)
    #[arg(long, value_name = "R", allow_negative_numbers = true)]
    terminal_radius: Option<f64>,
    /// Exponent p of Murray's law r0^p = r1^p + r2^p (default: 3.2 for the kidney, as measured; 3 for the ellipsoid)
    #[arg(long, value_name = "P", allow_negative_numbers = true)]
    exponent: Option<f64>,
    /// Longest extent of the organ, in um (default: terminal density of a rat kidney)
    #[arg(long, value_name = "L", allow_negative_numbers = true)]
    size: Option<f64>,
    /// Also grow veins and a capillary bed with loops, about 38 vessels per terminal. Needs --organ ellipsoid
    #[arg(long)]
    capillaries: bool,
    /// Mean radius of the capillaries, in um; the default was measured in mouse cortex
    #[arg(long, value_name = "R", requires = "capillaries", default_value_t = BedParams::default().radius, allow_negative_numbers = true)]
    capillary_radius: f64,
    /// Mean length of the capillaries, in um; the default is an assumption, not a measurement
    #[arg(long, value_name = "L", requires = "capillaries", default_value_t = BedParams::default().length, allow_negative_numbers = true)]
    capillary_length: f64,
    /// Output file, in um: .vtp, or .swc (node radii only)
    #[arg(short, long, value_name = "NETWORK")]
    output: PathBuf,
    #[command(flatten)]
    common: Common,
}

/// Shapes to fill.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum OrganArg {
    /// Rat kidney: dense cortex, thin medulla, a hilum where the artery enters
    Kidney,
    /// Uniform density
    Ellipsoid,
}

/// Report of the growth.
#[derive(Serialize)]
struct Grown<'a> {
    program: &'static str,
    parameters: &'a GenerateParams,
    /// Longest extent of the organ, um.
    size: f64,
    nodes: usize,
    edges: usize,
    root_radius: f64,
    morphometry: &'a Morphometry,
}

impl Args {
    fn params(&self) -> GenerateParams {
        let organ = match self.organ {
            OrganArg::Kidney => Organ::Kidney,
            OrganArg::Ellipsoid => Organ::Ellipsoid,
        };
        let usual = GenerateParams::new(organ, self.terminals);
        let terminal_radius = if self.capillaries { ARTERIOLE } else { usual.terminal_radius };
        let exponent = self.exponent.unwrap_or(usual.exponent);
        usual
            .seed(self.seed)
            .terminal_radius(self.terminal_radius.unwrap_or(terminal_radius))
            .exponent(exponent)
            .size(self.size)
    }
}

/// Radius of the thinnest arteries and veins beside capillaries, um.
const ARTERIOLE: f64 = 4.0;

/// Report of a growth with capillaries.
#[derive(Serialize)]
struct GrownLooped<'a> {
    program: &'static str,
    parameters: &'a GenerateParams,
    capillaries: &'a BedParams,
    nodes: usize,
    edges: usize,
    joined: usize,
    open: usize,
}

/// Grows arteries, veins and capillaries, and writes them.
fn run_looped(args: &Args) -> Result<Exit, Failure> {
    ensure_network_writable(&args.output).map_err(|e| Failure::input(e.to_string()))?;
    let (params, bed) = (args.params(), BedParams { radius: args.capillary_radius, length: args.capillary_length });
    let pool = thread_pool(args.common.threads)?;
    let Looped { skeleton, kind, joined, open } =
        pool.install(|| looped(&params, &bed)).map_err(|e| Failure::usage(e.to_string()))?;
    let (nodes, edges) = (skeleton.nodes.len(), skeleton.edges.len());
    write_network(&args.output, &skeleton, &[NetworkArray::NodeInts("Kind", kind)])
        .map_err(|e| Failure::input(e.to_string()))?;
    let program = concat!("anastomesh ", env!("CARGO_PKG_VERSION"));
    if args.common.json {
        let grown = GrownLooped { program, parameters: &params, capillaries: &bed, nodes, edges, joined, open };
        print(true, &grown, String::new)?;
    } else if !args.common.quiet {
        let network = row("network", &format!("{}, {}", counted(nodes, "node"), counted(edges, "edge")));
        let (joined, open) = (counted(joined, "artery or vein end"), grouped(open));
        let ends = row("ends", &format!("{joined} connected to capillaries, {open} open"));
        log::result(&format!("{network}{ends}{}", ended(&[&args.output]).rows(&[])));
    }
    Ok(Exit::Fine)
}

/// Grows a network and writes it.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    if args.capillaries {
        return run_looped(args);
    }
    ensure_tree_writable(&args.output).map_err(|e| Failure::input(e.to_string()))?;
    let params = args.params();
    let pool = thread_pool(args.common.threads)?;
    let network = pool.install(|| generate(&params)).map_err(|e| Failure::usage(e.to_string()))?;
    write_tree(&args.output, &network, &[]).map_err(|e| Failure::input(e.to_string()))?;
    if args.common.quiet && !args.common.json {
        return Ok(Exit::Fine);
    }
    let morphometry = Morphometry::of(&network);
    let grown = Grown {
        program: concat!("anastomesh ", env!("CARGO_PKG_VERSION")),
        parameters: &params,
        size: params.resolved_size(),
        nodes: network.nodes.len(),
        edges: network.edges.len(),
        root_radius: network.nodes.first().map_or(0.0, |root| root.radius),
        morphometry: &morphometry,
    };
    if args.common.json {
        print(true, &grown, String::new)?;
    } else {
        log::result(&format!("{}{}", text(&grown), ended(&[&args.output]).rows(&[])));
    }
    Ok(Exit::Fine)
}

/// Text report: sizes, and vessel orders compared with a rat kidney.
fn text(grown: &Grown) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let terminals = grown.parameters.terminals as usize;
    let sizes = [(grown.nodes, "node"), (grown.edges, "edge"), (terminals, "terminal")];
    let sizes = sizes.map(|(count, what)| counted(count, what)).join(", ");
    let (radius, size) = (grown.root_radius, grouped(grown.size.round() as usize));
    out += &row("network", &format!("{sizes}; root radius {radius:.1} µm, organ length {size} µm"));
    let _ = writeln!(
        out,
        "order    vessels         radius/µm         length/µm   (mean +- standard deviation; below: measured in rats)"
    );
    for (order, figures) in grown.morphometry.orders.iter().enumerate() {
        let f = figures;
        let _ = writeln!(
            out,
            "{order:>5}{:>11}{:>10.1} +-{:>5.1}{:>10.0} +-{:>5.0}",
            f.count, f.radius, f.radius_deviation, f.length, f.length_deviation
        );
        if let Some(p) = RAT_KIDNEY.get(order) {
            let [[n, dn], [r, dr], [l, dl]] = [p.count, p.radius, p.length];
            let _ = writeln!(out, "{:>16}{r:>10.1} +-{dr:>5.1}{l:>10.0} +-{dl:>5.0}", format!("({n:.0} +-{dn:.0})"));
        }
    }
    out
}

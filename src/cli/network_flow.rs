//! `anastomesh flow`: one-dimensional flow through a network, and reduced-order models of it.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use serde::Serialize;

use super::common::{Common, ended, print, thread_pool};
use super::exit::{Exit, Failure};
use super::flow::FlowArgs;
use super::hint;
use super::log;
use super::network::NetworkArgs;
use super::prepare::CureArgs;
use super::progress::Bars;
use super::refine::RefineArgs;
use super::run::{failure, remarks};
use super::stop::{NOTHING_KEPT, Stop};
use crate::report::flow::{FlowSummary, ResultSummary, arrays, result_arrays, result_table, table};
use crate::report::inlets;
use crate::report::rows::Ended;
use crate::run::{MeshingError, PreparedRun, Run};
use anastomesh_flow::{Along, ModelOptions, ResultFluid, Supply, VesselFlow, reduced_model};
use anastomesh_flow::{FlowError, FlowPlan, FlowSolution, InletSite};
use anastomesh_io::network::{
    NodeNames, Stiffness, ensure_network_writable, ensure_reduced_writable, write_network, write_reduced,
};
use anastomesh_io::results::read_result;
use anastomesh_io::{ensure_text_writable, write_text};
use anastomesh_mesh::progress::Progress;
use anastomesh_network::flow::NetworkFlow;
use anastomesh_skeleton::{NodeId, Skeleton};

#[derive(Debug, clap::Args)]
pub struct Args {
    #[command(flatten)]
    network: NetworkArgs,
    /// Output file: .json (model for `svZeroDSolver`), .in (model for `svOneDSolver`), .vtp (network with the arrays `Pressure`,
    /// `Flow` and `WallShear`) or .csv (table of vessels)
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: PathBuf,
    /// Result of a solver on the mesh of this network: an `OpenFOAM` case (.foam) or a file of `svMultiPhysics` (.vtu). Its
    /// pressure, flow and wall shear along the vessels are written beside the one-dimensional solution, as .vtp or .csv
    #[arg(long, value_name = "RESULT", help_heading = "Output")]
    result: Option<PathBuf>,
    /// Vessels of models and tables
    #[arg(long, value_enum, default_value_t = VesselsArg::Edges, help_heading = "Output")]
    vessels: VesselsArg,
    /// Stiffness E h / r of vessel walls (Young's modulus, wall thickness, radius): a constant K3, or K1,K2,K3 for
    /// K1 exp(K2 r) + K3. Units are consistent with the mesh (default: 2e6,-2253,8.65e4, arteries in SI units). Steady models
    /// without this option have rigid vessels
    #[arg(long, value_name = "K3|K1,K2,K3", help_heading = "Output", allow_hyphen_values = true)]
    stiffness: Option<StiffnessArg>,
    /// Inlet node, by its name or number in the file; repeatable (default: the roots of the file, or else the widest
    /// terminal of each component)
    #[arg(long, help_heading = "Run", value_name = "NODE")]
    root: Vec<String>,
    /// Move overlapping vessels apart first, in at most N iterations, unless `mesh` first tries the network as it is. The
    /// network of a mesh is written by `mesh --refined`
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "200", help_heading = "Run")]
    refine: Option<usize>,
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
enum VesselsArg {
    /// Each edge of the network is a vessel
    Edges,
    /// Each branch between bifurcations is a vessel
    Branches,
}

/// Value of `--stiffness`.
#[derive(Clone, Copy, Debug, PartialEq)]
struct StiffnessArg(Stiffness);

impl FromStr for StiffnessArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let expected = || "expected a number above zero, or three numbers with commas".to_owned();
        let numbers: Result<Vec<f64>, _> = text.split(',').map(|word| word.trim().parse::<f64>()).collect();
        let k = match numbers.map_err(|_| expected())?[..] {
            [k3] => [0.0, 0.0, k3],
            [k1, k2, k3] => [k1, k2, k3],
            _ => return Err(expected()),
        };
        let is_sound = k.iter().all(|number| number.is_finite()) && k[0] >= 0.0 && k[2] >= 0.0 && k[0] + k[2] > 0.0;
        if is_sound { Ok(Self(Stiffness { k })) } else { Err(expected()) }
    }
}

/// Kind of output, by its extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Model,
    Network,
    Table,
}

/// Figures of a run.
#[derive(Serialize)]
#[serde(untagged)]
enum Found {
    Flow(FlowSummary),
    Result(ResultSummary),
}

impl Found {
    fn text(&self, ended: &Ended) -> String {
        match self {
            Self::Flow(summary) => summary.text(ended),
            Self::Result(summary) => summary.text(ended),
        }
    }
}

/// Output of `--json`.
#[derive(Serialize)]
struct Output<'a> {
    program: &'static str,
    #[serde(flatten)]
    found: &'a Found,
}

/// Solves for the flow through a network and writes it, or a model of it.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let kind = args.kind()?;
    let plan = args.flow.plan()?;
    let pool = thread_pool(args.common.threads)?;
    let stop = Stop::listen(args.common.quiet)?;
    let bars = Bars::new(args.common.quiet, args.common.progress, stop.clone());
    let prepared = pool.install(|| args.prepared(&plan, &bars))?;
    let found = pool.install(|| match &args.result {
        Some(result) => args.write_result(kind, &plan, &prepared, result, &stop).map(Found::Result),
        None => args.write(kind, &plan, &prepared, &stop).map(Found::Flow),
    })?;
    if args.common.json {
        let program = concat!("anastomesh ", env!("CARGO_PKG_VERSION"));
        print(true, &Output { program, found: &found }, String::new)?;
    } else if !args.common.quiet {
        log::result(&found.text(&ended(&[&args.output])));
    }
    Ok(Exit::Fine)
}

impl Args {
    /// Kind of the output; checks that it can be written.
    fn kind(&self) -> Result<Kind, Failure> {
        let path = &self.output;
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        let checked = |kind, check: Result<(), String>| check.map(|()| kind).map_err(Failure::input);
        match extension.as_str() {
            "json" | "in" if self.result.is_some() => {
                Err(Failure::usage("--result is written as a network or a table: name a .vtp or .csv file"))
            }
            "json" | "in" => checked(Kind::Model, ensure_reduced_writable(path).map_err(|e| e.to_string())),
            "vtp" => checked(Kind::Network, ensure_network_writable(path).map_err(|e| e.to_string())),
            "csv" => ensure_text_writable(path).map(|()| Kind::Table).map_err(|e| Failure::unwritable(path, &e)),
            _ => Err(Failure::usage(format!(
                "{}: unrecognised extension; name a .json, .in, .vtp or .csv file",
                path.display()
            ))),
        }
    }

    /// Reads and prepares the network as `mesh` does.
    fn prepared(&self, plan: &FlowPlan, bars: &Bars) -> Result<PreparedRun, Failure> {
        let cures = self.cures.params(true);
        let file = self.network.file(cures.radii)?;
        let [inlets, outlets] = self.flow.extension();
        let mut run = Run::new(file).prepare(cures).roots(&self.root).extend(inlets, outlets).flow(plan.clone());
        if let Some(iterations) = self.refine {
            run = run.refine(self.how.params(iterations));
        }
        let prepared = run.prepared().map_err(|e| self.explain(e))?;
        let PreparedRun { notes, networks, inlets, cut_short, .. } = &prepared;
        let read = remarks(notes, &networks.prepare, &networks.names, self.common.verbose);
        for remark in
            read.into_iter().chain(inlets::remarks(inlets)).chain(FlowArgs::remark(cut_short, &networks.names))
        {
            bars.note(&remark);
        }
        prepared.refined(None, bars).map_err(|e| self.explain(e))
    }

    fn explain(&self, error: MeshingError) -> Failure {
        failure(error, &self.network.network, || Failure::stopped(NOTHING_KEPT))
    }

    fn write(&self, kind: Kind, plan: &FlowPlan, prepared: &PreparedRun, stop: &Stop) -> Result<FlowSummary, Failure> {
        let network: &Skeleton = &prepared.networks.network;
        let viscosity = plan.viscosity;
        let (solved, supply) = Self::solved(plan, prepared)?;
        let flow = VesselFlow::of(network, &solved, viscosity);
        let lumped = self.vessels == VesselsArg::Branches;
        stop.keep();
        let vessels = match kind {
            Kind::Model => {
                let model = reduced_model(network, &solved, &supply, &self.model_options(plan, &supply));
                let model = model.map_err(|e| Failure::input(format!("{}: {e}", self.network.network.display())))?;
                write_reduced(&self.output, &model).map_err(|e| Failure::input(e.to_string()))?;
                model.vessels.len()
            }
            Kind::Network => {
                let written = write_network(&self.output, network, &arrays(&flow));
                written.map_err(|e| Failure::input(e.to_string()))?;
                network.edges.len()
            }
            Kind::Table => {
                let rows = flow.rows(network, viscosity, lumped);
                self.write_table(&rows, &prepared.networks.names)?;
                rows.len()
            }
        };
        let largest = |values: &[f64]| values.iter().fold(0.0, |most: f64, value| most.max(*value));
        Ok(FlowSummary {
            vessels,
            inlets: supply.rates.len(),
            outlets: solved.of_terminal.len() - supply.rates.len(),
            inflow: supply.rates.values().sum(),
            largest_pressure: largest(&flow.pressure),
            largest_shear: largest(&flow.shear),
        })
    }

    /// Writes a result along the vessels.
    fn write_result(
        &self,
        kind: Kind,
        plan: &FlowPlan,
        prepared: &PreparedRun,
        path: &Path,
        stop: &Stop,
    ) -> Result<ResultSummary, Failure> {
        let network: &Skeleton = &prepared.networks.network;
        let result = read_result(path).map_err(|e| Failure::input(e.to_string()))?;
        let fluid = ResultFluid { density: plan.density, viscosity: plan.viscosity };
        let inlets: BTreeSet<NodeId> = prepared.inlets.sites(network).iter().map(|inlet| inlet.node).collect();
        let along = Along::of(network, &inlets, &result, fluid);
        let along = along.map_err(|e| Failure::input(format!("{}: {e}", path.display())))?;
        stop.keep();
        if kind == Kind::Network {
            let written = write_network(&self.output, network, &result_arrays(&along));
            written.map_err(|e| Failure::input(e.to_string()))?;
        } else {
            let failed = |why: &dyn std::fmt::Display| Failure::unwritable(&self.output, why);
            let text = result_table(&along, network, &prepared.networks.names).map_err(|e| failed(&e))?;
            write_text(&self.output, &text).map_err(|e| failed(&e))?;
        }
        Ok(ResultSummary::of(&along, &result.name, result.cells.len()))
    }

    fn write_table(&self, rows: &[anastomesh_flow::VesselRow], names: &NodeNames) -> Result<(), Failure> {
        let failed = |why: &dyn std::fmt::Display| Failure::unwritable(&self.output, why);
        let text = table(rows, names).map_err(|e| failed(&e))?;
        write_text(&self.output, &text).map_err(|e| failed(&e))
    }

    /// Solves for the flow with the conditions of the options.
    fn solved(flow: &FlowPlan, prepared: &PreparedRun) -> Result<(NetworkFlow, Supply), Failure> {
        let network = &prepared.networks.network;
        let inlets = prepared.inlets.sites(network);
        let names = &prepared.networks.names;
        let solved = flow.solve(network, &inlets, &|node| names.of(NodeId(node)));
        let FlowSolution { flow, outlets, waveforms } = solved.map_err(|e| match e {
            FlowError::NotConverged(_) => Failure::stage(e.to_string()),
            e => Failure::input(hint::of_flow(&e)),
        })?;
        let rate = |inlet: &InletSite| Some((inlet.node, *flow.of_terminal.get(&inlet.node)?));
        let rates = inlets.iter().filter_map(rate).collect();
        Ok((flow, Supply { rates, waveforms, outlets }))
    }

    fn model_options(&self, flow: &FlowPlan, supply: &Supply) -> ModelOptions {
        let stiffness = self.stiffness.map_or_else(Stiffness::default, |StiffnessArg(stiffness)| stiffness);
        ModelOptions::new(flow.density, flow.viscosity)
            .stiffness(stiffness)
            .elastic(self.stiffness.is_some() || !supply.waveforms.is_empty())
            .lumped(self.vessels == VesselsArg::Branches)
            .periods(if supply.waveforms.is_empty() { 0 } else { flow.periods })
    }
}

//! Flow options, for the patch table and solver cases.

use super::exit::Failure;
use super::numbers::{above_zero, fraction, number};
use anastomesh_flow::{FlowPlan, Inflow, OutletKind, OutletPlan, OutletSplit, Outlets, Reference};
use anastomesh_io::flow::{FlowTable, Profile, StructuredTree};
use anastomesh_io::network::NodeNames;
use anastomesh_mesh::units::counted;
use anastomesh_skeleton::NodeId;
use std::path::PathBuf;
use std::str::FromStr;

/// Maximum number of listed terminals.
const LISTED: usize = 10;

/// Flow and outlets.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Flow")]
pub struct FlowArgs {
    /// Grouping of outlets into patches: separate patches, one patch (`outlets`), or one patch per diameter-defined
    /// Strahler order (`outlets_order_1`, …). `MESH_patches.csv` always lists every outlet
    #[arg(long, value_enum, default_value_t = OutletArg::Separate)]
    outlets: OutletArg,
    /// Extend each outlet by this many radii, less if another vessel is in the way
    #[arg(long, value_name = "RADII", value_parser = above_zero, allow_negative_numbers = true)]
    extend_outlets: Option<f64>,
    /// Extend each inlet by this many radii, less if another vessel is in the way
    #[arg(long, value_name = "RADII", value_parser = above_zero, allow_negative_numbers = true)]
    extend_inlets: Option<f64>,
    /// Flow rate into each inlet, in the mesh's unit of length cubed per second (default: Reynolds number 1). A file is a
    /// CSV table of one period: time in seconds, then a column for all inlets, or one per patch or node
    #[arg(long, value_name = "RATE|FILE.csv", allow_negative_numbers = true)]
    inflow: Option<InflowArg>,
    /// Velocity profile on inlets (default: that of the solver for a flow rate, parabolic in svMultiPhysics and uniform in
    /// `OpenFOAM`)
    #[arg(long, value_enum)]
    inlet_profile: Option<ProfileArg>,
    /// Number of periods of pulsatile flow
    #[arg(long, value_name = "N", default_value_t = FlowPlan::default().periods, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    periods: u32,
    /// Number of results per period of pulsatile flow
    #[arg(long, value_name = "N", default_value_t = FlowPlan::default().outputs, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    outputs: u32,
    /// Duration of the start from rest to pulsatile flow (default: a tenth of a period)
    #[arg(long, value_name = "SECONDS", value_parser = number, allow_negative_numbers = true)]
    ramp: Option<f64>,
    /// Model beyond each outlet. The resistances of `resistance` and `rcr` need `--total-resistance` or `--mean-pressure`
    #[arg(long, value_enum, default_value_t = ModelArg::Pressure)]
    outlet_model: ModelArg,
    /// Pressure beyond the outlets, in units consistent with density and viscosity
    #[arg(long, value_name = "P", default_value_t = 0.0, value_parser = number, allow_negative_numbers = true)]
    outlet_pressure: f64,
    /// Resistance of all outlets in parallel, pressure per flow rate
    #[arg(long, value_name = "R", value_parser = above_zero, allow_negative_numbers = true, conflicts_with = "mean_pressure")]
    total_resistance: Option<f64>,
    /// Pressure at the inlets at mean flow; resistances take what the network leaves of it
    #[arg(long, value_name = "P", value_parser = number, allow_negative_numbers = true)]
    mean_pressure: Option<f64>,
    /// Distribution of the resistance over the outlets (default: network). `network` keeps the flow rates of the
    /// one-dimensional solution, `murray` is inverse to a power of the radius
    #[arg(long, value_enum)]
    outlet_split: Option<SplitArg>,
    /// Exponent of the radius for `--outlet-split murray` (default: 3)
    #[arg(long, value_name = "M", value_parser = above_zero, allow_negative_numbers = true)]
    murray_exponent: Option<f64>,
    /// Time constant of `rcr`: distal resistance times capacitance
    #[arg(long, value_name = "SECONDS", value_parser = above_zero, allow_negative_numbers = true)]
    outlet_time_constant: Option<f64>,
    /// Proximal part of the resistance of `rcr` (default: 0.09)
    #[arg(long, value_name = "PART", value_parser = fraction, allow_negative_numbers = true)]
    proximal_fraction: Option<f64>,
    /// Radius at which the vessels of `structured-tree` end
    #[arg(long, value_name = "R", value_parser = above_zero, allow_negative_numbers = true)]
    tree_minimum_radius: Option<f64>,
    /// Stiffness E h / r of the vessels of `structured-tree`, as a pressure; outlets are then RCR models (default: rigid)
    #[arg(long, value_name = "P", value_parser = above_zero, allow_negative_numbers = true)]
    tree_stiffness: Option<f64>,
    /// Dynamic viscosity in units consistent with the mesh (default: blood, for a mesh in metres)
    #[arg(long, value_name = "MU", default_value_t = anastomesh_io::flow::BLOOD_VISCOSITY, value_parser = above_zero, allow_negative_numbers = true)]
    viscosity: f64,
    /// Density in units consistent with the mesh (default: blood, for a mesh in metres)
    #[arg(long, value_name = "RHO", default_value_t = anastomesh_io::flow::BLOOD_DENSITY, value_parser = above_zero, allow_negative_numbers = true)]
    density: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum OutletArg {
    Separate,
    Grouped,
    ByOrder,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum ProfileArg {
    Uniform,
    Parabolic,
    Womersley,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum ModelArg {
    /// Given pressure
    Pressure,
    /// Pressure proportional to the flow rate
    Resistance,
    /// Three-element windkessel: resistance, capacitance, resistance
    Rcr,
    /// Olufsen's tree of small vessels
    StructuredTree,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum SplitArg {
    Network,
    Murray,
}

/// Value of `--inflow`.
#[derive(Clone, Debug, PartialEq)]
enum InflowArg {
    Rate(f64),
    Table(PathBuf),
}

impl FromStr for InflowArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match number(text) {
            Ok(_) => above_zero(text).map(Self::Rate),
            Err(_) => Ok(Self::Table(text.into())),
        }
    }
}

impl FlowArgs {
    /// Flow of these options; reads the table of flow rates.
    pub fn plan(&self) -> Result<FlowPlan, Failure> {
        self.ensure_consistent()?;
        let inflow = match &self.inflow {
            None => Inflow::Usual,
            Some(InflowArg::Rate(rate)) => Inflow::Rate(*rate),
            Some(InflowArg::Table(path)) => {
                Inflow::Table(FlowTable::read(path).map_err(|e| Failure::input(format!("--inflow {e}")))?)
            }
        };
        let profile = match self.inlet_profile {
            None => Profile::Solver,
            Some(ProfileArg::Uniform) => Profile::Uniform,
            Some(ProfileArg::Parabolic) => Profile::Parabolic,
            Some(ProfileArg::Womersley) => Profile::Womersley,
        };
        let plan = FlowPlan::default().density(self.density).viscosity(self.viscosity).inflow(inflow).profile(profile);
        let plan = plan.outlets(self.outlet_plan()?).periods(self.periods).outputs(self.outputs).ramp(self.ramp);
        Ok(plan)
    }

    fn outlet_plan(&self) -> Result<OutletPlan, Failure> {
        let needs = |option: &str| Failure::usage(format!("--outlet-model {} needs {option}", self.model()));
        let kind = match self.outlet_model {
            ModelArg::Pressure => OutletKind::Pressure,
            ModelArg::Resistance => OutletKind::Resistance,
            ModelArg::Rcr => OutletKind::Rcr {
                time_constant: self.outlet_time_constant.ok_or_else(|| needs("--outlet-time-constant SECONDS"))?,
                proximal_fraction: self.proximal_fraction.unwrap_or(OutletKind::PROXIMAL_FRACTION),
            },
            ModelArg::StructuredTree => {
                let radius = self.tree_minimum_radius.ok_or_else(|| needs("--tree-minimum-radius R"))?;
                OutletKind::StructuredTree(StructuredTree::new(radius).stiffness(self.tree_stiffness))
            }
        };
        let total = self.total_resistance.map(Reference::TotalResistance);
        let exponent = self.murray_exponent.unwrap_or(3.0);
        let split = match self.outlet_split {
            Some(SplitArg::Murray) => OutletSplit::Murray { exponent },
            _ => OutletSplit::Network,
        };
        let reference = total.or(self.mean_pressure.map(Reference::MeanPressure));
        Ok(OutletPlan::default().kind(kind).distal_pressure(self.outlet_pressure).reference(reference).split(split))
    }

    fn model(&self) -> &'static str {
        match self.outlet_model {
            ModelArg::Pressure => "pressure",
            ModelArg::Resistance => "resistance",
            ModelArg::Rcr => "rcr",
            ModelArg::StructuredTree => "structured-tree",
        }
    }

    /// Checks that no option is without effect.
    fn ensure_consistent(&self) -> Result<(), Failure> {
        let model = self.outlet_model;
        let splits = matches!(model, ModelArg::Resistance | ModelArg::Rcr);
        let (rcr, tree) = (model == ModelArg::Rcr, model == ModelArg::StructuredTree);
        let murray = self.outlet_split == Some(SplitArg::Murray);
        let pulsatile = matches!(self.inflow, Some(InflowArg::Table(_)));
        let time = FlowPlan::default();
        let [resistances, windkessel, trees, radii, table] = [
            "--outlet-model resistance or rcr",
            "--outlet-model rcr",
            "--outlet-model structured-tree",
            "--outlet-split murray",
            "pulsatile flow: --inflow FILE.csv",
        ];
        let rules = [
            ("--total-resistance", self.total_resistance.is_some(), splits, resistances),
            ("--mean-pressure", self.mean_pressure.is_some(), splits, resistances),
            ("--outlet-split", self.outlet_split.is_some(), splits, resistances),
            ("--murray-exponent", self.murray_exponent.is_some(), murray, radii),
            ("--outlet-time-constant", self.outlet_time_constant.is_some(), rcr, windkessel),
            ("--proximal-fraction", self.proximal_fraction.is_some(), rcr, windkessel),
            ("--tree-minimum-radius", self.tree_minimum_radius.is_some(), tree, trees),
            ("--tree-stiffness", self.tree_stiffness.is_some(), tree, trees),
            ("--periods", self.periods != time.periods, pulsatile, table),
            ("--outputs", self.outputs != time.outputs, pulsatile, table),
            ("--ramp", self.ramp.is_some(), pulsatile, table),
        ];
        match rules.iter().find(|(_, is_given, has_effect, _)| *is_given && !has_effect) {
            Some((option, .., needed)) => Err(Failure::usage(format!("{option} has an effect only with {needed}"))),
            None => Ok(()),
        }
    }

    /// Lengths by which inlets and outlets are extended, in their radii.
    pub fn extension(&self) -> [f64; 2] {
        [self.extend_inlets, self.extend_outlets].map(Option::unwrap_or_default)
    }

    /// Note on terminals that were extended by less than requested.
    pub fn remark(cut_short: &[(u32, f64)], names: &NodeNames) -> Option<String> {
        let named = |&(node, radii): &(u32, f64)| format!("node {} by {radii} radii", names.of(NodeId(node)));
        let first: Vec<String> = cut_short.iter().take(LISTED).map(named).collect();
        let more = if cut_short.len() > LISTED { ", …" } else { "" };
        let (count, list) = (cut_short.len(), first.join(", "));
        (count > 0).then(|| {
            format!("{} extended by less, as another vessel is in the way: {list}{more}", counted(count, "terminal"))
        })
    }

    pub fn outlets(&self) -> Outlets {
        match self.outlets {
            OutletArg::Separate => Outlets::Separate,
            OutletArg::Grouped => Outlets::Grouped,
            OutletArg::ByOrder => Outlets::ByOrder,
        }
    }
}

//! What flows through a mesh, for what is written beside it and for cases of solvers.

use crate::pipeline::{Fluid, Outlets};
use anastomesh_io::network::NodeNames;
use anastomesh_skeleton::NodeId;

/// Terminals that are named at most.
const LISTED: usize = 10;

/// Flow and outlets.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Flow")]
pub struct FlowArgs {
    /// Which outlets share a patch: separate, none; grouped, all (`outlets`); by-order, those whose vessels have the same
    /// diameter-defined Strahler order (`outlets_order_1`, …). `MESH_patches.csv` names every one of them in any case
    #[arg(long, value_enum, default_value_t = OutletArg::Separate)]
    outlets: OutletArg,
    /// Go on straight from each outlet by so many of its radii; less where another vessel is in the way, which is said
    #[arg(long, value_name = "RADII", value_parser = above_zero, allow_negative_numbers = true)]
    extend_outlets: Option<f64>,
    /// The same of each inlet
    #[arg(long, value_name = "RADII", value_parser = above_zero, allow_negative_numbers = true)]
    extend_inlets: Option<f64>,
    /// Volume per time into each inlet, in the mesh's unit of length: for the one-dimensional flow in `MESH_patches.csv` and for
    /// cases of solvers (default: what has a Reynolds number of 1 there)
    #[arg(long, value_name = "FLOW", value_parser = above_zero, allow_negative_numbers = true)]
    inflow: Option<f64>,
    /// Dynamic viscosity, in units that fit the mesh's: as it stands that of blood, when the mesh is in metres (--units)
    #[arg(long, value_name = "MU", default_value_t = anastomesh_io::volume::BLOOD_VISCOSITY, value_parser = above_zero, allow_negative_numbers = true)]
    viscosity: f64,
    /// Mass per volume, in units that fit the mesh's: as it stands that of blood, when the mesh is in metres (--units)
    #[arg(long, value_name = "RHO", default_value_t = anastomesh_io::volume::BLOOD_DENSITY, value_parser = above_zero, allow_negative_numbers = true)]
    density: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum OutletArg {
    Separate,
    Grouped,
    ByOrder,
}

fn above_zero(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|e| format!("{e}"))?;
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err("a finite number above zero".into()) }
}

impl FlowArgs {
    pub fn fluid(&self) -> Fluid {
        Fluid { density: self.density, viscosity: self.viscosity, inflow: self.inflow }
    }

    /// Lengths by which inlets and outlets are extended, in their radii.
    pub fn extension(&self) -> [f64; 2] {
        [self.extend_inlets, self.extend_outlets].map(Option::unwrap_or_default)
    }

    /// Says which terminals were extended by less than asked for.
    pub fn remark(cut_short: &[(u32, f64)], names: &NodeNames) -> Option<String> {
        let named = |&(node, radii): &(u32, f64)| format!("node {} by {radii} radii", names.of(NodeId(node)));
        let first: Vec<String> = cut_short.iter().take(LISTED).map(named).collect();
        let more = if cut_short.len() > LISTED { ", …" } else { "" };
        let (count, list) = (cut_short.len(), first.join(", "));
        (count > 0)
            .then(|| format!("{count} terminals extended by less, as another vessel is in the way: {list}{more}"))
    }

    pub fn outlets(&self) -> Outlets {
        match self.outlets {
            OutletArg::Separate => Outlets::Separate,
            OutletArg::Grouped => Outlets::Grouped,
            OutletArg::ByOrder => Outlets::ByOrder,
        }
    }
}

//! What flows through a mesh, for what is written beside it and for cases of solvers.

use crate::pipeline::{Fluid, Outlets};

/// Flow and outlets.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Flow")]
pub struct FlowArgs {
    /// Which outlets share a patch: separate, none; grouped, all (`outlets`); by-order, those whose vessels have the same
    /// diameter-defined Strahler order (`outlets_order_1`, …). MESH_patches.csv names every one of them in any case
    #[arg(long, value_enum, default_value_t = OutletArg::Separate)]
    outlets: OutletArg,
    /// Volume per time into each inlet, in the mesh's unit of length: for the one-dimensional flow in MESH_patches.csv and for
    /// cases of solvers (default: what has a Reynolds number of 1 there)
    #[arg(long, value_name = "FLOW", value_parser = above_zero)]
    inflow: Option<f64>,
    /// Dynamic viscosity, in units that fit the mesh's: as it stands that of blood, when the mesh is in metres (--units)
    #[arg(long, value_name = "MU", default_value_t = crate::io::volume::BLOOD_VISCOSITY, value_parser = above_zero)]
    viscosity: f64,
    /// Mass per volume, in units that fit the mesh's: as it stands that of blood, when the mesh is in metres (--units)
    #[arg(long, value_name = "RHO", default_value_t = crate::io::volume::BLOOD_DENSITY, value_parser = above_zero)]
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

    pub fn outlets(&self) -> Outlets {
        match self.outlets {
            OutletArg::Separate => Outlets::Separate,
            OutletArg::Grouped => Outlets::Grouped,
            OutletArg::ByOrder => Outlets::ByOrder,
        }
    }
}

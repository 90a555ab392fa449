//! Flow options, for the patch table and solver cases.

use super::numbers::above_zero;
use crate::pipeline::{Fluid, Outlets};
use anastomesh_io::network::NodeNames;
use anastomesh_mesh::units::counted;
use anastomesh_skeleton::NodeId;

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
    /// Flow rate into each inlet, in the mesh's unit of length, for `MESH_patches.csv` and solver cases (default: Reynolds
    /// number 1)
    #[arg(long, value_name = "FLOW", value_parser = above_zero, allow_negative_numbers = true)]
    inflow: Option<f64>,
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

impl FlowArgs {
    pub fn fluid(&self) -> Fluid {
        Fluid { density: self.density, viscosity: self.viscosity, inflow: self.inflow }
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

//! One-dimensional flow: table of vessels, arrays and summary.

use crate::reduced::{VesselFlow, VesselRow};
use crate::report::rows::{Ended, row};
use anastomesh_io::network::{NetworkArray, NodeNames};
use anastomesh_mesh::units::counted;
use anastomesh_skeleton::NodeId;
use serde::Serialize;
use std::error::Error;

/// Columns of the table. Units are consistent with the network.
const COLUMNS: [&str; 9] =
    ["start", "end", "length", "radius", "resistance", "flow", "pressure_start", "pressure_end", "wall_shear"];

/// Table with a row for each vessel, along the flow; nodes have their names in the network file.
///
/// # Errors
/// The table cannot be created, which happens only if memory is insufficient.
pub fn table(rows: &[VesselRow], names: &NodeNames) -> Result<String, Box<dyn Error>> {
    let mut table = csv::Writer::from_writer(Vec::new());
    table.write_record(COLUMNS)?;
    for VesselRow { nodes, length, radius, resistance, flow, pressures: [first, last], shear } in rows {
        let mut record: Vec<String> = nodes.iter().map(|&node| names.of(NodeId(node))).collect();
        let numbers = [length, radius, resistance, flow, first, last, shear];
        record.extend(numbers.map(|number| format!("{number:?}")));
        table.write_record(record)?;
    }
    Ok(String::from_utf8(table.into_inner()?)?)
}

/// Arrays of the solution: `Pressure` on nodes, `Flow` and `WallShear` on edges.
pub fn arrays(flow: &VesselFlow) -> Vec<NetworkArray> {
    vec![
        NetworkArray::NodeFloats("Pressure", flow.pressure.clone()),
        NetworkArray::EdgeFloats("Flow", flow.flow.clone()),
        NetworkArray::EdgeFloats("WallShear", flow.shear.clone()),
    ]
}

/// Size of a model and the flow through it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FlowSummary {
    /// Number of vessels in the output.
    pub vessels: usize,
    /// Number of inlets.
    pub inlets: usize,
    /// Number of outlets.
    pub outlets: usize,
    /// Flow rate into all inlets.
    pub inflow: f64,
    /// Largest pressure.
    pub largest_pressure: f64,
    /// Largest wall shear stress.
    pub largest_shear: f64,
}

impl FlowSummary {
    /// Text of the summary.
    pub fn text(&self, ended: &Ended) -> String {
        let Self { vessels, inlets, outlets, inflow, largest_pressure, largest_shear } = self;
        let vessels = [(*vessels, "vessel"), (*inlets, "inlet"), (*outlets, "outlet")];
        let vessels = vessels.map(|(count, what)| counted(count, what)).join(", ");
        let flow =
            format!("inflow {inflow:.4e}, max pressure {largest_pressure:.4e}, max wall shear {largest_shear:.4e}");
        format!("{}{}{}", row("network", &vessels), row("flow", &flow), ended.rows(&[]))
    }
}

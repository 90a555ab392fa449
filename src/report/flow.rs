//! One-dimensional flow, and results of solvers beside it: tables of vessels, arrays and summaries.

use crate::report::rows::{Ended, row};
use anastomesh_flow::{Along, BranchFlow, VesselFlow, VesselRow};
use anastomesh_io::network::{NetworkArray, NodeNames};
use anastomesh_mesh::units::counted;
use anastomesh_skeleton::{NodeId, Skeleton};
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

/// Columns of the table of a result. The suffix `_1d` marks the one-dimensional solution.
const RESULT_COLUMNS: [&str; 16] = [
    "start",
    "end",
    "length",
    "radius",
    "cells",
    "stations",
    "flow",
    "flow_spread",
    "flow_1d",
    "flow_difference",
    "pressure_start",
    "pressure_end",
    "pressure_start_1d",
    "pressure_end_1d",
    "wall_shear",
    "wall_shear_1d",
];

/// Smallest flow rate for relative differences, relative to the inflow.
const FLOOR: f64 = 1e-3;

/// Table of a result with a row for each branch.
///
/// # Errors
/// The table cannot be created, which happens only if memory is insufficient.
pub fn result_table(along: &Along, network: &Skeleton, names: &NodeNames) -> Result<String, Box<dyn Error>> {
    let mut table = csv::Writer::from_writer(Vec::new());
    table.write_record(RESULT_COLUMNS)?;
    let inflow = along.inflow;
    for branch in &along.branches {
        let node = |node: u32| names.of(NodeId(network.nodes[node as usize].original));
        let at = |values: &[f64], end: usize| values[branch.nodes[end] as usize];
        let mut record = vec![node(branch.nodes[0]), node(branch.nodes[1])];
        let number = |number: f64| if number.is_nan() { String::new() } else { format!("{number:?}") };
        record.extend([branch.length, branch.radius].map(number));
        record.extend([branch.cells, branch.stations].map(|count| count.to_string()));
        record.extend([branch.flow, branch.spread, branch.expected_flow, difference(branch, inflow)].map(number));
        record.extend([0, 1].map(|end| number(at(&along.pressure, end))));
        record.extend([0, 1].map(|end| number(at(&along.expected_pressure, end))));
        record.extend([branch.shear, branch.expected_shear].map(number));
        table.write_record(record)?;
    }
    Ok(String::from_utf8(table.into_inner()?)?)
}

/// Arrays of a result: pressures on nodes, flow rates and wall shear stresses on edges.
pub fn result_arrays(along: &Along) -> Vec<NetworkArray> {
    let inflow = along.inflow;
    let edges = 0..along.of_edge.len();
    let branch = |edge: usize| &along.branches[along.of_edge[edge] as usize];
    let of_edges = |value: &dyn Fn(usize) -> f64| edges.clone().map(value).collect();
    vec![
        NetworkArray::NodeFloats("Pressure", along.pressure.clone()),
        NetworkArray::NodeFloats("Pressure1D", along.expected_pressure.clone()),
        NetworkArray::EdgeFloats("Flow", of_edges(&|edge| along.edge_flow(edge)[0])),
        NetworkArray::EdgeFloats("Flow1D", of_edges(&|edge| along.edge_flow(edge)[1])),
        NetworkArray::EdgeFloats("FlowDifference", of_edges(&|edge| difference(branch(edge), inflow))),
        NetworkArray::EdgeFloats("WallShear", along.shear.clone()),
        NetworkArray::EdgeFloats("WallShear1D", of_edges(&|edge| branch(edge).expected_shear)),
    ]
}

/// Difference of the flow rate from the one-dimensional one, relative to it.
fn difference(branch: &BranchFlow, inflow: f64) -> f64 {
    (branch.flow - branch.expected_flow).abs() / branch.expected_flow.abs().max(FLOOR * inflow)
}

/// Comparison of a result with the one-dimensional solution.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ResultSummary {
    /// Name of the time step or file.
    pub time: String,
    /// Number of cells.
    pub cells: usize,
    /// Number of branches.
    pub branches: usize,
    /// Number of branches without a station.
    pub branches_without_flow: usize,
    /// Flow rate into all inlets.
    pub inflow: f64,
    /// Flow rate out of all outlets.
    pub outflow: f64,
    /// Median relative difference of the flow rates of branches from the one-dimensional ones.
    pub median_flow_difference: f64,
    /// Largest relative difference.
    pub max_flow_difference: f64,
    /// Largest spread of the stations of a branch, relative to its flow rate.
    pub max_flow_spread: f64,
    /// Largest pressure drop from an inlet to an outlet.
    pub pressure_drop: f64,
    /// That of the one-dimensional solution.
    pub pressure_drop_1d: f64,
    /// Mean wall shear stress, by wall of the branches.
    pub mean_shear: f64,
    /// That of the one-dimensional solution.
    pub mean_shear_1d: f64,
}

impl ResultSummary {
    /// Compares a result.
    pub fn of(along: &Along, time: &str, cells: usize) -> Self {
        let inflow = along.inflow;
        let with_flow = || along.branches.iter().filter(|branch| branch.stations > 0);
        let mut differences: Vec<f64> = with_flow().map(|branch| difference(branch, inflow)).collect();
        differences.sort_unstable_by(f64::total_cmp);
        let spread = |branch: &BranchFlow| branch.spread / branch.flow.abs().max(FLOOR * inflow);
        let drop = |pressures: &[f64]| {
            let of_terminals =
                || along.of_terminal.keys().map(|node| pressures[node.index()]).filter(|p| p.is_finite());
            of_terminals().fold(f64::NEG_INFINITY, f64::max) - of_terminals().fold(f64::INFINITY, f64::min)
        };
        let mean = |value: &dyn Fn(&BranchFlow) -> f64| {
            let sound = || along.branches.iter().filter(|branch| branch.shear.is_finite());
            let wall = |branch: &BranchFlow| branch.length * branch.radius;
            sound().map(|branch| wall(branch) * value(branch)).sum::<f64>() / sound().map(wall).sum::<f64>()
        };
        Self {
            time: time.to_owned(),
            cells,
            branches: along.branches.len(),
            branches_without_flow: along.branches.len() - differences.len(),
            inflow,
            outflow: along.of_terminal.values().sum::<f64>() - inflow,
            median_flow_difference: differences.get(differences.len() / 2).copied().unwrap_or(f64::NAN),
            max_flow_difference: differences.last().copied().unwrap_or(f64::NAN),
            max_flow_spread: with_flow().map(spread).fold(0.0, f64::max),
            pressure_drop: drop(&along.pressure),
            pressure_drop_1d: drop(&along.expected_pressure),
            mean_shear: mean(&|branch| branch.shear),
            mean_shear_1d: mean(&|branch| branch.expected_shear),
        }
    }

    /// Text of the summary.
    pub fn text(&self, ended: &Ended) -> String {
        let percent = |part: f64| format!("{:.2} %", 100.0 * part);
        let missing = match self.branches_without_flow {
            0 => String::new(),
            count => format!("; {} too short for a flow rate", counted(count, "vessel")),
        };
        let size =
            format!("{}: {}, {}{missing}", self.time, counted(self.cells, "cell"), counted(self.branches, "vessel"));
        let flow = format!(
            "inflow {:.4e}, outflow {:.4e}; flow differs from 1D by median {}, max {}; spread within a vessel max {}",
            self.inflow,
            self.outflow,
            percent(self.median_flow_difference),
            percent(self.max_flow_difference),
            percent(self.max_flow_spread)
        );
        let beside = |what: &str, value: f64, expected: f64| {
            format!("{what} {value:.4e}, 1D {expected:.4e} ({:+.2} %)", 100.0 * (value / expected - 1.0))
        };
        let rows = [
            ("result", size),
            ("flow", flow),
            ("pressure", beside("max drop", self.pressure_drop, self.pressure_drop_1d)),
            ("shear", beside("mean", self.mean_shear, self.mean_shear_1d)),
        ];
        rows.map(|(what, text)| row(what, &text)).concat() + &ended.rows(&[])
    }
}

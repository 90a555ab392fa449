//! Writer of zero-dimensional models.

use crate::flow::OutletModel;
use crate::network::reduced::{ModelEnd, ReducedFault, ReducedModel, ReducedVessel};
use std::collections::BTreeMap;
use std::io::{self, Write};

/// Time steps per period of pulsatile flow.
const STEPS: usize = 1000;

/// Rounding errors of pressures in the solver, relative to the largest pressure. Larger than the residuals of models with
/// pressures up to 2e4 and flow rates of 1e-9, which are 1e-16.
const ROUNDING: f64 = 2e-15;

/// Writes a model. Each vessel also has its `nodes` and `radii`, and `network` has the positions.
pub(in crate::network) fn write(out: &mut dyn Write, model: &ReducedModel) -> io::Result<()> {
    let period = model.period().map_err(io::Error::other)?;
    writeln!(out, "{{\n\"simulation_parameters\": {},", parameters(model))?;
    conditions(out, model, period)?;
    junctions(out, model)?;
    out.write_all(b"\"vessels\": [\n")?;
    for (number, vessel) in model.vessels.iter().enumerate() {
        write_vessel(out, model, number, vessel)?;
        out.write_all(if number + 1 < model.vessels.len() { b",\n" } else { b"\n" })?;
    }
    out.write_all(b"],\n\"network\": {\"generator\": \"anastomesh\", \"nodes\": [\n")?;
    for (number, (position, radius)) in model.nodes.iter().enumerate() {
        let end = if number + 1 < model.nodes.len() { "," } else { "" };
        writeln!(out, "[{:?}, {:?}, {:?}, {radius:?}]{end}", position.x, position.y, position.z)?;
    }
    out.write_all(b"]}\n}\n")
}

fn parameters(model: &ReducedModel) -> String {
    let rounding = ROUNDING * model.largest_pressure;
    let inflow = model.smallest_inflow();
    let inflow = if inflow.is_finite() { inflow } else { 1.0 };
    if model.is_pulsatile() {
        let tolerance = rounding.max(1e-6 * inflow);
        return format!(
            "{{\"number_of_cardiac_cycles\": {}, \"number_of_time_pts_per_cardiac_cycle\": {}, \"absolute_tolerance\": \
             {tolerance:?}, \"output_variable_based\": false, \"output_interval\": {}}}",
            model.periods.max(1),
            STEPS + 1,
            STEPS / 100
        );
    }
    // A steady model is linear, and its first step is exact if it is made: below the residual of the inflow.
    let tolerance =
        if rounding < 0.1 * inflow { (rounding.max(1e-12 * inflow) * 0.1 * inflow).sqrt() } else { rounding };
    format!(
        "{{\"number_of_cardiac_cycles\": 1, \"number_of_time_pts_per_cardiac_cycle\": 2, \"absolute_tolerance\": \
         {tolerance:?}, \"rho_infty\": 0.0, \"output_variable_based\": false}}"
    )
}

/// Name of the condition at a terminal.
fn condition_name(node: u32, end: &ModelEnd) -> String {
    match end {
        ModelEnd::Inlet { .. } => format!("INLET_{node}"),
        ModelEnd::Outlet(_) => format!("OUTLET_{node}"),
    }
}

fn conditions(out: &mut dyn Write, model: &ReducedModel, period: f64) -> io::Result<()> {
    out.write_all(b"\"boundary_conditions\": [\n")?;
    for (number, (&node, end)) in model.ends.iter().enumerate() {
        let (kind, values) = condition(end, period);
        let (name, comma) = (condition_name(node, end), if number + 1 < model.ends.len() { "," } else { "" });
        writeln!(out, "{{\"bc_name\": \"{name}\", \"bc_type\": \"{kind}\", \"bc_values\": {{{values}}}}}{comma}")?;
    }
    out.write_all(b"],\n")
}

/// Type and values of a condition.
fn condition(end: &ModelEnd, period: f64) -> (&'static str, String) {
    let both = |value: f64| format!("[{value:?}, {value:?}], \"t\": [0.0, {period:?}]");
    match end {
        ModelEnd::Inlet { waveform: Some(waveform), .. } => {
            ("FLOW", format!("\"Q\": {:?}, \"t\": {:?}", waveform.rates(), waveform.times()))
        }
        ModelEnd::Inlet { rate, waveform: None } => ("FLOW", format!("\"Q\": {}", both(*rate))),
        ModelEnd::Outlet(OutletModel::Pressure(pressure)) => ("PRESSURE", format!("\"P\": {}", both(*pressure))),
        ModelEnd::Outlet(OutletModel::Resistance { resistance, distal_pressure }) => {
            ("RESISTANCE", format!("\"R\": {resistance:?}, \"Pd\": {distal_pressure:?}"))
        }
        ModelEnd::Outlet(OutletModel::Rcr { proximal, capacitance, distal, distal_pressure }) => (
            "RCR",
            format!("\"Rp\": {proximal:?}, \"C\": {capacitance:?}, \"Rd\": {distal:?}, \"Pd\": {distal_pressure:?}"),
        ),
    }
}

fn junctions(out: &mut dyn Write, model: &ReducedModel) -> io::Result<()> {
    out.write_all(b"\"junctions\": [")?;
    let mut comma = "\n";
    for (node, [ending, beginning]) in model.joints().iter().enumerate() {
        if model.ends.contains_key(&(node as u32)) || ending.is_empty() && beginning.is_empty() {
            continue;
        }
        write!(
            out,
            "{comma}{{\"junction_name\": \"J{node}\", \"junction_type\": \"NORMAL_JUNCTION\", \"inlet_vessels\": \
             {ending:?}, \"outlet_vessels\": {beginning:?}}}"
        )?;
        comma = ",\n";
    }
    out.write_all(b"\n],\n")
}

fn write_vessel(out: &mut dyn Write, model: &ReducedModel, number: usize, vessel: &ReducedVessel) -> io::Result<()> {
    let ReducedVessel { path, radii, length, resistance, inertance, capacitance } = vessel;
    let [start, end] = vessel.tips();
    write!(
        out,
        "{{\"vessel_id\": {number}, \"vessel_name\": \"branch{number}_seg0\", \"vessel_length\": {length:?}, \
         \"zero_d_element_type\": \"BloodVessel\", \"zero_d_element_values\": {{\"R_poiseuille\": {resistance:?}, \"L\": \
         {inertance:?}, \"C\": {capacitance:?}, \"stenosis_coefficient\": 0.0}}, \"nodes\": {path:?}, \"radii\": {radii:?}"
    )?;
    let here = |place: &'static str, node: u32, ends: &BTreeMap<u32, ModelEnd>| {
        ends.get(&node).map(|end| format!("\"{place}\": \"{}\"", condition_name(node, end)))
    };
    let conditions = [here("inlet", start, &model.ends), here("outlet", end, &model.ends)];
    let conditions: Vec<String> = conditions.into_iter().flatten().collect();
    if !conditions.is_empty() {
        write!(out, ", \"boundary_conditions\": {{{}}}", conditions.join(", "))?;
    }
    out.write_all(b"}")
}

/// Checks that the solver takes a model.
pub(in crate::network) fn check(model: &ReducedModel) -> Result<(), ReducedFault> {
    model.period().map(drop)
}

//! Writer of one-dimensional models.

use crate::flow::OutletModel;
use crate::network::reduced::{ModelEnd, ReducedFault, ReducedModel, ReducedVessel};
use std::f64::consts::PI;
use std::io::{self, Write};

/// Time steps per period.
const STEPS: usize = 1000;
/// Results per period.
const RESULTS: usize = 50;
/// Convergence tolerance of the solver's examples.
const TOLERANCE: f64 = 1e-8;
/// Limits of the number of finite elements per segment.
const ELEMENTS: [f64; 2] = [2.0, 50.0];
/// Length of a finite element, in radii.
const ELEMENT_LENGTH: f64 = 4.0;

/// Writes a model. A segment has the areas of its ends; between them its radius is linear.
pub(in crate::network) fn write(out: &mut dyn Write, model: &ReducedModel) -> io::Result<()> {
    let period = model.period().map_err(io::Error::other)?;
    writeln!(out, "# Written by anastomesh. Units are consistent: those of lengths, density and viscosity.")?;
    writeln!(out, "MODEL results_")?;
    writeln!(out, "\n# NODE name x y z")?;
    for (number, (position, _)) in model.nodes.iter().enumerate() {
        writeln!(out, "NODE {number} {:?} {:?} {:?}", position.x, position.y, position.z)?;
    }
    joints(out, model)?;
    writeln!(
        out,
        "\n# SEGMENT name id length elements node node area area flow material loss angle upstream branch outlet table"
    )?;
    for (number, vessel) in model.vessels.iter().enumerate() {
        segment(out, model, number, vessel)?;
    }
    tables(out, model, period)?;
    let steps = STEPS * model.periods.max(1) as usize;
    writeln!(
        out,
        "\n# SOLVEROPTIONS step interval steps quadrature table inlet tolerance formulation stabilisation\nSOLVEROPTIONS \
         {:?} {} {steps} 2 INFLOW FLOW {TOLERANCE:?} 1 1",
        period / STEPS as f64,
        STEPS / RESULTS
    )?;
    let [k1, k2, k3] = model.stiffness.k;
    writeln!(
        out,
        "\n# MATERIAL name law density viscosity pressure exponent k1 k2 k3\nMATERIAL WALL OLUFSEN {:?} {:?} 0.0 2.0 \
         {k1:?} {k2:?} {k3:?}\n\nOUTPUT TEXT",
        model.density, model.viscosity
    )
}

fn joints(out: &mut dyn Write, model: &ReducedModel) -> io::Result<()> {
    writeln!(out, "\n# JOINT name node list list, then the segments that end and begin there")?;
    let list = |segments: &[u32]| segments.iter().map(|segment| format!(" {segment}")).collect::<String>();
    for (node, [ending, beginning]) in model.joints().iter().enumerate() {
        if model.ends.contains_key(&(node as u32)) || ending.is_empty() && beginning.is_empty() {
            continue;
        }
        writeln!(
            out,
            "JOINT J{node} {node} IN{node} OUT{node}\nJOINTINLET IN{node} {}{}\nJOINTOUTLET OUT{node} {}{}",
            ending.len(),
            list(ending),
            beginning.len(),
            list(beginning)
        )?;
    }
    Ok(())
}

fn segment(out: &mut dyn Write, model: &ReducedModel, number: usize, vessel: &ReducedVessel) -> io::Result<()> {
    let ([start, end], [a, b]) = (vessel.tips(), vessel.ends());
    let elements = (vessel.length / (ELEMENT_LENGTH * f64::midpoint(a, b))).ceil().clamp(ELEMENTS[0], ELEMENTS[1]);
    let (kind, table) = match model.ends.get(&end) {
        Some(ModelEnd::Outlet(outlet)) => (kind(outlet), format!("OUTLET_{end}")),
        _ => ("NOBOUND", "NONE".to_owned()),
    };
    writeln!(
        out,
        "SEGMENT seg{number} {number} {:?} {elements} {start} {end} {:?} {:?} 0.0 WALL NONE 0.0 0 0 {kind} {table}",
        vessel.length,
        PI * a * a,
        PI * b * b
    )
}

fn kind(outlet: &OutletModel) -> &'static str {
    match outlet {
        OutletModel::Pressure(_) => "PRESSURE",
        OutletModel::Resistance { .. } => "RESISTANCE",
        OutletModel::Rcr { .. } => "RCR",
    }
}

fn tables(out: &mut dyn Write, model: &ReducedModel, period: f64) -> io::Result<()> {
    writeln!(out, "\n# DATATABLE name LIST, then times and values")?;
    for (node, end) in &model.ends {
        let (name, rows) = match end {
            ModelEnd::Inlet { rate, waveform } => {
                let rows = match waveform {
                    Some(waveform) => waveform.times().iter().copied().zip(waveform.rates().iter().copied()).collect(),
                    None => vec![(0.0, *rate), (period, *rate)],
                };
                ("INFLOW".to_owned(), rows)
            }
            ModelEnd::Outlet(outlet) => {
                let values = match *outlet {
                    OutletModel::Pressure(pressure) => vec![pressure],
                    OutletModel::Resistance { resistance, distal_pressure } => vec![resistance, distal_pressure],
                    OutletModel::Rcr { proximal, capacitance, distal, distal_pressure } => {
                        vec![proximal, capacitance, distal, distal_pressure]
                    }
                };
                (format!("OUTLET_{node}"), values.into_iter().map(|value| (0.0, value)).collect())
            }
        };
        writeln!(out, "DATATABLE {name} LIST")?;
        for (time, value) in rows {
            writeln!(out, "{time:?} {value:?}")?;
        }
        writeln!(out, "ENDDATATABLE")?;
    }
    Ok(())
}

/// Checks that the solver takes a model.
pub(in crate::network) fn check(model: &ReducedModel) -> Result<(), ReducedFault> {
    model.period()?;
    match model.inlets() {
        1 => Ok(()),
        inlets => Err(ReducedFault::Inlets { inlets }),
    }
}

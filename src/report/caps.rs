//! CSV table of all inlets and outlets.

use anastomesh_flow::{CapRow, Caps};
use anastomesh_io::flow::OutletModel;
use anastomesh_io::network::NodeNames;
use anastomesh_skeleton::NodeId;
use std::error::Error;

/// Columns. Lengths are in the mesh's unit; flow is the mean volume per time, into inlets and out of outlets. The columns
/// from `model` on belong to outlets, and the parts of the resistance and the capacitance to RCR models.
const COLUMNS: [&str; 21] = [
    "id",
    "name",
    "node",
    "center_x",
    "center_y",
    "center_z",
    "normal_x",
    "normal_y",
    "normal_z",
    "area",
    "radius",
    "strahler_order",
    "diameter_order",
    "flow",
    "pressure",
    "model",
    "resistance",
    "proximal_resistance",
    "distal_resistance",
    "capacitance",
    "distal_pressure",
];

/// Table with a row for each inlet and outlet; nodes have their names in the network file.
///
/// # Errors
/// The table cannot be created, which happens only if memory is insufficient.
pub fn table(caps: &Caps, names: &NodeNames) -> Result<String, Box<dyn Error>> {
    let mut table = csv::Writer::from_writer(Vec::new());
    table.write_record(COLUMNS)?;
    for CapRow { id, name, cap, area, strahler, order, flow, pressure, outlet, .. } in &caps.rows {
        let mut record = vec![id.to_string(), name.clone(), names.of(NodeId(cap.node))];
        let numbers = cap.center.coords.iter().chain(&cap.normal).chain([area, &cap.radius]);
        // Shortest form that is read back unchanged.
        let text = |number: &f64| format!("{number:?}");
        record.extend(numbers.map(text));
        record.extend([strahler, order].map(ToString::to_string));
        record.extend([flow, pressure].map(text));
        record.extend(model(outlet.as_ref()));
        table.write_record(record)?;
    }
    Ok(String::from_utf8(table.into_inner()?)?)
}

/// Name, resistance, proximal and distal resistance, capacitance and distal pressure of an outlet model; empty where
/// there is none.
fn model(outlet: Option<&OutletModel>) -> [String; 6] {
    let Some(outlet) = outlet else { return Default::default() };
    let (name, [proximal, distal, capacitance], distal_pressure) = match *outlet {
        OutletModel::Pressure(pressure) => ("pressure", [None; 3], pressure),
        OutletModel::Resistance { distal_pressure, .. } => ("resistance", [None; 3], distal_pressure),
        OutletModel::Rcr { proximal, capacitance, distal, distal_pressure } => {
            ("rcr", [proximal, distal, capacitance].map(Some), distal_pressure)
        }
        _ => return Default::default(),
    };
    let text = |number: Option<f64>| number.map_or_else(String::new, |number| format!("{number:?}"));
    [
        name.to_owned(),
        text(Some(outlet.resistance())),
        text(proximal),
        text(distal),
        text(capacitance),
        text(Some(distal_pressure)),
    ]
}

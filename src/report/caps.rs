//! CSV table of all inlets and outlets.

use crate::pipeline::{CapRow, Caps};
use anastomesh_io::network::NodeNames;
use anastomesh_skeleton::NodeId;
use std::error::Error;

/// Columns. Lengths are in the mesh's unit; flow is volume per time, into inlets and out of outlets.
const COLUMNS: [&str; 16] = [
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
    "resistance",
];

/// Table with a row for each inlet and outlet; nodes have their names in the network file.
///
/// # Errors
/// The table cannot be created, which happens only if memory is insufficient.
pub fn table(caps: &Caps, names: &NodeNames) -> Result<String, Box<dyn Error>> {
    let mut table = csv::Writer::from_writer(Vec::new());
    table.write_record(COLUMNS)?;
    for CapRow { id, name, cap, area, strahler, order, flow, pressure, resistance, .. } in &caps.rows {
        let mut record = vec![id.to_string(), name.clone(), names.of(NodeId(cap.node))];
        let numbers = cap.center.coords.iter().chain(&cap.normal).chain([area, &cap.radius]);
        // Shortest form that is read back unchanged.
        let text = |number: &f64| format!("{number:?}");
        record.extend(numbers.map(text));
        record.extend([strahler, order].map(ToString::to_string));
        record.extend([flow, pressure, resistance].map(text));
        table.write_record(record)?;
    }
    Ok(String::from_utf8(table.into_inner()?)?)
}

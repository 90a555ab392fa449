//! Row of a summary for `prepare`.

use super::rows::row;
use anastomesh_mesh::units::{counted, grouped};
use anastomesh_network::{PrepareReport, Size};

/// The network as it came in and as it is now, in one row.
pub fn row_of(report: &PrepareReport) -> String {
    let Size { nodes, edges, tips, components, loops, .. } = report.result;
    let given = report.given.nodes;
    let was = if given == nodes { String::new() } else { format!(" (of {})", grouped(given)) };
    let [nodes, edges, tips, loops] = [nodes, edges, tips, loops].map(grouped);
    let components = counted(components, "component");
    row("network", &format!("{nodes} nodes{was}, {edges} edges, {tips} tips, {components}, {loops} loops"))
}

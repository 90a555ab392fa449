//! Row of a summary for `prepare`.

use super::rows::row;
use anastomesh_mesh::units::{counted, grouped};
use anastomesh_network::{PrepareReport, Size};

/// Row with the size of the network before and after preparation.
pub fn row_of(report: &PrepareReport) -> String {
    let Size { nodes, edges, tips, components, loops, .. } = report.result;
    let given = report.given.nodes;
    let was = if given == nodes { String::new() } else { format!(" (of {})", grouped(given)) };
    let nodes = counted(nodes, "node");
    let parts = [(edges, "edge"), (tips, "tip"), (components, "component"), (loops, "loop")];
    let parts = parts.map(|(count, what)| counted(count, what)).join(", ");
    row("network", &format!("{nodes}{was}, {parts}"))
}

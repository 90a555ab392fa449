//! Patches: names, positions, areas, flows.

use super::html::Section;
use crate::pipeline::{CapRow, Caps};
use anastomesh_io::network::NodeNames;
use anastomesh_mesh::Patch;
use anastomesh_skeleton::NodeId;

/// Maximum number of table rows.
const LISTED: usize = 100;

/// Table of inlets and outlets with their flow; nodes have their names in the network file.
pub fn terminals(caps: &Caps, names: &NodeNames) -> Section {
    let row = |row: &CapRow| {
        let [x, y, z]: [f64; 3] = row.cap.center.into();
        vec![
            row.id.to_string(),
            row.name.clone(),
            names.of(NodeId(row.cap.node)),
            format!("{x:.4} {y:.4} {z:.4}"),
            format!("{:.4}", row.cap.radius),
            format!("{:.4e}", row.area),
            row.strahler.to_string(),
            format!("{:.4e}", row.flow),
            format!("{:.4e}", row.pressure),
        ]
    };
    let rows: Vec<Vec<String>> = caps.rows.iter().take(LISTED).map(row).collect();
    let head = ["patch", "name", "node", "centre", "radius", "area", "order", "flow", "pressure"];
    more(Section::new("Inlets and outlets").table(&head, &rows), caps.rows.len())
}

/// Table of the patches that a file names.
pub fn named_patches(patches: &[Patch]) -> Section {
    if patches.is_empty() {
        return Section::new("Patches");
    }
    let row = |patch: &Patch| {
        let cap = patch.cap.map_or_else(Default::default, |cap| {
            let [x, y, z]: [f64; 3] = cap.center.into();
            [cap.node.to_string(), format!("{x:.4} {y:.4} {z:.4}"), format!("{:.4}", cap.radius)]
        });
        [vec![patch.id.to_string(), patch.name.clone()], cap.to_vec()].concat()
    };
    let rows: Vec<Vec<String>> = patches.iter().take(LISTED).map(row).collect();
    more(Section::new("Patches").table(&["patch", "name", "node", "centre", "radius"], &rows), patches.len())
}

fn more(section: Section, count: usize) -> Section {
    match count.saturating_sub(LISTED) {
        0 => section,
        hidden => section.text(&format!("and {hidden} more")),
    }
}

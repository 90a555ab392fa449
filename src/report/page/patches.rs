//! Patches: names, positions, areas, flows.

use super::figures::{LengthUnit, figure};
use super::html::Section;
use anastomesh_flow::{CapRow, Caps};
use anastomesh_io::network::NodeNames;
use anastomesh_mesh::units::{grouped, number};
use anastomesh_mesh::{Cap, Patch};
use anastomesh_skeleton::NodeId;

/// Maximum number of table rows.
const LISTED: usize = 100;

/// Table of inlets and outlets with their flow; nodes have their names in the network file.
pub fn terminals(caps: &Caps, names: &NodeNames, unit: LengthUnit) -> Section {
    let row = |row: &CapRow| {
        vec![
            row.id.to_string(),
            row.name.clone(),
            names.of(NodeId(row.cap.node)),
            position(&row.cap),
            figure(row.cap.radius),
            figure(row.area),
            row.strahler.to_string(),
            figure(row.flow),
            figure(row.pressure),
        ]
    };
    let rows: Vec<Vec<String>> = caps.rows.iter().take(LISTED).map(row).collect();
    let [centre, radius, area] =
        [("centre", ""), ("radius", ""), ("area", "²")].map(|(name, power)| unit.title(name, power));
    let head = ["patch", "name", "node", &centre, &radius, &area, "Strahler order", "flow", "pressure"];
    more(Section::new("Inlets and outlets").table(&head, &rows), caps.rows.len())
}

/// Table of the patches that a file names.
pub fn named_patches(patches: &[Patch]) -> Section {
    if patches.is_empty() {
        return Section::new("Patches");
    }
    let row = |patch: &Patch| {
        let cap =
            patch.cap.map_or_else(Default::default, |cap| [cap.node.to_string(), position(&cap), figure(cap.radius)]);
        [vec![patch.id.to_string(), patch.name.clone()], cap.to_vec()].concat()
    };
    let rows: Vec<Vec<String>> = patches.iter().take(LISTED).map(row).collect();
    more(Section::new("Patches").table(&["patch", "name", "node", "centre", "radius"], &rows), patches.len())
}

fn position(cap: &Cap) -> String {
    <[f64; 3]>::from(cap.center).map(number).join(" ")
}

fn more(section: Section, count: usize) -> Section {
    match count.saturating_sub(LISTED) {
        0 => section,
        hidden => section.text(&format!("and {} more", grouped(hidden))),
    }
}

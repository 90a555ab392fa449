//! Networks in the viewer: displayed, or used to look up the vessel of a mesh point.

use super::pack::{Pack, QuantizationGrid};
use super::scale::Scale;
use anastomesh_network::flow::{NotConverged, Orders};
use anastomesh_skeleton::{NodeId, Skeleton};

/// Grid resolution of node positions and of radii, in steps.
const STEPS: u32 = 1 << 20;

/// Packs a network with its inlets and returns the metadata for the page.
pub fn add_network(network: &Skeleton, inlets: &[NodeId], pack: &mut Pack) -> Result<serde_json::Value, NotConverged> {
    let grid = QuantizationGrid::of(network.nodes.iter().map(|n| &n.position), STEPS);
    pack.add("node", &grid.steps(network.nodes.iter().map(|n| &n.position)), 3);
    pack.add("nodeName", &network.nodes.iter().map(|n| n.original as i32).collect::<Vec<_>>(), 1);
    let ends: Vec<i32> = network.edges.iter().flat_map(|e| e.nodes.map(|n| n.0 as i32)).collect();
    pack.add("edge", &ends, 2);
    let widest = network.edges.iter().flat_map(|e| e.radii).fold(0.0, f64::max);
    let step = if widest > 0.0 { widest / f64::from(STEPS) } else { 1.0 };
    let radii: Vec<i32> = network.edges.iter().flat_map(|e| e.radii.map(|r| (r / step).round() as i32)).collect();
    pack.add("edgeRadius", &radii, 2);
    let orders = Orders::from_inlets(network, inlets.iter().copied())?.strahler;
    pack.add("edgeOrder", &orders.iter().map(|&o| o as i32).collect::<Vec<_>>(), 1);
    let branches = network.branches(&network.adjacency()).of_edge;
    pack.add("edgeBranch", &branches.iter().map(|(b, _)| b.0 as i32).collect::<Vec<_>>(), 1);
    let narrowest = network.edges.iter().flat_map(|e| e.radii).fold(widest, f64::min);
    Ok(serde_json::json!({ "grid": grid, "radiusStep": step, "radii": [narrowest, widest],
        "orders": orders.iter().max(), "edges": network.edges.len() }))
}

/// Packs the values at both ends of each edge of the network.
pub fn add_values(values: &[[f64; 2]], scale: Scale, pack: &mut Pack) {
    let codes: Vec<i32> = values.as_flattened().iter().map(|&x| scale.code(x, f64::from(STEPS))).collect();
    pack.add("edgeValue", &codes, 2);
}

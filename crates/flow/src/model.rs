//! Reduced-order models from a network and its steady flow.

use anastomesh_io::flow::{OutletModel, Waveform};
use anastomesh_io::network::{ModelEnd, ReducedModel, ReducedVessel, Stiffness};
use anastomesh_network::flow::{NetworkFlow, resistance};
use anastomesh_skeleton::{Edge, EdgeId, NodeId, Skeleton};
use std::collections::BTreeMap;

/// Options of a reduced-order model.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ModelOptions {
    /// Mass per volume.
    pub density: f64,
    /// Dynamic viscosity.
    pub viscosity: f64,
    /// Stiffness of vessel walls.
    pub stiffness: Stiffness,
    /// True if vessels have inertance and capacitance, which steady flow does not need.
    pub elastic: bool,
    /// True if each branch between bifurcations is one vessel; else each edge is.
    pub lumped: bool,
    /// Number of simulated periods.
    pub periods: u32,
}

impl ModelOptions {
    /// One rigid vessel per edge.
    pub fn new(density: f64, viscosity: f64) -> Self {
        Self { density, viscosity, stiffness: Stiffness::default(), elastic: false, lumped: false, periods: 0 }
    }
}

anastomesh_mesh::setters!(ModelOptions { stiffness: Stiffness, elastic: bool, lumped: bool, periods: u32 });

/// Conditions at the terminals of a network.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Supply {
    /// Mean flow rates by inlet.
    pub rates: BTreeMap<NodeId, f64>,
    /// Pulsatile flow rates by inlet.
    pub waveforms: BTreeMap<NodeId, Waveform>,
    /// Models by outlet; others have pressure 0.
    pub outlets: BTreeMap<NodeId, OutletModel>,
}

/// Component without an inlet or without an outlet, so that its pressures are undefined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the vessels at node {} have no {missing}, so that their pressures are undefined; add one, or remove these vessels", node.0)]
pub struct Closed {
    /// First node of the component, by its index in the network.
    pub node: NodeId,
    /// Missing kind of terminal.
    pub missing: &'static str,
}

/// Builds the model of a network with a known steady flow.
///
/// # Errors
/// A component has no inlet or no outlet.
pub fn reduced_model(
    network: &Skeleton,
    flow: &NetworkFlow,
    supply: &Supply,
    options: &ModelOptions,
) -> Result<ReducedModel, Closed> {
    check_open(network, supply)?;
    let adjacency = network.adjacency();
    let mut vessels: Vec<ReducedVessel> = if options.lumped {
        let branches = network.branches(&adjacency).list;
        branches.iter().map(|branch| vessel(network, &branch.nodes, &branch.edges, options)).collect()
    } else {
        network.edge_ids().map(|edge| vessel(network, &network.edge(edge).nodes, &[edge], options)).collect()
    };
    let terminals = adjacency.terminals();
    let ends: BTreeMap<u32, ModelEnd> = terminals.iter().map(|&node| (node.0, end(node, supply))).collect();
    for vessel in &mut vessels {
        if runs_upstream(vessel, &ends, &flow.pressure) {
            vessel.reverse();
        }
    }
    let pressures = flow.pressure.iter().fold(0.0, |most: f64, pressure| most.max(pressure.abs()));
    Ok(ReducedModel::new(options.density, options.viscosity, options.stiffness)
        .nodes(network.nodes.iter().map(|node| (node.position, node.radius)).collect())
        .vessels(vessels)
        .ends(ends)
        .largest_pressure(pressures)
        .periods(options.periods))
}

/// Vessel along edges, in series.
fn vessel(network: &Skeleton, nodes: &[NodeId], edges: &[EdgeId], options: &ModelOptions) -> ReducedVessel {
    let mut vessel = ReducedVessel { path: nodes.iter().map(|node| node.0).collect(), ..ReducedVessel::default() };
    for (&id, &start) in edges.iter().zip(nodes) {
        let edge: &Edge = network.edge(id);
        let length = network.length(id);
        let mut radii = edge.radii;
        if edge.nodes[0] != start {
            radii.reverse();
        }
        vessel.radii.extend(radii);
        vessel.length += length;
        vessel.resistance += resistance(network, id, options.viscosity);
        if options.elastic {
            vessel.inertance += ReducedVessel::cone_inertance(options.density, length, radii);
            vessel.capacitance += ReducedVessel::cone_capacitance(&options.stiffness, length, radii);
        }
    }
    vessel
}

fn end(node: NodeId, supply: &Supply) -> ModelEnd {
    match supply.rates.get(&node) {
        Some(&rate) => ModelEnd::Inlet { rate, waveform: supply.waveforms.get(&node).cloned() },
        None => ModelEnd::Outlet(supply.outlets.get(&node).copied().unwrap_or_default()),
    }
}

/// True if a vessel ends at an inlet, begins at an outlet, or else leads to the higher pressure.
fn runs_upstream(vessel: &ReducedVessel, ends: &BTreeMap<u32, ModelEnd>, pressure: &[f64]) -> bool {
    let [start, end] = vessel.tips();
    match [start, end].map(|node| ends.get(&node)) {
        [Some(ModelEnd::Inlet { .. }), _] | [_, Some(ModelEnd::Outlet(_))] => false,
        [_, Some(ModelEnd::Inlet { .. })] | [Some(ModelEnd::Outlet(_)), _] => true,
        _ => pressure[start as usize] < pressure[end as usize],
    }
}

/// Checks that each component has an inlet and an outlet.
fn check_open(network: &Skeleton, supply: &Supply) -> Result<(), Closed> {
    let adjacency = network.adjacency();
    let components = network.components(&adjacency);
    let mut found = vec![[false; 2]; components.list.len()];
    for node in adjacency.terminals() {
        found[components.of_node[node.index()] as usize][usize::from(!supply.rates.contains_key(&node))] = true;
    }
    for (component, [inlet, outlet]) in components.list.iter().zip(found) {
        let missing = match [inlet, outlet] {
            [true, true] => continue,
            [false, _] => "inlet",
            [true, false] => "outlet",
        };
        return Err(Closed { node: component.nodes[0], missing });
    }
    Ok(())
}

#[cfg(test)]
mod tests;

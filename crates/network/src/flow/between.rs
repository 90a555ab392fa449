//! Poiseuille flow with given inflow and given pressures at the outlets.

use super::conductors::Conductors;
use super::conjugate_gradient::NotConverged;
use super::poiseuille::{NetworkFlow, resistance};
use anastomesh_skeleton::{NodeId, Skeleton};
use std::collections::BTreeMap;

/// Solves for the node pressures with a given pressure at each outlet. `inlets` holds terminals with their volume inflow
/// rate, at least 0; outlets that are not in `outlets` are at pressure 0. Each component needs an outlet.
///
/// ```
/// use anastomesh_network::flow::solve_between;
/// use anastomesh_skeleton::{NodeId, fixtures::network};
///
/// let points = [[0.0; 3], [0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [0.0, -1.0, 1.0]];
/// let fork = network(&points, 1.0, &[(0, 1), (1, 2), (1, 3)]);
/// // The pressure at the second outlet stops its flow.
/// let own = 8.0 * 2.0 / std::f64::consts::PI;
/// let outlets = [(NodeId(3), 3.0 * own)].into();
/// let flow = solve_between(&fork, &[(NodeId(0), 3.0)].into(), &outlets, 2.0)?;
/// assert!(flow.of_terminal[&NodeId(3)].abs() < 1e-12 && (flow.of_terminal[&NodeId(2)] - 3.0).abs() < 1e-12);
/// # Ok::<(), anastomesh_network::flow::NotConverged>(())
/// ```
///
/// # Errors
/// [`NotConverged`] with the residual, for networks with many loops.
pub fn solve_between(
    skeleton: &Skeleton,
    inlets: &BTreeMap<NodeId, f64>,
    outlets: &BTreeMap<NodeId, f64>,
    viscosity: f64,
) -> Result<NetworkFlow, NotConverged> {
    let adjacency = skeleton.adjacency();
    let terminals = adjacency.terminals();
    // Elimination needs inflows of at least 0: pressures are counted from the lowest outlet.
    let lowest = terminals.iter().filter(|node| !inlets.contains_key(node));
    let lowest = lowest.map(|node| outlets.get(node).copied().unwrap_or(0.0)).fold(f64::INFINITY, f64::min);
    let lowest = if lowest.is_finite() { lowest } else { 0.0 };
    let mut fixed: Vec<Option<f64>> = vec![None; skeleton.nodes.len()];
    for node in terminals.iter().filter(|node| !inlets.contains_key(node)) {
        fixed[node.index()] = Some(outlets.get(node).copied().unwrap_or(0.0) - lowest);
    }
    let mut network = Conductors::new(skeleton.nodes.len());
    for edge in skeleton.edge_ids() {
        let (conductance, [a, b]) = (1.0 / resistance(skeleton, edge, viscosity), skeleton.edge(edge).nodes);
        match [a, b].map(|node| fixed[node.index()]) {
            [None, None] => network.join([a.0, b.0], conductance),
            [None, Some(pressure)] => hold(&mut network, a, conductance, pressure),
            [Some(pressure), None] => hold(&mut network, b, conductance, pressure),
            [Some(_), Some(_)] => {}
        }
    }
    for (&node, &flow) in inlets {
        network.let_in(node.0, flow);
    }
    let mut pressure = network.pressures()?;
    for (pressure, fixed) in pressure.iter_mut().zip(&fixed) {
        *pressure = fixed.unwrap_or(*pressure) + lowest;
    }
    let through = |node: NodeId| {
        if let Some(&flow) = inlets.get(&node) {
            return flow;
        }
        let edge = adjacency.edges(node)[0];
        let other = skeleton.edge(edge).other(node);
        (pressure[other.index()] - pressure[node.index()]) / resistance(skeleton, edge, viscosity)
    };
    let of_terminal = terminals.iter().map(|&node| (node, through(node))).collect();
    Ok(NetworkFlow { pressure, of_terminal })
}

/// Joins a node to a given pressure.
fn hold(network: &mut Conductors, node: NodeId, conductance: f64, pressure: f64) {
    network.join_ground(node.0, conductance);
    network.let_in(node.0, conductance * pressure);
}

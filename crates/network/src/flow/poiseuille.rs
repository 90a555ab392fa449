//! Poiseuille flow with given inflow and zero pressure at the outlets.

use super::conductors::Conductors;
use super::conjugate_gradient::NotConverged;
use anastomesh_skeleton::{EdgeId, NodeId, Skeleton};
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Flow through a network.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NetworkFlow {
    /// Pressure of each node.
    pub pressure: Vec<f64>,
    /// Volume flow rate into each inlet and out of each outlet. Components without an outlet have no flow.
    pub of_terminal: BTreeMap<NodeId, f64>,
}

/// Minimum edge length relative to the radius: a zero length would give infinite conductance.
const SHORTEST: f64 = 1e-9;

/// Solves for the node pressures. `inlets` holds terminals with their volume inflow rate; all other terminals are
/// outlets at pressure 0.
///
/// # Errors
/// [`NotConverged`] with the residual, for networks with many loops.
pub fn solve(skeleton: &Skeleton, inlets: &BTreeMap<NodeId, f64>, viscosity: f64) -> Result<NetworkFlow, NotConverged> {
    solve_with_resistances(skeleton, inlets, &BTreeMap::new(), viscosity)
}

/// Solves for the node pressures with a resistance above 0 beyond some outlets, and pressure 0 behind it. `inlets` are as
/// in [`solve`]; outlets that are not in `resistances` are at pressure 0.
///
/// # Errors
/// [`NotConverged`] with the residual, for networks with many loops.
pub fn solve_with_resistances(
    skeleton: &Skeleton,
    inlets: &BTreeMap<NodeId, f64>,
    resistances: &BTreeMap<NodeId, f64>,
    viscosity: f64,
) -> Result<NetworkFlow, NotConverged> {
    let adjacency = skeleton.adjacency();
    let components = skeleton.components(&adjacency);
    let terminals = adjacency.terminals();
    let mut is_outlet = vec![false; skeleton.nodes.len()];
    let mut has_outlet = vec![false; components.list.len()];
    for node in terminals.iter().filter(|node| !inlets.contains_key(node)) {
        is_outlet[node.index()] = !resistances.contains_key(node);
        has_outlet[components.of_node[node.index()] as usize] = true;
    }
    let mut network = Conductors::new(skeleton.nodes.len());
    for edge in skeleton.edge_ids() {
        let (conductance, [a, b]) = (conductance(skeleton, edge, viscosity), skeleton.edge(edge).nodes);
        match [a, b].map(|node| is_outlet[node.index()]) {
            [false, false] => network.join([a.0, b.0], conductance),
            [false, true] => network.join_ground(a.0, conductance),
            [true, false] => network.join_ground(b.0, conductance),
            [true, true] => {}
        }
    }
    for (&node, &resistance) in resistances {
        network.join_ground(node.0, 1.0 / resistance);
    }
    let let_in = |node: NodeId, flow: f64| {
        if has_outlet[components.of_node[node.index()] as usize] { flow } else { 0.0 }
    };
    for (&node, &flow) in inlets {
        network.let_in(node.0, let_in(node, flow));
    }
    let pressure = network.pressures()?;
    let through = |node: NodeId| {
        if let Some(&flow) = inlets.get(&node) {
            return let_in(node, flow);
        }
        if let Some(&resistance) = resistances.get(&node) {
            return pressure[node.index()] / resistance;
        }
        let edge = adjacency.edges(node)[0];
        conductance(skeleton, edge, viscosity) * pressure[skeleton.edge(edge).other(node).index()]
    };
    let of_terminal = terminals.iter().map(|&node| (node, through(node))).collect();
    Ok(NetworkFlow { pressure, of_terminal })
}

/// Resistance of an edge, a straight cone, to Poiseuille flow: pressure per flow rate.
///
/// ```
/// use anastomesh_network::flow::resistance;
/// use anastomesh_skeleton::{EdgeId, fixtures::network};
///
/// let tube = network(&[[0.0; 3], [0.0, 0.0, 3.0]], 1.0, &[(0, 1)]);
/// assert!((resistance(&tube, EdgeId(0), 2.0) * std::f64::consts::PI / 48.0 - 1.0).abs() < 1e-15);
/// ```
#[must_use]
pub fn resistance(skeleton: &Skeleton, edge: EdgeId, viscosity: f64) -> f64 {
    1.0 / conductance(skeleton, edge, viscosity)
}

/// Conductance of a straight cone: 3 π a³ b³ / (8 μ L (a² + ab + b²)).
fn conductance(skeleton: &Skeleton, edge: EdgeId, viscosity: f64) -> f64 {
    let [a, b] = skeleton.edge(edge).radii;
    let length = skeleton.length(edge).max(SHORTEST * a.min(b));
    3.0 * PI * (a * b).powi(3) / (8.0 * viscosity * length * (a * a + a * b + b * b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_skeleton::fixtures::{network, tangle};

    fn solved(skeleton: &Skeleton, inlets: &[(u32, f64)]) -> NetworkFlow {
        solve(skeleton, &inlets.iter().map(|&(node, flow)| (NodeId(node), flow)).collect(), 2.0).unwrap()
    }

    #[test]
    fn a_tube_has_poiseuilles_resistance_and_a_cone_its_own() {
        let mut tube = network(&[[0.0; 3], [0.0, 0.0, 6.0], [0.0, 0.0, 9.0]], 1.5, &[(0, 1), (1, 2)]);
        let flow = solved(&tube, &[(0, 3.0)]);
        let expected = 3.0 * 8.0 * 2.0 * 9.0 / (PI * 1.5_f64.powi(4));
        assert!((flow.pressure[0] / expected - 1.0).abs() < 1e-14, "{flow:?}");
        assert_eq!(flow.of_terminal[&NodeId(0)], 3.0);
        assert!((flow.of_terminal[&NodeId(2)] - 3.0).abs() < 1e-14);
        // A cone is equivalent to its two halves.
        tube.edges = vec![tube.edges[0]];
        tube.edges[0].radii = [2.0, 1.0];
        tube.nodes.pop();
        let whole = solved(&tube, &[(0, 1.0)]).pressure[0];
        let mut halves = network(&[[0.0; 3], [0.0, 0.0, 3.0], [0.0, 0.0, 6.0]], 1.0, &[(0, 1), (1, 2)]);
        halves.edges[0].radii = [2.0, 1.5];
        halves.edges[1].radii = [1.5, 1.0];
        assert!((solved(&halves, &[(0, 1.0)]).pressure[0] / whole - 1.0).abs() < 1e-14);
    }

    #[test]
    fn resistances_beyond_outlets_divide_the_flow() {
        let points = [[0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 2.0], [-1.0, 0.0, 2.0]];
        let fork = network(&points, 0.2, &[(0, 1), (1, 2), (1, 3)]);
        let side = 8.0 * 2.0 * 2.0_f64.sqrt() / (PI * 0.2_f64.powi(4));
        let [inlets, resistances] = [[(NodeId(0), 3.0)], [(NodeId(2), side)]].map(BTreeMap::from);
        let flow = solve_with_resistances(&fork, &inlets, &resistances, 2.0).unwrap();
        // One side has twice the resistance of the other.
        assert!((flow.of_terminal[&NodeId(2)] - 1.0).abs() < 1e-14, "{flow:?}");
        assert!((flow.of_terminal[&NodeId(3)] - 2.0).abs() < 1e-14);
        assert!((flow.pressure[2] / side - 1.0).abs() < 1e-14);
        assert_eq!(flow.pressure[3], 0.0);
    }

    #[test]
    fn what_goes_in_comes_out() {
        let tree = tangle(12, 3);
        let flow = solved(&tree, &[(0, 1.0)]);
        let out: f64 = flow.of_terminal.iter().filter(|(node, _)| node.0 != 0).map(|(_, flow)| flow).sum();
        assert_eq!(flow.of_terminal.len(), 4097);
        assert!((out - 1.0).abs() < 1e-12, "{out}");
    }

    #[test]
    fn both_ways_round_a_loop_are_taken() {
        let points = [[0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 2.0], [-1.0, 0.0, 2.0], [0.0, 0.0, 3.0], [0.0, 0.0, 4.0]];
        let ring = network(&points, 0.2, &[(0, 1), (1, 2), (1, 3), (2, 4), (3, 4), (4, 5)]);
        let flow = solved(&ring, &[(0, 1.0)]);
        assert!((flow.pressure[2] / flow.pressure[3] - 1.0).abs() < 1e-14);
        let [long, short] = [8.0_f64.sqrt() / 2.0, 1.0].map(|length| 8.0 * 2.0 * length / (PI * 0.2_f64.powi(4)));
        assert!((flow.pressure[0] / (2.0 * short + long) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn nothing_goes_into_a_closed_component() {
        let two = network(&[[0.0; 3], [0.0, 0.0, 1.0], [5.0, 0.0, 0.0], [5.0, 0.0, 1.0]], 0.2, &[(0, 1), (2, 3)]);
        let flow = solved(&two, &[(0, 1.0), (2, 1.0), (3, 1.0)]);
        let of_terminal: Vec<f64> = flow.of_terminal.into_values().collect();
        assert!((of_terminal[1] - 1.0).abs() < 1e-14);
        assert_eq!([of_terminal[0], of_terminal[2], of_terminal[3]], [1.0, 0.0, 0.0]);
        assert_eq!(flow.pressure[1..], [0.0; 3]);
    }
}

//! One-dimensional flow of whole organs: total inflow equals outflow, and every node is balanced.

use crate::common;
use anastomesh::network::Skeleton;
use anastomesh::skeleton::NodeId;
use anastomesh::testing::network_flow;
use std::collections::BTreeMap;
use std::f64::consts::PI;

/// Conductance of each edge, for a viscosity of 1.
fn conductances(skeleton: &Skeleton) -> Vec<f64> {
    let of = |edge: &anastomesh::skeleton::Edge| {
        let [a, b] = edge.radii;
        let [p, q] = edge.nodes.map(|node| skeleton.nodes[node.0 as usize].position);
        3.0 * PI * (a * b).powi(3) / (8.0 * (q - p).norm() * (a * a + a * b + b * b))
    };
    skeleton.edges.iter().map(of).collect()
}

fn balanced(name: &str, outlets: usize) {
    let Some(shared) = common::shared() else { return };
    let skeleton = common::network(&shared.join("data/kidney").join(name));
    let terminals = skeleton.adjacency().terminals();
    let radius = |node: NodeId| skeleton.nodes[node.0 as usize].radius;
    let inlet = terminals.iter().copied().max_by(|&a, &b| radius(a).total_cmp(&radius(b))).expect("a terminal");
    let flow = network_flow(&skeleton, &BTreeMap::from([(inlet, 1.0)]), 1.0).expect("pressures");
    let out: Vec<f64> = terminals.iter().filter(|&&node| node != inlet).map(|node| flow.of_terminal[node]).collect();
    assert_eq!(out.len(), outlets);
    assert!((out.iter().sum::<f64>() - 1.0).abs() < 1e-10, "{}", out.iter().sum::<f64>());
    assert!(out.iter().all(|&flow| flow >= 0.0));
    // Flows are pressure differences: their rounding errors are small relative to the flow through the node.
    let mut balance = vec![[0.0_f64; 2]; skeleton.nodes.len()];
    for (edge, g) in skeleton.edges.iter().zip(conductances(&skeleton)) {
        let [p, q] = edge.nodes.map(|node| flow.pressure[node.0 as usize]);
        for (node, flow) in edge.nodes.into_iter().zip([g * (p - q), g * (q - p)]) {
            balance[node.0 as usize][0] += flow;
            balance[node.0 as usize][1] += flow.abs() + 1e-12 * g * p.max(q);
        }
    }
    let adjacency = skeleton.adjacency();
    for (node, [sum, all]) in (0..).map(NodeId).zip(&balance) {
        assert!(adjacency.valence(node) < 2 || sum.abs() <= 1e-6 * all, "{node:?}: {sum} of {all}");
    }
}

#[test]
fn a_tree_of_thirty_thousand_outlets() {
    balanced("tree_refined.vtp", 29_608);
}

#[test]
fn arteries_and_veins_that_share_thirty_thousand_loops() {
    balanced("artery_vein_refined.vtp", 1);
}

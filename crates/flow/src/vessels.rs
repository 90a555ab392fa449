//! One-dimensional solution by vessel.

use anastomesh_network::flow::{NetworkFlow, resistance};
use anastomesh_skeleton::{EdgeId, NodeId, Skeleton};
use serde::Serialize;
use std::f64::consts::PI;

/// Steady flow through the edges of a network.
#[derive(Clone, Debug, PartialEq)]
pub struct VesselFlow {
    /// Pressure by node.
    pub pressure: Vec<f64>,
    /// Flow rate by edge, from its first to its second node.
    pub flow: Vec<f64>,
    /// Wall shear stress by edge, at its mean radius.
    pub shear: Vec<f64>,
}

/// Vessel in a table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct VesselRow {
    /// Nodes at both ends, by their index in the file, along the flow.
    pub nodes: [u32; 2],
    /// Arc length.
    pub length: f64,
    /// Mean radius.
    pub radius: f64,
    /// Pressure drop per flow rate.
    pub resistance: f64,
    /// Flow rate, not negative.
    pub flow: f64,
    /// Pressures at both ends.
    pub pressures: [f64; 2],
    /// Mean wall shear stress.
    pub shear: f64,
}

/// Wall shear stress of Poiseuille flow: 4 μ Q / (π r³).
pub(super) fn poiseuille_shear(viscosity: f64, flow: f64, radius: f64) -> f64 {
    4.0 * viscosity * flow.abs() / (PI * radius.powi(3))
}

impl VesselFlow {
    /// Flow rates and shear stresses from pressures.
    pub fn of(network: &Skeleton, solved: &NetworkFlow, viscosity: f64) -> Self {
        let pressure = solved.pressure.clone();
        let rate = |edge: EdgeId| {
            let [a, b] = network.edge(edge).nodes.map(|node| pressure[node.index()]);
            (a - b) / resistance(network, edge, viscosity)
        };
        let flow: Vec<f64> = network.edge_ids().map(rate).collect();
        let shear = network.edge_ids().zip(&flow);
        let shear = shear.map(|(edge, &flow)| poiseuille_shear(viscosity, flow, network.edge(edge).mean_radius()));
        Self { shear: shear.collect(), flow, pressure }
    }

    /// Rows of a table, one per branch (`lumped`) or edge.
    pub fn rows(&self, network: &Skeleton, viscosity: f64, lumped: bool) -> Vec<VesselRow> {
        if !lumped {
            let row = |edge| self.row(network, viscosity, &network.edge(edge).nodes, &[edge]);
            return network.edge_ids().map(row).collect();
        }
        let branches = network.branches(&network.adjacency()).list;
        branches.iter().map(|branch| self.row(network, viscosity, &branch.nodes, &branch.edges)).collect()
    }

    fn row(&self, network: &Skeleton, viscosity: f64, nodes: &[NodeId], edges: &[EdgeId]) -> VesselRow {
        let length: f64 = edges.iter().map(|&edge| network.length(edge)).sum();
        let mean = |value: &dyn Fn(EdgeId) -> f64| {
            edges.iter().map(|&edge| network.length(edge) * value(edge)).sum::<f64>() / length.max(f64::MIN_POSITIVE)
        };
        let resistance: f64 = edges.iter().map(|&edge| resistance(network, edge, viscosity)).sum();
        let mut ends = [nodes[0], nodes[nodes.len() - 1]];
        if self.pressure[ends[0].index()] < self.pressure[ends[1].index()] {
            ends.reverse();
        }
        let pressures = ends.map(|node| self.pressure[node.index()]);
        VesselRow {
            nodes: ends.map(|node| network.node(node).original),
            length,
            radius: mean(&|edge| network.edge(edge).mean_radius()),
            resistance,
            flow: (pressures[0] - pressures[1]) / resistance,
            pressures,
            shear: mean(&|edge| self.shear[edge.index()]),
        }
    }
}

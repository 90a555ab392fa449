//! Reader of zero-dimensional models with positions.

use crate::network::content::{NetworkFile, NetworkOptions};
use crate::network::polylines::{Polylines, Radii};
use anastomesh_mesh::geometry::Point3;
use anastomesh_skeleton::NodeId;
use serde::Deserialize;
use serde_json::Value;

/// Errors of a zero-dimensional model.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SvZeroDError {
    /// The model has no positions.
    #[error(
        "a svZeroDSolver model without positions: write it with `anastomesh flow`, or give the network that it was made of"
    )]
    NoPositions,
    /// A part of the model has another form than this program writes.
    #[error("{what}: {source}; write the model again")]
    Form {
        /// Part of the model.
        what: &'static str,
        /// Error of the JSON reader.
        source: serde_json::Error,
    },
    /// A vessel has another number of radii than of ends of edges.
    #[error("vessel {vessel}: the list of nodes has length {nodes}, and that of radii {radii}; give 2 radii per edge")]
    Radii {
        /// Number of the vessel, from 0.
        vessel: usize,
        /// Number of nodes.
        nodes: usize,
        /// Number of radii.
        radii: usize,
    },
    /// A vessel refers to a missing node.
    #[error("vessel {vessel} refers to node {node}, and there are {nodes} nodes; correct it")]
    NoNode {
        /// Number of the vessel, from 0.
        vessel: usize,
        /// Node.
        node: u32,
        /// Number of nodes.
        nodes: usize,
    },
    /// The number of nodes exceeds the index range.
    #[error("too many nodes for 32-bit indices ({})", u32::MAX)]
    TooMany,
}

#[derive(Deserialize)]
struct Nodes {
    nodes: Vec<[f64; 4]>,
}

#[derive(Deserialize)]
struct Vessel {
    nodes: Vec<u32>,
    radii: Vec<f64>,
    #[serde(default)]
    boundary_conditions: Option<Conditions>,
}

#[derive(Deserialize)]
struct Conditions {
    #[serde(default)]
    inlet: Option<String>,
}

/// True if a JSON object is a model of the solver.
pub(in crate::network) fn is_model(whole: &Value) -> bool {
    whole.get("vessels").is_some_and(Value::is_array) && whole.get("simulation_parameters").is_some()
}

/// Reads a model. Terminals with a flow rate are roots.
pub(in crate::network) fn read(whole: Value, _: &NetworkOptions) -> Result<NetworkFile, SvZeroDError> {
    let Value::Object(mut whole) = whole else { return Err(SvZeroDError::NoPositions) };
    let nodes = whole.remove("network").ok_or(SvZeroDError::NoPositions)?;
    let form = |what| move |source| SvZeroDError::Form { what, source };
    let Nodes { nodes } = serde_json::from_value(nodes).map_err(form("nodes of the network"))?;
    let vessels = whole.remove("vessels").unwrap_or_default();
    let vessels: Vec<Vessel> = serde_json::from_value(vessels).map_err(form("vessels"))?;
    check(&vessels, nodes.len())?;
    let edges: usize = vessels.iter().map(|vessel| vessel.nodes.len() - 1).sum();
    let polylines = Polylines {
        points: nodes.iter().map(|&[x, y, z, _]| Point3::new(x, y, z)).collect(),
        ends: (1..=edges).map(|i| 2 * i).collect(),
        path: vessels.iter().flat_map(|vessel| vessel.nodes.windows(2).flatten().copied()).collect(),
    };
    let mut network = NetworkFile::default();
    if !polylines.fits(&network.skeleton) {
        return Err(SvZeroDError::TooMany);
    }
    let inlet =
        |vessel: &Vessel| vessel.boundary_conditions.as_ref()?.inlet.as_ref().and(vessel.nodes.first().copied());
    network.roots = vessels.iter().filter_map(inlet).map(NodeId).collect();
    let radii = Radii {
        nodes: Some(nodes.iter().map(|node| node[3]).collect()),
        corners: Some(vessels.into_iter().flat_map(|vessel| vessel.radii).collect()),
        lines: None,
    };
    polylines.append_to(&mut network.skeleton, &radii);
    Ok(network)
}

fn check(vessels: &[Vessel], nodes: usize) -> Result<(), SvZeroDError> {
    for (number, vessel) in vessels.iter().enumerate() {
        let (own, radii) = (vessel.nodes.len(), vessel.radii.len());
        if own < 2 || radii != 2 * (own - 1) {
            return Err(SvZeroDError::Radii { vessel: number, nodes: own, radii });
        }
        if let Some(&node) = vessel.nodes.iter().find(|&&node| node as usize >= nodes) {
            return Err(SvZeroDError::NoNode { vessel: number, node, nodes });
        }
    }
    Ok(())
}

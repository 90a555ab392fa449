//! Reader of nodes and links.

use super::vessels::{self, VesselListError};
use crate::network::columns::Value;
use crate::network::content::{NetworkFile, NetworkOptions};
use crate::network::graph::{Graph, GraphFault, GraphPlace};
use crate::network::svzerod::{self, SvZeroDError};
use serde_json::{Map, Value as Json};

/// Errors of a JSON network.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JsonError {
    /// The JSON is malformed.
    #[error("invalid JSON: {0}; correct the file, or copy it again if it is truncated")]
    Json(#[from] serde_json::Error),
    /// A list is missing.
    #[error("the outermost object has no list '{list}': write the graph as node-link data")]
    NoList {
        /// Name of the missing list.
        list: &'static str,
    },
    /// An entry of a list is not an object, or lacks a key.
    #[error("{place}: '{key}' is missing: give a word or a number")]
    NoKey {
        /// Place in the file.
        place: GraphPlace,
        /// Key.
        key: &'static str,
    },
    /// The graph is not a valid network.
    #[error(transparent)]
    Graph(#[from] GraphFault),
    /// The zero-dimensional model is not a valid network.
    #[error(transparent)]
    Model(#[from] SvZeroDError),
    /// The list of vessels is not a valid network.
    #[error(transparent)]
    Vessels(#[from] VesselListError),
}

pub(in crate::network) fn read(bytes: &[u8], options: &NetworkOptions) -> Result<NetworkFile, JsonError> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let whole: Json = serde_json::from_slice(bytes)?;
    if svzerod::is_model(&whole) {
        return Ok(svzerod::read(whole, options)?);
    }
    if vessels::is_vessel_list(&whole) {
        return Ok(vessels::read(&whole, options)?);
    }
    let list = |names: &[&str]| names.iter().find_map(|name| whole.get(name)).and_then(Json::as_array);
    let nodes = list(&["nodes"]).ok_or(JsonError::NoList { list: "nodes" })?;
    // NetworkX called edges links before version 3.4.
    let edges = list(&["edges", "links"]).ok_or(JsonError::NoList { list: "edges" })?;
    let mut graph = Graph::default();
    for (at, node) in nodes.iter().enumerate() {
        let place = GraphPlace::Node(at);
        let row = graph.node(&name(node, "id", place)?, place)?;
        for (key, value) in attributes(node, &["id"]) {
            graph.nodes.set(row, key, value);
        }
    }
    for (at, edge) in edges.iter().enumerate() {
        let place = GraphPlace::Edge(at);
        let (from, to) = (name(edge, "source", place)?, name(edge, "target", place)?);
        let row = graph.edge([&from, &to], place)?;
        for (key, value) in attributes(edge, &["source", "target", "key"]) {
            graph.edges.set(row, key, value);
        }
    }
    Ok(graph.into_network(options)?)
}

/// Node name under a key of an entry: a word, a number, or a list of these.
fn name(entry: &Json, key: &'static str, place: GraphPlace) -> Result<String, JsonError> {
    match entry.get(key) {
        Some(Json::String(word)) => Ok(word.clone()),
        Some(value @ (Json::Number(_) | Json::Array(_))) => Ok(value.to_string()),
        _ => Err(JsonError::NoKey { place, key }),
    }
}

/// Attributes of an entry, except node names.
fn attributes<'a>(entry: &'a Json, but: &'a [&str]) -> impl Iterator<Item = (&'a str, Value)> {
    let entries = entry.as_object().into_iter().flat_map(Map::iter);
    entries.filter(|(key, _)| !but.contains(&key.as_str())).filter_map(|(key, value)| {
        let value = match value {
            Json::Number(number) => Value::Number(number.as_f64()?),
            Json::String(text) => Value::of(text),
            Json::Array(list) => {
                let numbers: Option<Vec<f64>> = list.iter().take(4).map(Json::as_f64).collect();
                Value::List(numbers.filter(|n| !n.is_empty())?)
            }
            _ => return None,
        };
        Some((key.as_str(), value))
    })
}

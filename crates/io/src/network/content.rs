//! Network file contents, reader options, and additional arrays.

use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::units::{counted, place};
use anastomesh_skeleton::{LineGroup, NodeId, Skeleton};
use serde::Serialize;
use std::fmt;

/// Options for reading a network.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct NetworkOptions {
    /// Name of the radius array (on points, cells or both); detected by its name if `None`.
    pub radius_array: Option<String>,
    /// Radius of all vessels of a file without radii.
    pub radius: Option<f64>,
    /// Treat all radii as diameters. Otherwise only arrays with such a name are halved.
    pub diameters: bool,
    /// Factor on radii, for a unit that differs from that of the positions.
    pub radius_scale: Option<f64>,
    /// Factor on positions and radii, such as 1e-6 from micrometres to metres.
    pub scale: Option<f64>,
    /// Name of a node array whose values are kept with the network.
    pub node_array: Option<String>,
    /// Keep unusable radii (zero, negative, infinite, NaN) for `prepare` to replace. By default they are an error.
    pub any_radii: bool,
}

anastomesh_mesh::setters!(NetworkOptions {
    radius_array: impl Into<Option<String>>,
    radius: impl Into<Option<f64>>,
    diameters: bool,
    radius_scale: impl Into<Option<f64>>,
    scale: impl Into<Option<f64>>,
    node_array: impl Into<Option<String>>,
    any_radii: bool,
});

/// Network as stored in its file; `skeleton::clean` makes it usable.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NetworkFile {
    /// Nodes in the file's order, and edges in the order of its lines.
    pub skeleton: Skeleton,
    /// Notes on decisions of the reader.
    pub notes: Vec<NetworkNote>,
    /// Node names in the file.
    pub names: NodeNames,
    /// Nodes that the file declares as roots, in its order.
    pub roots: Vec<NodeId>,
    /// Vessel of each node's line; empty if the file does not have this information.
    pub groups: Vec<Option<LineGroup>>,
    /// Values of the requested node array, one per node; else empty.
    pub node_values: Vec<f64>,
}

/// Node names of a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum NodeNames {
    /// No names: nodes are numbered from 0.
    #[default]
    Order,
    /// Numeric ids.
    Ids(Vec<i64>),
    /// Text names.
    Words(Vec<String>),
}

impl NodeNames {
    /// Finds the node with a name.
    pub fn find(&self, name: &str, nodes: usize) -> Option<NodeId> {
        let at = match self {
            Self::Order => name.parse().ok().filter(|&at| at < nodes),
            Self::Ids(ids) => name.parse().ok().and_then(|id: i64| ids.iter().position(|&i| i == id)),
            Self::Words(words) => words.iter().position(|w| w == name),
        };
        at.map(|at| NodeId(at as u32))
    }

    /// Names a further node, which is a copy of another one.
    pub fn add_copy(&mut self, node: NodeId) {
        match self {
            Self::Order => {}
            Self::Ids(ids) => ids.push(ids.iter().max().map_or(0, |id| id.saturating_add(1))),
            Self::Words(words) => {
                let Some(word) = words.get(node.index()) else { return };
                let free = (2..words.len() + 3).map(|k| format!("{word}_{k}")).find(|name| !words.contains(name));
                words.extend(free);
            }
        }
    }

    /// Name of a node.
    pub fn of(&self, node: NodeId) -> String {
        let named = match self {
            Self::Order => None,
            Self::Ids(ids) => ids.get(node.index()).map(ToString::to_string),
            Self::Words(words) => words.get(node.index()).cloned(),
        };
        named.unwrap_or_else(|| node.0.to_string())
    }
}

/// Decision of a reader that the user should know.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "note", rename_all = "snake_case")]
#[non_exhaustive]
pub enum NetworkNote {
    /// Node radii come from this point array.
    NodeRadii {
        /// Array name.
        array: String,
    },
    /// Each line has its own radius, from this cell array; node radii are used for nodes only.
    EdgeRadii {
        /// Array name.
        array: String,
    },
    /// The file has no radii: all vessels have the given one.
    NoRadii,
    /// There are no point radii: a node has the radius of its thickest edge.
    NodeRadiiFromEdges,
    /// The array name indicates diameters: the values were halved.
    Halved {
        /// Array name.
        array: String,
    },
    /// Other arrays are possible radii and were not used.
    NotUsed {
        /// Array names.
        arrays: Vec<String>,
    },
    /// The arrays `GroupIds` and `Blanking` assign lines to vessels.
    Grouped {
        /// Number of vessels, excluding the interiors of branchings.
        vessels: usize,
    },
    /// Cells other than lines were ignored.
    OtherCells {
        /// Number of ignored cells.
        count: usize,
    },
    /// There are no z coordinates: all nodes have z = 0.
    Planar,
    /// All radii were halved on request.
    Diameters,
    /// Positions and radii were scaled.
    Scaled {
        /// Factor on positions.
        positions: f64,
        /// Factor on radii.
        radii: f64,
    },
    /// Vessels leave the surface around the tissue. They were cut, or it is opened for them.
    Cut {
        /// Number of cuts.
        vessels: usize,
        /// Number of openings.
        openings: usize,
        /// Name of the node at the first of both.
        node: String,
        /// Its place.
        at: [f64; 3],
        /// Number of nodes that were removed.
        removed: usize,
    },
    /// Length units of the file and of the result.
    Unit {
        /// Unit in the file.
        from: &'static str,
        /// Unit of the result.
        to: &'static str,
    },
    /// Edges were read from a second file.
    EdgesFrom {
        /// File name.
        file: String,
    },
    /// Vessels of a joint end at different places and were connected by short vessels.
    Bridged {
        /// Number of added vessels.
        count: usize,
    },
    /// The radii are so large or small relative to the network that units may be inconsistent.
    OutOfProportion {
        /// Largest radius.
        radius: f64,
        /// Diagonal of the network's bounding box.
        extent: f64,
    },
}

impl fmt::Display for NetworkNote {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::NodeRadii { array } => write!(f, "node radii: array '{array}' on the points"),
            Self::EdgeRadii { array } => write!(f, "vessel radii: array '{array}' on the lines"),
            Self::NoRadii => write!(f, "the file has no radii: all vessels get the given one"),
            Self::NodeRadiiFromEdges => {
                write!(f, "no node radii: each node gets the radius of its thickest vessel")
            }
            Self::Halved { array } => write!(f, "array '{array}' has the name of a diameter: values halved"),
            Self::NotUsed { arrays } => {
                write!(f, "unused arrays that may be radii: {}", arrays.join(", "))
            }
            Self::Grouped { vessels } => {
                write!(f, "arrays GroupIds and Blanking: lines of {}", counted(*vessels, "vessel"))
            }
            Self::OtherCells { count } => write!(f, "{} other than lines ignored", counted(*count, "cell")),
            Self::Planar => write!(f, "no z coordinates: all nodes have z = 0"),
            Self::Diameters => write!(f, "radii halved (--diameters)"),
            Self::Scaled { positions, radii } => {
                write!(f, "positions multiplied by {positions}, radii by {radii}")
            }
            Self::Cut { vessels, openings, node, at, removed } => {
                let (cut, opened) = (counted(*vessels, "vessel"), counted(*openings, "opening"));
                let (at, removed) = (place(*at), counted(*removed, "node"));
                write!(
                    f,
                    "surface around the tissue: {cut} cut, {removed} removed, {opened}, first at node {node}, {at}"
                )
            }
            Self::Unit { from, to } if from == to => write!(f, "lengths in {from}"),
            Self::Unit { from, to } => write!(f, "lengths converted from {from} to {to}"),
            Self::EdgesFrom { file } => write!(f, "edges read from {file}"),
            Self::Bridged { count } => {
                write!(f, "{} added between joints and vessel ends", counted(*count, "short vessel"))
            }
            Self::OutOfProportion { radius, extent } => {
                write!(f, "the largest radius is {radius} in a network of extent {extent}: check the units")
            }
        }
    }
}

/// Values of nodes or edges.
#[derive(Clone, Debug, PartialEq)]
pub enum NetworkArray {
    /// Integers, one per node.
    NodeInts(&'static str, Vec<u32>),
    /// Vectors, one per node.
    NodeVectors(&'static str, Vec<[f64; 3]>),
    /// Numbers, one per node.
    NodeFloats(&'static str, Vec<f64>),
    /// Numbers, one per edge.
    EdgeFloats(&'static str, Vec<f64>),
}

/// Additional arrays of a refined network: `OriginalNode`, the input node of each node, and `Displacement`, its
/// displacement from `origin`.
///
/// ```
/// use anastomesh_io::network::refinement_arrays;
/// use anastomesh_io::{NetworkOptions, read_network, write_network};
///
/// let network = read_network("../../fixtures/tree_30.swc".as_ref(), &NetworkOptions::default())?.skeleton;
/// let unchanged: Vec<_> = network.nodes.iter().map(|node| node.position).collect();
/// let folder = tempfile::tempdir()?;
/// write_network(&folder.path().join("refined.vtp"), &network, &refinement_arrays(&network, &unchanged))?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn refinement_arrays(skeleton: &Skeleton, origin: &[Point3]) -> Vec<NetworkArray> {
    let moved = skeleton.nodes.iter().zip(origin).map(|(n, o)| (n.position - o).into());
    vec![
        NetworkArray::NodeInts("OriginalNode", skeleton.nodes.iter().map(|n| n.original).collect()),
        NetworkArray::NodeVectors("Displacement", moved.collect()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_of_nodes_get_free_names() {
        let mut order = NodeNames::Order;
        order.add_copy(NodeId(0));
        assert_eq!(order.of(NodeId(3)), "3");
        let mut ids = NodeNames::Ids(vec![7, 9, 2]);
        ids.add_copy(NodeId(0));
        assert_eq!(ids.of(NodeId(3)), "10");
        let mut words = NodeNames::Words(vec!["a".into(), "a_2".into()]);
        words.add_copy(NodeId(0));
        assert_eq!(words.of(NodeId(2)), "a_3");
    }
}

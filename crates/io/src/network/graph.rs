//! Graphs with named nodes, and edges that refer to names: the common part of GraphML, JSON, Pajek and tables.

use super::columns::{Columns, NoNumber, Value};
use super::content::{NetworkFile, NetworkNote, NetworkOptions, NodeNames};
use super::polylines::{Polylines, Radii};
use super::radii::{Choice, NodeArrayFault, RadiusFault, node_array};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::units::counted;
use rustc_hash::FxHashMap;
use std::fmt;

/// Position in a file: a line, a byte, or a list entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GraphPlace {
    /// Line number, from 1.
    Line(usize),
    /// Byte offset, from 0.
    Byte(usize),
    /// Index in the list of nodes, from 0.
    Node(usize),
    /// Index in the list of edges, from 0.
    Edge(usize),
}

impl fmt::Display for GraphPlace {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::Node(node) => write!(f, "node {node} of the list (from 0)"),
            Self::Edge(edge) => write!(f, "edge {edge} of the list (from 0)"),
        }
    }
}

/// Errors of a graph.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GraphFault {
    /// There are no nodes.
    #[error("the file has no nodes: is it a graph with positions?")]
    NoNodes,
    /// There are no edges.
    #[error("the file has no edges ({}): a network needs vessels", counted(*nodes, "node"))]
    NoEdges {
        /// Number of nodes.
        nodes: usize,
    },
    /// Two nodes have an equal name.
    #[error("{place}: duplicate node '{name}', first defined at {first}; names must differ")]
    RepeatedNode {
        /// Place in the file.
        place: GraphPlace,
        /// Name in the file.
        name: String,
        /// Place of the first one.
        first: GraphPlace,
    },
    /// An edge refers to a missing node.
    #[error("{place}: an edge ends at the unknown node '{name}': correct it")]
    UnknownNode {
        /// Place in the file.
        place: GraphPlace,
        /// Name in the file.
        name: String,
    },
    /// No positions are known.
    #[error(
        "the nodes have no coordinates: give attributes x, y (and z), or a list named position, pos or coords; found: {}",
        if available.is_empty() { "none".to_owned() } else { available.join(", ") }
    )]
    NoPositions {
        /// Names of the node attributes.
        available: Vec<String>,
    },
    /// A node has no position.
    #[error("{place}: node '{name}' has no {what}: complete it")]
    NoPosition {
        /// Place in the file.
        place: GraphPlace,
        /// Name in the file.
        name: String,
        /// Item.
        what: String,
    },
    /// A value is not a number.
    #[error("{place}: {what} is '{text}', not a number: correct it")]
    NotANumber {
        /// Place in the file.
        place: GraphPlace,
        /// Item.
        what: String,
        /// Text that was found.
        text: String,
    },
    /// No attribute is usable as radius.
    #[error(transparent)]
    Radius(#[from] RadiusFault),
    /// The requested node array is not usable.
    #[error(transparent)]
    NodeArray(#[from] NodeArrayFault),
    /// The number of nodes or edges exceeds the index range.
    #[error("too many nodes for 32-bit indices ({})", u32::MAX)]
    TooMany,
}

/// Graph as stored in its file.
#[derive(Debug, Default)]
pub(super) struct Graph {
    names: Vec<String>,
    index: FxHashMap<String, u32>,
    /// Position of each node in the file.
    nodes_at: Vec<GraphPlace>,
    /// Attributes of nodes.
    pub nodes: Columns,
    ends: Vec<[String; 2]>,
    edges_at: Vec<GraphPlace>,
    /// Attributes of edges.
    pub edges: Columns,
}

/// Names of coordinate attributes.
const X: &[&str] = &["x", "posx", "xpos", "px", "coordx", "xcoord", "xcoordinate", "positionx", "vx", "x0"];
const Y: &[&str] = &["y", "posy", "ypos", "py", "coordy", "ycoord", "ycoordinate", "positiony", "vy", "y0"];
const Z: &[&str] = &["z", "posz", "zpos", "pz", "coordz", "zcoord", "zcoordinate", "positionz", "vz", "z0"];
/// Names of position attributes.
const POSITION: &[&str] =
    &["position", "pos", "coords", "coordinates", "coord", "coordinate", "xyz", "point", "vcoords"];

impl Graph {
    /// Adds a node and returns its row.
    pub(super) fn node(&mut self, name: &str, place: GraphPlace) -> Result<u32, GraphFault> {
        let row = self.names.len() as u32;
        if row == u32::MAX {
            return Err(GraphFault::TooMany);
        }
        if let Some(&before) = self.index.get(name) {
            let first = self.nodes_at[before as usize];
            return Err(GraphFault::RepeatedNode { place, name: short(name), first });
        }
        self.index.insert(name.to_owned(), row);
        self.names.push(name.to_owned());
        self.nodes_at.push(place);
        Ok(row)
    }

    /// Adds an edge between two nodes, which may be added later, and returns its row.
    pub(super) fn edge(&mut self, ends: [&str; 2], place: GraphPlace) -> Result<u32, GraphFault> {
        let row = self.ends.len() as u32;
        if row == u32::MAX {
            return Err(GraphFault::TooMany);
        }
        self.ends.push(ends.map(str::to_owned));
        self.edges_at.push(place);
        Ok(row)
    }

    /// Converts the graph to a network.
    pub(super) fn into_network(self, options: &NetworkOptions) -> Result<NetworkFile, GraphFault> {
        if self.names.is_empty() {
            return Err(GraphFault::NoNodes);
        }
        if self.ends.is_empty() {
            return Err(GraphFault::NoEdges { nodes: self.names.len() });
        }
        let path = self.path()?;
        let positions = self.positions()?;
        let choice = Choice::of(self.nodes.names(), self.edges.names(), options)?;
        let of_nodes = choice.points.as_deref().map(|name| {
            let numbers = self.nodes.numbers(name, self.names.len());
            numbers.map(|n| choice.radii(name, n)).map_err(|bad| no_number(&bad, name, &self.nodes_at))
        });
        let of_edges = choice.cells.as_deref().map(|name| {
            let numbers = self.edges.numbers(name, self.ends.len());
            numbers.map(|n| choice.radii(name, n)).map_err(|bad| no_number(&bad, name, &self.edges_at))
        });
        let radii = Radii { nodes: of_nodes.transpose()?, lines: of_edges.transpose()?, corners: None };
        let mut notes = choice.notes();
        if positions.planar {
            notes.push(NetworkNote::Planar);
        }
        let values = node_array(self.nodes.names(), options)?.map(|name| {
            let numbers = self.nodes.numbers(&name, self.names.len());
            numbers.map_err(|bad| no_number(&bad, &name, &self.nodes_at))
        });
        let node_values = values.transpose()?.unwrap_or_default();
        let ends = (1..=self.ends.len()).map(|i| 2 * i).collect();
        let polylines = Polylines { points: positions.points, ends, path };
        let mut network =
            NetworkFile { notes, names: NodeNames::Words(self.names), node_values, ..NetworkFile::default() };
        if !polylines.fits(&network.skeleton) {
            return Err(GraphFault::TooMany);
        }
        polylines.append_to(&mut network.skeleton, &radii);
        Ok(network)
    }

    /// Nodes of all edges.
    fn path(&self) -> Result<Vec<u32>, GraphFault> {
        let mut path = Vec::with_capacity(2 * self.ends.len());
        for (ends, &place) in self.ends.iter().zip(&self.edges_at) {
            for name in ends {
                let node = self.index.get(name).ok_or_else(|| GraphFault::UnknownNode { place, name: short(name) })?;
                path.push(*node);
            }
        }
        Ok(path)
    }

    fn positions(&self) -> Result<Positions, GraphFault> {
        let (x, y, z) = (self.nodes.find(X), self.nodes.find(Y), self.nodes.find(Z));
        let list = self.nodes.find(POSITION);
        match (x, y, list) {
            // Two coordinates beside a list of three are those of a drawing: NetworkX writes 0 0 in Pajek files.
            (_, _, Some(list)) if z.is_none() && self.is_spatial(list) => self.placed_by_lists(list),
            (Some(x), Some(y), _) => self.placed_by_coordinates([Some(x), Some(y), z]),
            (_, _, Some(list)) => self.placed_by_lists(list),
            _ => Err(GraphFault::NoPositions { available: self.nodes.names().to_vec() }),
        }
    }

    /// True if the first value of an attribute is a list of three numbers.
    fn is_spatial(&self, name: &str) -> bool {
        matches!(self.nodes.values(name, 1)[0], Some(Value::List(list)) if list.len() == 3)
    }

    fn placed_by_coordinates(&self, names: [Option<&str>; 3]) -> Result<Positions, GraphFault> {
        let mut points = vec![Point3::origin(); self.names.len()];
        for (axis, name) in names.iter().enumerate() {
            let Some(name) = name else { continue };
            let numbers =
                self.nodes.numbers(name, points.len()).map_err(|bad| no_number(&bad, name, &self.nodes_at))?;
            for (row, number) in numbers.into_iter().enumerate() {
                if number.is_nan() {
                    return Err(self.no_position(row, name));
                }
                points[row][axis] = number;
            }
        }
        Ok(Positions { points, planar: names[2].is_none() })
    }

    fn placed_by_lists(&self, name: &str) -> Result<Positions, GraphFault> {
        let mut planar = true;
        let mut points = Vec::with_capacity(self.names.len());
        for (row, value) in self.nodes.values(name, self.names.len()).into_iter().enumerate() {
            points.push(match value {
                Some(Value::List(list)) if list.len() == 2 => Point3::new(list[0], list[1], 0.0),
                Some(Value::List(list)) if list.len() == 3 => {
                    planar = false;
                    Point3::new(list[0], list[1], list[2])
                }
                _ => return Err(self.no_position(row, name)),
            });
        }
        Ok(Positions { points, planar })
    }

    fn no_position(&self, row: usize, what: &str) -> GraphFault {
        GraphFault::NoPosition { place: self.nodes_at[row], name: short(&self.names[row]), what: short(what) }
    }
}

struct Positions {
    points: Vec<Point3>,
    /// True if no node has a z coordinate.
    planar: bool,
}

fn no_number(bad: &NoNumber, what: &str, places: &[GraphPlace]) -> GraphFault {
    GraphFault::NotANumber { place: places[bad.row as usize], what: short(what), text: bad.text.clone() }
}

/// Start of a name, for a message.
fn short(name: &str) -> String {
    name.chars().take(40).collect()
}

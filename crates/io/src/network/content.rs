//! What a network file holds, how it is read, and what goes into it beside the network.

use anastomesh_mesh::geometry::Point3;
use anastomesh_skeleton::{LineGroup, NodeId, Skeleton};
use serde::Serialize;
use std::fmt;

/// How to read a network.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct NetworkOptions {
    /// Name of the array (on points, cells or both) that holds the radius; by default it is found by its name.
    pub radius_array: Option<String>,
    /// What the file calls radii are diameters. Without this, only arrays with such a name are halved.
    pub diameters: bool,
    /// Radii are multiplied by this, as when they are in another unit than the positions.
    pub radius_scale: Option<f64>,
    /// Positions and radii are multiplied by this, as from micrometres to metres by 1e-6.
    pub scale: Option<f64>,
    /// Name of an array on the nodes whose numbers are to be kept beside the network.
    pub node_array: Option<String>,
    /// Read radii that cannot be used (zero, negative, infinite, no number) as they stand, for `prepare` to fill; by
    /// default they are an error.
    pub any_radii: bool,
}

anastomesh_mesh::setters!(NetworkOptions {
    radius_array: impl Into<Option<String>>,
    diameters: bool,
    radius_scale: impl Into<Option<f64>>,
    scale: impl Into<Option<f64>>,
    node_array: impl Into<Option<String>>,
    any_radii: bool,
});

/// A network as it stands in its file: `skeleton::clean` makes it usable.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NetworkFile {
    /// Nodes in the file's order, edges in the order of its lines.
    pub skeleton: Skeleton,
    /// What the reader decided.
    pub notes: Vec<NetworkNote>,
    /// What the file calls its nodes.
    pub names: NodeNames,
    /// Nodes that the file says to be where its trees begin, in its order.
    pub roots: Vec<NodeId>,
    /// Of each node, the vessel that its line is drawn for; empty where the file says nothing of it.
    pub groups: Vec<Option<LineGroup>>,
    /// The numbers of the array that was asked for, one per node; else empty.
    pub node_values: Vec<f64>,
}

/// What a file calls its nodes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum NodeNames {
    /// Nothing: their order from 0 is their name.
    #[default]
    Order,
    /// By numbers of its own.
    Ids(Vec<i64>),
    /// By words.
    Words(Vec<String>),
}

impl NodeNames {
    /// The node that has a name, if there is one.
    pub fn find(&self, name: &str, nodes: usize) -> Option<NodeId> {
        let at = match self {
            Self::Order => name.parse().ok().filter(|&at| at < nodes),
            Self::Ids(ids) => name.parse().ok().and_then(|id: i64| ids.iter().position(|&i| i == id)),
            Self::Words(words) => words.iter().position(|w| w == name),
        };
        at.map(|at| NodeId(at as u32))
    }

    /// What a node is called.
    pub fn of(&self, node: NodeId) -> String {
        let named = match self {
            Self::Order => None,
            Self::Ids(ids) => ids.get(node.index()).map(ToString::to_string),
            Self::Words(words) => words.get(node.index()).cloned(),
        };
        named.unwrap_or_else(|| node.0.to_string())
    }
}

/// A decision of a reader that its user should know.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "note", rename_all = "snake_case")]
#[non_exhaustive]
pub enum NetworkNote {
    /// Node radii come from this array on the points.
    NodeRadii {
        /// The array.
        array: String,
    },
    /// Each line has its own radius, from this array on the cells; node radii serve for the nodes alone.
    EdgeRadii {
        /// The array.
        array: String,
    },
    /// There are no radii on the points: a node's radius is that of its thickest edge.
    NodeRadiiFromEdges,
    /// The array holds diameters, by its name: its values were halved.
    Halved {
        /// The array.
        array: String,
    },
    /// Other arrays could be radii too and were not used.
    NotUsed {
        /// The arrays.
        arrays: Vec<String>,
    },
    /// Lines say which vessel they are drawn for, in arrays `GroupIds` and `Blanking`.
    Grouped {
        /// How many vessels they are, without the insides of branchings.
        vessels: usize,
    },
    /// Cells that are no lines were ignored.
    OtherCells {
        /// How many.
        count: usize,
    },
    /// There are no coordinates z: all nodes lie at z = 0.
    Planar,
    /// All radii were halved, as was asked for.
    Diameters,
    /// Positions were multiplied by one number, radii by another.
    Scaled {
        /// Factor of the positions.
        positions: f64,
        /// Factor of the radii.
        radii: f64,
    },
    /// The unit of lengths in the file, and that in which they go on.
    Unit {
        /// In the file.
        from: &'static str,
        /// From here on.
        to: &'static str,
    },
    /// Edges were read from a second file.
    EdgesFrom {
        /// Its name.
        file: String,
    },
    /// Vessels that meet at a joint end at different places: a short vessel was put between them.
    Bridged {
        /// How many of them.
        count: usize,
    },
    /// Vessels are so thick or so thin beside the network that radii and positions may be in different units.
    OutOfProportion {
        /// Largest radius.
        radius: f64,
        /// Diagonal of the box around the network.
        extent: f64,
    },
}

impl fmt::Display for NetworkNote {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::NodeRadii { array } => write!(f, "radii of nodes: array '{array}' on the points"),
            Self::EdgeRadii { array } => write!(f, "radii of vessels: array '{array}' on the lines"),
            Self::NodeRadiiFromEdges => {
                write!(f, "no radii on the points: nodes have the radius of their thickest vessel")
            }
            Self::Halved { array } => write!(f, "array '{array}' holds diameters by its name: halved"),
            Self::NotUsed { arrays } => {
                write!(f, "arrays that could be radii too, not used: {}", arrays.join(", "))
            }
            Self::Grouped { vessels } => write!(f, "arrays GroupIds and Blanking: lines of {vessels} vessels"),
            Self::OtherCells { count } => write!(f, "{count} cells that are no lines were ignored"),
            Self::Planar => write!(f, "no coordinates z: all nodes lie in the plane z = 0"),
            Self::Diameters => write!(f, "radii taken for diameters, as asked: halved"),
            Self::Scaled { positions, radii } => {
                write!(f, "positions multiplied by {positions}, radii by {radii}, as asked")
            }
            Self::Unit { from, to } if from == to => write!(f, "lengths in {from}, as given"),
            Self::Unit { from, to } => write!(f, "lengths in {from}, as given; in {to} from here on"),
            Self::EdgesFrom { file } => write!(f, "edges: from {file}"),
            Self::Bridged { count } => write!(
                f,
                "{count} vessels begin at another place than the joint they leave from: a short vessel put between"
            ),
            Self::OutOfProportion { radius, extent } => {
                write!(f, "the largest radius is {radius} in a network of extent {extent}: are both in one unit?")
            }
        }
    }
}

/// Values that go with the nodes or the edges.
#[derive(Clone, Debug, PartialEq)]
pub enum NetworkArray {
    /// Integers, one per node.
    NodeInts(&'static str, Vec<u32>),
    /// Vectors, one per node.
    NodeVectors(&'static str, Vec<[f64; 3]>),
}

/// The arrays that a refined network carries: `OriginalNode`, the node of the input that each node was, and
/// `Displacement`, how it moved from `origin`.
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

//! What a network file holds, how it is read, and what goes into it beside the network.

use crate::geometry::Point3;
use crate::skeleton::Skeleton;
use serde::Serialize;
use std::fmt;

/// How to read a network.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NetworkOptions {
    /// Name of the array (on points, cells or both) that holds the radius; by default it is found by its name.
    pub radius_array: Option<String>,
    /// Read radii that cannot be used (zero, negative, infinite, no number) as they stand, for `prepare` to fill; by
    /// default they are an error.
    pub any_radii: bool,
}

/// A network as it stands in its file: `skeleton::clean` makes it usable.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NetworkFile {
    /// Nodes in the file's order, edges in the order of its lines.
    pub skeleton: Skeleton,
    /// What the reader decided.
    pub notes: Vec<NetworkNote>,
}

/// A decision of a reader that its user should know.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
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
    /// Cells that are no lines were ignored.
    OtherCells {
        /// How many.
        count: usize,
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
                write!(
                    f,
                    "arrays that could be radii too, not used: {} (choose with --radius-array)",
                    arrays.join(", ")
                )
            }
            Self::OtherCells { count } => write!(f, "{count} cells that are no lines were ignored"),
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
/// use anastomesh::io::{NetworkOptions, read_network, write_network};
/// use anastomesh::testing::refinement_arrays;
/// use anastomesh::network::{RefineParams, clean, refine};
///
/// let file = read_network("fixtures/tree_30.swc".as_ref(), &NetworkOptions::default())?;
/// let (network, _) = clean(&file.skeleton)?;
/// let refined = refine(&network, &RefineParams::default(), &())?;
/// let folder = tempfile::tempdir()?;
/// let arrays = refinement_arrays(&refined.skeleton, &refined.origin);
/// write_network(&folder.path().join("refined.vtp"), &refined.skeleton, &arrays)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn refinement_arrays(skeleton: &Skeleton, origin: &[Point3]) -> Vec<NetworkArray> {
    let moved = skeleton.nodes.iter().zip(origin).map(|(n, o)| (n.position - o).into());
    vec![
        NetworkArray::NodeInts("OriginalNode", skeleton.nodes.iter().map(|n| n.original).collect()),
        NetworkArray::NodeVectors("Displacement", moved.collect()),
    ]
}

//! Which vessel a line is drawn for, where its file says so.

use super::{Edge, Skeleton};

/// What VMTK's branch extraction says of a piece of a line: cell arrays `GroupIds` and `Blanking`.
///
/// Pieces of one group are one vessel, drawn once for each line that runs through it; blanked groups are the places where
/// vessels part (Antiga and Steinman, 2004).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineGroup {
    /// The number of the vessel.
    pub group: i64,
    /// Whether it is the inside of a branching and no vessel of its own.
    pub blanked: bool,
}

/// What the groups of two lines say about them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kinship {
    /// They are one vessel.
    Same,
    /// They are two vessels.
    Different,
    /// Nothing.
    Unknown,
}

impl LineGroup {
    /// The group of each edge, by the groups of the file's nodes (as `Node::original` counts them): that of its ends where
    /// both have the same.
    pub fn of_edges(skeleton: &Skeleton, nodes: &[Option<Self>]) -> Vec<Option<Self>> {
        let of_node = |n| nodes.get(skeleton.node(n).original as usize).copied().flatten();
        let of_edge = |e: &Edge| of_node(e.nodes[0]).filter(|&group| of_node(e.nodes[1]) == Some(group));
        skeleton.edges.iter().map(of_edge).collect()
    }

    /// What two groups say: of the inside of a branching, nothing.
    pub fn kinship(a: Option<Self>, b: Option<Self>) -> Kinship {
        match a.zip(b) {
            Some((a, b)) if a.blanked || b.blanked => Kinship::Unknown,
            Some((a, b)) if a.group == b.group => Kinship::Same,
            Some(_) => Kinship::Different,
            None => Kinship::Unknown,
        }
    }
}

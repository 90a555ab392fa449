//! Vessel of each line, if the file has this information.

use super::{Edge, Skeleton};

/// Group of a piece of a line from VMTK's branch extraction: cell arrays `GroupIds` and `Blanking`.
///
/// Pieces of one group are one vessel, drawn once for each line through it; blanked groups are the insides of
/// bifurcations (Antiga and Steinman, 2004).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineGroup {
    /// Number of the vessel.
    pub group: i64,
    /// True for the inside of a bifurcation, which is no separate vessel.
    pub blanked: bool,
}

/// Relation of two lines by their groups.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kinship {
    /// One vessel.
    Same,
    /// Two vessels.
    Different,
    /// Unknown.
    Unknown,
}

impl LineGroup {
    /// Group of each edge, from the groups of the file's nodes (as `Node::original` counts them). An edge has the
    /// common group of its ends.
    pub fn of_edges(skeleton: &Skeleton, nodes: &[Option<Self>]) -> Vec<Option<Self>> {
        let of_node = |n| nodes.get(skeleton.node(n).original as usize).copied().flatten();
        let of_edge = |e: &Edge| of_node(e.nodes[0]).filter(|&group| of_node(e.nodes[1]) == Some(group));
        skeleton.edges.iter().map(of_edge).collect()
    }

    /// Relation by two groups; unknown for the inside of a bifurcation.
    pub fn kinship(a: Option<Self>, b: Option<Self>) -> Kinship {
        match a.zip(b) {
            Some((a, b)) if a.blanked || b.blanked => Kinship::Unknown,
            Some((a, b)) if a.group == b.group => Kinship::Same,
            Some(_) => Kinship::Different,
            None => Kinship::Unknown,
        }
    }
}

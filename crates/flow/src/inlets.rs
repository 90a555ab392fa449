//! Inlets of a network: the terminals that are named, and in each component without one the terminal of largest radius.

use super::plan::InletSite;
use anastomesh_io::network::NodeNames;
use anastomesh_mesh::units::counted;
use anastomesh_skeleton::{Adjacency, NodeId, Skeleton};
use serde::Serialize;
use std::collections::BTreeMap;

/// Reason why a terminal is an inlet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum InletReason {
    /// Named by the caller.
    Asked,
    /// Root in the file.
    RootOfFile,
    /// Widest terminal of its component.
    Widest,
}

/// A terminal that becomes an inlet.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inlet {
    /// Node index in the file, from 0.
    #[serde(skip)]
    pub original: u32,
    /// Name of the node in the file.
    pub node: String,
    /// Position of the node.
    pub position: [f64; 3],
    /// Radius of the vessel there.
    pub radius: f64,
    /// Reason for the choice.
    pub why: InletReason,
}

/// Inlets of a cleaned network.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Inlets {
    /// Inlets in the order of nodes; at least one per component that has terminals.
    pub list: Vec<Inlet>,
    /// Node indices in the file, from 0, of the inlets that the caller or the file names.
    pub roots: Vec<u32>,
    /// Roots of the file that are not terminals, with their numbers of vessels.
    pub inner: Vec<(String, usize)>,
}

/// Named inlet that is not a terminal of the network.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", match vessels {
    Some(vessels) => format!("node {node} is not a terminal ({} meet there); name a node with one vessel", counted(*vessels, "vessel")),
    None => format!("node {node} is not in the network; give the name or number of a terminal in the file"),
})]
pub struct NoTerminal {
    /// Name of the node as given.
    pub node: String,
    /// Number of vessels of the node; `None` if the network has no such node.
    pub vessels: Option<usize>,
}

/// Adds missing inlets: in each component without a named one, the terminal of largest radius (of equals,
/// the first).
///
/// `reasons` holds one entry per node.
pub(super) fn complete(skeleton: &Skeleton, adjacency: &Adjacency, reasons: &mut [Option<InletReason>]) {
    let components = skeleton.components(adjacency);
    let mut rooted = vec![false; components.list.len()];
    for (&component, _) in components.of_node.iter().zip(&*reasons).filter(|(_, why)| why.is_some()) {
        rooted[component as usize] = true;
    }
    let widest = skeleton.roots(adjacency, &components);
    for node in widest.into_iter().zip(&rooted).filter(|(_, rooted)| !**rooted).filter_map(|(node, _)| node) {
        reasons[node.index()] = Some(InletReason::Widest);
    }
}

impl Inlets {
    /// Chooses the inlets of a cleaned network: the nodes in `asked`, or else the roots of the file.
    ///
    /// In each component without an inlet, the widest terminal is added.
    ///
    /// # Errors
    /// A requested node is not a terminal.
    pub fn of(
        skeleton: &Skeleton,
        names: &NodeNames,
        roots_of_file: &[NodeId],
        asked: &[String],
    ) -> Result<Self, NoTerminal> {
        let adjacency = skeleton.adjacency();
        let original = |n: NodeId| skeleton.node(n).original;
        let most = skeleton.nodes.iter().map(|n| n.original as usize + 1).max().unwrap_or(0);
        let mut at: Vec<Option<NodeId>> = vec![None; most];
        skeleton.node_ids().for_each(|n| at[original(n) as usize] = Some(n));
        let now = |file: NodeId| at.get(file.index()).copied().flatten();
        let mut why: Vec<Option<InletReason>> = vec![None; skeleton.nodes.len()];
        let mut inner = Vec::new();
        for name in asked {
            let node = names.find(name, most).and_then(now);
            let vessels = node.map(|n| adjacency.valence(n));
            match (node, vessels) {
                (Some(node), Some(1)) => why[node.index()] = Some(InletReason::Asked),
                _ => return Err(NoTerminal { node: name.clone(), vessels }),
            }
        }
        if asked.is_empty() {
            for &root in roots_of_file {
                match now(root).map(|n| (n, adjacency.valence(n))) {
                    Some((node, 1)) => why[node.index()] = Some(InletReason::RootOfFile),
                    Some((_, vessels)) => inner.push((names.of(root), vessels)),
                    // Cleaning has merged it with a node before it.
                    None => {}
                }
            }
        }
        let chosen: Vec<NodeId> = skeleton.node_ids().filter(|n| why[n.index()].is_some()).collect();
        complete(skeleton, &adjacency, &mut why);
        let inlet = |n: NodeId| {
            let edge = skeleton.edge(adjacency.edges(n)[0]);
            why[n.index()].map(|why| Inlet {
                original: original(n),
                node: names.of(NodeId(original(n))),
                position: skeleton.node(n).position.into(),
                radius: edge.radii[edge.end(n)],
                why,
            })
        };
        let list = skeleton.node_ids().filter(|&n| adjacency.valence(n) == 1).filter_map(inlet).collect();
        Ok(Self { list, roots: chosen.into_iter().map(original).collect(), inner })
    }

    /// Inlets of a network with the nodes of the file, with the names of their patches.
    pub fn sites(&self, network: &Skeleton) -> Vec<InletSite> {
        let nodes: BTreeMap<u32, NodeId> = network.node_ids().map(|id| (network.node(id).original, id)).collect();
        let site = |(k, inlet): (usize, &Inlet)| {
            let patch = if k == 0 { "inlet".to_owned() } else { format!("inlet_{k}") };
            let node = *nodes.get(&inlet.original)?;
            Some(InletSite { node, patch, name: inlet.node.clone(), radius: inlet.radius })
        };
        self.list.iter().enumerate().filter_map(site).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_io::network::{NetworkFormat, NetworkOptions, read_network_from};
    use anastomesh_skeleton::clean;

    /// The root 7 is thinner than the leaf 1.
    const TREE: &str = "7 0 0 0 0 1 -1\n5 0 0 0 9 1 7\n1 0 0 6 20 2 5\n3 0 0 -6 20 1 5\n";

    fn inlets(text: &str, asked: &[&str]) -> Result<Inlets, NoTerminal> {
        let file = read_network_from(text.as_bytes(), NetworkFormat::Swc, &NetworkOptions::default()).unwrap();
        let (skeleton, _) = clean(&file.skeleton).unwrap();
        let asked: Vec<String> = asked.iter().map(ToString::to_string).collect();
        Inlets::of(&skeleton, &file.names, &file.roots, &asked)
    }

    #[test]
    fn the_root_of_the_file_is_the_inlet() {
        let found = inlets(TREE, &[]).unwrap();
        assert_eq!((found.list.len(), found.roots.clone()), (1, vec![0]));
        assert_eq!((found.list[0].node.as_str(), found.list[0].why), ("7", InletReason::RootOfFile));
    }

    #[test]
    fn nodes_are_asked_for_as_the_file_calls_them() {
        let found = inlets(TREE, &["3"]).unwrap();
        assert_eq!((found.roots, found.list[0].why), (vec![3], InletReason::Asked));
        assert_eq!(inlets(TREE, &["5"]), Err(NoTerminal { node: "5".into(), vessels: Some(3) }));
        assert_eq!(inlets(TREE, &["0"]), Err(NoTerminal { node: "0".into(), vessels: None }));
    }

    #[test]
    fn a_root_inside_is_named_and_the_widest_taken() {
        let inside = "5 0 0 0 9 1 -1\n1 0 0 6 20 2 5\n3 0 0 -6 20 1 5\n";
        let found = inlets(inside, &[]).unwrap();
        assert_eq!((found.inner.as_slice(), found.roots.len()), (&[("5".to_owned(), 2)][..], 0));
        assert_eq!((found.list[0].node.as_str(), found.list[0].why), ("1", InletReason::Widest));
    }
}

//! Selection of the terminals that become inlets.

use anastomesh_io::network::NodeNames;
use anastomesh_mesh::units::number;
use anastomesh_skeleton::{NodeId, Skeleton};
use serde::Serialize;
use std::fmt;

/// Reason why a terminal is an inlet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Why {
    /// Requested by the caller.
    Asked,
    /// Root of the file.
    RootOfFile,
    /// Widest terminal of its component.
    Widest,
}

/// Terminal that becomes an inlet.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inlet {
    /// Node index in the file, from 0.
    #[serde(skip)]
    pub original: u32,
    /// Node name in the file.
    pub node: String,
    /// Position of the node.
    pub position: [f64; 3],
    /// Vessel radius at the node.
    pub radius: f64,
    /// Reason for the selection.
    pub why: Why,
}

impl fmt::Display for Inlet {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let at = self.position.map(number).join(" ");
        let why = match self.why {
            Why::Asked => "as asked",
            Why::RootOfFile => "the root in the file",
            Why::Widest => "the widest terminal of its component; --root names another",
        };
        write!(f, "node {} at {at}, radius {} ({why})", self.node, number(self.radius))
    }
}

/// Inlets of a cleaned network: those identified by index in the file, else the widest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inlets {
    /// One or more per component with terminals, in the order of nodes.
    pub list: Vec<Inlet>,
    /// Indices in the file, from 0, of those not selected by radius.
    pub roots: Vec<u32>,
    /// Roots of the file that are not terminals, with their vessel counts.
    pub inner: Vec<(String, usize)>,
}

/// Requested root that is not a terminal, with its vessel count if the node exists.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoTerminal {
    /// Node name as requested.
    pub node: String,
    /// Vessel count; `None` if there is no such node.
    pub vessels: Option<usize>,
}

impl Inlets {
    /// Selects the requested nodes; else the roots of the file; else the widest terminal of each component.
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
        let components = skeleton.components(&adjacency);
        let original = |n: NodeId| skeleton.node(n).original;
        let most = skeleton.nodes.iter().map(|n| n.original as usize + 1).max().unwrap_or(0);
        let mut at: Vec<Option<NodeId>> = vec![None; most];
        skeleton.node_ids().for_each(|n| at[original(n) as usize] = Some(n));
        let now = |file: NodeId| at.get(file.index()).copied().flatten();
        let mut why: Vec<Option<Why>> = vec![None; skeleton.nodes.len()];
        let mut inner = Vec::new();
        for name in asked {
            let node = names.find(name, most).and_then(now);
            let vessels = node.map(|n| adjacency.valence(n));
            match (node, vessels) {
                (Some(node), Some(1)) => why[node.index()] = Some(Why::Asked),
                _ => return Err(NoTerminal { node: name.clone(), vessels }),
            }
        }
        if asked.is_empty() {
            for &root in roots_of_file {
                match now(root).map(|n| (n, adjacency.valence(n))) {
                    Some((node, 1)) => why[node.index()] = Some(Why::RootOfFile),
                    Some((_, vessels)) => inner.push((names.of(root), vessels)),
                    // Cleaning merged it with an earlier node.
                    None => {}
                }
            }
        }
        let chosen: Vec<NodeId> = skeleton.node_ids().filter(|n| why[n.index()].is_some()).collect();
        let mut rooted = vec![false; components.list.len()];
        for n in &chosen {
            rooted[components.of_node[n.index()] as usize] = true;
        }
        let widest = skeleton.roots(&adjacency, &components);
        for node in widest.into_iter().zip(&rooted).filter(|(_, rooted)| !**rooted).filter_map(|(node, _)| node) {
            why[node.index()] = Some(Why::Widest);
        }
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

    /// Text lines, limited in number.
    pub fn remarks(&self) -> Vec<String> {
        const LISTED: usize = 10;
        let mut lines: Vec<String> = self.list.iter().take(LISTED).map(|inlet| format!("inlet: {inlet}")).collect();
        if self.list.len() > LISTED {
            lines.push(format!("inlet: and {} more, one per component", self.list.len() - LISTED));
        }
        for (node, vessels) in self.inner.iter().take(LISTED) {
            lines.push(format!(
                "root: node {node} of the file has {vessels} vessels and lies inside the network, so it is no inlet; put a \
                 vessel before it, or name a terminal with --root"
            ));
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_io::network::{NetworkFormat, NetworkOptions, read_network_from};
    use anastomesh_skeleton::clean;

    /// Root 7 is thinner than leaf 1.
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
        assert_eq!((found.list[0].node.as_str(), found.list[0].why), ("7", Why::RootOfFile));
        assert!(found.remarks()[0].contains("node 7 at 0 0 0, radius 1 (the root in the file)"));
    }

    #[test]
    fn nodes_are_asked_for_as_the_file_calls_them() {
        let found = inlets(TREE, &["3"]).unwrap();
        assert_eq!((found.roots, found.list[0].why), (vec![3], Why::Asked));
        assert_eq!(inlets(TREE, &["5"]), Err(NoTerminal { node: "5".into(), vessels: Some(3) }));
        assert_eq!(inlets(TREE, &["0"]), Err(NoTerminal { node: "0".into(), vessels: None }));
    }

    #[test]
    fn a_root_inside_is_named_and_the_widest_taken() {
        let inside = "5 0 0 0 9 1 -1\n1 0 0 6 20 2 5\n3 0 0 -6 20 1 5\n";
        let found = inlets(inside, &[]).unwrap();
        assert_eq!((found.inner.as_slice(), found.roots.len()), (&[("5".to_owned(), 2)][..], 0));
        assert_eq!((found.list[0].node.as_str(), found.list[0].why), ("1", Why::Widest));
        assert!(found.remarks()[1].contains("node 5 of the file has 2 vessels"));
    }
}

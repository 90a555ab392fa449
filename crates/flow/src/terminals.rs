//! Patches of terminals: ids and names.

use std::collections::BTreeMap;

use super::inlets::{self, InletReason};
use anastomesh_mesh::WALL;
use anastomesh_skeleton::{NodeId, Skeleton};

/// Id and name of the patch that closes each terminal.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TerminalPatches {
    /// By terminal node.
    pub of: BTreeMap<NodeId, (i32, String)>,
}

/// A root was asked for that is not a terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("root node {node} (from 0) is not a terminal; name a node with one edge")]
pub struct NotATerminal {
    /// Node as given.
    pub node: u32,
}

impl TerminalPatches {
    /// Assigns patches: inlets get 2, 3, … (`inlet`, `inlet_1`, …), the outlets follow (`outlet_0`, …).
    ///
    /// Inlets are the terminals whose `original` index is in `roots`, completed by the widest terminal of each other component. Order is that of the
    /// nodes.
    ///
    /// # Errors
    /// A root is not a terminal of the skeleton.
    pub fn assign(skeleton: &Skeleton, roots: &[u32]) -> Result<Self, NotATerminal> {
        let adjacency = skeleton.adjacency();
        let terminals = adjacency.terminals();
        let original = |n: NodeId| skeleton.node(n).original;
        if let Some(&node) = roots.iter().find(|&&root| !terminals.iter().any(|&t| original(t) == root)) {
            return Err(NotATerminal { node });
        }
        let mut reasons = vec![None; skeleton.nodes.len()];
        for &terminal in terminals.iter().filter(|&&t| roots.contains(&original(t))) {
            reasons[terminal.index()] = Some(InletReason::Asked);
        }
        inlets::complete(skeleton, &adjacency, &mut reasons);
        let inlets: Vec<NodeId> = skeleton.node_ids().filter(|n| reasons[n.index()].is_some()).collect();
        Ok(Self { of: names(&terminals, &inlets) })
    }
}

fn names(terminals: &[NodeId], inlets: &[NodeId]) -> BTreeMap<NodeId, (i32, String)> {
    let mut of = BTreeMap::new();
    let mut id = WALL;
    for (k, &inlet) in inlets.iter().enumerate() {
        id += 1;
        of.insert(inlet, (id, if k == 0 { "inlet".to_owned() } else { format!("inlet_{k}") }));
    }
    let outlets = terminals.iter().filter(|t| inlets.binary_search(t).is_err());
    for (k, &outlet) in outlets.enumerate() {
        id += 1;
        of.insert(outlet, (id, format!("outlet_{k}")));
    }
    of
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::geometry::Point3;
    use anastomesh_skeleton::{Edge, Node};

    /// A Y whose terminals are nodes 0, 2 and 3 with radii 2, 1 and 3.
    fn y() -> Skeleton {
        let radii = [2.0, 2.0, 1.0, 3.0];
        let node =
            |i: usize| Node { position: Point3::new(i as f64, 0.0, 0.0), radius: radii[i], original: 10 + i as u32 };
        let edge =
            |a: u32, b: u32| Edge { nodes: [NodeId(a), NodeId(b)], radii: [radii[a as usize], radii[b as usize]] };
        Skeleton { nodes: (0..4).map(node).collect(), edges: vec![edge(0, 1), edge(1, 2), edge(1, 3)] }
    }

    fn name(patches: &TerminalPatches, node: u32) -> (i32, &str) {
        let (id, name) = &patches.of[&NodeId(node)];
        (*id, name)
    }

    #[test]
    fn the_widest_terminal_is_the_inlet() {
        let patches = TerminalPatches::assign(&y(), &[]).expect("no root asked for");
        assert_eq!(
            [name(&patches, 3), name(&patches, 0), name(&patches, 2)],
            [(2, "inlet"), (3, "outlet_0"), (4, "outlet_1")]
        );
    }

    #[test]
    fn a_root_asked_for_is_the_inlet() {
        let patches = TerminalPatches::assign(&y(), &[12]).expect("a terminal");
        assert_eq!(
            [name(&patches, 2), name(&patches, 0), name(&patches, 3)],
            [(2, "inlet"), (3, "outlet_0"), (4, "outlet_1")]
        );
    }

    #[test]
    fn a_root_inside_is_refused() {
        assert_eq!(TerminalPatches::assign(&y(), &[11]), Err(NotATerminal { node: 11 }));
    }
}

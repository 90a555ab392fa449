//! Which terminal is an inlet, which an outlet, and what their patches are called.

use std::collections::BTreeMap;

use crate::mesh::WALL;
use crate::skeleton::{NodeId, Skeleton};

/// Id and name of the patch that closes each terminal.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TerminalPatches {
    /// By terminal node.
    pub of: BTreeMap<NodeId, (i32, String)>,
}

/// A root was asked for that is not a terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("node {node} was given as root, but the network has no terminal of that number")]
pub struct NotATerminal {
    /// The node as it was given.
    pub node: u32,
}

/// Assigns patches: inlets get 2, 3, … (`inlet`, `inlet_1`, …), the outlets follow (`outlet_0`, …).
///
/// Inlets are the terminals whose `original` index is in `roots`; in a component without one, the terminal of largest
/// radius (of equals, the first). Order is that of the nodes.
///
/// # Errors
/// When a root is not a terminal of the skeleton.
pub fn assign(skeleton: &Skeleton, roots: &[u32]) -> Result<TerminalPatches, NotATerminal> {
    let adjacency = skeleton.adjacency();
    let (component, count) = skeleton.components();
    let terminals: Vec<NodeId> =
        (0..skeleton.nodes.len() as u32).map(NodeId).filter(|&n| adjacency.edges_at(n).len() == 1).collect();
    let original = |n: NodeId| skeleton.nodes[n.0 as usize].original;
    if let Some(&node) = roots.iter().find(|&&root| !terminals.iter().any(|&t| original(t) == root)) {
        return Err(NotATerminal { node });
    }
    let mut inlets: Vec<NodeId> = terminals.iter().copied().filter(|&t| roots.contains(&original(t))).collect();
    let mut rooted = vec![false; count];
    for inlet in &inlets {
        rooted[component[inlet.0 as usize] as usize] = true;
    }
    let mut widest: BTreeMap<u32, NodeId> = BTreeMap::new();
    for &t in terminals.iter().filter(|t| !rooted[component[t.0 as usize] as usize]) {
        let best = widest.entry(component[t.0 as usize]).or_insert(t);
        if skeleton.nodes[t.0 as usize].radius > skeleton.nodes[best.0 as usize].radius {
            *best = t;
        }
    }
    inlets.extend(widest.into_values());
    inlets.sort_unstable();
    Ok(TerminalPatches { of: names(&terminals, &inlets) })
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

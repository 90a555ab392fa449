//! Spurs: segmentation artifacts that look like tiny branches.

use anastomesh_mesh::geometry::point_segment;
use anastomesh_skeleton::{Adjacency, Branch, BranchId, Branches, NodeId, Skeleton, SkeletonError, clean};
use serde::Serialize;

/// Maximum length of a spur that ends inside a vessel of its branch point, in radii of that vessel.
const LONGEST: f64 = 4.0;

/// Maximum rounds: a branch point with n spurs needs n. Larger numbers belong to no vessel.
const MAX_SPUR_PASSES: usize = 100;

/// Reason why a branch is a spur.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SpurReason {
    /// The branch is at most as long as the radius of its parent vessel.
    Short,
    /// The tip lies within a vessel of its branch point.
    Inside,
}

/// Removed spur.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spur {
    /// Tip of the spur.
    pub tip: u32,
    /// Branch point of the spur.
    pub from: u32,
    /// Length of the spur, in the unit of the network.
    pub length: f64,
    /// Radius of the parent vessel.
    pub radius: f64,
    /// Reason for the removal.
    pub reason: SpurReason,
}

/// Removes the shortest spur of each branch point until none is left. After each removal the remaining branches may
/// join to one vessel.
pub(super) fn take_off(skeleton: &Skeleton) -> Result<(Skeleton, Vec<Spur>), SkeletonError> {
    let (mut current, mut all) = (skeleton.clone(), Vec::new());
    for _ in 0..MAX_SPUR_PASSES {
        let adjacency = current.adjacency();
        let branches = current.branches(&adjacency);
        let found = spurs(&current, &adjacency, &branches);
        if found.is_empty() {
            break;
        }
        let mut gone = vec![false; current.edges.len()];
        for (id, spur) in found {
            all.push(spur);
            for edge in &branches.list[id.index()].edges {
                gone[edge.index()] = true;
            }
        }
        let edges = current.edge_ids().filter(|e| !gone[e.index()]).map(|e| *current.edge(e)).collect();
        (current, _) = clean(&Skeleton { nodes: current.nodes, edges })?;
    }
    Ok((current, all))
}

/// Shortest spur of each branch point.
fn spurs(skeleton: &Skeleton, adjacency: &Adjacency, branches: &Branches) -> Vec<(BranchId, Spur)> {
    let mut is_root = vec![false; skeleton.nodes.len()];
    for root in skeleton.roots(adjacency, &skeleton.components(adjacency)).into_iter().flatten() {
        is_root[root.index()] = true;
    }
    let mut best: Vec<Option<(BranchId, Spur)>> = vec![None; skeleton.nodes.len()];
    for (id, branch) in (0..).map(BranchId).zip(&branches.list) {
        let Some((from, tip)) = hangs(adjacency, branch) else { continue };
        // The inlet is never a spur.
        if is_root[tip.index()] {
            continue;
        }
        let Some(spur) = spur(skeleton, adjacency, branches, id, [from, tip]) else { continue };
        let slot = &mut best[from.index()];
        if slot.is_none_or(|(_, b)| spur.length < b.length) {
            *slot = Some((id, spur));
        }
    }
    best.into_iter().flatten().collect()
}

/// Branch point and tip of a branch that has both.
fn hangs(adjacency: &Adjacency, branch: &Branch) -> Option<(NodeId, NodeId)> {
    let [a, b] = branch.ends();
    match [a, b].map(|n| adjacency.valence(n)) {
        [1, v] if v > 2 => Some((b, a)),
        [v, 1] if v > 2 => Some((a, b)),
        _ => None,
    }
}

fn spur(
    skeleton: &Skeleton,
    adjacency: &Adjacency,
    branches: &Branches,
    id: BranchId,
    [from, tip]: [NodeId; 2],
) -> Option<Spur> {
    let branch = &branches.list[id.index()];
    let others = adjacency.edges(from).iter().filter(|e| branches.of_edge[e.index()].0 != id);
    let radius = others.clone().map(|&e| skeleton.edge(e).radii[skeleton.edge(e).end(from)]).fold(0.0, f64::max);
    let length = branch.length();
    let reason = if length <= radius {
        SpurReason::Short
    } else if length <= LONGEST * radius && others.clone().any(|e| inside(skeleton, branches, *e, from, tip)) {
        SpurReason::Inside
    } else {
        return None;
    };
    let name = |n: NodeId| skeleton.node(n).original;
    Some(Spur { tip: name(tip), from: name(from), length, radius, reason })
}

/// True if a tip lies within the first radii of the branch that leaves `from` by an edge.
fn inside(
    skeleton: &Skeleton,
    branches: &Branches,
    edge: anastomesh_skeleton::EdgeId,
    from: NodeId,
    tip: NodeId,
) -> bool {
    let (id, piece) = branches.of_edge[edge.index()];
    let branch = &branches.list[id.index()];
    let point = skeleton.node(tip).position;
    let forwards = branch.nodes[piece as usize] == from;
    let reach = 2.0 * LONGEST * skeleton.edge(edge).mean_radius();
    let holds = |k: usize| {
        let tube = branch.tube(skeleton, k);
        let (t, distance) = point_segment(&point, &tube.a, &tube.b);
        distance < tube.radius(t)
    };
    let near = |k: usize| (branch.arc[k] - branch.arc[piece as usize]).abs() <= reach;
    if forwards {
        (piece as usize..branch.edges.len()).take_while(|&k| near(k)).any(holds)
    } else {
        (0..=piece as usize).rev().take_while(|&k| near(k)).any(holds)
    }
}

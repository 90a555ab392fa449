//! Short tips, whose cap would lie in the wall of another vessel of their branch point.

use anastomesh_mesh::geometry::{Point3, Vec3, point_segment};
use anastomesh_skeleton::{Adjacency, Branch, BranchId, Branches, NodeId, Skeleton, SkeletonError, clean, separation};
use serde::Serialize;

/// Required tip length: a factor on the distance at which two walls separate (equation 12), and an addition in radii.
/// Walls blend before they separate, and a cap needs a piece of its own vessel.
const MARGIN: f64 = 1.1;
const OWN: f64 = 0.3;
/// Length of a vessel, in radii, up to which it is removed if its length is too small an extension.
const STUB: f64 = 1.5;

/// Tip that is too close to its branch point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ShortTip {
    /// Tip node.
    pub tip: u32,
    /// Branch point of its vessel.
    pub from: u32,
    /// Length of the vessel, in the unit of the network.
    pub length: f64,
    /// Length at which the cap is clear.
    pub needed: f64,
    /// True if the tip was extended to that length; otherwise its vessel was removed.
    pub put_out: bool,
}

/// Extends short tips straight on, or removes their vessels.
pub(super) fn treat(skeleton: &Skeleton) -> Result<(Skeleton, Vec<ShortTip>), SkeletonError> {
    let adjacency = skeleton.adjacency();
    let branches = skeleton.branches(&adjacency);
    let found: Vec<(BranchId, ExtendedTip)> = (0..branches.list.len() as u32)
        .map(BranchId)
        .filter_map(|id| Some((id, find(skeleton, &adjacency, &branches, id)?)))
        .collect();
    if found.is_empty() {
        return Ok((skeleton.clone(), Vec::new()));
    }
    let mut result = skeleton.clone();
    let mut gone = vec![false; skeleton.edges.len()];
    for (id, tip) in &found {
        if tip.told.put_out {
            let node = &mut result.nodes[tip.node.index()];
            node.position += tip.way * (tip.told.needed - tip.told.length);
        } else {
            branches.list[id.index()].edges.iter().for_each(|e| gone[e.index()] = true);
        }
    }
    result.edges = skeleton.edge_ids().filter(|e| !gone[e.index()]).map(|e| *skeleton.edge(e)).collect();
    Ok((clean(&result)?.0, found.into_iter().map(|(_, tip)| tip.told).collect()))
}

/// Short tip and its extension.
struct ExtendedTip {
    node: NodeId,
    /// Direction in which its vessel ends.
    way: Vec3,
    told: ShortTip,
}

fn find(skeleton: &Skeleton, adjacency: &Adjacency, branches: &Branches, id: BranchId) -> Option<ExtendedTip> {
    let branch = &branches.list[id.index()];
    let [a, b] = branch.ends();
    let (from, tip) = match [a, b].map(|n| adjacency.valence(n)) {
        [1, v] if v > 2 => (b, a),
        [v, 1] if v > 2 => (a, b),
        _ => return None,
    };
    let length = branch.length();
    let at = |n: NodeId| skeleton.node(n).position;
    let own = skeleton.edge(*branch.edges.iter().find(|e| skeleton.edge(**e).nodes.contains(&tip))?);
    let radius = own.radii[own.end(tip)];
    let way = (at(tip) - at(own.other(tip))).try_normalize(0.0)?;
    let chord = at(tip) - at(from);
    let mut needed = 0.0_f64;
    let mut is_outside = true;
    for &edge in adjacency.edges(from).iter().filter(|e| branches.of_edge[e.index()].0 != id) {
        let beside = point_along(skeleton, branches, edge, from, length) - at(from);
        let other = skeleton.edge(edge).radii[skeleton.edge(edge).end(from)];
        if beside.norm() <= 0.0 || chord.norm() <= 0.0 {
            continue;
        }
        let length_needed = MARGIN * separation(&chord, &beside, [radius, other]).max(other) + OWN * radius;
        if length_needed <= length {
            continue;
        }
        // Chords say little about vessels that wind, or taper from a wide branch point.
        let vessel = &branches.list[branches.of_edge[edge.index()].0.index()];
        let is_apart = |distance: f64, wall: f64| distance >= MARGIN * (wall + radius);
        if is_beyond(skeleton, vessel, &at(tip), is_apart) {
            continue;
        }
        is_outside &= is_beyond(skeleton, vessel, &at(tip), |distance, wall| distance >= wall + OWN * radius);
        needed = needed.max(length_needed);
    }
    let short = needed - length;
    let is_stub = short > length && length <= STUB * radius;
    // An extension by more than the length of the vessel is a defect of the mesh.
    let put_out = short <= length && !is_stub;
    // A longer vessel that leaves the others is not removed: the mesher finds out whether its cap fits.
    let is_short = short > 0.0 && (put_out || !is_outside || length <= STUB * radius);
    is_short.then(|| {
        let name = |n: NodeId| skeleton.node(n).original;
        ExtendedTip { node: tip, way, told: ShortTip { tip: name(tip), from: name(from), length, needed, put_out } }
    })
}

/// True if a point satisfies a condition on its distance from each axis of a vessel and the radius there.
fn is_beyond(skeleton: &Skeleton, vessel: &Branch, point: &Point3, is_apart: impl Fn(f64, f64) -> bool) -> bool {
    vessel.tubes(skeleton).all(|tube| {
        let (t, distance) = point_segment(point, &tube.a, &tube.b);
        is_apart(distance, tube.radius(t))
    })
}

/// First node at distance `length` along the branch that leaves `from` by an edge, or its last node.
fn point_along(
    skeleton: &Skeleton,
    branches: &Branches,
    edge: anastomesh_skeleton::EdgeId,
    from: NodeId,
    length: f64,
) -> Point3 {
    let (id, piece) = branches.of_edge[edge.index()];
    let branch = &branches.list[id.index()];
    let here = branch.arc[piece as usize];
    let node = if branch.nodes[piece as usize] == from {
        let next = branch.arc.partition_point(|&s| s < here + length);
        branch.nodes[next.min(branch.nodes.len() - 1)]
    } else {
        let end = branch.arc[piece as usize + 1];
        let before = branch.arc.partition_point(|&s| s <= end - length);
        branch.nodes[before.saturating_sub(1)]
    };
    skeleton.node(node).position
}

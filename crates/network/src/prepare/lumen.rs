//! Adjacent branch points within one lumen, and loops that enclose only lumen.

use anastomesh_mesh::geometry::{Tube, point_segment};
use anastomesh_skeleton::{Branch, Branches, Edge, NodeId, Skeleton, SkeletonError, clean};
use rustc_hash::FxHashMap;
use serde::Serialize;

/// Branch point merged into another one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct JoinedNodes {
    /// Removed node.
    pub node: u32,
    /// Node that replaces it.
    pub into: u32,
    /// Distance of the nodes, in the unit of the network.
    pub distance: f64,
    /// Radius of the lumen: the smaller of the two nodes' radii.
    pub radius: f64,
}

/// Loop closed by removing a branch inside another branch's lumen or inside that of its own branch point.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ClosedLoop {
    /// Ends of the branch.
    pub nodes: [u32; 2],
    /// Length of the branch, in the unit of the network.
    pub length: f64,
}

/// Report of the lumen cure.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct JoinedReport {
    /// Merged branch points.
    pub nodes: Vec<JoinedNodes>,
    /// Closed loops.
    pub loops: Vec<ClosedLoop>,
}

/// Merges branch points within one lumen and closes loops within their own lumen.
pub(super) fn join(skeleton: &Skeleton) -> Result<(Skeleton, JoinedReport), SkeletonError> {
    let (closed, mut loops) = close_loops(skeleton)?;
    let (joined, nodes) = join_nodes(&closed)?;
    let (result, more) = close_loops(&joined)?;
    loops.extend(more);
    Ok((result, JoinedReport { nodes, loops }))
}

/// Contracts branches between branch points that are at most as long as the lumen radius at either end, shortest first.
/// No node moves by more than a radius, so a vessel with many side branches does not collapse to a point.
fn join_nodes(skeleton: &Skeleton) -> Result<(Skeleton, Vec<JoinedNodes>), SkeletonError> {
    let adjacency = skeleton.adjacency();
    let branches = skeleton.branches(&adjacency);
    let radius = |n: NodeId| skeleton.shared_radius(&adjacency, n);
    let between = |b: &Branch| b.ends().iter().all(|&n| adjacency.valence(n) > 2) && !b.is_closed();
    let mut short: Vec<(f64, usize)> = (branches.list.iter().enumerate())
        .filter(|(_, b)| between(b) && b.length() <= b.ends().map(radius).into_iter().fold(f64::INFINITY, f64::min))
        .map(|(i, b)| (b.length(), i))
        .collect();
    short.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    // A merge target is never merged itself, so no node moves twice.
    let mut into: Vec<NodeId> = skeleton.node_ids().collect();
    let mut is_target = vec![false; skeleton.nodes.len()];
    let mut report = Vec::new();
    let mut gone = vec![false; skeleton.edges.len()];
    for &(distance, index) in &short {
        let branch = &branches.list[index];
        let [a, b] = branch.ends();
        // The wider node stays.
        let pair = if radius(b) > radius(a) { [b, a] } else { [a, b] };
        let free = |n: NodeId| into[n.index()] == n && !is_target[n.index()];
        let Some([stays, goes]) =
            [pair, [pair[1], pair[0]]].into_iter().find(|p| into[p[0].index()] == p[0] && free(p[1]))
        else {
            continue;
        };
        into[goes.index()] = stays;
        is_target[stays.index()] = true;
        for edge in &branch.edges {
            gone[edge.index()] = true;
        }
        let [node, target] = [goes, stays].map(|n| skeleton.node(n).original);
        report.push(JoinedNodes { node, into: target, distance, radius: radius(a).min(radius(b)) });
    }
    if report.is_empty() {
        return Ok((skeleton.clone(), report));
    }
    // A second short branch between the nodes is now a loop within the lumen; folded, it would be a spur.
    for (_, index) in short {
        let branch = &branches.list[index];
        let [a, b] = branch.ends().map(|n| into[n.index()]);
        if a == b {
            branch.edges.iter().for_each(|e| gone[e.index()] = true);
        }
    }
    let renamed = |e: &Edge| Edge { nodes: e.nodes.map(|n| into[n.index()]), radii: e.radii };
    let edges = skeleton.edge_ids().filter(|e| !gone[e.index()]).map(|e| renamed(skeleton.edge(e))).collect();
    Ok((clean(&Skeleton { nodes: skeleton.nodes.clone(), edges })?.0, report))
}

/// Removes branches that return to their branch point within its lumen. Of two branches between the same branch points,
/// removes one that lies within the other.
fn close_loops(skeleton: &Skeleton) -> Result<(Skeleton, Vec<ClosedLoop>), SkeletonError> {
    let adjacency = skeleton.adjacency();
    let branches = skeleton.branches(&adjacency);
    let mut gone = vec![false; branches.list.len()];
    let mut beside: FxHashMap<[NodeId; 2], Vec<usize>> = FxHashMap::default();
    for (i, branch) in branches.list.iter().enumerate() {
        let [a, b] = branch.ends();
        if a != b {
            beside.entry([a.min(b), a.max(b)]).or_default().push(i);
        } else if adjacency.valence(a) > 2 {
            let center = skeleton.node(a);
            let radius = skeleton.shared_radius(&adjacency, a);
            gone[i] = branch.nodes.iter().all(|&n| (skeleton.node(n).position - center.position).norm() < radius);
        }
    }
    let mut groups: Vec<Vec<usize>> = beside.into_values().filter(|group| group.len() > 1).collect();
    groups.sort_unstable();
    for mut group in groups {
        // The thickest branch stays; the others are compared with the remaining ones.
        let radius = |i: usize| branches.list[i].mean_radius(skeleton);
        group.sort_by(|&i, &j| radius(j).total_cmp(&radius(i)).then(i.cmp(&j)));
        let mut kept: Vec<usize> = Vec::new();
        for i in group {
            gone[i] = kept.iter().any(|&k| within(skeleton, &branches, i, k));
            if !gone[i] && kept.len() < MOST_BESIDE {
                kept.push(i);
            }
        }
    }
    let ends = |i: usize| branches.list[i].ends().map(|n| skeleton.node(n).original);
    let lost = (0..gone.len()).filter(|&i| gone[i]);
    let loops: Vec<_> = lost.map(|i| ClosedLoop { nodes: ends(i), length: branches.list[i].length() }).collect();
    if loops.is_empty() {
        return Ok((skeleton.clone(), loops));
    }
    let stays = |e: &anastomesh_skeleton::EdgeId| !gone[branches.of_edge[e.index()].0.index()];
    let edges = skeleton.edge_ids().filter(stays).map(|e| *skeleton.edge(e)).collect();
    Ok((clean(&Skeleton { nodes: skeleton.nodes.clone(), edges })?.0, loops))
}

/// Maximum number of parallel branches that serve as reference.
const MOST_BESIDE: usize = 8;
/// Maximum number of point-edge pairs in a containment test.
const MOST_LOOKS: f64 = 1e6;
/// Containment tolerance, in radii of the outer branch. Beyond it there may be a hole between the walls.
const WITHIN: f64 = 1.25;
/// Sampling step along a branch, in its radii.
const STEP: f64 = 0.5;

/// True if branch `i` lies within the tubes of branch `k` along its whole length. Returns false if there are too many
/// points to test, as a loop within a lumen is short.
fn within(skeleton: &Skeleton, branches: &Branches, i: usize, k: usize) -> bool {
    let (inner, outer) = (&branches.list[i], &branches.list[k]);
    let tubes: Vec<_> = outer.tubes(skeleton).collect();
    let steps = |tube: &Tube| (tube.length() / (STEP * tube.min_radius())).ceil().max(1.0);
    let places: f64 = inner.tubes(skeleton).map(|tube| steps(&tube)).sum();
    if places * tubes.len() as f64 > MOST_LOOKS {
        return false;
    }
    inner.tubes(skeleton).all(|inner| {
        // Most edge ends are tested twice; a single-edge branch has only shared nodes.
        (0..=steps(&inner) as usize).all(|j| {
            let point = inner.point(j as f64 / steps(&inner));
            tubes.iter().any(|tube| {
                let (t, distance) = point_segment(&point, &tube.a, &tube.b);
                distance < WITHIN * tube.radius(t)
            })
        })
    })
}

//! Crowded terminals, which are too close for two caps or for the loop through a pair that two trees share. They are
//! listed, moved apart, or merged on request.

use super::params::{Crowded, RefineParams};
use anastomesh_skeleton::{CrowdedTerminals, Node, NodeId, Skeleton};
use rustc_hash::FxHashSet;
use serde::{Deserialize, Serialize};

/// Target distance of terminals, in sums of their radii: their walls must not fuse either.
pub(super) const APART: f64 = 1.2;
/// Target distance of terminals that two trees share. Four vessels of radius r surround the hole between them, from
/// bifurcations about 2.8 r away. At this distance the hole is 1.6 r wide; at 1.2 r the walls close it.
const SHARED_APART: f64 = 2.0;
/// Maximum length of a straight vessel, in distances of its ends.
const STRAIGHT: f64 = 1.2;
/// Maximum number of sweeps: a terminal that moves away from one may approach a third.
const SWEEPS: usize = 100;

/// Two terminals closer than the sum of their radii, and the result of their treatment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CrowdedPair {
    /// The terminals, as indices into the input.
    pub nodes: [u32; 2],
    /// Distance before treatment.
    pub distance: f64,
    /// Sum of the radii.
    pub radii: f64,
    /// True if they are now apart or merged.
    pub resolved: bool,
    /// Displacement of each terminal.
    pub moved: [f64; 2],
}

/// Lists crowded terminals and treats them according to `params.crowded`. With `folds`, this includes nodes at which a
/// vessel reverses: terminals that two trees share, or noise in a polyline. Nodes removed by a merge are also removed
/// from `origin`.
pub(super) fn treat(
    skeleton: &mut Skeleton,
    origin: &mut Vec<anastomesh_mesh::geometry::Point3>,
    params: &RefineParams,
    folds: bool,
) -> Vec<CrowdedPair> {
    let adjacency = skeleton.adjacency();
    let folds = folds.then(|| skeleton.folds(&adjacency));
    let is_end = |n: &NodeId| adjacency.valence(*n) == 1 || folds.as_ref().is_some_and(|folds| folds[n.index()]);
    let ends: Vec<NodeId> = skeleton.node_ids().filter(is_end).collect();
    // The two ends of a short straight vessel need no space between their caps.
    let branches = skeleton.branches(&adjacency);
    let short: FxHashSet<[NodeId; 2]> = (branches.list.iter())
        .filter(|branch| {
            let [a, b] = branch.ends().map(|n| skeleton.node(n).position);
            branch.length() < STRAIGHT * (b - a).norm()
        })
        .map(anastomesh_skeleton::Branch::ends)
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    let crowded = |s: &Skeleton| {
        let mut pairs = s.crowded_among(&ends);
        pairs.retain(|pair| !short.contains(&pair.nodes));
        pairs
    };
    let found = crowded(skeleton);
    let is_free = |pair: &CrowdedTerminals| pair.nodes.iter().all(|n| adjacency.valence(*n) == 1);
    let place = |s: &Skeleton, pair: &CrowdedTerminals| pair.nodes.map(|n| s.node(n).position);
    let before: Vec<_> = found.iter().map(|pair| place(skeleton, pair)).collect();
    let resolved = match params.crowded {
        Crowded::Keep => vec![false; found.len()],
        Crowded::Part => {
            let apart = |pair: &CrowdedTerminals| if is_free(pair) { APART } else { SHARED_APART };
            part(skeleton, &found, crowded, apart)
        }
        // Pairs shared by two trees remain unchanged.
        Crowded::Merge => found.iter().map(is_free).collect(),
    };
    let original = |n: NodeId| skeleton.node(n).original;
    let pairs = found.iter().zip(resolved).zip(before).map(|((pair, resolved), before)| {
        let after = place(skeleton, pair);
        CrowdedPair {
            nodes: pair.nodes.map(original),
            distance: pair.distance,
            radii: pair.radii,
            resolved,
            moved: [0, 1].map(|i| (after[i] - before[i]).norm()),
        }
    });
    let pairs = pairs.collect();
    if params.crowded == Crowded::Merge {
        let free: Vec<CrowdedTerminals> = found.into_iter().filter(is_free).collect();
        merge(skeleton, origin, &free);
    }
    pairs
}

/// Moves the terminals of each pair to a distance of `apart` sums of their radii, each by half the change. Repeats
/// until none are `crowded`; returns a flag for each pair.
fn part(
    skeleton: &mut Skeleton,
    found: &[CrowdedTerminals],
    crowded: impl Fn(&Skeleton) -> Vec<CrowdedTerminals>,
    apart: impl Fn(&CrowdedTerminals) -> f64,
) -> Vec<bool> {
    let mut close = found.to_vec();
    for _ in 0..SWEEPS {
        for pair in &close {
            let [a, b] = pair.nodes.map(|n| *skeleton.node(n));
            let lacking = apart(pair) * pair.radii - (b.position - a.position).norm();
            if lacking > 0.0 {
                let way = direction(&a, &b) * (0.5 * lacking);
                skeleton.nodes[pair.nodes[0].index()].position -= way;
                skeleton.nodes[pair.nodes[1].index()].position += way;
            }
        }
        close = crowded(skeleton);
        if close.is_empty() {
            break;
        }
    }
    found.iter().map(|pair| close.iter().all(|c| c.nodes != pair.nodes)).collect()
}

/// Direction from one terminal to another; arbitrary if they coincide.
fn direction(a: &Node, b: &Node) -> anastomesh_mesh::geometry::Vec3 {
    (b.position - a.position).try_normalize(0.0).unwrap_or_else(anastomesh_mesh::geometry::Vec3::x)
}

/// Merges the terminals of each pair. If both hang on one node, the thinner vessel is removed; others are joined
/// halfway.
fn merge(skeleton: &mut Skeleton, origin: &mut Vec<anastomesh_mesh::geometry::Point3>, found: &[CrowdedTerminals]) {
    let adjacency = skeleton.adjacency();
    let mut gone = vec![false; skeleton.nodes.len()];
    let mut dropped = vec![false; skeleton.edges.len()];
    for pair in found {
        let [a, b] = pair.nodes;
        if gone[a.index()] || gone[b.index()] {
            continue;
        }
        let [e, f] = pair.nodes.map(|n| adjacency.edges(n)[0]);
        if skeleton.edge(e).other(a) == skeleton.edge(f).other(b) {
            let thinner = skeleton.edge(f).mean_radius() < skeleton.edge(e).mean_radius();
            let (node, edge) = if thinner { (b, f) } else { (a, e) };
            (gone[node.index()], dropped[edge.index()]) = (true, true);
        } else {
            let middle = nalgebra::center(&skeleton.node(a).position, &skeleton.node(b).position);
            skeleton.nodes[a.index()].position = middle;
            let end = skeleton.edge(f).end(b);
            skeleton.edges[f.index()].nodes[end] = a;
            gone[b.index()] = true;
        }
    }
    drop_nodes(skeleton, origin, &gone, &dropped);
}

fn drop_nodes(
    skeleton: &mut Skeleton,
    origin: &mut Vec<anastomesh_mesh::geometry::Point3>,
    gone: &[bool],
    dropped: &[bool],
) {
    let mut next = 0;
    let new: Vec<NodeId> = gone
        .iter()
        .map(|gone| {
            let id = NodeId(next);
            next += u32::from(!gone);
            id
        })
        .collect();
    let mut kept = dropped.iter().map(|d| !d);
    skeleton.edges.retain(|_| kept.next().unwrap_or(true));
    for edge in &mut skeleton.edges {
        edge.nodes = edge.nodes.map(|n| new[n.index()]);
    }
    let mut kept = gone.iter().map(|g| !g);
    skeleton.nodes.retain(|_| kept.next().unwrap_or(true));
    let mut kept = gone.iter().map(|g| !g);
    origin.retain(|_| kept.next().unwrap_or(true));
}

#[cfg(test)]
mod tests {
    use super::super::tests::{network, run};
    use super::*;

    /// A bifurcation whose two ends are close together, and a vessel that ends close to one of them.
    fn crowd() -> Skeleton {
        let points = [
            [0.0, 0.0, 0.0],
            [20.0, 0.0, 0.0],
            [40.0, 0.1, 0.0],
            [40.0, -0.1, 0.0],
            [70.0, 0.0, 0.5],
            [41.0, 0.0, 0.5],
        ];
        network(&points, 1.0, &[(0, 1), (1, 2), (1, 3), (4, 5)])
    }

    fn with(crowded: Crowded) -> super::super::Refined {
        run(&crowd(), &RefineParams { crowded, ..RefineParams::default() })
    }

    #[test]
    fn they_are_listed() {
        let kept = with(Crowded::Keep);
        let pairs: Vec<_> = kept.report.crowded.iter().map(|p| (p.nodes, p.resolved)).collect();
        assert_eq!(pairs, [([2, 3], false), ([2, 5], false), ([3, 5], false)]);
        assert!(kept.report.crowded.iter().all(|p| p.moved == [0.0, 0.0]));
        assert_eq!(kept.skeleton.nodes[2].position, crowd().nodes[2].position);
    }

    #[test]
    fn they_are_parted_by_default() {
        let parted = with(RefineParams::default().crowded);
        assert!(parted.report.crowded.iter().all(|p| p.resolved));
        assert!(parted.skeleton.crowded_terminals(&parted.skeleton.adjacency()).is_empty());
        let moved = (parted.skeleton.nodes[2].position - parted.origin[2]).norm();
        assert!(moved > 0.5 && moved < 5.0, "{moved}");
        assert!((parted.report.crowded[0].moved[0] - moved).abs() < 1e-9);
        assert_eq!(parted.origin[2], crowd().nodes[2].position);
        assert_eq!(parted.skeleton.nodes[0].position, crowd().nodes[0].position);
    }

    #[test]
    fn terminals_that_two_trees_share_are_parted() {
        // The loop through both would have no hole.
        let points = [
            [-20.0, 0.0, 0.0],
            [0.0, 0.0, 0.0],
            [30.0, 0.1, 0.0],
            [30.0, -0.1, 0.0],
            [0.0, 2.0, 9.0],
            [-20.0, 9.0, 9.0],
        ];
        let s = network(&points, 1.0, &[(0, 1), (1, 2), (1, 3), (2, 4), (3, 4), (4, 5)]);
        let refined = run(&s, &RefineParams::default());
        assert_eq!(refined.report.crowded.iter().map(|p| (p.nodes, p.resolved)).collect::<Vec<_>>(), [([2, 3], true)]);
        let apart = (refined.skeleton.nodes[2].position - refined.skeleton.nodes[3].position).norm();
        assert!((apart - 4.0).abs() < 1e-9, "{apart}");
        let merged = run(&s, &RefineParams { crowded: Crowded::Merge, ..RefineParams::default() });
        assert!(merged.report.crowded.iter().all(|p| !p.resolved));
    }

    #[test]
    fn the_ends_of_a_vessel_that_is_wider_than_long_stay() {
        let s = network(&[[0.0; 3], [0.6, 0.0, 0.0], [30.0, 0.0, 0.0], [60.0, 0.0, 0.0]], 1.0, &[(0, 1), (2, 3)]);
        let refined = run(&s, &RefineParams::default());
        assert!(refined.report.crowded.is_empty());
        assert!((0..4).all(|i| refined.skeleton.nodes[i].position == s.nodes[i].position));
    }

    #[test]
    fn they_are_merged() {
        let merged = with(Crowded::Merge);
        assert_eq!(merged.skeleton.check(), Ok(()));
        assert_eq!(merged.origin.len(), merged.skeleton.nodes.len());
        let adjacency = merged.skeleton.adjacency();
        let left: Vec<u32> = adjacency.terminals().iter().map(|&n| merged.skeleton.node(n).original).collect();
        // Terminal 2 was removed, as its vessel is no thicker than that of 3, which was then joined to 5.
        assert_eq!(left, [0, 4]);
        assert_eq!(merged.skeleton.components(&adjacency).list.len(), 1);
    }
}

//! Tips that coincide within rounding: a line split into segments with separate numbering.

use super::line::TURNS_BACK;
use super::nested::WIDER;
use anastomesh_mesh::geometry::{Aabb, Bvh, DisjointSets, Vec3};
use anastomesh_skeleton::{Adjacency, Edge, NodeId, Skeleton, SkeletonError, clean};

/// Maximum distance of coinciding tips, in radii of the thinner one.
const ONE_PLACE: f64 = 0.01;

/// Maximum number of tip pairs. Only networks with all tips in one place exceed it.
const MOST_PAIRS: usize = 10_000_000;

/// True if a thin and a wide vessel leave two tips in one direction: one vessel does not continue the other.
fn is_concentric(skeleton: &Skeleton, adjacency: &Adjacency, tips: [NodeId; 2]) -> bool {
    let [a, b] = tips.map(|n| skeleton.node(n).radius);
    let way = |n: NodeId| {
        let next = skeleton.edge(adjacency.edges(n)[0]).other(n);
        let way = skeleton.node(next).position - skeleton.node(n).position;
        way.try_normalize(0.0).unwrap_or_else(Vec3::zeros)
    };
    a.max(b) > WIDER * a.min(b) && way(tips[0]).dot(&way(tips[1])) > TURNS_BACK
}

/// Merges coinciding tips in pairs. Among three or more, pairs form in order of distance.
pub(super) fn join(skeleton: &Skeleton) -> Result<(Skeleton, Vec<[u32; 2]>), SkeletonError> {
    let adjacency = skeleton.adjacency();
    let tips = adjacency.terminals();
    let reach = |n: NodeId| ONE_PLACE * skeleton.node(n).radius;
    let boxes: Vec<Aabb> =
        tips.iter().map(|&n| Aabb::of_points([&skeleton.node(n).position]).grown(0.5 * reach(n))).collect();
    let mut pairs: Vec<(f64, NodeId, NodeId)> = Vec::new();
    Bvh::new(&boxes).self_pairs(|i, j| {
        let [a, b] = [tips[i as usize], tips[j as usize]];
        let distance = (skeleton.node(a).position - skeleton.node(b).position).norm();
        let is_one_place = distance <= reach(a).min(reach(b));
        if is_one_place && pairs.len() < MOST_PAIRS && !is_concentric(skeleton, &adjacency, [a, b]) {
            pairs.push((distance, a.min(b), a.max(b)));
        }
    });
    pairs.sort_by(|p, q| p.0.total_cmp(&q.0).then((p.1, p.2).cmp(&(q.1, q.2))));
    let mut sets = DisjointSets::new(skeleton.nodes.len());
    let mut taken = vec![false; skeleton.nodes.len()];
    let mut met = Vec::new();
    for (_, a, b) in pairs {
        if !taken[a.index()] && !taken[b.index()] {
            sets.join(a.0, b.0);
            (taken[a.index()], taken[b.index()]) = (true, true);
            met.push([a, b]);
        }
    }
    if met.is_empty() {
        return Ok((skeleton.clone(), Vec::new()));
    }
    let renamed = |e: &Edge| Edge { nodes: e.nodes.map(|n| NodeId(sets.find(n.0))), radii: e.radii };
    let edges = skeleton.edges.iter().map(renamed).collect();
    let (result, _) = clean(&Skeleton { nodes: skeleton.nodes.clone(), edges })?;
    Ok((result, met.into_iter().map(|pair| pair.map(|n| skeleton.node(n).original)).collect()))
}

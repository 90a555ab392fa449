//! A second tree that shares the terminals of the first, as veins share the capillaries with arteries.
//!
//! The paper leaves this to future work, but its data contain such a network. The second tree copies every node except
//! the terminals, next to the first tree and from its own root. Copies are offset normal to the plane of the
//! bifurcation, so the trees run in layers. They form folds at the shared terminals. Refinement opens the folds and
//! separates the trees.

use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_skeleton::{Adjacency, Edge, EdgeId, Node, NodeId, Skeleton};

/// Distance between the axes of both trees, in sums of their radii.
const BESIDE: f64 = 1.3;
/// Weight of a bifurcation's plane relative to the side of the second tree before the bifurcation.
const FORK: f64 = 2.0;

/// Network of two trees.
#[derive(Clone, Debug)]
pub struct Dual {
    /// Both trees; the nodes and edges of the first come first, unchanged.
    pub skeleton: Skeleton,
    /// Tree of each node: 0 for the first, 1 for the second, 2 for shared terminals.
    pub tree: Vec<u32>,
    /// Root of the second tree in each component that has one.
    pub roots: Vec<NodeId>,
}

/// Grows the second tree. The `original` of a copy is that of its node plus one more than the maximum.
///
/// Networks with loops are allowed: every vessel gets a companion. The root of a component is its thickest terminal.
///
/// ```
/// use anastomesh_network::{GenerateParams, Organ, dual, generate};
///
/// let tree = generate(&GenerateParams::new(Organ::Ellipsoid, 20))?;
/// let both = dual(&tree);
/// assert_eq!(both.tree.iter().filter(|&&of| of == 2).count(), 20);
/// # Ok::<(), anastomesh_network::GenerateError>(())
/// ```
pub fn dual(skeleton: &Skeleton) -> Dual {
    let adjacency = skeleton.adjacency();
    let components = skeleton.components(&adjacency);
    let roots = skeleton.roots(&adjacency, &components);
    let mut is_root = vec![false; skeleton.nodes.len()];
    for root in roots.iter().flatten() {
        is_root[root.index()] = true;
    }
    let seeds: Vec<NodeId> =
        roots.iter().zip(&components.list).filter_map(|(root, c)| root.or(c.nodes.first().copied())).collect();
    let sides = sides(skeleton, &adjacency, &seeds);
    let mut out = skeleton.clone();
    let beyond = skeleton.nodes.iter().map(|n| n.original).max().unwrap_or(0).saturating_add(1);
    let mut tree = vec![0; skeleton.nodes.len()];
    let mut copy: Vec<NodeId> = skeleton.node_ids().collect();
    for node in skeleton.node_ids() {
        let i = node.index();
        if adjacency.valence(node) == 1 && !is_root[i] {
            tree[i] = 2;
            continue;
        }
        copy[i] = NodeId(out.nodes.len() as u32);
        let thickest = adjacency.edges(node).iter().map(|&e| radius_at(skeleton, e, node)).fold(0.0, f64::max);
        let Node { position, radius, original } = *skeleton.node(node);
        let position: Point3 = position + sides[i] * (BESIDE * 2.0 * thickest);
        out.nodes.push(Node { position, radius, original: original.saturating_add(beyond) });
        tree.push(1);
    }
    for edge in &skeleton.edges {
        let nodes = edge.nodes.map(|n| copy[n.index()]);
        // A vessel between two terminals has no inner node to copy: its companion would be itself.
        if nodes != edge.nodes {
            out.edges.push(Edge { nodes, radii: edge.radii });
        }
    }
    let roots = roots.into_iter().flatten().map(|root| copy[root.index()]).collect();
    Dual { skeleton: out, tree, roots }
}

fn radius_at(skeleton: &Skeleton, edge: EdgeId, node: NodeId) -> f64 {
    let edge = skeleton.edge(edge);
    edge.radii[edge.end(node)]
}

/// Unit direction from each node to its copy, propagated along the vessels from the seeds.
fn sides(skeleton: &Skeleton, adjacency: &Adjacency, seeds: &[NodeId]) -> Vec<Vec3> {
    let mut sides = vec![Vec3::zeros(); skeleton.nodes.len()];
    let mut seen = vec![false; skeleton.nodes.len()];
    let mut queue = std::collections::VecDeque::new();
    let at = |n: NodeId| skeleton.node(n).position;
    for &seed in seeds {
        let Some(&first) = adjacency.edges(seed).first() else { continue };
        let way = at(skeleton.edge(first).other(seed)) - at(seed);
        sides[seed.index()] = side_of(skeleton, adjacency, seed, &way, &any_across(&way));
        seen[seed.index()] = true;
        queue.push_back(seed);
        while let Some(node) = queue.pop_front() {
            for &edge in adjacency.edges(node) {
                let next = skeleton.edge(edge).other(node);
                if std::mem::replace(&mut seen[next.index()], true) {
                    continue;
                }
                let way = at(next) - at(node);
                sides[next.index()] = side_of(skeleton, adjacency, next, &way, &sides[node.index()]);
                queue.push_back(next);
            }
        }
    }
    sides
}

/// Direction to the copy of a node reached along `way`; `before` is the previous direction.
fn side_of(skeleton: &Skeleton, adjacency: &Adjacency, node: NodeId, way: &Vec3, before: &Vec3) -> Vec3 {
    let way = way.try_normalize(0.0).unwrap_or_else(Vec3::x);
    let carried = (before - way * way.dot(before)).try_normalize(1e-6).unwrap_or_else(|| any_across(&way));
    let edges = adjacency.edges(node);
    let mut normal = Vec3::zeros();
    for (i, &e) in edges.iter().enumerate() {
        for &f in &edges[..i] {
            let [u, v] = [e, f].map(|e| {
                let chord = skeleton.node(skeleton.edge(e).other(node)).position - skeleton.node(node).position;
                chord.try_normalize(0.0).unwrap_or_else(Vec3::zeros)
            });
            let across = u.cross(&v);
            normal += if across.dot(&carried) < 0.0 { -across } else { across };
        }
    }
    let blended =
        carried + normal.try_normalize(1e-6).unwrap_or_else(Vec3::zeros) * if edges.len() > 2 { FORK } else { 0.0 };
    let blended = blended - way * way.dot(&blended);
    blended.try_normalize(1e-6).unwrap_or(carried)
}

fn any_across(way: &Vec3) -> Vec3 {
    let mut axis = Vec3::zeros();
    axis[way.iamin()] = 1.0;
    way.cross(&axis).try_normalize(0.0).unwrap_or(axis)
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_skeleton::fixtures::{network, tangle};

    #[test]
    fn shares_the_terminals_and_has_its_own_root() {
        let s = tangle(4, 2);
        let dual = dual(&s);
        assert_eq!(dual.skeleton.check(), Ok(()));
        let (before, after) = (s.adjacency(), dual.skeleton.adjacency());
        let terminals = before.terminals().len() - 1;
        assert_eq!(dual.skeleton.edges.len(), 2 * s.edges.len());
        assert_eq!(dual.skeleton.nodes.len(), 2 * s.nodes.len() - terminals);
        // Only the two roots remain open; each shared terminal but one closes a loop.
        assert_eq!(after.terminals(), [NodeId(0), dual.roots[0]]);
        let components = dual.skeleton.components(&after).list;
        assert_eq!((components.len(), components[0].loops()), (1, terminals - 1));
        assert_eq!(dual.tree.iter().filter(|t| **t == 2).count(), terminals);
        let mut originals: Vec<u32> = dual.skeleton.nodes.iter().map(|n| n.original).collect();
        originals.sort_unstable();
        originals.dedup();
        assert_eq!(originals.len(), dual.skeleton.nodes.len());
    }

    #[test]
    fn a_single_vessel_and_a_ring_have_companions_as_far_as_they_can() {
        let vessel = dual(&network(&[[0.0; 3], [9.0, 0.0, 0.0]], 1.0, &[(0, 1)]));
        assert_eq!((vessel.skeleton.check(), vessel.skeleton.edges.len()), (Ok(()), 2));
        let ring = dual(&network(&[[0.0; 3], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0]], 1.0, &[(0, 1), (1, 2), (2, 0)]));
        assert_eq!((ring.skeleton.check(), ring.skeleton.edges.len(), ring.roots.len()), (Ok(()), 6, 0));
    }
}

//! Splitting of nodes (section 3.1 of the paper): a node of valence above 3 becomes a chain of nodes of valence 3.

use anastomesh_mesh::geometry::Point3;
use anastomesh_skeleton::cuttability::THIN;
use anastomesh_skeleton::{Adjacency, Edge, EdgeId, Node, NodeId, Skeleton};
use serde::Serialize;
use std::sync::Arc;

/// Maximum halvings of the shift if an edge would become too short.
const HALVINGS: u32 = 8;
/// Sum of the shifts at a node, in its radii, if vessels are not to be moved apart. A smaller one gives tubes of bifurcations that
/// are shorter than the contour resolves; a larger one widens the lumen at nodes of many vessels.
const IN_PLACE: f64 = 0.1;

/// Node that was split, with the nodes and edges made of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SplitNode {
    /// The node; it keeps its id and moves upstream.
    pub node: NodeId,
    /// New nodes, in downstream order.
    pub made: Vec<NodeId>,
    /// Length of the shortest new edge, in radii of the node; 2 if space permits.
    pub shortest_link: f64,
}

/// Report of a split.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SplitReport {
    /// Split nodes, in ascending order.
    pub nodes: Vec<SplitNode>,
}

/// Splits every node of more than three edges until none remains.
///
/// The thickest vessel of the node (the parent, in a tree) defines the upstream direction. The old node moves up to one
/// radius upstream. It keeps the thickest vessel and the one that points most upstream. A new node up to one radius
/// downstream takes the others and is split in turn. The shift is at most half of the thickest vessel. It is halved
/// while an edge would be shorter than half its old length and half a radius. Murray's law gives the new edge's radius,
/// up to that of the node. Terminals do not move; a new node inherits the `original` of the split node.
///
/// The skeleton must satisfy `Skeleton::check`, as does the result.
pub fn split(skeleton: &Skeleton) -> (Skeleton, SplitReport) {
    split_by(skeleton, false)
}

/// Splits nodes of more than three edges like [`split`], with shifts whose sum is at most a tenth of a radius. Vessels keep their
/// places, and those that leave one node remain close to each other. Nodes of two vessels and any number of thin ones are left.
pub fn split_in_place(skeleton: &Skeleton) -> (Skeleton, SplitReport) {
    split_by(skeleton, true)
}

/// Splits nodes, in place or with shifts of up to a radius.
fn split_by(skeleton: &Skeleton, in_place: bool) -> (Skeleton, SplitReport) {
    let adjacency = skeleton.adjacency();
    let mut out = skeleton.clone();
    let mut report = SplitReport::default();
    for node in crowded(skeleton, &adjacency, in_place) {
        let reach = if in_place { IN_PLACE / (adjacency.valence(node) - 3) as f64 } else { 1.0 };
        report.nodes.push(split_node(&mut out, node, adjacency.edges(node).to_vec(), reach));
    }
    (out, report)
}

/// Splits a shared network in place. Returns the given network if no node has to be split.
pub fn split_shared(skeleton: &Arc<Skeleton>) -> (Arc<Skeleton>, SplitReport) {
    if crowded(skeleton, &skeleton.adjacency(), true).is_empty() {
        return (Arc::clone(skeleton), SplitReport::default());
    }
    let (skeleton, report) = split_in_place(skeleton);
    (Arc::new(skeleton), report)
}

/// Nodes of more than three edges, in place only those of more than two edges that are not thin.
fn crowded(skeleton: &Skeleton, adjacency: &Adjacency, in_place: bool) -> Vec<NodeId> {
    let is_wide = |node: NodeId, edge: EdgeId| radius_at(skeleton, edge, node) > THIN * skeleton.node(node).radius;
    let is_crowded = |&node: &NodeId| {
        let edges = adjacency.edges(node);
        edges.len() > 3 && (!in_place || edges.iter().filter(|&&edge| is_wide(node, edge)).count() > 2)
    };
    skeleton.node_ids().filter(is_crowded).collect()
}

fn split_node(skeleton: &mut Skeleton, node: NodeId, mut edges: Vec<EdgeId>, reach: f64) -> SplitNode {
    let radius = skeleton.node(node).radius;
    let mut done = SplitNode { node, made: Vec::new(), shortest_link: f64::INFINITY };
    let mut links = Vec::new();
    let mut current = node;
    while edges.len() > 3 {
        let (made, link, rest) = split_once(skeleton, current, &edges, reach);
        done.made.push(made);
        links.push(link);
        current = made;
        edges = rest;
        edges.push(link);
    }
    for link in links {
        done.shortest_link = done.shortest_link.min(skeleton.length(link) / radius);
    }
    done
}

/// Splits off one new node. Returns it, the edge that leads to it, and the edges moved to it.
fn split_once(skeleton: &mut Skeleton, node: NodeId, edges: &[EdgeId], reach: f64) -> (NodeId, EdgeId, Vec<EdgeId>) {
    let centre = *skeleton.node(node);
    let parent = thickest(skeleton, edges);
    let away = |s: &Skeleton, e: EdgeId| s.node(s.edge(e).other(node)).position - centre.position;
    let upstream = away(skeleton, parent).normalize();
    let cosine = |e: EdgeId| away(skeleton, e).normalize().dot(&upstream);
    let children: Vec<EdgeId> = edges.iter().copied().filter(|&e| e != parent).collect();
    let kept = children.iter().copied().fold(children[0], |best, e| if cosine(e) > cosine(best) { e } else { best });
    let rest: Vec<EdgeId> = children.into_iter().filter(|&e| e != kept).collect();

    let far = |e: EdgeId| skeleton.node(skeleton.edge(e).other(node)).position;
    let shift = room(&centre, far(parent), far(kept), &rest.iter().map(|&e| far(e)).collect::<Vec<_>>(), reach);
    let radius = murray(skeleton, node, &rest).min(centre.radius);
    let made = NodeId(skeleton.nodes.len() as u32);
    skeleton.nodes.push(Node { position: centre.position - upstream * shift, radius, original: centre.original });
    skeleton.nodes[node.index()].position = centre.position + upstream * shift;
    for &edge in &rest {
        let end = skeleton.edge(edge).end(node);
        skeleton.edges[edge.index()].nodes[end] = made;
    }
    let link = EdgeId(skeleton.edges.len() as u32);
    skeleton.edges.push(Edge { nodes: [node, made], radii: [radius, radius] });
    (made, link, rest)
}

/// Edge with the largest mean radius; the first among equals.
fn thickest(skeleton: &Skeleton, edges: &[EdgeId]) -> EdgeId {
    let radius = |e: EdgeId| skeleton.edge(e).mean_radius();
    edges.iter().copied().fold(edges[0], |best, e| if radius(e) > radius(best) { e } else { best })
}

/// Murray radius of a vessel that feeds the given ones (cubes add up), from their radii at `node`.
fn murray(skeleton: &Skeleton, node: NodeId, edges: &[EdgeId]) -> f64 {
    let largest = edges.iter().map(|&e| radius_at(skeleton, e, node)).fold(0.0, f64::max);
    // Divided by the largest, so that no unit of length under- or overflows.
    let cubes: f64 = edges.iter().map(|&e| (radius_at(skeleton, e, node) / largest).powi(3)).sum();
    largest * libm::cbrt(cubes)
}

fn radius_at(skeleton: &Skeleton, edge: EdgeId, node: NodeId) -> f64 {
    let edge = skeleton.edge(edge);
    edge.radii[edge.end(node)]
}

/// Maximum shift of the old node towards `parent` and of the new node away from it.
fn room(centre: &Node, parent: Point3, kept: Point3, rest: &[Point3], reach: f64) -> f64 {
    let toward = parent - centre.position;
    let length = toward.norm();
    let mut shift = (reach * centre.radius).min(0.5 * length);
    let fits = |shift: f64| {
        let (up, down) = (centre.position + toward * (shift / length), centre.position - toward * (shift / length));
        let long_enough = |from: &Point3, to: &Point3| {
            let before = (to - centre.position).norm();
            (to - from).norm() >= 0.5 * before.min(centre.radius)
        };
        long_enough(&up, &kept) && rest.iter().all(|to| long_enough(&down, to))
    };
    for _ in 0..HALVINGS {
        if fits(shift) {
            break;
        }
        shift *= 0.5;
    }
    shift
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Vessels from the origin to the given points.
    fn star(ends: &[[f64; 3]], radii: &[f64]) -> Skeleton {
        let mut nodes = vec![Node { position: Point3::origin(), radius: radii[0], original: 0 }];
        let mut edges = Vec::new();
        for (i, (&end, &radius)) in ends.iter().zip(radii).enumerate() {
            let id = i as u32 + 1;
            nodes.push(Node { position: end.into(), radius, original: id });
            edges.push(Edge { nodes: [NodeId(0), NodeId(id)], radii: [radius; 2] });
        }
        Skeleton { nodes, edges }
    }

    fn check(before: &Skeleton, after: &Skeleton, report: &SplitReport) {
        assert_eq!(after.check(), Ok(()));
        let (a, b) = (before.adjacency(), after.adjacency());
        assert!(after.node_ids().all(|n| b.valence(n) <= 3));
        let count = |s: &Skeleton, a: &anastomesh_skeleton::Adjacency| {
            let components = s.components(a).list;
            (components.len(), components.iter().map(anastomesh_skeleton::Component::loops).sum::<usize>())
        };
        assert_eq!(count(before, &a), count(after, &b));
        for node in before.node_ids() {
            if a.valence(node) <= 3 {
                assert_eq!(before.node(node), after.node(node));
            }
        }
        for edge in before.edge_ids() {
            assert_eq!(before.edge(edge).radii, after.edge(edge).radii);
        }
        for split in &report.nodes {
            assert_eq!(split.made.len(), a.valence(split.node) - 3);
            assert!(split.made.iter().all(|&m| after.node(m).original == before.node(split.node).original));
        }
    }

    #[test]
    fn thin_vessels_share_a_node_on_a_wide_one() {
        let ends = [[-5.0, 0.0, 0.0], [5.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 0.0, 3.0]];
        let thin = star(&ends, &[1.0, 1.0, 0.01, 0.1]);
        assert_eq!(split_in_place(&thin), (thin.clone(), SplitReport::default()));
        check(&thin, &split(&thin).0, &split(&thin).1);
        let (apart, report) = split_in_place(&star(&ends, &[1.0, 1.0, 0.01, 0.2]));
        assert_eq!((apart.nodes.len(), report.nodes.len()), (6, 1));
    }

    #[test]
    fn four_vessels_become_two_junctions_two_radii_apart() {
        let s = star(&[[0.0, 0.0, 9.0], [9.0, 0.0, -9.0], [-9.0, 0.0, -9.0], [0.0, 9.0, 1.0]], &[1.0, 0.6, 0.6, 0.5]);
        let (after, report) = split(&s);
        check(&s, &after, &report);
        assert!((after.nodes[0].position - Point3::new(0.0, 0.0, 1.0)).norm() < 1e-12);
        assert!((after.nodes[5].position - Point3::new(0.0, 0.0, -1.0)).norm() < 1e-12);
        // The sideways vessel stays upstream; the other two share the new node by Murray's law.
        assert_eq!(after.edges[3].nodes, [NodeId(0), NodeId(4)]);
        assert_eq!(after.edges[1].nodes, [NodeId(5), NodeId(2)]);
        assert!((after.nodes[5].radius - libm::cbrt(2.0 * 0.6_f64.powi(3))).abs() < 1e-12);
        assert!((report.nodes[0].shortest_link - 2.0).abs() < 1e-12);
    }

    #[test]
    fn short_vessels_are_not_swallowed() {
        let s = star(&[[0.0, 0.0, 0.2], [0.0, 0.1, -1.0], [0.1, 0.0, -1.0], [0.0, 0.0, -1.0]], &[1.0; 4]);
        let (after, report) = split(&s);
        check(&s, &after, &report);
        for edge in s.edge_ids() {
            assert!(after.length(edge) >= 0.5 * s.length(edge).min(1.0) - 1e-12);
        }
    }

    #[test]
    fn a_star_is_split_in_its_place() {
        let ends: Vec<[f64; 3]> =
            (0..12).map(f64::from).map(|a| [9.0 * libm::cos(a), 9.0 * libm::sin(a), a - 6.0]).collect();
        let s = star(&ends, &[1.0; 12]);
        let (after, report) = split_in_place(&s);
        check(&s, &after, &report);
        assert_eq!(report.nodes[0].made.len(), 9);
        for node in after.nodes.iter().filter(|node| node.original == 0) {
            assert!(node.position.coords.norm() < 1.01 * IN_PLACE, "{}", node.position);
        }
    }

    proptest! {
        #[test]
        fn any_graph_is_split(
            points in prop::collection::vec(prop::array::uniform3(-50.0..50.0_f64), 12),
            ends in prop::collection::vec((0..12_u32, 0..12_u32, 1..5_u8), 1..40),
        ) {
            let nodes = points.iter().enumerate();
            let nodes = nodes.map(|(i, &p)| Node { position: p.into(), radius: 1.0, original: i as u32 }).collect();
            let edge = |&(a, b, r): &(u32, u32, u8)| Edge { nodes: [NodeId(a), NodeId(b)], radii: [f64::from(r); 2] };
            let raw = Skeleton { nodes, edges: ends.iter().map(edge).collect() };
            if let Ok((s, _)) = anastomesh_skeleton::clean(&raw) {
                let (after, report) = split(&s);
                prop_assert_eq!(&split(&after).0, &after);
                check(&s, &after, &report);
            }
        }
    }
}

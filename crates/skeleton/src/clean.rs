//! Cleaning: from an input network to a skeleton that satisfies `Skeleton::check`.

use super::{Edge, EdgeId, Node, NodeId, Skeleton, SkeletonError};
use anastomesh_mesh::geometry::DisjointSets;
use anastomesh_mesh::units::counted;
use serde::Serialize;

/// Maximum length of an edge to be contracted, relative to its radius. The rounding of coordinates determines the
/// direction of such an edge.
const NEGLIGIBLE: f64 = 1e-6;

/// Summary of cleaning. Nodes and edges are numbered as in the input, from 0.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct CleanReport {
    /// Nodes exactly at an earlier node, merged with it: (node, the earlier one).
    pub coincident: Vec<(u32, u32)>,
    /// Edges without length, dropped: both ends are one node or lie at one point.
    pub zero_length: Vec<u32>,
    /// Edges shorter than a millionth of their radius, contracted to a point.
    pub contracted: Vec<u32>,
    /// Edges between the nodes of another one, dropped: (edge, the one that was kept: the thicker).
    pub repeated: Vec<(u32, u32)>,
    /// Nodes without an edge, dropped.
    pub isolated: Vec<u32>,
    /// Nodes inside a branch with a radius jump between edges; both ends were given the mean.
    pub blended: Vec<u32>,
}

impl CleanReport {
    /// True if nothing was changed.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Changes with their counts, as sentences; only those that occurred.
    pub fn changes(&self) -> Vec<String> {
        let done = [
            (self.coincident.len(), "node", "merged with another at the same position"),
            (self.zero_length.len(), "edge", "of zero length removed"),
            (self.contracted.len(), "edge", "shorter than 1e-6 radii contracted"),
            (self.repeated.len(), "repeated edge", "removed"),
            (self.isolated.len(), "node", "without edges removed"),
            (self.blended.len(), "radius jump", "within a branch smoothed"),
        ];
        let happened = done.into_iter().filter(|(count, ..)| *count > 0);
        happened.map(|(count, what, change)| format!("{} {change}", counted(count, what))).collect()
    }
}

/// Merges nodes at identical positions, drops edges without length, repeated edges and nodes without edges, and makes
/// the radius continuous along each branch.
///
/// Merged nodes keep the largest radius; edges keep their own radii. If the file has one radius per edge, the radius
/// jumps between edges: at a node of valence 2 both sides get the mean. At junctions the jump stays: a thin side branch
/// leaves a thick vessel with its own radius, and the surface blends the two. Centrelines that all start
/// at the inlet become one graph as far as their points coincide.
///
/// ```
/// use anastomesh_mesh::Point3;
/// use anastomesh_skeleton::{Edge, Node, NodeId, Skeleton, clean};
///
/// let node = |z: f64, original| Node { position: Point3::new(0.0, 0.0, z), radius: 1.0, original };
/// let edge = |a, b| Edge { nodes: [NodeId(a), NodeId(b)], radii: [1.0; 2] };
/// // The third node is where the second is.
/// let raw = Skeleton { nodes: vec![node(0.0, 0), node(9.0, 1), node(9.0, 2), node(20.0, 3)], edges: vec![edge(0, 1), edge(2, 3)] };
/// let (network, report) = clean(&raw)?;
/// assert_eq!((network.nodes.len(), report.coincident), (3, vec![(2, 1)]));
/// # Ok::<(), anastomesh_skeleton::SkeletonError>(())
/// ```
///
/// # Errors
/// If a number is unusable, an edge refers to a missing node, or no edge remains.
pub fn clean(raw: &Skeleton) -> Result<(Skeleton, CleanReport), SkeletonError> {
    if raw.edges.is_empty() {
        return Err(SkeletonError::NoVessel { nodes: raw.nodes.len() });
    }
    raw.check_numbers()?;
    let mut report = CleanReport::default();
    let merged = merge_nodes(raw, &mut report);
    let kept = keep_edges(raw, &merged, &mut report);
    let mut skeleton = renumber(raw, &merged, &kept, &mut report);
    if skeleton.edges.is_empty() {
        return Err(SkeletonError::NoVessel { nodes: raw.nodes.len() });
    }
    blend_radii(&mut skeleton, &mut report);
    Ok((skeleton, report))
}

/// Merged node of each node.
fn merge_nodes(raw: &Skeleton, report: &mut CleanReport) -> Vec<u32> {
    let mut sets = DisjointSets::new(raw.nodes.len());
    // Adding 0 turns −0 into 0.
    let key = |i: u32| raw.nodes[i as usize].position.coords.add_scalar(0.0);
    let order = |&i: &u32, &j: &u32| {
        let (a, b) = (key(i), key(j));
        let by_axis = (0..3).map(|k| a[k].total_cmp(&b[k])).find(|o| o.is_ne());
        by_axis.unwrap_or_else(|| i.cmp(&j))
    };
    let mut sorted: Vec<u32> = (0..raw.nodes.len() as u32).collect();
    sorted.sort_unstable_by(order);
    for group in sorted.chunk_by(|&i, &j| key(i) == key(j)) {
        for &node in &group[1..] {
            sets.join(group[0], node);
            report.coincident.push((raw.nodes[node as usize].original, raw.nodes[group[0] as usize].original));
        }
    }
    report.coincident.sort_unstable();
    for (id, edge) in raw.edges.iter().enumerate() {
        let [a, b] = edge.nodes.map(|n| n.0);
        let length = raw.length(EdgeId(id as u32));
        if length > 0.0 && length < NEGLIGIBLE * edge.mean_radius() {
            sets.join(a, b);
            report.contracted.push(id as u32);
        }
    }
    (0..raw.nodes.len() as u32).map(|i| sets.root(i)).collect()
}

/// Edges to keep, in ascending order.
fn keep_edges(raw: &Skeleton, merged: &[u32], report: &mut CleanReport) -> Vec<u32> {
    let ends = |id: u32| {
        let [a, b] = raw.edges[id as usize].nodes.map(|n| merged[n.index()]);
        [a.min(b), a.max(b)]
    };
    let mut kept = Vec::with_capacity(raw.edges.len());
    for id in 0..raw.edges.len() as u32 {
        let [a, b] = ends(id);
        if a != b {
            kept.push(id);
        } else if report.contracted.binary_search(&id).is_err() {
            report.zero_length.push(id);
        }
    }
    kept.sort_unstable_by_key(|&id| (ends(id), id));
    let mut unique = Vec::with_capacity(kept.len());
    for group in kept.chunk_by(|&i, &j| ends(i) == ends(j)) {
        let radius = |id: u32| raw.edges[id as usize].mean_radius();
        let thickest =
            group.iter().copied().fold(group[0], |best, id| if radius(id) > radius(best) { id } else { best });
        unique.push(thickest);
        report.repeated.extend(group.iter().filter(|&&id| id != thickest).map(|&id| (id, thickest)));
    }
    report.repeated.sort_unstable();
    unique.sort_unstable();
    unique
}

fn renumber(raw: &Skeleton, merged: &[u32], kept: &[u32], report: &mut CleanReport) -> Skeleton {
    const UNUSED: u32 = u32::MAX;
    const USED: u32 = u32::MAX - 1;
    let mut new_id = vec![UNUSED; raw.nodes.len()];
    for node in kept.iter().flat_map(|&e| raw.edges[e as usize].nodes) {
        new_id[merged[node.index()] as usize] = USED;
    }
    let mut nodes: Vec<Node> = Vec::new();
    for (i, node) in raw.nodes.iter().enumerate() {
        let target = merged[i] as usize;
        if target != i {
            if let Some(earlier) = nodes.get_mut(new_id[target] as usize) {
                earlier.radius = earlier.radius.max(node.radius);
            }
        } else if new_id[i] == USED {
            new_id[i] = nodes.len() as u32;
            nodes.push(*node);
        } else {
            report.isolated.push(node.original);
        }
    }
    let rename = |n: NodeId| NodeId(new_id[merged[n.index()] as usize]);
    let edges = kept.iter().map(|&id| {
        let edge = raw.edges[id as usize];
        Edge { nodes: edge.nodes.map(rename), radii: edge.radii }
    });
    Skeleton { edges: edges.collect(), nodes }
}

/// Makes the radius continuous at nodes of valence 2.
fn blend_radii(skeleton: &mut Skeleton, report: &mut CleanReport) {
    let adjacency = skeleton.adjacency();
    for node in skeleton.node_ids() {
        let &[e, f] = adjacency.edges(node) else { continue };
        let slots = [e, f].map(|id| (id.index(), skeleton.edge(id).end(node)));
        let [a, b] = slots.map(|(edge, end)| skeleton.edges[edge].radii[end]);
        if (a - b).abs() > 0.0 {
            for (edge, end) in slots {
                skeleton.edges[edge].radii[end] = 0.5 * (a + b);
            }
            report.blended.push(skeleton.node(node).original);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::skeleton;
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn overlapping_lines_become_one_graph() {
        // Two lines from inlet 0: 0-1-2-3 and 4-5-6-7, with points 4, 5, 6 at 0, 1, 2.
        let mut raw = skeleton(9, &[(0, 1), (1, 2), (2, 3), (4, 5), (5, 6), (6, 7), (7, 7)]);
        for (copy, of) in [(4, 0), (5, 1), (6, 2)] {
            raw.nodes[copy].position = raw.nodes[of].position;
        }
        raw.nodes[5].radius = 2.0;
        let (s, report) = clean(&raw).unwrap();
        assert_eq!(s.check(), Ok(()));
        assert_eq!((s.nodes.len(), s.edges.len()), (5, 4));
        assert_eq!(report.coincident, [(4, 0), (5, 1), (6, 2)]);
        assert_eq!(report.repeated, [(3, 0), (4, 1)]);
        assert_eq!(report.zero_length, [6]);
        assert_eq!(report.isolated, [8]);
        assert_eq!(s.adjacency().valence(NodeId(2)), 3);
        assert!((s.nodes[1].radius - 2.0).abs() < 1e-15);
        assert_eq!(s.nodes.iter().map(|n| n.original).collect::<Vec<_>>(), [0, 1, 2, 3, 7]);
    }

    #[test]
    fn the_thicker_of_repeated_edges_stays() {
        let mut raw = skeleton(2, &[(0, 1), (1, 0), (0, 1)]);
        raw.edges[1].radii = [3.0, 3.0];
        let (s, report) = clean(&raw).unwrap();
        assert_eq!(s.edges, [raw.edges[1]]);
        assert_eq!(report.repeated, [(0, 1), (2, 1)]);
    }

    #[test]
    fn radius_is_continuous_along_a_branch_and_jumps_at_a_junction() {
        let mut raw = skeleton(5, &[(0, 1), (2, 1), (2, 3), (2, 4)]);
        raw.edges[0].radii = [4.0, 4.0];
        raw.edges[1].radii = [2.0, 2.0];
        let (s, report) = clean(&raw).unwrap();
        assert_eq!(s.edges[0].radii, [4.0, 3.0]);
        assert_eq!(s.edges[1].radii, [2.0, 3.0]);
        assert_eq!(s.edges[2].radii, [1.0, 1.0]);
        assert_eq!(report.blended, [1]);
    }

    #[test]
    fn tiny_edges_are_contracted_and_nothing_is_left_unjoined() {
        let mut raw = skeleton(4, &[(0, 1), (1, 2), (2, 3)]);
        raw.nodes[2].position = raw.nodes[1].position + anastomesh_mesh::geometry::Vec3::new(1e-15, 1e-14, 0.0);
        let (s, report) = clean(&raw).unwrap();
        assert_eq!(report.contracted, [1]);
        assert_eq!(s.edges.len(), 2);
        assert_eq!(s.components(&s.adjacency()).list.len(), 1);
    }

    #[test]
    fn nothing_to_mesh_is_an_error() {
        assert_eq!(clean(&skeleton(1, &[])), Err(SkeletonError::NoVessel { nodes: 1 }));
        assert_eq!(clean(&skeleton(2, &[(1, 1)])), Err(SkeletonError::NoVessel { nodes: 2 }));
        assert!(matches!(clean(&skeleton(2, &[(1, 7)])), Err(SkeletonError::UnknownNode { .. })));
    }

    proptest! {
        #[test]
        fn any_graph_comes_out_clean_and_cleaning_again_changes_nothing(
            edges in prop::collection::vec((0..30_u32, 0..30_u32, 1..4_u8, 1..4_u8), 1..60),
            moved in prop::collection::vec((0..30_usize, 0..30_usize), 0..10),
        ) {
            let ends: Vec<(u32, u32)> = edges.iter().map(|e| (e.0, e.1)).collect();
            let mut raw = skeleton(30, &ends);
            for (edge, e) in raw.edges.iter_mut().zip(&edges) {
                edge.radii = [f64::from(e.2), f64::from(e.3)];
            }
            for (a, b) in moved {
                raw.nodes[a].position = raw.nodes[b].position;
            }
            if let Ok((s, _)) = clean(&raw) {
                prop_assert_eq!(s.check(), Ok(()));
                let (again, report) = clean(&s).unwrap();
                prop_assert_eq!(&again, &s);
                prop_assert!(report.is_empty());
            }
        }
    }
}

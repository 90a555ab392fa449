//! Merging of duplicate lines of one vessel.
//!
//! VMTK centrelines run from the inlet to each outlet, so the trunk occurs once per outlet; assembled networks have
//! duplicates, too. Two lines run together while each lies within the radius of the other, with the same direction.
//! They separate where one leaves the tube of the other. (Antiga, Steinman, 'Robust and objective decomposition and
//! mapping of bifurcating vessels', IEEE Transactions on Medical Imaging 23, 2004). The longest of them is kept, but for
//! lines within wider ones; the others begin at their separation from it.

mod line;
mod meet;
mod nested;
mod runs;

use anastomesh_mesh::geometry::Point3;
use anastomesh_skeleton::{Edge, EdgeId, LineGroup, Node, NodeId, Skeleton, SkeletonError, clean};
use line::{SampledLine, lines_of};
use rayon::prelude::*;
use runs::{Course, DoubledStretch, Foot, KeptLines, runs};
use serde::Serialize;

/// Nodes closer to an edge's end than this fraction of a radius are moved to that end.
const NEAR: f64 = 1e-3;

/// Place at which a line leaves the tube of another one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Parting {
    /// Last node of the line within the other's tube: VMTK's branching point, to within an edge length.
    pub leaves: u32,
    /// Node of separation in the graph, at the end of the trunk.
    pub branches: u32,
}

/// Removed part of a line that ran together with another one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Merged {
    /// First and last node of the part.
    pub nodes: [u32; 2],
    /// Nodes of the other line's edge next to the first node.
    pub with: [u32; 2],
    /// Length of the part, in the unit of the network.
    pub length: f64,
    /// Maximum distance of the two lines over the part, in radii.
    pub apart: f64,
    /// Separations from the other line; empty if both end together.
    pub partings: Vec<Parting>,
}

/// Report of the merge.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MergeReport {
    /// Number of input lines: branches, split where they turn back.
    pub lines: usize,
    /// Pairs of tips that coincided within rounding and were merged.
    pub met: Vec<[u32; 2]>,
    /// Removed parts.
    pub merged: Vec<Merged>,
    /// True if the merge stopped early because too many lines overlap.
    pub gave_up: bool,
}

/// Merges lines that run together. `groups` holds the vessel of each node's lines, if the file has them. The result
/// satisfies `Skeleton::check`.
pub(super) fn merge(
    skeleton: &Skeleton,
    groups: &[Option<LineGroup>],
) -> Result<(Skeleton, MergeReport), SkeletonError> {
    let (skeleton, met) = meet::join(skeleton)?;
    let skeleton = &skeleton;
    let adjacency = skeleton.adjacency();
    let branches = skeleton.branches(&adjacency);
    let parts: Vec<Vec<SampledLine>> = branches.list.par_iter().map(|b| lines_of(skeleton, b)).collect();
    let lines: Vec<SampledLine> = parts.into_iter().flatten().collect();
    let nested = nested::nested(skeleton, &lines);
    let mut order: Vec<usize> = (0..lines.len()).collect();
    // Stable sort: of equal lines the earlier comes first.
    order.sort_by(|&a, &b| nested[a].cmp(&nested[b]).then(lines[b].length().total_cmp(&lines[a].length())));
    let mut report = MergeReport { lines: lines.len(), met, ..MergeReport::default() };
    let mut kept = KeptLines::new(skeleton, LineGroup::of_edges(skeleton, groups));
    let mut changes = Changes::new(skeleton);
    for line in order.into_iter().map(|i| &lines[i]) {
        let feet = kept.feet(line);
        let along = kept.along(line);
        let points: Vec<Point3> = line.nodes.iter().map(|&n| skeleton.node(n).position).collect();
        let open = [0, line.last()].map(|i| adjacency.valence(line.nodes[i]) == 1);
        let found: Vec<DoubledStretch> = runs(&Course { line, feet: &feet, along: &along, points: &points }, open);
        for run in &found {
            changes.apply(line, &feet, open, run);
            for at in [run.first, run.last] {
                if let Some(foot) = &feet[at] {
                    kept.attach(line.nodes[at], foot);
                }
            }
        }
        report.merged.extend(found.iter().map(|run| told(skeleton, line, &feet, run)));
        kept.keep(line, &found);
    }
    report.gave_up = kept.gave_up();
    if report.merged.is_empty() {
        return Ok((skeleton.clone(), report));
    }
    Ok((clean(&changes.applied())?.0, report))
}

/// Converts a run to its report entry.
fn told(skeleton: &Skeleton, line: &SampledLine, feet: &[Option<Foot>], run: &DoubledStretch) -> Merged {
    let name = |i: usize| skeleton.node(line.nodes[i]).original;
    let within = || (run.first..=run.last).filter_map(|i| feet[i].map(|f| (i, f)));
    let beside = within().next().map_or([line.nodes[run.first]; 2], |(_, f)| skeleton.edge(f.edge).nodes);
    let partings = run.parts.iter().zip([run.first, run.last]);
    Merged {
        nodes: [run.first, run.last].map(name),
        with: beside.map(|n| skeleton.node(n).original),
        length: line.arc[run.last] - line.arc[run.first],
        apart: within().map(|(i, f)| f.distance / line.radii[i]).fold(0.0, f64::max),
        partings: partings
            .filter_map(|(leaves, at)| Some(Parting { leaves: name((*leaves)?), branches: name(at) }))
            .collect(),
    }
}

/// Collected changes to the graph.
struct Changes<'a> {
    skeleton: &'a Skeleton,
    gone: Vec<bool>,
    /// Nodes to insert into edges.
    feet: Vec<(EdgeId, f64, NodeId)>,
}

/// Follows replacements of a node to the final one. Terminates, as only unreplaced nodes serve as targets.
fn last(onto: &[NodeId], mut node: NodeId) -> NodeId {
    while onto[node.index()] != node {
        node = onto[node.index()];
    }
    node
}

impl<'a> Changes<'a> {
    fn new(skeleton: &'a Skeleton) -> Self {
        Self { skeleton, gone: vec![false; skeleton.edges.len()], feet: Vec::new() }
    }

    /// Removes a run and joins the ends of its line to the other line, except tips, which are removed with it.
    fn apply(&mut self, line: &SampledLine, feet: &[Option<Foot>], open: [bool; 2], run: &DoubledStretch) {
        let tips = [open[0] && run.first == 0, open[1] && run.last == line.last()];
        for (at, tip) in [run.first, run.last].into_iter().zip(tips) {
            if let (Some(foot), false) = (feet[at], tip) {
                self.feet.push((foot.edge, foot.t, line.nodes[at]));
            }
        }
        for &edge in &line.edges[run.first..run.last] {
            self.gone[edge.index()] = true;
        }
    }

    /// Returns the graph without removed edges; edges are split at inserted nodes.
    fn applied(mut self) -> Skeleton {
        self.feet.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let mut nodes: Vec<Node> = self.skeleton.nodes.clone();
        let mut onto: Vec<NodeId> = self.skeleton.node_ids().collect();
        let mut edges: Vec<Edge> = Vec::with_capacity(self.skeleton.edges.len() + self.feet.len());
        let mut feet = self.feet.iter().peekable();
        for id in self.skeleton.edge_ids().filter(|id| !self.gone[id.index()]) {
            let mut edge = *self.skeleton.edge(id);
            let tube = self.skeleton.tube(id);
            while let Some(&(_, t, node)) = feet.next_if(|f| f.0 == id) {
                // A node at the end of an edge is replaced by that end.
                let off = [t * tube.length() / tube.ra, (1.0 - t) * tube.length() / tube.rb];
                if let Some(end) = off.iter().position(|&off| off < NEAR) {
                    let [of, end] = [node, self.skeleton.edge(id).nodes[end]].map(|n| last(&onto, n));
                    onto[of.index()] = end;
                    continue;
                }
                let radius = tube.radius(t);
                nodes[node.index()] = Node { position: tube.point(t), radius, original: nodes[node.index()].original };
                edges.push(Edge { nodes: [edge.nodes[0], node], radii: [edge.radii[0], radius] });
                edge = Edge { nodes: [node, edge.nodes[1]], radii: [radius, edge.radii[1]] };
            }
            edges.push(edge);
        }
        for edge in &mut edges {
            edge.nodes = edge.nodes.map(|n| last(&onto, n));
        }
        Skeleton { nodes, edges }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two parallel straight lines of 30 points, `apart` radii apart.
    fn beside(apart: f64) -> Skeleton {
        let mut s = Skeleton::default();
        for line in 0..2 {
            for i in 0..30 {
                let id = s.nodes.len() as u32;
                let position = Point3::new(f64::from(i) * 0.5, f64::from(line) * apart, 0.0);
                s.nodes.push(Node { position, radius: 1.0, original: id });
                if i > 0 {
                    s.edges.push(Edge { nodes: [NodeId(id - 1), NodeId(id)], radii: [1.0; 2] });
                }
            }
        }
        s
    }

    fn groups(of_lines: [i64; 2], blanked: bool) -> Vec<Option<LineGroup>> {
        (0..60).map(|i| Some(LineGroup { group: of_lines[i / 30], blanked })).collect()
    }

    fn lines_left(apart: f64, groups: &[Option<LineGroup>]) -> usize {
        let (merged, _) = merge(&beside(apart), groups).unwrap();
        merged.branches(&merged.adjacency()).list.len()
    }

    #[test]
    fn groups_go_before_geometry() {
        let geometry = [lines_left(0.8, &[]), lines_left(0.8, &groups([3, 4], true))];
        assert_eq!(geometry, [1, 1], "within each other, and no group inside a branching");
        assert_eq!(lines_left(0.8, &groups([3, 4], false)), 2);
    }

    /// The thinnest of concentric vessels is the longest, as it contains an edge that joins them.
    #[test]
    fn the_widest_of_concentric_vessels_is_kept() {
        let mut s = beside(0.01);
        for (i, node) in s.nodes.iter_mut().enumerate() {
            node.radius = if i < 30 { 1.0 } else { 3.0 };
        }
        for edge in &mut s.edges[29..] {
            edge.radii = [3.0; 2];
        }
        s.edges.push(Edge { nodes: [NodeId(0), NodeId(30)], radii: [3.0; 2] });
        let (merged, report) = merge(&s, &[]).unwrap();
        assert!(merged.edges.iter().all(|edge| edge.radii == [3.0; 2]), "{merged:?}");
        assert_eq!((merged.branches(&merged.adjacency()).list.len(), report.merged.len()), (1, 1));
    }

    #[test]
    fn one_of_two_radii_is_enough_within_a_group() {
        let mut s = beside(1.2);
        for node in &mut s.nodes[..30] {
            node.radius = 2.0;
        }
        for edge in &mut s.edges[..29] {
            edge.radii = [2.0; 2];
        }
        let left = |groups: &[Option<LineGroup>]| {
            let (merged, _) = merge(&s, groups).unwrap();
            merged.branches(&merged.adjacency()).list.len()
        };
        assert_eq!((left(&[]), left(&groups([3, 3], false))), (2, 1));
    }
}

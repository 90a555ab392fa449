//! Crotches: overlaps of two vessels that continue, without a gap, up to the bifurcation that joins them.
//!
//! Branches that leave a bifurcation at a small angle overlap far beyond it, as measured airways and arteries do. Their union
//! has the topology of the bifurcation: it divides where the tubes separate. A vessel that returns to another one, or to
//! itself, encloses a hole or joins what is apart.

use super::{Adjacency, EdgeId, JOINED, NodeId, Overlap, Skeleton};
use anastomesh_mesh::geometry::{Point3, Total, Tube};
use rustc_hash::FxHashMap;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Maximum length of the path between the two places of a crotch, in sums of their radii.
const REACH: f64 = 60.0;
/// Maximum number of nodes in the search for this path.
const MOST_NODES: usize = 4000;
/// Step along the vessels, in radii, and maximum number of steps.
const STEP: f64 = 0.25;
const MOST_STEPS: usize = 4000;

/// Rule for the crotches of a network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrotchRule {
    /// Factor on the radii. Tubes of these radii must overlap along a crotch.
    pub narrower: f64,
    /// Path length, in sums of the radii of the overlap, by which its places may lie beyond the crotch.
    pub beyond: f64,
    /// Distance, in sums of radii, by which the vessels may part on that path. If they part further, they enclose a gap.
    pub parting: f64,
}

impl Default for CrotchRule {
    fn default() -> Self {
        Self { narrower: 1.0, beyond: 0.5 * JOINED, parting: f64::INFINITY }
    }
}

impl Skeleton {
    /// True if an overlap lies in the crotch of a bifurcation, or at most a certain length beyond its end. The two vessels then
    /// overlap at all pairs of places between there and their bifurcation.
    pub fn is_in_crotch(&self, adjacency: &Adjacency, overlap: &Overlap, rule: CrotchRule) -> bool {
        CrotchSearch::default().is_in_crotch(self, adjacency, overlap, rule)
    }

    /// Tube of an edge, from one of its nodes.
    fn oriented(&self, edge: EdgeId, from: NodeId) -> Tube {
        let tube = self.tube(edge);
        if self.edge(edge).nodes[0] == from { tube } else { Tube { a: tube.b, b: tube.a, ra: tube.rb, rb: tube.ra } }
    }

    /// Part of an edge between a place on it and one of its nodes; with `towards`, from the place to the node.
    fn piece(&self, edge: EdgeId, place: &Point3, node: NodeId, towards: bool) -> Tube {
        let tube = self.oriented(edge, node);
        let length = tube.length();
        let t = if length > 0.0 { ((place - tube.a).norm() / length).min(1.0) } else { 0.0 };
        let radius = tube.radius(t);
        if towards {
            Tube { a: *place, b: tube.a, ra: radius, rb: tube.ra }
        } else {
            Tube { a: tube.a, b: *place, ra: tube.ra, rb: radius }
        }
    }
}

/// Search for crotches in one skeleton. Successive overlaps of one edge share the paths from it, which take most of the
/// time in tangled networks. Overlaps are best in ascending order.
#[derive(Debug, Default)]
pub struct CrotchSearch {
    /// First edge of the last overlap.
    from: Option<EdgeId>,
    /// Paths from its ends.
    paths: [ShortestPaths; 2],
}

impl CrotchSearch {
    /// See [`Skeleton::is_in_crotch`]. All calls must have the same skeleton.
    pub fn is_in_crotch(
        &mut self,
        skeleton: &Skeleton,
        adjacency: &Adjacency,
        overlap: &Overlap,
        rule: CrotchRule,
    ) -> bool {
        let Some(path) = self.path(skeleton, adjacency, overlap) else { return false };
        path.closes(rule, rule.beyond * overlap.radii)
    }

    /// Shortest path along the vessels between the two places of an overlap; `None` if it is long.
    fn path(&mut self, skeleton: &Skeleton, adjacency: &Adjacency, overlap: &Overlap) -> Option<Path> {
        let [first, second] = overlap.edges;
        let [p, q] = overlap.points;
        if first == second {
            return None;
        }
        if self.from != Some(first) {
            self.from = Some(first);
            self.paths.iter_mut().zip(overlap.nodes[0]).for_each(|(paths, node)| paths.restart(node));
        }
        let at = |n: NodeId| skeleton.node(n).position;
        let mut limit = REACH * overlap.radii;
        let mut best: Option<(usize, NodeId)> = None;
        for (i, paths) in self.paths.iter_mut().enumerate() {
            let start = (at(overlap.nodes[0][i]) - p).norm();
            for node in overlap.nodes[1] {
                let rest = start + (at(node) - q).norm();
                let Some(length) = paths.to(skeleton, adjacency, node, [first, second], limit - rest) else { continue };
                if best.is_none() || rest + length < limit {
                    (limit, best) = (rest + length, Some((i, node)));
                }
            }
        }
        let (start, mut node) = best?;
        // From the second place back to the first.
        let mut path = Path { tubes: Vec::new(), arc: vec![0.0], bifurcations: Vec::new(), length: limit };
        path.push(skeleton.piece(second, &q, node, true));
        loop {
            if adjacency.valence(node) > 2 {
                path.bifurcations.push(path.end());
            }
            let Some(edge) = self.paths[start].before(node) else { break };
            path.push(skeleton.oriented(edge, node));
            node = skeleton.edge(edge).other(node);
        }
        path.push(skeleton.piece(first, &p, node, false));
        Some(path)
    }
}

/// Shortest paths from a node (Dijkstra's algorithm), found as far as they are asked for.
#[derive(Debug, Default)]
struct ShortestPaths {
    /// Length of the path to a node, and its last edge.
    found: FxHashMap<NodeId, (f64, Option<EdgeId>)>,
    /// Nearest first.
    heap: BinaryHeap<Reverse<(Total, NodeId, Option<EdgeId>)>>,
}

impl ShortestPaths {
    fn restart(&mut self, start: NodeId) {
        self.found.clear();
        self.heap.clear();
        self.heap.push(Reverse((Total(0.0), start, None)));
    }

    /// Last edge of the path to a node; `None` at its start.
    fn before(&self, node: NodeId) -> Option<EdgeId> {
        self.found.get(&node).and_then(|&(_, by)| by)
    }

    /// Length of the path to an end of the second edge, which does not lead through either edge. `None` if it is longer than the
    /// limit.
    fn to(
        &mut self,
        skeleton: &Skeleton,
        adjacency: &Adjacency,
        node: NodeId,
        [first, second]: [EdgeId; 2],
        limit: f64,
    ) -> Option<f64> {
        while !self.found.contains_key(&node) && self.found.len() <= MOST_NODES {
            let &Reverse((Total(distance), next, by)) = self.heap.peek()?;
            if distance > limit {
                return None;
            }
            self.heap.pop();
            if self.found.contains_key(&next) {
                continue;
            }
            self.found.insert(next, (distance, by));
            for &edge in adjacency.edges(next).iter().filter(|&&edge| edge != first) {
                let beyond = skeleton.edge(edge).other(next);
                if !self.found.contains_key(&beyond) {
                    self.heap.push(Reverse((Total(distance + skeleton.length(edge)), beyond, Some(edge))));
                }
            }
        }
        let &(length, by) = self.found.get(&node)?;
        (length <= limit && by != Some(second)).then_some(length)
    }
}

/// Path along vessels.
struct Path {
    tubes: Vec<Tube>,
    /// Length up to the start of each tube, and to the end of the last one.
    arc: Vec<f64>,
    /// Lengths up to the bifurcations.
    bifurcations: Vec<f64>,
    length: f64,
}

impl Path {
    fn push(&mut self, tube: Tube) {
        self.arc.push(self.end() + tube.length());
        self.tubes.push(tube);
    }

    fn end(&self) -> f64 {
        self.arc.last().copied().unwrap_or(0.0)
    }

    /// Point and radius at a length.
    fn at(&self, s: f64) -> (Point3, f64) {
        let i = self.arc.partition_point(|&arc| arc <= s).clamp(1, self.tubes.len()) - 1;
        let tube = &self.tubes[i];
        let length = tube.length();
        let t = if length > 0.0 { ((s - self.arc[i]) / length).clamp(0.0, 1.0) } else { 0.0 };
        (tube.point(t), tube.radius(t))
    }

    /// True if the ends of the path can approach each other until they are joined. Tubes must overlap at both places
    /// all the time, except for a length at the beginning. A bifurcation must lie between them at the end.
    fn closes(&self, rule: CrotchRule, beyond: f64) -> bool {
        let (mut low, mut high) = (0.0, self.end());
        let mut has_met = false;
        let mut least = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let [(_, ra), (_, rb)] = [self.at(low), self.at(high)];
            let thick = ra.max(rb) * rule.narrower;
            if high - low <= JOINED * thick {
                return self.bifurcations.iter().any(|&s| (low - thick..=high + thick).contains(&s));
            }
            // Relative distance of the axes: below 1 where the tubes overlap.
            let apart = |&(low, high): &(f64, f64)| {
                let [(p, ra), (q, rb)] = [self.at(low), self.at(high)];
                (p - q).norm() / (rule.narrower * (ra + rb))
            };
            let step = STEP * rule.narrower * ra.min(rb);
            let ways = [(low + step, high - step), (low + step, high), (low, high - step)];
            let Some(&next) = ways.iter().min_by(|a, b| apart(a).total_cmp(&apart(b))) else { return false };
            let distance = apart(&next);
            let meets = distance < 1.0;
            has_met |= meets;
            (low, high) = next;
            least = least.min(distance);
            if !meets && (has_met || self.length - (high - low) > beyond || distance > least + rule.parting) {
                return false;
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::network;

    fn in_crotch(points: &[[f64; 3]], edges: &[(u32, u32)]) -> Vec<bool> {
        let s = network(points, 1.0, edges);
        let adjacency = s.adjacency();
        let pairs = s.overlaps(&adjacency).pairs;
        assert!(!pairs.is_empty());
        pairs.iter().map(|o| s.is_in_crotch(&adjacency, o, CrotchRule::default())).collect()
    }

    /// A trunk, and two branches in pieces whose distance in radii is given along them.
    fn fork(apart: &[f64]) -> (Vec<[f64; 3]>, Vec<(u32, u32)>) {
        let (mut points, mut edges) = (vec![[-9.0, 0.0, 0.0], [0.0; 3]], vec![(0, 1)]);
        for side in [-0.5, 0.5] {
            let mut last = 1;
            for (i, y) in apart.iter().enumerate() {
                edges.push((last, points.len() as u32));
                last = points.len() as u32;
                points.push([2.0 * (i as f64 + 1.0), side * y, 0.0]);
            }
        }
        (points, edges)
    }

    #[test]
    fn branches_that_separate_slowly_have_a_crotch() {
        let apart: Vec<f64> = (1..20).map(|i| 0.2 * f64::from(i)).collect();
        let (points, edges) = fork(&apart);
        let found = in_crotch(&points, &edges);
        assert!(found.iter().all(|&is_in| is_in), "{found:?}");
    }

    #[test]
    fn branches_that_meet_again_have_none_there() {
        let (points, edges) = fork(&[1.5, 2.5, 4.0, 4.0, 2.5, 1.0, 1.0, 2.5, 4.0]);
        assert!(in_crotch(&points, &edges).contains(&false));
    }

    #[test]
    fn vessels_that_part_before_their_crotch_enclose_a_gap() {
        let (points, edges) = fork(&[1.2, 1.7, 2.6, 2.1, 4.0, 6.0]);
        let s = network(&points, 1.2, &edges);
        let adjacency = s.adjacency();
        let at_end = s.overlaps(&adjacency).pairs.into_iter().filter(|o| o.points[0].x > 7.0).collect::<Vec<_>>();
        assert!(!at_end.is_empty());
        let is_in = |parting| {
            let rule = CrotchRule { narrower: 1.0 / 1.2, beyond: 6.0, parting };
            at_end.iter().all(|o| s.is_in_crotch(&adjacency, o, rule))
        };
        assert!(is_in(f64::INFINITY) && !is_in(0.15));
    }

    #[test]
    fn a_bend_without_a_bifurcation_is_no_crotch() {
        let (points, edges) = fork(&[1.0, 1.2, 1.3, 1.4, 1.5, 1.6, 1.7, 1.8]);
        let found = in_crotch(&points, &edges[1..]);
        assert!(found.iter().all(|&is_in| !is_in), "{found:?}");
    }

    #[test]
    fn a_vessel_that_crosses_is_in_no_crotch() {
        let points = [[-9.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, -9.0, 1.5], [0.0, 9.0, 1.5]];
        assert_eq!(in_crotch(&points, &[(0, 1), (2, 3)]), [false]);
    }
}

//! Overlaps of vessels.
//!
//! Two points of the skeleton overlap if their distance is below the sum of their radii. Points that are close along the
//! skeleton are excepted, because vessels always overlap near the junction or bend that joins them. Close means within
//! 3 r on either side, so at most 6 r apart along the skeleton. Here r is the larger of the two radii, since a thin
//! vessel that leaves a thick one starts inside it.

use super::walk::LocalDistances;
use super::{Adjacency, EdgeId, NodeId, Skeleton};
use anastomesh_mesh::geometry::{Aabb, Bvh, Point3, Tube, minimise_convex, point_tube, tube_tube};
use rayon::prelude::*;
use serde::Serialize;

/// Distance along the skeleton, in radii, within which points belong to one junction or bend.
pub const JOINED: f64 = 6.0;

/// Maximum pairs of edges tested, more than in any network that is not a single tangle.
const MOST_PAIRS: usize = 100_000_000;

/// Edges processed at a time.
const AT_A_TIME: usize = 1 << 14;

/// Two overlapping edges, and their deepest overlap.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Overlap {
    /// The two edges, in ascending order.
    pub edges: [EdgeId; 2],
    /// The nodes of each edge.
    pub nodes: [[NodeId; 2]; 2],
    /// Axis points of the deepest overlap.
    #[serde(serialize_with = "as_arrays")]
    pub points: [Point3; 2],
    /// Distance of the two points.
    pub distance: f64,
    /// Sum of the radii there; larger than `distance`.
    pub radii: f64,
}

fn as_arrays<S: serde::Serializer>(points: &[Point3; 2], serializer: S) -> Result<S::Ok, S::Error> {
    points.map(<[f64; 3]>::from).serialize(serializer)
}

/// Overlaps of a skeleton.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Overlaps {
    /// Pairs of overlapping edges, in ascending order.
    pub pairs: Vec<Overlap>,
    /// Pairs of intersecting edges without a common node, however close they are along the skeleton, including
    /// neighbours along a polyline. In ascending order.
    pub unconnected: Vec<[EdgeId; 2]>,
    /// Number of these that are not joined by an edge either.
    pub far: usize,
    /// False if there were too many pairs of close edges to test all.
    pub complete: bool,
}

impl Overlap {
    /// True if the two edges share a node: vessels that leave a junction side by side.
    pub fn shares_node(&self) -> bool {
        self.nodes[0].iter().any(|n| self.nodes[1].contains(n))
    }
}

impl Skeleton {
    /// Finds the vessels that overlap.
    pub fn overlaps(&self, adjacency: &Adjacency) -> Overlaps {
        let (candidates, complete) = self.close_pairs();
        let mut overlaps = Overlaps { complete, ..Overlaps::default() };
        let mut groups = candidates.chunk_by(|p, q| p[0] == q[0]);
        loop {
            let some: Vec<&[[EdgeId; 2]]> = groups.by_ref().take(AT_A_TIME).collect();
            if some.is_empty() {
                return overlaps;
            }
            let look = |scratch: &mut Scratch, group: &&_| self.overlaps_of_edge(adjacency, group, scratch);
            let found: Vec<Found> = some.par_iter().map_init(Scratch::default, look).collect();
            for part in found {
                overlaps.pairs.extend(part.pairs);
                overlaps.unconnected.extend(part.unconnected);
                overlaps.far += part.far;
            }
        }
    }

    /// Pairs of edges with overlapping boxes, ascending, and true if these are all.
    fn close_pairs(&self) -> (Vec<[EdgeId; 2]>, bool) {
        let tree = Bvh::of(self.edge_ids().map(|e| tube_box(&self.tube(e))).collect::<Vec<Aabb>>());
        let mut candidates: Vec<[EdgeId; 2]> = Vec::new();
        let mut complete = true;
        // Adjacent edges short for their radius cannot overlap beyond 6 r. They are skipped to save memory.
        tree.self_pairs(|a, b| {
            let pair = [EdgeId(a), EdgeId(b)];
            if candidates.len() >= MOST_PAIRS {
                complete = false;
            } else if !self.joined_by_a_short_way(pair) {
                candidates.push(pair);
            }
        });
        candidates.par_sort_unstable();
        (candidates, complete)
    }

    /// True if the edges share a node and are too short to overlap beyond it.
    fn joined_by_a_short_way(&self, pair: [EdgeId; 2]) -> bool {
        let [e, f] = pair.map(|id| self.edge(id));
        let limit = JOINED * self.tube(pair[0]).min_radius().max(self.tube(pair[1]).min_radius());
        e.nodes.iter().any(|n| f.nodes.contains(n)) && self.length(pair[0]) + self.length(pair[1]) <= limit
    }

    fn overlaps_of_edge(&self, adjacency: &Adjacency, group: &[[EdgeId; 2]], scratch: &mut Scratch) -> Found {
        let mut found = Found::default();
        let first = group[0][0];
        let tube = self.tube(first);
        scratch.close.clear();
        let mut radius = tube.max_radius();
        for &[_, second] in group {
            let other = self.tube(second);
            let pair = tube_tube(&tube, &other);
            if pair.gap >= 0.0 {
                continue;
            }
            radius = radius.max(other.max_radius());
            scratch.close.push(second);
            let ends = self.edge(second).nodes;
            if !self.edge(first).nodes.iter().any(|n| ends.contains(n)) {
                found.unconnected.push([first, second]);
                found.far += usize::from(!self.joined_by_an_edge(adjacency, [first, second]));
            }
        }
        if scratch.close.is_empty() {
            return found;
        }
        for (end, ways) in self.edge(first).nodes.into_iter().zip(&mut scratch.ways) {
            ways.search(self, adjacency, end, JOINED * radius);
        }
        for &second in &scratch.close {
            let ends = self.edge(second).nodes;
            let way = scratch.ways.each_ref().map(|ways| ends.map(|n| ways.of(n)));
            if let Some((s, t)) = deepest_apart(&tube, &self.tube(second), way, [[1.0; 2]; 2]) {
                found.pairs.push(self.overlap([first, second], s, t));
            }
        }
        found
    }

    fn joined_by_an_edge(&self, adjacency: &Adjacency, [e, f]: [EdgeId; 2]) -> bool {
        let ends = self.edge(f).nodes;
        let around = |n: NodeId| adjacency.edges(n).iter().map(move |&g| self.edge(g).other(n));
        self.edge(e).nodes.into_iter().any(|n| around(n).any(|m| ends.contains(&m)))
    }

    fn overlap(&self, edges: [EdgeId; 2], s: f64, t: f64) -> Overlap {
        let [a, b] = edges.map(|e| self.tube(e));
        let points = [a.point(s), b.point(t)];
        Overlap {
            edges,
            nodes: edges.map(|e| self.edge(e).nodes),
            points,
            distance: (points[0] - points[1]).norm(),
            radii: a.radius(s) + b.radius(t),
        }
    }
}

#[derive(Default)]
struct Found {
    pairs: Vec<Overlap>,
    unconnected: Vec<[EdgeId; 2]>,
    far: usize,
}

#[derive(Default)]
struct Scratch {
    close: Vec<EdgeId>,
    ways: [LocalDistances; 2],
}

fn tube_box(tube: &Tube) -> Aabb {
    let ball = |p: &Point3, r: f64| Aabb::of_points([p]).grown(r);
    ball(&tube.a, tube.ra).union(&ball(&tube.b, tube.rb))
}

/// Deepest overlap of two tubes among points not close along the skeleton; `None` without overlap.
///
/// They overlap if their distance is below the sum of their radii. The factors in `clearance` multiply this sum at the ends
/// of `a` and of `b`. `way[i][j]` is the distance along the skeleton from end i of `a` to end j of `b`. Each path from s to t passes one of four pairs of ends. So "more
/// than 6 r apart" is a set of linear conditions. The admissible set is a convex polygon, and the gap is convex on it.
pub fn deepest_apart(a: &Tube, b: &Tube, way: [[f64; 2]; 2], clearance: [[f64; 2]; 2]) -> Option<(f64, f64)> {
    let conditions = apart_conditions(a, b, way);
    let polygon = clip_square(&conditions)?;
    let (mut low, mut high) = (1.0_f64, 0.0_f64);
    for corner in &polygon {
        low = low.min(corner[0]);
        high = high.max(corner[0]);
    }
    let wide = |tube: &Tube, by: [f64; 2]| Tube { ra: by[0] * tube.ra, rb: by[1] * tube.rb, ..*tube };
    let (a, b) = (&wide(a, clearance[0]), &wide(b, clearance[1]));
    let at = |s: f64| {
        let range = t_range(&polygon, s);
        let t = point_tube(&a.point(s), b).0.clamp(range.0, range.1);
        ((a.point(s) - b.point(t)).norm() - a.radius(s) - b.radius(t), s, t)
    };
    let best = minimise_convex(at, [low, high], 0.0);
    (best.0 < 0.0).then_some((best.1, best.2))
}

/// Conditions k0 + k1 s + k2 t > 0 for points to be more than 6 r apart along the skeleton.
fn apart_conditions(a: &Tube, b: &Tube, way: [[f64; 2]; 2]) -> Vec<[f64; 3]> {
    let (la, lb) = (a.length(), b.length());
    let mut conditions = Vec::with_capacity(8);
    for (i, row) in way.iter().enumerate() {
        for (j, &between) in row.iter().enumerate() {
            if between == f64::INFINITY {
                continue;
            }
            // From s to end i of a, from end j of b to t.
            let (s0, s1) = if i == 0 { (0.0, la) } else { (la, -la) };
            let (t0, t1) = if j == 0 { (0.0, lb) } else { (lb, -lb) };
            let constant = s0 + between + t0;
            conditions.push([constant - JOINED * a.ra, s1 - JOINED * (a.rb - a.ra), t1]);
            conditions.push([constant - JOINED * b.ra, s1, t1 - JOINED * (b.rb - b.ra)]);
        }
    }
    conditions
}

/// Part of the unit square where all conditions hold; `None` if it is empty.
fn clip_square(conditions: &[[f64; 3]]) -> Option<Vec<[f64; 2]>> {
    let mut polygon = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mut next = Vec::new();
    for k in conditions {
        let value = |p: &[f64; 2]| k[0] + k[1] * p[0] + k[2] * p[1];
        next.clear();
        for (i, p) in polygon.iter().enumerate() {
            let q = &polygon[(i + 1) % polygon.len()];
            let (u, v) = (value(p), value(q));
            if u > 0.0 {
                next.push(*p);
            }
            if (u > 0.0) != (v > 0.0) {
                let x = (u / (u - v)).clamp(0.0, 1.0);
                next.push([p[0] + x * (q[0] - p[0]), p[1] + x * (q[1] - p[1])]);
            }
        }
        std::mem::swap(&mut polygon, &mut next);
        if polygon.is_empty() {
            return None;
        }
    }
    Some(polygon)
}

/// Range of t in a convex polygon at `s`.
fn t_range(polygon: &[[f64; 2]], s: f64) -> (f64, f64) {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut include = |t: f64| {
        low = low.min(t);
        high = high.max(t);
    };
    for (i, p) in polygon.iter().enumerate() {
        let q = &polygon[(i + 1) % polygon.len()];
        // Compared exactly: just beside s, the edges of the polygon give the range.
        if p[0].total_cmp(&s).is_eq() {
            include(p[1]);
        }
        if (p[0] < s) != (q[0] < s) {
            include(p[1] + (s - p[0]) / (q[0] - p[0]) * (q[1] - p[1]));
        }
    }
    if low > high {
        // Rounding moved s slightly outside: use the nearest corner.
        let nearest = polygon.iter().min_by(|p, q| (p[0] - s).abs().total_cmp(&(q[0] - s).abs()));
        let t = nearest.map_or(0.0, |p| p[1]);
        return (t, t);
    }
    (low, high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::network;
    use proptest::prelude::*;

    fn overlaps(s: &Skeleton) -> Overlaps {
        s.overlaps(&s.adjacency())
    }

    /// Two straight vessels that leave one point at an angle (degrees).
    fn fork(angle: f64) -> Skeleton {
        let (sin, cos) = libm::sincos(angle.to_radians());
        network(&[[0.0; 3], [20.0, 0.0, 0.0], [20.0 * cos, 20.0 * sin, 0.0]], 1.0, &[(0, 1), (0, 2)])
    }

    #[test]
    fn crossing_vessels_overlap_where_they_cross() {
        let points = [[-9.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, -9.0, 1.5], [0.0, 9.0, 1.5]];
        let found = overlaps(&network(&points, 1.0, &[(0, 1), (2, 3)]));
        assert_eq!(found.pairs.len(), 1);
        let pair = found.pairs[0];
        assert_eq!((pair.edges, pair.nodes[1]), ([EdgeId(0), EdgeId(1)], [NodeId(2), NodeId(3)]));
        assert!((pair.distance - 1.5).abs() < 1e-6 && (pair.radii - 2.0).abs() < 1e-9);
        assert!((pair.points[0] - Point3::origin()).norm() < 1e-6);
        assert_eq!((found.unconnected.len(), found.far, found.complete), (1, 1, true));
        assert!(overlaps(&network(&points, 0.7, &[(0, 1), (2, 3)])).pairs.is_empty());
    }

    #[test]
    fn a_fork_counts_when_it_is_narrower_than_its_radius_three_radii_on() {
        // At 3 r from the fork the axes are 6 sin(angle / 2) apart: 2 at 38.94 degrees.
        assert!(overlaps(&fork(60.0)).pairs.is_empty());
        assert!(overlaps(&fork(40.0)).pairs.is_empty());
        let found = overlaps(&fork(38.0));
        assert_eq!(found.pairs.len(), 1);
        assert!(found.pairs[0].shares_node());
        assert!(found.unconnected.is_empty());
    }

    #[test]
    fn polylines_overlap_themselves_only_when_they_return() {
        // A half circle of radius 4 in pieces of half a vessel radius.
        let arc = |radius: f64| -> Vec<[f64; 3]> {
            let steps = (std::f64::consts::PI * radius / 0.5) as u32;
            let angle = |i: u32| std::f64::consts::PI * f64::from(i) / f64::from(steps);
            (0..=steps).map(|i| [radius * libm::cos(angle(i)), radius * libm::sin(angle(i)), 0.0]).collect()
        };
        let chain = |points: &[[f64; 3]]| {
            let edges: Vec<(u32, u32)> = (1..points.len() as u32).map(|i| (i - 1, i)).collect();
            network(points, 1.0, &edges)
        };
        let wide = overlaps(&chain(&arc(4.0)));
        assert!(wide.pairs.is_empty());
        assert!(!wide.unconnected.is_empty());
        let mut hairpin = arc(0.9);
        hairpin.insert(0, [0.9, -9.0, 0.0]);
        hairpin.push([-0.9, -9.0, 0.0]);
        let found = overlaps(&chain(&hairpin));
        assert_eq!(found.pairs.len(), 1);
        assert!((found.pairs[0].distance - 1.8).abs() < 1e-9);
    }

    #[test]
    fn a_vessel_that_returns_to_its_own_junction_overlaps_there() {
        let points = [[0.0; 3], [20.0, 0.0, 0.0], [20.0, 20.0, 0.0], [0.5, 1.0, 0.0], [-20.0, 0.0, 0.0]];
        let found = overlaps(&network(&points, 1.0, &[(0, 1), (1, 2), (2, 3), (0, 4)]));
        assert_eq!(found.pairs.iter().map(|p| p.edges.map(|e| e.0)).collect::<Vec<_>>(), [[0, 2], [2, 3]]);
    }

    proptest! {
        /// Agrees with sampled points and distances along the skeleton.
        #[test]
        fn agrees_with_sampling(
            points in prop::collection::vec(prop::array::uniform3(-8.0..8.0_f64), 8),
            radii in prop::collection::vec(0.2..1.5_f64, 8),
        ) {
            // A tree and a loop.
            let ends = [(0, 1), (1, 2), (2, 3), (1, 4), (4, 5), (5, 6), (6, 1), (6, 7)];
            let mut s = network(&points, 1.0, &ends);
            for (node, &r) in s.nodes.iter_mut().zip(&radii) {
                node.radius = r;
            }
            for edge in &mut s.edges {
                edge.radii = edge.nodes.map(|n| radii[n.index()]);
            }
            let adjacency = s.adjacency();
            let found = s.overlaps(&adjacency);
            let distances: Vec<Vec<f64>> = s.node_ids().map(|a| {
                let mut ways = LocalDistances::default();
                ways.search(&s, &adjacency, a, f64::INFINITY);
                s.node_ids().map(|b| ways.of(b)).collect()
            }).collect();
            for e in s.edge_ids() {
                for f in s.edge_ids().filter(|&f| f > e) {
                    let (a, b) = (s.tube(e), s.tube(f));
                    let mut deepest = 0.0_f64;
                    for i in 0..=40 {
                        for j in 0..=40 {
                            let (u, v) = (f64::from(i) / 40.0, f64::from(j) / 40.0);
                            let mut way = f64::INFINITY;
                            for (p, from) in s.edge(e).nodes.iter().zip([u, 1.0 - u]) {
                                for (q, to) in s.edge(f).nodes.iter().zip([v, 1.0 - v]) {
                                    let between = distances[p.index()][q.index()];
                                    way = way.min(from * a.length() + between + to * b.length());
                                }
                            }
                            if way > JOINED * a.radius(u).max(b.radius(v)) {
                                let gap = (a.point(u) - b.point(v)).norm() - a.radius(u) - b.radius(v);
                                deepest = deepest.min(gap);
                            }
                        }
                    }
                    let pair = found.pairs.iter().find(|p| p.edges == [e, f]);
                    let depth = pair.map_or(0.0, |p| p.distance - p.radii);
                    prop_assert!(depth <= deepest + 1e-6, "{e:?} {f:?}: {depth} above {deepest}");
                    prop_assert!(depth >= deepest - 0.6, "{e:?} {f:?}: {depth} far below {deepest}");
                }
            }
        }
    }
}

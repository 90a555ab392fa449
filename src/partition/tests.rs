//! Partitions of hand-made and random skeletons.

// Copied radii and arc lengths are identical bit for bit.

use proptest::prelude::*;

use super::check::PartitionFlaw;
use super::parts::{PartitionWarning, UncutReason};
use super::*;
use anastomesh_mesh::geometry::{Point3, Tube, Vec3, point_segment, segment_segment};
use anastomesh_mesh::progress::StopsAfter;
use anastomesh_skeleton::{Edge, Node, NodeId};
use std::ops::Range;

/// Skeleton of points with radii, and edges between them.
pub(super) fn skeleton(points: &[([f64; 3], f64)], edges: &[[u32; 2]]) -> Skeleton {
    let node = |(i, (p, radius)): (usize, &([f64; 3], f64))| Node {
        position: Point3::from(*p),
        radius: *radius,
        original: i as u32,
    };
    let edge = |&[a, b]: &[u32; 2]| Edge {
        nodes: [NodeId(a), NodeId(b)],
        radii: [points[a as usize].1, points[b as usize].1],
    };
    Skeleton { nodes: points.iter().enumerate().map(node).collect(), edges: edges.iter().map(edge).collect() }
}

/// Polyline of unit radius.
pub(super) fn polyline(points: impl IntoIterator<Item = [f64; 3]>) -> Skeleton {
    let points: Vec<_> = points.into_iter().map(|p| (p, 1.0)).collect();
    let edges: Vec<_> = (1..points.len() as u32).map(|i| [i - 1, i]).collect();
    skeleton(&points, &edges)
}

fn cut_up(s: &Skeleton, params: &PartitionParams) -> Partition {
    let partition = partition(s, params).unwrap();
    check_partition(s, &partition).unwrap();
    partition
}

fn default_cut(s: &Skeleton) -> Partition {
    cut_up(s, &PartitionParams::default())
}

fn only_reason(p: &Partition, branch: u32) -> Option<UncutReason> {
    p.uncut.iter().find(|(b, _)| b.0 == branch).map(|(_, r)| *r)
}

/// Two junctions `length` apart along x, each with two arms of 8.
pub(super) fn h_shape(length: f64) -> Skeleton {
    skeleton(
        &[
            ([0.0, 0.0, 0.0], 1.0),
            ([length, 0.0, 0.0], 1.0),
            ([-4.0, 7.0, 0.0], 1.0),
            ([-4.0, -7.0, 0.0], 1.0),
            ([length + 4.0, 0.0, 7.0], 1.0),
            ([length + 4.0, 0.0, -7.0], 1.0),
        ],
        &[[0, 1], [0, 2], [0, 3], [1, 4], [1, 5]],
    )
}

#[test]
fn a_y_is_one_cluster_with_three_caps() {
    let s = skeleton(
        &[([0.0; 3], 1.0), ([-9.0, 0.0, 0.0], 1.2), ([7.0, 7.0, 0.0], 0.8), ([7.0, -7.0, 0.0], 0.8)],
        &[[0, 1], [0, 2], [0, 3]],
    );
    let p = default_cut(&s);
    assert_eq!((p.clusters.len(), p.cuts.len(), p.clusters[0].ends.len()), (1, 0, 3));
    assert!(p.uncut.iter().all(|(_, r)| *r == UncutReason::Terminal));
    // Overrun: one radius, or 1.6 voxels of 2 · 0.8 / 3.
    for end in &p.clusters[0].ends {
        let t = p.clusters[0].tubes[end.overrun as usize];
        let expected = end.section.radius.max(1.6 * 2.0 * 0.8 / 3.0);
        assert!((t.length() - expected).abs() < 1e-12);
    }
    assert!(p.warnings.is_empty());
}

#[test]
fn an_h_is_cut_in_its_middle() {
    let p = default_cut(&h_shape(12.0));
    assert_eq!((p.clusters.len(), p.cuts.len()), (2, 1));
    assert_eq!(p.clusters[0].nodes, [NodeId(0), NodeId(2), NodeId(3)]);
    let [lo, hi] = p.cut_arcs[0];
    assert!((lo - 2.2).abs() < 1e-9 && (hi - 9.8).abs() < 1e-9, "{lo} {hi}");
    assert_eq!(p.cuts[0].path.len(), 2);
    let summary = p.summary();
    assert_eq!((summary.junction_clusters, summary.largest_nodes, summary.uncut.terminal), (2, 3, 4));
    serde_json::to_string(&summary).unwrap();
}

#[test]
fn length_decides() {
    // Minimum: 2 × 2.2 plus 1 for the connector.
    assert_eq!(default_cut(&h_shape(5.5)).cuts.len(), 1);
    let p = default_cut(&h_shape(5.3));
    assert_eq!((p.cuts.len(), only_reason(&p, 0)), (0, Some(UncutReason::Length)));
}

/// Junction at the origin with a stem, an arm along x to another junction, and an arm at `degrees` to it.
pub(super) fn acute(degrees: f64, arm: f64) -> Skeleton {
    let (sin, cos) = libm::sincos(degrees.to_radians());
    skeleton(
        &[
            ([0.0; 3], 1.0),
            ([-10.0, 0.0, 0.0], 1.0),
            ([arm, 0.0, 0.0], 1.0),
            ([arm * cos, arm * sin, 0.0], 1.0),
            ([arm + 3.0, 0.0, 6.0], 1.0),
            ([arm + 3.0, 0.0, -6.0], 1.0),
        ],
        &[[0, 1], [0, 2], [0, 3], [2, 4], [2, 5]],
    )
}

#[test]
fn acute_angles_need_length() {
    let p = default_cut(&acute(30.0, 16.0));
    // 1.25 (1 / sin 30° + 1 / tan 30°) = 4.67; the clear zone starts half a radius before the plane: 4.87.
    assert!(p.cut_arcs[0][0] > 4.87 && p.cut_arcs[0][0] < 5.1, "{:?}", p.cut_arcs);
    let p = default_cut(&acute(15.0, 12.0));
    assert_eq!((p.cuts.len(), only_reason(&p, 1)), (0, Some(UncutReason::Angle)));
    // The angle itself counts, not its supplement: an arm straight back is ignored.
    let p = default_cut(&acute(100.0, 12.0));
    assert!((p.cut_arcs[0][0] - 2.2).abs() < 1e-9);
}

/// Smallest distance, in sums of radii, of an end's overrun from any tube of another piece of its cluster.
fn least_clearance(p: &Partition) -> f64 {
    let mut least = f64::INFINITY;
    for (i, cluster) in p.clusters.iter().enumerate() {
        for end in &cluster.ends {
            let tip = cluster.tubes[end.overrun as usize];
            let own = p.pieces.iter().find(|x| {
                let near = |t: &Tube| [t.a, t.b].iter().any(|q| (q - end.section.origin).norm() < 1e-9);
                x.cluster.0 as usize == i
                    && cluster.tubes[x.tubes.start as usize..x.tubes.end as usize].iter().any(near)
            });
            let own = own.map_or(0..0, |x| x.tubes.clone());
            for (j, t) in cluster.tubes.iter().enumerate() {
                if own.contains(&(j as u32)) || end.overrun == j as u32 {
                    continue;
                }
                let d = segment_segment([&tip.a, &tip.b], [&t.a, &t.b]).distance;
                least = least.min(d / (tip.max_radius() + t.max_radius()));
            }
        }
    }
    least
}

#[test]
fn a_cut_moves_out_of_the_way_of_another_vessel() {
    // An arm of the junction returns and passes the bridge of the H at x = 3, 2.2 from its axis.
    let mut points: Vec<_> =
        h_shape(16.0).nodes.iter().map(|n| (n.position.into(), 1.0)).collect::<Vec<([f64; 3], f64)>>();
    points[2].0 = [0.0, 9.0, 0.0];
    points.push(([3.0, 9.0, 0.0], 1.0));
    points.push(([3.0, 2.2, 0.0], 1.0));
    points.push(([3.0, 2.2, 9.0], 1.0));
    let edges = [[0, 1], [0, 2], [0, 3], [1, 4], [1, 5], [2, 6], [6, 7], [7, 8]];
    let p = default_cut(&skeleton(&points, &edges));
    assert_eq!(p.cuts.len(), 1);
    assert!(p.cut_arcs[0][0] > 3.9, "{:?}", p.cut_arcs);
    assert!(least_clearance(&p) > 1.0);
    // With less space behind it the cut is dropped, and the reason names the branch.
    for point in &mut points[..] {
        if point.0[0] > 15.0 {
            point.0[0] -= 9.0;
        }
    }
    let p = default_cut(&skeleton(&points, &edges));
    assert_eq!((p.clusters.len(), only_reason(&p, 0)), (1, Some(UncutReason::Clearance { near: BranchId(1) })));
}

#[test]
fn parallel_vessels_of_different_clusters_do_not_matter() {
    // Two nearly touching H shapes: separate components are separate clusters.
    let one = h_shape(14.0);
    let mut points: Vec<([f64; 3], f64)> = one.nodes.iter().map(|n| (n.position.into(), 1.0)).collect();
    let other: Vec<_> = points.iter().map(|(p, r)| ([p[0], p[1] + 0.5, p[2] + 2.01], *r)).collect();
    points.extend(other);
    let edges: Vec<[u32; 2]> = one.edges.iter().map(|e| [e.nodes[0].0, e.nodes[1].0]).collect();
    let both: Vec<_> = edges.iter().copied().chain(edges.iter().map(|e| [e[0] + 6, e[1] + 6])).collect();
    let p = default_cut(&skeleton(&points, &both));
    assert_eq!((p.clusters.len(), p.cuts.len()), (4, 2));
}

#[test]
fn loops_and_rings_are_cut() {
    // A long loop between two junctions, twice connected.
    let s = skeleton(
        &[
            ([0.0; 3], 1.0),
            ([20.0, 0.0, 0.0], 1.0),
            ([4.0, 8.0, 0.0], 1.0),
            ([16.0, 8.0, 0.0], 1.0),
            ([-9.0, 0.0, 0.0], 1.0),
            ([29.0, 0.0, 0.0], 1.0),
        ],
        &[[0, 1], [0, 2], [2, 3], [3, 1], [4, 0], [1, 5]],
    );
    let p = default_cut(&s);
    assert_eq!((p.clusters.len(), p.cuts.len()), (2, 2));
    // With one branch uncut, both junctions share a cluster that the other branch leaves and enters.
    let params = PartitionParams { forbidden_cuts: [BranchId(0)].into(), ..PartitionParams::default() };
    let p = cut_up(&s, &params);
    assert_eq!((p.clusters.len(), p.cuts.len()), (1, 1));
    assert_eq!(p.cuts[0].sides, [(ClusterId(0), p.cuts[0].sides[0].1), (ClusterId(0), p.cuts[0].sides[1].1)]);
    assert_eq!(only_reason(&p, 0), Some(UncutReason::Forbidden));
    // A ring without a junction, smooth and angular.
    for (n, radius) in [(40_u32, 8.0), (6, 10.0)] {
        let points: Vec<_> = (0..n)
            .map(|i| libm::sincos(f64::from(i) / f64::from(n) * std::f64::consts::TAU))
            .map(|(y, x)| ([radius * x, radius * y, 0.0], 1.0))
            .collect();
        let edges: Vec<_> = (0..n).map(|i| [i, (i + 1) % n]).collect();
        let p = default_cut(&skeleton(&points, &edges));
        assert!(!p.cuts.is_empty(), "{n}");
        assert!(least_clearance(&p) > 1.0);
    }
    // A ring that is too small to be cut is one cluster without ends.
    let p = default_cut(&skeleton(
        &[([2.0, 0.0, 0.0], 1.0), ([0.0, 2.0, 0.0], 1.0), ([-2.0, 0.0, 0.0], 1.0), ([0.0, -2.0, 0.0], 1.0)],
        &[[0, 1], [1, 2], [2, 3], [3, 0]],
    ));
    assert_eq!((p.clusters.len(), p.cuts.len(), p.clusters[0].ends.len()), (1, 0, 0));
}

#[test]
fn tubes_are_cut_when_they_are_long() {
    let tube = |length: f64| default_cut(&polyline([[0.0; 3], [length, 0.0, 0.0]]));
    assert_eq!(tube(29.0).clusters.len(), 1);
    let p = tube(100.0);
    assert_eq!((p.clusters.len(), p.cuts.len()), (2, 1));
    // Connectors are at most 200 radii long.
    let p = tube(1000.0);
    assert!(p.cuts.len() >= 5 && p.cut_arcs.iter().all(|a| a[1] - a[0] <= 200.0), "{:?}", p.cut_arcs);
    // Strong tapers are cut, too.
    let p = default_cut(&skeleton(&[([0.0; 3], 3.0), ([25.0, 0.0, 0.0], 1.0)], &[[0, 1]]));
    assert_eq!(p.cuts.len(), 1);
}

#[test]
fn a_tiny_tube_is_one_cluster() {
    let p = default_cut(&polyline([[0.0; 3], [0.3, 0.0, 0.0], [0.3, 0.3, 0.0], [0.6, 0.3, 0.0]]));
    assert_eq!((p.clusters.len(), p.clusters[0].ends.len()), (1, 2));
}

/// A helix of tiny edges with some noise.
pub(super) fn wiggly(edges: u32, step: f64, bend: f64) -> Vec<[f64; 3]> {
    let noise = |i: u32| f64::from((i.wrapping_mul(2_654_435_761)) >> 24) / 256.0 - 0.5;
    (0..=edges)
        .map(|i| {
            let (sin, cos) = libm::sincos(f64::from(i) * step / bend);
            let n = 0.1 * step;
            [bend * cos + n * noise(i), bend * sin + n * noise(i + 7), f64::from(i) * step * 0.5 + n * noise(i + 13)]
        })
        .collect()
}

#[test]
fn polylines_of_tiny_edges_are_cut_along_their_course() {
    let p = default_cut(&polyline(wiggly(400, 0.2, 12.0)));
    assert!(!p.cuts.is_empty());
    let path = &p.cuts[0].path;
    assert!(path.len() > 10);
    // Axes turn only slightly from section to section.
    assert!(path.windows(2).all(|s| s[0].axis.dot(&s[1].axis) > libm::cos(30_f64.to_radians())));
    // No cluster has a tube shorter than the edges.
    let tubes = p.clusters.iter().flat_map(|c| &c.tubes);
    assert!(tubes.map(Tube::length).fold(f64::INFINITY, f64::min) > 0.1);
}

#[test]
fn kinks_stay_in_clusters() {
    // Two straight parts of 25 at a right angle.
    let p = default_cut(&polyline([[0.0; 3], [25.0, 0.0, 0.0], [25.0, 25.0, 0.0]]));
    assert_eq!((p.cuts.len(), p.clusters.len()), (2, 3), "both parts are cut");
    for arc in &p.cut_arcs {
        assert!(arc[1] <= 24.0 || arc[0] >= 26.0, "{arc:?}");
    }
    // Discs at the bend have the frame of its plane, and so do those at the other ends of the connectors.
    let ends =
        p.clusters.iter().flat_map(|cluster| &cluster.ends).filter(|end| matches!(end.kind, EndKind::Cut { .. }));
    assert!(
        ends.clone().count() == 4 && ends.clone().all(|end| end.section.up == Some(-Vec3::z())),
        "{:?}",
        p.clusters
    );
    // A continuous bend of less than 3 radii leaves no place for a connector.
    let p = default_cut(&polyline(wiggly(400, 0.2, 2.0)));
    assert_eq!(only_reason(&p, 0), Some(UncutReason::Bend));
    // A slight kink is acceptable, and the connector follows it.
    let p = default_cut(&polyline([[0.0; 3], [25.0, 0.0, 0.0], [50.0, 5.0, 0.0]]));
    assert_eq!(p.cuts.len(), 1);
    assert!(p.cuts[0].path.len() >= 4);
}

#[test]
fn callers_move_and_forbid_cuts() {
    let s = h_shape(12.0);
    let shifted = |shift| {
        let params = PartitionParams { shifted_cuts: [(BranchId(0), shift)].into(), ..PartitionParams::default() };
        cut_up(&s, &params).cut_arcs[0]
    };
    let [lo, hi] = shifted(0.5);
    assert!(lo > 4.0 && (hi - 9.8).abs() < 1e-9);
    let [lo, hi] = shifted(-1.0);
    assert!((lo - 2.2).abs() < 1e-9 && (hi - 3.2).abs() < 1e-9);
    assert_eq!(shifted(f64::NAN), shifted(0.0));
    let params = PartitionParams { forbidden_cuts: [BranchId(0)].into(), ..PartitionParams::default() };
    assert_eq!(cut_up(&s, &params).clusters.len(), 1);
}

#[test]
fn radii_per_edge_jump_at_nodes() {
    let mut s = h_shape(14.0);
    for (edge, r) in s.edges.iter_mut().zip([1.3, 0.9, 0.7, 0.8, 0.9]) {
        edge.radii = [r, r];
    }
    let p = default_cut(&s);
    assert_eq!(p.cuts.len(), 1);
    assert!(p.cuts[0].path.iter().all(|x| x.radius == 1.3));
}

#[test]
fn caps_in_the_way_are_reported() {
    // A terminal inside the wall of its neighbour.
    let s = skeleton(
        &[([0.0; 3], 1.0), ([-9.0, 0.0, 0.0], 1.0), ([9.0, 0.0, 0.0], 1.0), ([0.0, 1.1, 0.0], 1.0)],
        &[[0, 1], [0, 2], [0, 3]],
    );
    let p = default_cut(&s);
    assert!(matches!(p.warnings[..], [PartitionWarning::CapNotClear { node: NodeId(3), .. }]), "{:?}", p.warnings);
    // A terminal faces another vessel 2.6 radii ahead.
    let s = skeleton(
        &[
            ([0.0; 3], 1.0),
            ([-9.0, 0.0, 0.0], 1.0),
            ([0.0, 9.0, 0.0], 1.0),
            ([9.0, 0.0, 0.0], 1.0),
            ([9.0, 6.4, 0.0], 1.0),
            ([2.7, 9.0, 0.0], 1.0),
            ([18.0, 0.0, 0.0], 1.0),
            ([-2.0, 15.0, 0.0], 1.0),
        ],
        &[[0, 1], [0, 2], [0, 3], [3, 4], [3, 6], [2, 7], [2, 5]],
    );
    let params = PartitionParams { forbidden_cuts: [BranchId(1), BranchId(2)].into(), ..PartitionParams::default() };
    let p = cut_up(&s, &params);
    assert!(p.warnings.is_empty(), "{:?}", p.warnings);
}

#[test]
fn bad_input_is_an_error() {
    let s = h_shape(12.0);
    let mut bad = s.clone();
    bad.edges[1].radii[0] = f64::NAN;
    assert!(matches!(
        partition(&bad, &PartitionParams::default()),
        Err(PartitionError::BadEdge { edge: anastomesh_skeleton::EdgeId(1), .. })
    ));
    for radius in [0.0, -1.0, f64::INFINITY] {
        bad.edges[1].radii[0] = radius;
        assert!(matches!(partition(&bad, &PartitionParams::default()), Err(PartitionError::BadEdge { .. })));
    }
    bad.edges[1].nodes[1] = NodeId(77);
    assert!(matches!(partition(&bad, &PartitionParams::default()), Err(PartitionError::NoSuchNode { .. })));
    let params = PartitionParams { rho: 0.0, ..PartitionParams::default() };
    assert!(matches!(partition(&s, &params), Err(PartitionError::Parameter { name: "rho", .. })));
    assert_eq!(default_cut(&Skeleton::default()), Partition::default());
}

/// The checker detects every kind of flaw.
#[test]
fn flaws_are_found() {
    let s = h_shape(12.0);
    let good = default_cut(&s);
    let spoilt = |f: &dyn Fn(&mut Partition)| {
        let mut p = good.clone();
        f(&mut p);
        check_partition(&s, &p).unwrap_err()
    };
    assert!(matches!(spoilt(&|p| p.cut_arcs[0][1] += 0.1), PartitionFlaw::Coverage { .. }));
    assert!(matches!(spoilt(&|p| p.clusters[0].tubes[0].a.x += 0.1), PartitionFlaw::Tubes { .. }));
    assert!(matches!(spoilt(&|p| p.clusters[0].nodes.clear()), PartitionFlaw::Node { .. }));
    assert!(matches!(spoilt(&|p| p.clusters[1].nodes.push(NodeId(0))), PartitionFlaw::Node { .. }));
    assert!(matches!(spoilt(&|p| p.cuts[0].sides.swap(0, 1)), PartitionFlaw::End { .. }));
    assert!(matches!(spoilt(&|p| p.clusters[0].ends[0].section.axis *= -1.0), PartitionFlaw::Direction { .. }));
    assert!(matches!(spoilt(&|p| p.cuts[0].path.reverse()), PartitionFlaw::Path { .. }));
    assert!(matches!(spoilt(&|p| p.cuts[0].path.extend_from_within(1..)), PartitionFlaw::Path { .. }));
    assert!(matches!(
        spoilt(&|p| {
            let end = p.clusters[1].ends.len() - 1;
            p.clusters[1].ends.truncate(end);
        }),
        PartitionFlaw::End { .. }
    ));
}

/// Random tree with extra edges that close loops; each edge is a polyline of one to `pieces` pieces.
pub(super) fn any_network() -> impl Strategy<Value = Skeleton> {
    let node =
        (prop::array::uniform3(-1.0..1.0_f64), 0.3..2.0_f64, any::<u32>(), 1..6_u32, 2.0..40.0_f64, any::<bool>());
    (prop::collection::vec(node, 1..40), prop::collection::vec((any::<u32>(), any::<u32>()), 0..3)).prop_map(
        |(nodes, extra)| {
            let mut points = vec![([0.0; 3], 1.0)];
            let mut edges: Vec<[u32; 2]> = Vec::new();
            let mut ends = vec![0_u32];
            let mut valence = vec![0_u32; 1];
            for (direction, radius, parent, pieces, length, jitter) in nodes {
                let mut parent = parent as usize % ends.len();
                while valence[parent] > 2 {
                    parent = (parent + 1) % ends.len();
                }
                valence[parent] += 1;
                let from = points[ends[parent] as usize];
                let d = Vec3::from(direction).try_normalize(1e-9).unwrap_or_else(Vec3::x) * length;
                let mut last = ends[parent];
                for k in 1..=pieces {
                    let t = f64::from(k) / f64::from(pieces);
                    let w = if jitter && k < pieces { 0.3 * f64::from(k % 2) } else { 0.0 };
                    let p = Point3::from(from.0) + d * t + Vec3::new(w, -w, w);
                    points.push((p.into(), from.1 + (radius - from.1) * t));
                    edges.push([last, points.len() as u32 - 1]);
                    last = points.len() as u32 - 1;
                }
                ends.push(last);
                valence.push(1);
            }
            for (a, b) in extra {
                let (a, b) = (a as usize % ends.len(), b as usize % ends.len());
                let pair = [ends[a], ends[b]];
                let known = edges.iter().any(|e| *e == pair || *e == [pair[1], pair[0]]);
                if a != b && valence[a] < 3 && valence[b] < 3 && !known {
                    valence[a] += 1;
                    valence[b] += 1;
                    edges.push(pair);
                }
            }
            skeleton(&points, &edges)
        },
    )
}

/// Minimum distance between the rim of an end's tip and the axes of all other vessels, in their radii.
fn rim_clearance(cluster: &Cluster, end: &ClusterEnd, own: &Range<u32>) -> f64 {
    let (u, w) = end.section.frame();
    let (r, length) = (end.section.radius, cluster.tubes[end.overrun as usize].length());
    let mut least = f64::INFINITY;
    for i in (0..cluster.tubes.len() as u32).filter(|i| !own.contains(i) && end.overrun != *i) {
        let tube = &cluster.tubes[i as usize];
        for height in [-0.4 * r, 0.0, 0.5 * length, length] {
            for k in 0..12 {
                let (sin, cos) = libm::sincos(f64::from(k) / 12.0 * std::f64::consts::TAU);
                let rim = end.section.origin + end.section.axis * height + (u * cos + w * sin) * r;
                let (t, distance) = point_segment(&rim, &tube.a, &tube.b);
                least = least.min(distance / tube.radius(t));
            }
        }
    }
    least
}

/// Minimum of [`rim_clearance`] over the ends at all cuts.
pub(super) fn least_rim(p: &Partition) -> f64 {
    let mut least = f64::INFINITY;
    for piece in &p.pieces {
        let cluster = &p.clusters[piece.cluster.0 as usize];
        let own = piece.tubes.start..piece.tubes.end;
        let is_own = |e: &&ClusterEnd| {
            own.contains(&e.overrun.wrapping_sub(1)) || own.end == e.overrun || own.end + 1 == e.overrun
        };
        for end in cluster.ends.iter().filter(is_own) {
            let EndKind::Cut { cut, .. } = end.kind else { continue };
            if p.cuts[cut.0 as usize].branch == piece.branch {
                least = least.min(rim_clearance(cluster, end, &own));
            }
        }
    }
    least
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn every_partition_is_sound(s in any_network(), rho in 2.5..6.0_f64, shift in -1.0..1.0_f64, some in any::<u8>()) {
        prop_assume!(s.edge_ids().all(|e| s.length(e) > 1e-6));
        let params = PartitionParams {
            rho,
            shifted_cuts: (0..u32::from(some % 9)).map(|b| (BranchId(b), shift)).collect(),
            forbidden_cuts: [BranchId(u32::from(some / 16))].into(),
            ..PartitionParams::default()
        };
        let p = partition(&s, &params).unwrap();
        prop_assert_eq!(check_partition(&s, &p), Ok(()));
        prop_assert!(p.uncut.iter().all(|(b, _)| p.cuts.iter().all(|c| c.branch != *b)));
        prop_assert!(p == partition(&s, &params).unwrap());
    }

    /// Branches that the metrics call cuttable are cut, unless vessels are in the way.
    #[test]
    fn what_is_called_cuttable_is_cut(s in any_network()) {
        prop_assume!(s.edge_ids().all(|e| s.length(e) > 1e-6));
        let adjacency = s.adjacency();
        let branches = s.branches(&adjacency);
        let p = partition(&s, &PartitionParams::default()).unwrap();
        let is_cut = |branch: BranchId| {
            let uncut = p.uncut.iter().find(|(b, _)| *b == branch).map(|(_, reason)| reason);
            matches!(uncut, None | Some(UncutReason::Clearance { .. }))
        };
        let inner: Vec<BranchId> = (0..branches.list.len() as u32)
            .map(BranchId)
            .filter(|b| branches.list[b.index()].ends().iter().all(|&n| adjacency.valence(n) > 2))
            .collect();
        let cuttable = s.metrics(&adjacency).cuttable;
        prop_assert_eq!((cuttable.count, cuttable.of), (inner.iter().filter(|b| is_cut(**b)).count(), inner.len()));
    }

    /// No vessel of a cluster comes close to the tip of another vessel that ends in a cut.
    #[test]
    fn tips_are_clear(s in any_network()) {
        prop_assume!(s.edge_ids().all(|e| s.length(e) > 1e-6));
        let least = least_rim(&partition(&s, &PartitionParams::default()).unwrap());
        prop_assert!(least > 1.12, "{least}");
    }

    /// Partitions do not depend on units.
    #[test]
    fn partitions_scale(s in any_network()) {
        prop_assume!(s.edge_ids().all(|e| s.length(e) > 1e-6));
        let scale = 1024.0;
        let mut larger = s.clone();
        for node in &mut larger.nodes {
            node.position *= scale;
            node.radius *= scale;
        }
        larger.edges.iter_mut().for_each(|e| e.radii = e.radii.map(|r| r * scale));
        let [a, b] = [&s, &larger].map(|s| partition(s, &PartitionParams::default()).unwrap());
        prop_assert_eq!(a.summary(), b.summary());
        for (x, y) in a.cut_arcs.iter().zip(&b.cut_arcs) {
            prop_assert!((x[0] * scale - y[0]).abs() < 1e-9 * y[1] && (x[1] * scale - y[1]).abs() < 1e-9 * y[1]);
        }
    }
}

#[test]
fn a_partition_can_be_cancelled() {
    let points: Vec<[f64; 3]> = (0..40).map(|i| [10.0 * f64::from(i), 0.0, 0.0]).collect();
    let s = Arc::new(polyline(points));
    let asked = StopsAfter::new(usize::MAX);
    assert!(lay_out(&s, &PartitionParams::default(), &asked).is_ok());
    for times in 0..asked.asked() {
        let stopped = lay_out(&s, &PartitionParams::default(), &StopsAfter::new(times));
        assert_eq!(stopped.err(), Some(PartitionError::Cancelled), "after {times} of {}", asked.asked());
    }
}

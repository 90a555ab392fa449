//! Tests of preparation: each cure on hand-written networks, and the merge on centrelines of other origin. The latter
//! are not in the repository and are skipped without the shared data.

use crate::common;
use anastomesh::Point3;
use anastomesh::io::{NetworkOptions, read_network};
use anastomesh::network::{PrepareParams, Prepared, RadiusDefect, Skeleton, SpurReason, TouchedBy, Touching, prepare};
use anastomesh::skeleton::{Edge, Node, NodeId};
use anastomesh::testing::{Aabb, Bvh, Tube, point_segment};
use proptest::prelude::*;
use std::path::Path;

/// Lines with separate nodes and one radius.
fn lines(lines: &[Vec<[f64; 3]>], radius: f64) -> Skeleton {
    let mut s = Skeleton::default();
    for line in lines {
        for (i, &p) in line.iter().enumerate() {
            let id = s.nodes.len() as u32;
            s.nodes.push(Node { position: p.into(), radius, original: id });
            if i > 0 {
                s.edges.push(Edge { nodes: [NodeId(id - 1), NodeId(id)], radii: [radius; 2] });
            }
        }
    }
    s
}

fn only(set: impl Fn(&mut PrepareParams)) -> PrepareParams {
    let mut params = PrepareParams::as_is();
    set(&mut params);
    params
}

fn done(s: &Skeleton, params: &PrepareParams) -> Prepared {
    let prepared = prepare(s, &[], params).unwrap();
    assert_eq!(prepared.skeleton.check(), Ok(()));
    prepared
}

/// A line that leaves the x axis at 20 along a parabola.
fn parted(step: f64, bend: f64) -> Vec<[f64; 3]> {
    let x = |i: i32| f64::from(i) * step;
    (0..1000).map(x).take_while(|&x| x <= 40.0).map(|x| [x, bend * (x - 20.0).max(0.0).powi(2), 0.0]).collect()
}

#[test]
fn lines_from_one_inlet_become_one_graph() {
    let s = lines(&[parted(0.25, 0.02), parted(0.31, -0.02)], 1.0);
    let made = done(&s, &only(|p| p.merge = true));
    let size = made.report.result;
    assert_eq!((size.tips, size.branch_points, size.components, size.loops), (3, 1, 1, 0));
    let adjacency = made.skeleton.adjacency();
    let fork = made.skeleton.node_ids().find(|&n| adjacency.valence(n) == 3).unwrap();
    // The distance is a tenth of a radius at 21.6; the line leaves the tube at 25, one sphere further.
    let x = made.skeleton.node(fork).position.x;
    assert!((21.0..=21.6).contains(&x), "{x}");
    let parting = made.report.merge.merged.iter().flat_map(|m| &m.partings).next().unwrap();
    let leaves = s.nodes[parting.leaves as usize].position.x;
    assert!((24.5..=25.0).contains(&leaves), "{leaves}");
}

#[test]
fn a_vessel_drawn_twice_is_there_once_and_the_rest_of_the_longer_stays() {
    let along = |from: i32, to: i32, y: f64| (from..=to).map(|i| [f64::from(i), y, 0.0]).collect::<Vec<_>>();
    let made = done(&lines(&[along(0, 30, 0.0), along(0, 20, 0.3), along(5, 15, 5.0)], 1.0), &only(|p| p.merge = true));
    assert_eq!((made.report.result.tips, made.report.result.nodes), (4, 31 + 11));
    assert_eq!(made.report.merge.merged.len(), 1);
    assert!((made.report.merge.merged[0].apart - 0.3).abs() < 1e-12);
}

#[test]
fn a_straight_vessel_of_three_pieces_and_a_fork_stay() {
    // The middle piece ends on two others of equal direction.
    let mut s = lines(&[vec![[0.0; 3], [10.0, 0.0, 0.0], [22.0, 0.0, 0.0], [40.0, 0.0, 0.0]]], 1.0);
    for (at, to) in [(1, [10.0, 15.0, 0.0]), (2, [30.0, 9.0, 0.0])] {
        let id = s.nodes.len() as u32;
        s.nodes.push(Node { position: to.into(), radius: 1.0, original: id });
        s.edges.push(Edge { nodes: [NodeId(at), NodeId(id)], radii: [1.0; 2] });
    }
    let made = done(&s, &only(|p| p.merge = true));
    assert_eq!((made.skeleton, made.report.merge.merged), (s, Vec::new()));
}

#[test]
fn tips_at_one_place_but_for_rounding_meet() {
    let s = lines(&[vec![[0.0; 3], [10.0, 0.0, 0.0]], vec![[10.001, 0.0, 0.0], [20.0, 0.0, 0.0]]], 1.0);
    let made = done(&s, &only(|p| p.merge = true));
    assert_eq!(made.report.merge.met, [[1, 2]]);
    assert_eq!((made.report.result.tips, made.report.result.components), (2, 1));
}

#[test]
fn radii_are_filled_between_good_ones() {
    let mut s = lines(&[(0..5).map(|i| [f64::from(i), 0.0, 0.0]).collect()], 2.0);
    s.nodes[0].radius = 4.0;
    for (node, radius) in [(1, 0.0), (2, f64::NAN), (3, f64::INFINITY)] {
        s.nodes[node].radius = radius;
    }
    for edge in &mut s.edges {
        edge.radii = edge.nodes.map(|n| s.nodes[n.index()].radius);
    }
    let made = done(&s, &only(|p| p.radii = true));
    for (node, expected) in [(1, 3.5), (2, 3.0), (3, 2.5)] {
        assert!((made.skeleton.nodes[node].radius - expected).abs() < 1e-6, "{:?}", made.skeleton.nodes);
    }
    let told: Vec<_> = made.report.radii.iter().map(|r| (r.node, r.given, r.fault)).collect();
    assert_eq!(
        told,
        [(1, Some(0.0), RadiusDefect::Missing), (2, None, RadiusDefect::Missing), (3, None, RadiusDefect::Missing)]
    );
    assert!(prepare(&s, &[], &PrepareParams::as_is()).is_err());

    s.nodes[1].radius = 2.0;
    s.nodes[2].radius = 50.0;
    s.nodes[3].radius = 2.0;
    let made = done(&s, &PrepareParams::default());
    assert_eq!((made.report.radii[0].node, made.report.radii[0].fault), (2, RadiusDefect::Absurd));
    for node in &mut s.nodes {
        node.radius = 0.0;
    }
    assert!(prepare(&s, &[], &PrepareParams::default()).is_err());
}

/// Radii of vessels in a file are kept: a wide branch point is not a neighbour of a twig's tip.
#[test]
fn a_twig_keeps_the_radius_of_its_vessel() {
    let points: Vec<[f64; 3]> = vec![[-9.0, 0.0, 0.0], [0.0; 3], [9.0, 0.0, 0.0], [0.0, 2.5, 0.0]];
    let mut s = lines(&[points[..3].to_vec()], 1.0);
    s.nodes.push(Node { position: points[3].into(), radius: 0.05, original: 3 });
    for (radii, filled) in [([0.05; 2], 0), ([1.0, 0.05], 1)] {
        s.edges.truncate(2);
        s.edges.push(Edge { nodes: [NodeId(1), NodeId(3)], radii });
        assert_eq!(done(&s, &only(|p| p.radii = true)).report.radii.len(), filled, "{radii:?}");
    }
}

#[test]
fn spurs_go_and_side_branches_stay() {
    let mut s = lines(&[(0..=8).map(|i| [5.0 * f64::from(i), 0.0, 0.0]).collect()], 2.0);
    // A branch within the radius, one with its tip inside, and a vessel.
    for (at, to) in [(2, [10.0, 1.5, 0.0]), (4, [23.0, 1.0, 0.0]), (6, [30.0, 9.0, 0.0])] {
        let id = s.nodes.len() as u32;
        s.nodes.push(Node { position: to.into(), radius: 0.5, original: id });
        s.edges.push(Edge { nodes: [NodeId(at), NodeId(id)], radii: [0.5; 2] });
    }
    let made = done(&s, &only(|p| p.spurs = true));
    let told: Vec<_> = made.report.spurs.iter().map(|s| (s.tip, s.from, s.reason)).collect();
    assert_eq!(told, [(9, 2, SpurReason::Short), (10, 4, SpurReason::Inside)]);
    assert_eq!((made.report.result.tips, made.report.result.branch_points), (3, 1));
}

#[test]
fn branch_points_in_one_lumen_are_joined_and_loops_in_it_closed() {
    let points = [[0.0; 3], [10.0, 0.0, 0.0], [10.8, 0.0, 0.0], [20.0, 0.0, 0.0], [10.0, 9.0, 0.0], [10.8, -9.0, 0.0]];
    let mut s = lines(&points.map(|p| vec![p]), 1.0);
    s.nodes.push(Node { position: Point3::new(10.4, 0.1, 0.0), radius: 1.0, original: 6 });
    for (a, b) in [(0, 1), (1, 2), (2, 3), (1, 4), (2, 5), (1, 6), (6, 2)] {
        s.edges.push(Edge { nodes: [NodeId(a), NodeId(b)], radii: [1.0; 2] });
    }
    let made = done(&s, &only(|p| p.join = true));
    assert_eq!((made.report.joined.nodes.len(), made.report.joined.loops.len()), (1, 1));
    assert_eq!((made.report.result.tips, made.report.result.branch_points, made.report.result.loops), (4, 1, 0));
}

/// A vessel along x with a side branch that returns to it; another component ends on its side.
fn touched() -> Skeleton {
    let along = |from: [f64; 3], to: [f64; 3]| -> Vec<[f64; 3]> {
        let at = |i: i32| [0, 1, 2].map(|k| from[k] + (to[k] - from[k]) * f64::from(i) / 20.0);
        (0..=20).map(at).collect()
    };
    let mut s = lines(
        &[
            along([0.0; 3], [60.0, 0.0, 0.0]),
            along([50.0, 30.0, 0.0], [50.0, 1.5, 0.0]),
            along([20.0, 20.0, 5.0], [20.0, 5.0, 5.0]),
        ],
        1.0,
    );
    for node in &mut s.nodes[..21] {
        node.radius = 2.0;
    }
    for edge in &mut s.edges[..20] {
        edge.radii = [2.0; 2];
    }
    s
}

#[test]
fn tips_on_other_vessels_are_drawn_back_or_joined() {
    let s = touched();
    let made = done(&s, &only(|p| p.touching = Touching::Retract));
    let [tip] = made.report.touching[..] else { panic!("{:?}", made.report.touching) };
    let TouchedBy::Retracted { by } = tip.done else { panic!("{tip:?}") };
    // Distance for the cap: 1.15 times the sum of the radii.
    assert_eq!(tip.tip, 41);
    assert!((1.95..2.3).contains(&by), "{by}");
    assert_eq!((made.report.result.tips, made.report.result.components), (6, 3));
    let joined = done(&s, &only(|p| p.touching = Touching::Join));
    assert_eq!((joined.report.result.tips, joined.report.result.components), (5, 2));
    assert_eq!(joined.report.touching[0].done, TouchedBy::Joined);
    assert_eq!(done(&s, &PrepareParams::as_is()).report.touching, []);
    // A second run changes nothing.
    let again = done(&made.skeleton, &only(|p| p.touching = Touching::Retract));
    assert_eq!(again.report.touching, []);
}

#[test]
fn radii_that_vanish_and_come_back_or_end_in_a_point_are_filled() {
    let radius = |i: i32| match i {
        10..=12 => 0.02,
        28 => 0.1,
        29 => 0.01,
        30 => 0.001,
        _ => 2.0,
    };
    let mut s = lines(&[(0..=30).map(|i| [f64::from(i), 0.0, 0.0]).collect()], 2.0);
    for (node, i) in s.nodes.iter_mut().zip(0..) {
        node.radius = radius(i);
    }
    for edge in &mut s.edges {
        edge.radii = edge.nodes.map(|n| s.nodes[n.0 as usize].radius);
    }
    let made = done(&s, &only(|p| p.radii = true));
    let filled: Vec<u32> = made.report.radii.iter().map(|r| r.node).collect();
    assert_eq!(filled, [10, 11, 12, 28, 29, 30]);
    assert!(made.skeleton.nodes.iter().all(|n| (n.radius - 2.0).abs() < 1e-9), "{:?}", made.report.radii);
}

#[test]
fn grown_networks_are_left_alone() {
    let s = lines(&[vec![[0.0; 3], [20.0, 0.0, 0.0]], vec![[10.0, 1.0, 0.0], [10.0, 20.0, 0.0]]], 1.0);
    let mut params = PrepareParams::default();
    params.only_measured = true;
    let made = done(&s, &params);
    assert!(!made.report.measured && !made.report.changed());
    assert_eq!(made.skeleton, s);
    assert!(done(&touched(), &PrepareParams::default()).report.measured);
}

#[test]
fn a_straight_vessel_beside_a_bow_is_no_loop_within_a_lumen() {
    // Both share their ends and lie within each other.
    let mut s = lines(&[(0..=20).map(|i| [f64::from(i), 0.1 * f64::from(i * (20 - i)), 0.0]).collect()], 1.0);
    s.edges.push(Edge { nodes: [NodeId(0), NodeId(20)], radii: [1.0; 2] });
    s.nodes.extend([([-9.0, 0.0, 0.0], 21), ([29.0, 0.0, 0.0], 22)].map(|(p, id)| Node {
        position: p.into(),
        radius: 1.0,
        original: id,
    }));
    s.edges.extend([[21, 0], [20, 22]].map(|ends| Edge { nodes: ends.map(NodeId), radii: [1.0; 2] }));
    let made = done(&s, &only(|p| p.join = true));
    assert_eq!((made.report.joined.loops.len(), made.report.result.loops), (0, 1));
}

#[test]
fn tips_too_close_to_their_fork_are_put_out_or_taken_off() {
    let branch = |angle: f64, length: f64| {
        let (sin, cos) = angle.to_radians().sin_cos();
        [length * cos, length * sin, 0.0]
    };
    let made = |angle: f64, length: f64| {
        let points = [[-20.0, 0.0, 0.0], [0.0; 3], [20.0, 0.0, 0.0], branch(angle, length)];
        let mut s = lines(&points.map(|p| vec![p]), 1.0);
        s.edges.extend([(0, 1), (1, 2), (1, 3)].map(|(a, b)| Edge { nodes: [NodeId(a), NodeId(b)], radii: [1.0; 2] }));
        let made = done(&s, &only(|p| p.short_tips = true));
        (made.report.result.tips, made.report.short_tips.first().map(|t| (t.tip, t.put_out)))
    };
    assert_eq!(made(90.0, 5.0), (3, None));
    assert_eq!(made(35.0, 2.5), (3, Some((3, true))));
    assert_eq!(made(10.0, 4.0), (2, Some((3, false))));
}

#[test]
fn islands_smaller_than_asked_go() {
    let s = lines(&[vec![[0.0; 3], [9.0, 0.0, 0.0], [19.0, 0.0, 0.0]], vec![[0.0, 50.0, 0.0], [4.0, 50.0, 0.0]]], 1.0);
    let made = done(&s, &only(|p| p.drop_islands = 3));
    assert_eq!((made.report.islands.len(), made.report.islands[0].node, made.report.result.components), (1, 3, 1));
    assert!(prepare(&s, &[], &only(|p| p.drop_islands = 4)).is_err());
}

#[test]
fn a_hundred_thousand_points_are_resampled_within_their_bounds() {
    let point = |i: i32| f64::from(i) * 1e-3;
    let helix: Vec<_> = (0..100_000).map(point).map(|t| [9.0 * t.cos(), 9.0 * t.sin(), 2.0 * t]).collect();
    let s = lines(&[helix], 1.0);
    let start = std::time::Instant::now();
    let made = done(&s, &only(|p| p.resample = true));
    eprintln!("100,000 points: {:?}, {} left", start.elapsed(), made.report.result.nodes);
    assert!(made.report.resample.furthest <= 0.05 && made.report.result.nodes < 1000);
    assert!(furthest(&s, &made.skeleton) <= 0.0501, "{}", furthest(&s, &made.skeleton));
}

#[test]
fn noise_that_is_evened_out_leaves_fewer_points_within_the_same_bounds() {
    let noise = |i: i32| (f64::from(i) * 12.9898).sin() * 43758.5453 % 1.0;
    let line: Vec<_> = (0..2000).map(|i| [f64::from(i) * 0.02, 0.04 * noise(i), 0.04 * noise(i + 5000)]).collect();
    let s = lines(&[line], 1.0);
    let resampled = |smooth| {
        let made = done(&s, &only(|p| (p.resample, p.smooth) = (true, smooth)));
        assert!(made.report.resample.furthest <= 0.05 && furthest(&s, &made.skeleton) <= 0.0501);
        made.report.result.nodes
    };
    let [rough, even] = [false, true].map(resampled);
    assert!(even < rough, "{rough} {even}");
}

#[test]
fn rings_and_vessels_beside_each_other_survive_resampling() {
    let mut s = lines(&[vec![[0.0; 3], [5.0, 0.01, 0.0], [10.0, 0.0, 0.0]], vec![[5.0, -0.01, 0.0]]], 1.0);
    for (a, b) in [(0, 3), (3, 2)] {
        s.edges.push(Edge { nodes: [NodeId(a), NodeId(b)], radii: [1.0; 2] });
    }
    let made = done(&s, &only(|p| p.resample = true));
    assert_eq!(made.report.result.loops, 1);
}

/// Straight vessel piece of an edge.
fn tube(network: &Skeleton, edge: &Edge) -> Tube {
    let [a, b] = edge.nodes.map(|n| network.nodes[n.0 as usize].position);
    Tube { a, b, ra: edge.radii[0], rb: edge.radii[1] }
}

/// Maximum distance of nodes and edge midpoints of `of` from the lines of `from`, in radii.
fn furthest(from: &Skeleton, of: &Skeleton) -> f64 {
    let given: Vec<Tube> = from.edges.iter().map(|e| tube(from, e)).collect();
    let boxes: Vec<Aabb> = given.iter().map(|t| Aabb::of_points([&t.a, &t.b])).collect();
    let tree = Bvh::new(&boxes);
    let mut worst = 0.0_f64;
    for tube in of.edges.iter().map(|e| tube(of, e)) {
        for t in [0.0, 0.5, 1.0] {
            let (point, radius) = (tube.point(t), tube.radius(t));
            let mut nearest = f64::INFINITY;
            tree.query(&Aabb::of_points([&point]).grown(radius), |e| {
                let given = &given[e as usize];
                nearest = nearest.min(point_segment(&point, &given.a, &given.b).1);
            });
            worst = worst.max(nearest / radius);
        }
    }
    worst
}

fn read(path: &Path) -> Skeleton {
    let options = NetworkOptions::default().any_radii(true);
    read_network(path, &options).unwrap_or_else(|e| panic!("{e}")).skeleton
}

/// VMTK's aorta has an inlet and two outlets, `SimVascular`'s pulmonary artery five outlets.
#[test]
fn overlapping_centrelines_become_one_graph_with_all_outlets() {
    let Some(shared) = common::shared() else { return };
    let files = [
        ("measured/vmtk_aorta_branches.vtp", 3),
        ("measured/vmtk_resampled_centerlines.vtp", 3),
        ("skeletons/vmtk_aorta_centerline.vtp", 3),
        ("measured/sv_SU201_RPA_centerlines.vtp", 6),
        ("measured/sv_rom_centerlines.vtp", 3),
    ];
    for (file, tips) in files {
        let raw = read(&shared.join("data").join(file));
        let merged = done(&raw, &only(|p| p.merge = true));
        let (size, axis) = (merged.report.result, furthest(&raw, &merged.skeleton));
        eprintln!("{file}: {size:?}, axis within {axis:.4} r");
        assert_eq!((size.tips, size.branch_points, size.loops, size.components), (tips, tips - 2, 0, 1), "{file}");
        assert!(axis <= 0.1, "{file}: {axis}");
        let again = done(&merged.skeleton, &only(|p| p.merge = true));
        assert_eq!(again.report.merge.merged, [], "{file}");
    }
}

proptest! {
    #[test]
    fn any_graph_comes_out_sound_and_the_same_each_time(
        points in prop::collection::vec((0..6_u8, 0..6_u8, 0..3_u8, 0..5_u8), 2..40),
        edges in prop::collection::vec((0..40_u32, 0..40_u32), 1..60),
    ) {
        let node = |(i, &(x, y, z, r)): (usize, &(u8, u8, u8, u8))| {
            let position = Point3::new(f64::from(x), f64::from(y), f64::from(z));
            Node { position, radius: f64::from(r) * 0.4, original: i as u32 }
        };
        let nodes: Vec<Node> = points.iter().enumerate().map(node).collect();
        let count = nodes.len() as u32;
        let edge = |&(a, b): &(u32, u32)| {
            let ids = [a % count, b % count];
            Edge { nodes: ids.map(NodeId), radii: ids.map(|i| nodes[i as usize].radius) }
        };
        let s = Skeleton { edges: edges.iter().map(edge).collect(), nodes: nodes.clone() };
        if let Ok(made) = prepare(&s, &[], &PrepareParams::default()) {
            prop_assert_eq!(made.skeleton.check(), Ok(()));
            prop_assert_eq!(prepare(&s, &[], &PrepareParams::default()), Ok(made));
        }
    }
}

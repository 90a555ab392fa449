//! Tests of the complete refinement.

use super::*;

use anastomesh_skeleton::clean;
pub(super) use anastomesh_skeleton::fixtures::{network, tangle};
use proptest::prelude::*;

pub(super) fn run(s: &Skeleton, params: &RefineParams) -> Refined {
    let refined = refine(s, params, &()).unwrap();
    assert_eq!(refined.skeleton.check(), Ok(()));
    assert_eq!(refined.skeleton.nodes.len(), refined.origin.len());
    refined
}

fn scaled(s: &Skeleton, f: f64) -> Skeleton {
    let mut out = s.clone();
    for node in &mut out.nodes {
        node.position = (node.position.coords * f).into();
        node.radius *= f;
    }
    for edge in &mut out.edges {
        edge.radii = edge.radii.map(|r| r * f);
    }
    out
}

#[test]
fn a_tangle_is_parted_and_can_be_cut() {
    let s = tangle(6, 3);
    let refined = run(&s, &RefineParams { crowded: Crowded::Keep, ..RefineParams::default() });
    let r = &refined.report;
    assert!(r.given.overlaps > 20, "{}", r.given.overlaps);
    assert!(10 * r.moved.overlaps < r.given.overlaps && r.moved.far <= 1, "{:?}", r.moved);
    assert!(r.moved.metrics.cuttable.percent() > 97.0, "{:?}", r.moved.metrics.cuttable);
    // Terminals and the root are fixed.
    let before = s.adjacency();
    for node in before.terminals() {
        assert_eq!(refined.skeleton.node(node).position, s.node(node).position);
    }
    assert!(r.displacement.max <= 21.0 * r.unit * (1.0 + 1e-12));
    assert!(r.residual.volume_lost <= 0.005 * r.residual.volume);
}

#[test]
fn the_unit_makes_no_difference() {
    let s = tangle(5, 7);
    // Few steps only: rounding differs between units, and a tangle amplifies it.
    let params = RefineParams { iterations: 40, ..RefineParams::default() };
    let reference = run(&s, &params).skeleton;
    for f in [1e-3, 1e-6, 22.7] {
        let other = run(&scaled(&s, f), &params).skeleton;
        assert_eq!(other.edges.len(), reference.edges.len());
        for (a, b) in reference.nodes.iter().zip(&other.nodes) {
            let wrong = (a.position.coords * f - b.position.coords).norm();
            assert!(wrong <= 1e-6 * f * a.position.coords.norm().max(1.0), "{wrong} at factor {f}");
        }
    }
}

#[test]
fn the_number_of_threads_makes_no_difference() {
    let s = tangle(6, 11);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(&s, &RefineParams { iterations: 60, ..RefineParams::default() }))
    };
    let (one, three) = (with(1), with(3));
    assert_eq!(one.skeleton, three.skeleton);
    assert_eq!(one.report, three.report);
}

#[test]
fn vessels_that_cross_exactly_in_a_plane_are_parted() {
    let points = [
        [-20.0, 0.0, 0.0],
        [0.0, 0.0, 0.0],
        [20.0, 9.0, 0.0],
        [20.0, -9.0, 0.0],
        [-9.0, -15.0, 0.0],
        [-9.0, 15.0, 0.0],
        [-1.0, 25.0, 0.0],
        [-17.0, 25.0, 0.0],
    ];
    let s = network(&points, 1.0, &[(0, 1), (1, 2), (1, 3), (4, 5), (5, 6), (5, 7)]);
    let refined = run(&s, &RefineParams::default());
    assert_eq!((refined.report.given.far, refined.report.moved.overlaps), (1, 0));
}

#[test]
fn what_cannot_move_is_bent_or_shrunk_or_listed() {
    // Two vessels between fixed terminals can separate only by bends.
    let s =
        network(&[[-20.0, 0.0, 0.0], [20.0, 0.0, 0.0], [0.0, -20.0, 0.5], [0.0, 20.0, 0.5]], 1.0, &[(0, 1), (2, 3)]);
    let refined = run(&s, &RefineParams::default());
    assert!(refined.report.bends > 0);
    assert_eq!(refined.report.moved.overlaps, 0, "{:?}", refined.report);
    let stiff = RefineParams { bends: false, residual: Residual::Report, ..RefineParams::default() };
    let listed = run(&s, &stiff).report.residual;
    assert_eq!((listed.pairs.len(), listed.left), (1, 1));
    assert_eq!(listed.pairs[0].edges, [[0, 1], [2, 3]]);
    assert_eq!(listed.pairs[0].treatment, Treatment::Left);
    let fused = run(&s, &RefineParams { residual: Residual::Fuse, ..stiff }).report.residual;
    assert_eq!(fused.pairs[0].treatment, Treatment::Fused);
}

#[test]
fn shrinking_is_local_and_at_most_by_a_third() {
    let points = [[-30.0, 0.0, 0.0], [30.0, 0.0, 0.0], [0.0, -30.0, 1.8], [0.0, 30.0, 1.8]];
    let s = network(&points, 1.0, &[(0, 1), (2, 3)]);
    let params = RefineParams { bends: false, ..RefineParams::default() };
    let refined = run(&s, &params);
    let r = &refined.report;
    assert_eq!((r.moved.overlaps, r.result.overlaps, r.residual.left), (1, 0, 0), "{:?}", r.residual);
    assert!(r.residual.shrunk_edges == 2 && r.residual.volume_lost < 0.1 * r.residual.volume, "{:?}", r.residual);
    let radii = refined.skeleton.edges.iter().flat_map(|e| e.radii);
    assert!(radii.clone().fold(f64::INFINITY, f64::min) >= 0.7 - 1e-12);
    // The ends keep their radii, and the radius is continuous.
    assert!(radii.fold(0.0, f64::max) <= 1.0 + 1e-12);
    let adjacency = refined.skeleton.adjacency();
    for node in refined.skeleton.node_ids() {
        if let &[e, f] = adjacency.edges(node) {
            let at = |e| refined.skeleton.edge(e).radii[refined.skeleton.edge(e).end(node)];
            assert!((at(e) - at(f)).abs() < 1e-12);
        } else {
            assert!((refined.skeleton.node(node).radius - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn terminals_move_only_as_far_as_they_may() {
    let s = network(
        &[[-20.0, 0.0, 0.0], [0.0, 0.0, 0.0], [20.0, 0.2, 0.0], [20.0, -0.2, 0.0]],
        1.0,
        &[(0, 1), (1, 2), (1, 3)],
    );
    let kept = RefineParams { crowded: Crowded::Keep, ..RefineParams::default() };
    let held = run(&s, &kept);
    assert!(held.report.residual.pairs.iter().all(|p| p.terminals_too_close));
    assert_eq!(held.skeleton.nodes[2].position, s.nodes[2].position);
    let free = run(&s, &RefineParams { free_terminals: 3.0, ..kept });
    let far = (free.skeleton.nodes[2].position - s.nodes[2].position).norm();
    assert!(far > 0.1 && far <= 3.0 + 1e-9, "{far}");
    assert_eq!(free.report.moved.overlaps, 0, "{:?}", free.report.residual);
}

#[test]
fn a_fork_to_terminals_side_by_side_comes_close_enough_to_part() {
    // The ends are fixed and clear of each other; long legs overlap for any position of the bifurcation.
    let points = [[-20.0, 0.0, 0.0], [0.0, 0.0, 0.0], [20.0, 1.2, 0.0], [20.0, -1.2, 0.0]];
    let s = network(&points, 1.0, &[(0, 1), (1, 2), (1, 3)]);
    let params = RefineParams { bends: false, ..RefineParams::default() };
    let refined = run(&s, &params);
    assert_eq!((refined.report.given.overlaps, refined.report.moved.overlaps), (1, 0));
    let leg = (refined.skeleton.nodes[1].position - refined.skeleton.nodes[2].position).norm();
    assert!(leg > 2.0 && leg < 4.0, "{leg}");
    assert_eq!(refined.report.result.metrics.shorter_than_2.count, 0);
}

#[test]
fn what_is_held_does_not_become_worse() {
    // Each leg satisfies equation 11. Separating them requires legs that violate it.
    let points = [[-20.0, 0.0, 0.0], [0.0, 0.0, 0.0], [20.0, 1.2, 0.0], [20.0, -1.2, 0.0]];
    let s = network(&points, 1.0, &[(0, 1), (1, 2), (1, 3)]);
    let params = RefineParams { bends: false, residual: Residual::Report, ..RefineParams::default() };
    assert_eq!(run(&s, &params).report.worse, [Metric::Equation11]);
    let held = run(&s, &RefineParams { hold: vec![Metric::Equation11], ..params });
    assert_eq!((held.report.worse.as_slice(), held.report.result.overlaps), (&[][..], 1));
}

#[test]
fn polylines_keep_their_shape() {
    // A polyline of short pieces along an arc, crossed by a straight vessel.
    let mut points: Vec<[f64; 3]> = (0..=60)
        .map(|i| {
            let a = std::f64::consts::PI * f64::from(i) / 60.0;
            [30.0 * libm::cos(a), 30.0 * libm::sin(a), 0.0]
        })
        .collect();
    let mut edges: Vec<(u32, u32)> = (0..60).map(|i| (i, i + 1)).collect();
    points.extend([[0.0, 10.0, 0.4], [0.0, 50.0, 0.4]]);
    edges.push((61, 62));
    let s = network(&points, 1.0, &edges);
    let refined = run(&s, &RefineParams { bends: false, ..RefineParams::default() });
    assert_eq!((refined.report.given.overlaps > 0, refined.report.moved.overlaps), (true, 0));
    // Neighbours move together, so the angle between pieces changes little.
    for i in 1..60 {
        let at = |j: usize| refined.skeleton.nodes[j].position;
        let (u, v) = (at(i) - at(i - 1), at(i + 1) - at(i));
        let turn = libm::atan2(u.cross(&v).norm(), u.dot(&v)).to_degrees();
        assert!(turn < 25.0, "{turn} at {i}");
    }
}

/// A polyline of 60 pieces along a parabola, and a separate straight vessel beside its vertex.
fn beside_a_bow(apart: f64) -> Skeleton {
    let x = |i: u32| f64::from(i) - 30.0;
    let mut points: Vec<[f64; 3]> = (0..=60).map(|i| [x(i), 0.02 * x(i) * x(i), 0.0]).collect();
    points.extend((0..=60).map(|i| [x(i), -apart, 0.0]));
    let edges: Vec<(u32, u32)> = (0..60).chain(61..121).map(|i| (i, i + 1)).collect();
    network(&points, 1.0, &edges)
}

#[test]
fn nothing_measured_moves_but_what_overlaps() {
    let clear = beside_a_bow(2.05);
    assert_eq!(run(&clear, &RefineParams::default()).skeleton, clear);
    let s = beside_a_bow(1.6);
    let refined = run(&s, &RefineParams { bends: false, ..RefineParams::default() });
    let r = &refined.report;
    assert!(r.given.overlaps > 0 && r.moved.overlaps == 0, "{r:?}");
    assert!(r.displacement_radii.max <= 1.0 && r.demanded.is_empty(), "{:?}", r.displacement_radii);
    let still = |i: usize| refined.skeleton.nodes[i].position == s.nodes[i].position;
    assert!((0..15).chain(47..61).all(still), "far from the place");
}

#[test]
fn an_overlap_may_demand_more_than_a_radius_unless_that_is_the_bound() {
    // Coinciding vessels: each has to move by a radius.
    let s = beside_a_bow(0.1);
    let params = RefineParams { bends: false, residual: Residual::Report, ..RefineParams::default() };
    let refined = run(&s, &params);
    assert_eq!(refined.report.result.overlaps, 0);
    let bound = |radii| RefineParams { freedom: Freedom::Radii(radii), ..params.clone() };
    let held = run(&s, &bound(0.3));
    assert!(held.report.result.overlaps > 0 && held.report.displacement_radii.max <= 0.3 + 1e-12);
    assert!(refine(&s, &bound(f64::NAN), &()).is_err());
}

#[test]
fn parameters_out_of_range_are_refused() {
    let s = tangle(1, 1);
    for bad in [
        RefineParams { clearance: f64::NAN, ..RefineParams::default() },
        RefineParams { barrier_rate: -1.0, ..RefineParams::default() },
        RefineParams { free_terminals: f64::INFINITY, ..RefineParams::default() },
    ] {
        assert!(matches!(refine(&s, &bad, &()), Err(RefineError::Parameter { .. })));
    }
    let mut broken = s;
    broken.nodes[0].position.x = f64::NAN;
    assert!(matches!(refine(&broken, &RefineParams::default(), &()), Err(RefineError::Skeleton(_))));
}

#[test]
fn odd_networks_end_in_something_finite() {
    let ring: Vec<(u32, u32)> = (0..8).map(|i| (i, (i + 1) % 8)).collect();
    let circle: Vec<[f64; 3]> =
        (0..8).map(|i| [libm::cos(f64::from(i)) * 9.0, libm::sin(f64::from(i)) * 9.0, 0.0]).collect();
    let line = [[0.0; 3], [5.0, 0.0, 0.0], [10.0, 0.0, 0.0]];
    let coincident = [[0.0; 3], [10.0, 0.0, 0.0], [5.0, 0.0, 0.0], [15.0, 0.0, 0.0]];
    let cases = [
        network(&line[..2], 1.0, &[(0, 1)]),
        network(&line, 1.0, &[(0, 1), (1, 2)]),
        network(&circle, 1.0, &ring),
        network(&coincident, 1.0, &[(0, 1), (2, 3)]),
        network(&coincident, 1e-12, &[(0, 1), (2, 3)]),
        network(&coincident, 1e12, &[(0, 1), (2, 3)]),
        scaled(&tangle(3, 5), 1e-12),
        scaled(&tangle(3, 5), 1e12),
    ];
    for s in cases {
        let params = RefineParams { iterations: 40, ..RefineParams::default() };
        let refined = run(&s, &params);
        assert!(refined.skeleton.nodes.iter().all(|n| n.position.iter().all(|x| x.is_finite())));
        assert!(refined.report.displacement.max.is_finite());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]
    #[test]
    fn any_graph_ends_finite_with_the_same_shape(
        points in prop::collection::vec(prop::array::uniform3(-20.0..20.0_f64), 14),
        ends in prop::collection::vec((0..14_u32, 0..14_u32, 1..5_u8), 1..24),
    ) {
        let mut raw = network(&points, 1.0, &ends.iter().map(|e| (e.0, e.1)).collect::<Vec<_>>());
        for (edge, e) in raw.edges.iter_mut().zip(&ends) {
            edge.radii = [0.4 * f64::from(e.2); 2];
        }
        if let Ok((s, _)) = clean(&raw) {
            let refined = run(&s, &RefineParams { iterations: 30, ..RefineParams::default() });
            let shape = |s: &Skeleton| {
                let a = s.adjacency();
                let list = s.components(&a).list;
                (list.len(), list.iter().map(anastomesh_skeleton::Component::loops).sum::<usize>(), a.terminals().len())
            };
            prop_assert_eq!(shape(&s), shape(&refined.skeleton));
            prop_assert!(refined.report.result.overlaps <= refined.report.given.overlaps);
            // Pieces of one vessel count as far pairs.
            let is_divided = s.is_measured() || refined.report.given.overlaps == 0;
            prop_assert!(is_divided || refined.report.result.far <= refined.report.given.far);
            prop_assert!(refined.report.displacement.max <= 21.0 * refined.report.unit * (1.0 + 1e-9));
        }
    }
}

/// Two vessels that leave one node side by side, and end almost in contact: their fixed ends must not drive them apart.
#[test]
fn vessels_that_almost_touch_up_to_their_ends_move_by_less_than_a_radius() {
    for gap in [0.001, 0.01] {
        let y = 1.0 + 0.5 * gap;
        let points = [[-8.0, 0.0, 0.0], [0.0, -y, 0.0], [39.0, -y, 0.0], [0.0, y, 0.0], [39.0, y, 0.0]];
        let given = network(&points, 1.0, &[(0, 1), (1, 2), (0, 3), (3, 4)]);
        let params = RefineParams::default().freedom(Freedom::Measured);
        let refined = refine(&given, &params, &()).unwrap();
        assert_eq!(refined.report.result.overlaps, 0);
        assert!(refined.report.displacement_radii.max < 1.0, "{:?}", refined.report.displacement_radii);
    }
}

/// Pairs in a crotch at the kept clearance may overlap at their own radii. Found by the fuzz target `refine`.
#[test]
fn a_polyline_that_reverses_keeps_its_number_of_overlaps() {
    let points =
        [[15.0, 7.5, 15.0], [15.0, 7.5, 0.0], [8.0, 0.0, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 10.0]];
    let given = network(&points, 0.5, &[(0, 1), (1, 2), (2, 3), (3, 4), (4, 5)]);
    for iterations in [1, 3, 10, 60] {
        let params = RefineParams::default().iterations(iterations).every(0);
        let report = refine(&given, &params, &()).unwrap().report;
        assert_eq!(report.given.overlaps, 1, "{iterations}");
        assert!(report.result.overlaps <= 1, "{iterations}: {}", report.result.overlaps);
    }
}

/// All vessels cross at one place, with fixed ends: the work is bounded, and the report states it.
#[test]
fn a_tangle_that_cannot_be_resolved_is_given_up() {
    let count = 90;
    let way = |i: usize| {
        let (z, angle) = (1.0 - 2.0 * (i as f64 + 0.5) / count as f64, 2.4 * i as f64);
        let across = (1.0 - z * z).sqrt();
        [12.0 * across * libm::cos(angle), 12.0 * across * libm::sin(angle), 12.0 * z]
    };
    let points: Vec<[f64; 3]> = (0..count).flat_map(|i| [way(i), way(i).map(|x| -x)]).collect();
    let edges: Vec<(u32, u32)> = (0..count as u32).map(|i| (2 * i, 2 * i + 1)).collect();
    let params = RefineParams::default().freedom(Freedom::Measured).every(0);
    let report = run(&network(&points, 1.0, &edges), &params).report;
    let iterations = report.history.last().map_or(0, |sample| sample.iteration);
    assert!(report.gave_up && iterations < params.iterations, "{iterations}");
    assert!(report.to_string().contains("ended early"), "{report}");
}

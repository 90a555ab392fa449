//! Positions and lengths of connectors along a branch.

use super::tests::{h_shape, polyline, skeleton};
use super::*;
use anastomesh_skeleton::CutRules;

fn cut_arcs(skeleton: &Skeleton, params: &PartitionParams) -> Vec<[f64; 2]> {
    let partition = partition(skeleton, params).expect("a partition");
    assert_eq!(check_partition(skeleton, &partition), Ok(()));
    partition.cut_arcs
}

fn is_near(found: &[[f64; 2]], expected: &[[f64; 2]]) -> bool {
    found.len() == expected.len()
        && found.as_flattened().iter().zip(expected.as_flattened()).all(|(a, b)| (a - b).abs() < 1e-9)
}

#[test]
fn the_shortest_connector_has_the_length_of_its_rule() {
    // Both planes are as near the first bifurcation as they may be.
    let params = |room: f64| PartitionParams {
        cuts: CutRules { room, ..CutRules::default() },
        eager_cuts: CutRules { room: 2.0, ..CutRules::default() },
        shifted_cuts: [(BranchId(0), -1.0)].into(),
        ..PartitionParams::default()
    };
    let mut wide = h_shape(24.0);
    for node in &mut wide.nodes {
        node.radius = 2.0;
    }
    wide.edges.iter_mut().for_each(|edge| edge.radii = [2.0; 2]);
    // A length of 3 radii, and of 1.
    assert!(is_near(&cut_arcs(&wide, &params(3.0)), &[[4.4, 10.4]]));
    assert!(is_near(&cut_arcs(&wide, &params(1.0)), &[[4.4, 6.4]]));
    // Branches with eager cuts have their own rule.
    let eager = PartitionParams { eager: [BranchId(0)].into(), ..params(3.0) };
    assert!(is_near(&cut_arcs(&h_shape(12.0), &eager), &[[2.2, 4.2]]));
}

#[test]
fn further_connectors_are_longer_than_the_shortest() {
    // Straight parts of 1.95, 1.9 and 48 radii. Only the first connector may be as short as the former two.
    let points = [[0.0; 3], [7.0, 0.0, 0.0], [7.0, 6.0, 0.0], [60.0, 6.0, 0.0]];
    let reversed = points.into_iter().rev();
    for vessel in [polyline(points), polyline(reversed)] {
        assert_eq!(cut_arcs(&vessel, &PartitionParams::default()).len(), 1);
    }
}

#[test]
fn pieces_are_long_by_the_radius_in_their_middle() {
    // The piece before the bend has 27 radii of its middle, and 9 of its start.
    let points = [([0.0; 3], 3.0), ([6.0, 0.0, 0.0], 1.0), ([25.0, 0.0, 0.0], 1.0), ([25.0, 60.0, 0.0], 1.0)];
    assert_eq!(cut_arcs(&skeleton(&points, &[[0, 1], [1, 2], [2, 3]]), &PartitionParams::default()).len(), 2);
}

#[test]
fn connectors_of_a_long_vessel_are_six_radii_apart() {
    let long = skeleton(&[([0.0; 3], 2.0), ([2000.0, 0.0, 0.0], 2.0)], &[[0, 1]]);
    let arcs = cut_arcs(&long, &PartitionParams::default());
    // Terminals keep three radii, and a connector has 200 at most.
    assert_eq!(arcs.len(), 5);
    assert!(is_near(&[[arcs[0][0], arcs[4][1]]], &[[6.0, 1994.0]]), "{arcs:?}");
    assert!(arcs.windows(2).all(|pair| (pair[1][0] - pair[0][1] - 12.0).abs() < 1e-9), "{arcs:?}");
}

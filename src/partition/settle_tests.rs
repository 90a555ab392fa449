//! Cuts that move out of the way of other vessels.

use super::tests::{least_rim, skeleton};
use super::*;

/// A bridge along x between bifurcations at 0 and `length`, with two arms at each. The first arm leads along some points to a
/// terminal. Returns the bridge's cut.
fn cut_of_bridge(length: f64, arm: &[[f64; 3]]) -> Option<[f64; 2]> {
    let mut points =
        vec![[0.0; 3], [length, 0.0, 0.0], [-4.0, -7.0, 0.0], [length + 4.0, 0.0, 7.0], [length + 4.0, 0.0, -7.0]];
    let mut edges = vec![[0, 1], [0, 5], [0, 2], [1, 3], [1, 4]];
    points.extend(arm);
    edges.extend((6..points.len() as u32).map(|i| [i - 1, i]));
    let points: Vec<_> = points.into_iter().map(|p| (p, 1.0)).collect();
    // The arm is not cut.
    let params = PartitionParams { forbidden_cuts: [BranchId(1)].into(), ..PartitionParams::default() };
    let skeleton = skeleton(&points, &edges);
    let partition = partition(&skeleton, &params).expect("a partition");
    assert_eq!(check_partition(&skeleton, &partition), Ok(()));
    assert!(least_rim(&partition) > 1.12);
    assert!(partition.cuts.len() < 2);
    partition.cut_arcs.first().copied()
}

#[test]
fn a_cut_moves_past_a_vessel_beside_its_own() {
    // The arm runs along the bridge from 3 to 15, where both would fuse.
    let arm = |aside: f64| [[0.0, 9.0, 0.0], [3.0, 9.0, 0.0], [3.0, aside, 0.0], [15.0, aside, 0.0], [15.0, 12.0, 0.0]];
    assert!(cut_of_bridge(40.0, &arm(2.2)).is_some_and(|[from, _]| from > 16.0 && from < 20.0));
    assert!(cut_of_bridge(40.0, &arm(3.5)).is_some_and(|[from, _]| (from - 2.2).abs() < 1e-9));
    assert_eq!(cut_of_bridge(19.0, &arm(2.2)), None);
}

#[test]
fn a_cut_moves_past_the_tip_of_another_vessel() {
    // The arm ends beside the bridge. Its axis keeps the distance of vessels that do not fuse, and its tip does not.
    let arm = |end: f64| [[0.0, 9.0, 0.0], [4.0, 9.0, 0.0], [4.0, end, 0.0]];
    assert!(cut_of_bridge(20.0, &arm(2.6)).is_some_and(|[from, _]| from > 5.0 && from < 8.0));
    assert!(cut_of_bridge(20.0, &arm(3.6)).is_some_and(|[from, _]| (from - 2.2).abs() < 1e-9));
    // The arm ends before the plane, and its tip lies beside it.
    let arm = |aside: f64| [[0.0, 9.0, 0.0], [-4.0, 9.0, aside], [-4.0, 0.0, aside], [1.0, 0.0, aside]];
    assert!(cut_of_bridge(20.0, &arm(2.2)).is_some_and(|[from, _]| from > 2.5 && from < 3.0));
    assert!(cut_of_bridge(20.0, &arm(2.3)).is_some_and(|[from, _]| (from - 2.2).abs() < 1e-9));
}

#[test]
fn the_straight_ends_of_vessels_keep_out_of_each_others_way() {
    // Two arms bend beside each other. Their axes keep apart, and their straight ends at planes there do not.
    let far = [[0.0; 3], [-7.0, 16.0, -5.0], [-11.0, 9.0, -3.0], [-10.0, 22.0, -7.0]].map(|p| (p, 1.2));
    let first = [
        [3.0, -1.5, -3.8],
        [4.3, -3.5, -2.44],
        [3.6, -4.0, -0.8],
        [3.0, -6.0, 3.0],
        [-2.0, -9.0, 10.0],
        [-5.0, -5.0, 6.0],
    ];
    let second = [[2.6, -2.6, 1.4], [4.4, -3.7, 1.0], [6.0, -4.2, 1.0], [10.0, -8.0, 5.0], [13.0, -2.0, 1.0]];
    let points: Vec<_> = far.into_iter().chain(first.map(|p| (p, 0.95))).chain(second.map(|p| (p, 0.65))).collect();
    let to_far = [[0, 1], [1, 2], [1, 3]];
    let to_first = [[0, 4], [4, 5], [5, 6], [6, 7], [7, 8], [7, 9]];
    let to_second = [[0, 10], [10, 11], [11, 12], [12, 13], [12, 14]];
    let skeleton = skeleton(&points, &[&to_far[..], &to_first[..], &to_second[..]].concat());
    let partition = partition(&skeleton, &PartitionParams::default()).expect("a partition");
    assert_eq!(check_partition(&skeleton, &partition), Ok(()));
    // Only the vessel apart from both is cut.
    assert!(least_rim(&partition) > 1.2);
    assert_eq!(partition.cuts.len(), 1);
    let in_the_way = |(_, why): &&(BranchId, UncutReason)| matches!(why, UncutReason::Clearance { .. });
    assert_eq!(partition.uncut.iter().filter(in_the_way).count(), 2);
}

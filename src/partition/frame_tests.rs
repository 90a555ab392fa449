//! Frames of discs at cuts.

use super::tests::{polyline, skeleton};
use super::*;
use anastomesh_mesh::geometry::Vec3;

/// First frame vectors at the cuts of the cluster with a node.
fn ups(skeleton: &Skeleton, node: u32) -> Vec<Option<Vec3>> {
    let partition = partition(skeleton, &PartitionParams::default()).expect("a partition");
    let mut around = partition.clusters.iter().filter(|cluster| cluster.nodes.iter().any(|n| n.0 == node));
    let cluster = around.next().expect("a cluster");
    let at_cuts = cluster.ends.iter().filter(|end| matches!(end.kind, EndKind::Cut { .. }));
    at_cuts.map(|end| end.section.up).collect()
}

#[test]
fn slight_bends_have_no_frame() {
    // A bend beside the terminal, by this angle.
    let bent = |degrees: f64| {
        let (sin, cos) = libm::sincos(degrees.to_radians());
        ups(&polyline([[0.0; 3], [2.0, 0.0, 0.0], [2.0 + 90.0 * cos, 90.0 * sin, 0.0]]), 0)
    };
    assert_eq!(bent(15.0), [None]);
    assert_eq!(bent(50.0).len(), 1);
    assert!(bent(50.0)[0].is_some_and(|up| up.z.abs() > 1.0 - 1e-12), "{:?}", bent(50.0));
}

#[test]
fn a_vessel_that_returns_to_its_bifurcation_leaves_it_twice() {
    // A ring that is cut beside its far corner, which has another plane, and a tail.
    let points = [[0.0; 3], [9.0, 0.0, 0.0], [9.0, 9.0, 3.0], [0.0, 9.0, 0.0], [-9.0, -9.0, 0.0]];
    let ring = skeleton(&points.map(|p| (p, 1.0)), &[[0, 1], [1, 2], [2, 3], [3, 0], [0, 4]]);
    let [near, far] = [0, 2].map(|node| ups(&ring, node));
    assert_eq!((near.len(), far.len()), (2, 2));
    assert!(near.iter().all(|up| up.is_some_and(|up| up.z.abs() > 1.0 - 1e-12)), "{near:?}");
    assert!(far.iter().all(|up| up.is_some_and(|up| up.z.abs() < 0.99)), "{far:?}");
}

#[test]
fn clusters_of_more_than_32_pieces_have_no_frames() {
    // Bifurcations in a row, each with a short vessel. One may have two. The last vessel is long, and cut.
    let comb = |bifurcations: u32, with_another: bool| {
        let mut points = vec![[-6.0, 0.0, 0.0]];
        let mut edges = Vec::new();
        for i in 0..=bifurcations {
            edges.push([points.len() as u32 - 1, points.len() as u32]);
            points.push([4.0 * f64::from(i) + if i == bifurcations { 60.0 } else { 0.0 }, 0.0, 0.0]);
        }
        let sides = (1..=bifurcations).map(|i| (i, 6.0)).chain(with_another.then_some((3, -6.0)));
        for (node, aside) in sides {
            edges.push([node, points.len() as u32]);
            let [x, y, z] = points[node as usize];
            points.push([x, y + aside, z]);
        }
        let points: Vec<_> = points.into_iter().map(|p| (p, 1.0)).collect();
        ups(&skeleton(&points, &edges), bifurcations)
    };
    let z = |up: Option<Vec3>| up.map(|up| up.z.abs());
    assert_eq!(comb(15, false).into_iter().map(z).collect::<Vec<_>>(), [Some(1.0)]);
    assert_eq!(comb(15, true).into_iter().map(z).collect::<Vec<_>>(), [Some(1.0)]);
    assert_eq!(comb(16, false), [None]);
}

//! Clusters of a layout: sizes of edges, summary figures, clusters that are cut again.

use super::near::terminal_overrun;
use super::parts::{PartitionWarning, UncutReason};
use super::tests::{any_network, h_shape, polyline, skeleton};
use super::*;
use anastomesh_mesh::geometry::Point3;
use anastomesh_skeleton::course::{Courses, Way};
use anastomesh_skeleton::{NodeSizes, SizeAt, SizeField};
use proptest::prelude::*;

fn layout(skeleton: &Skeleton, params: &PartitionParams) -> Layout {
    lay_out(&Arc::new(skeleton.clone()), params, &()).expect("a layout")
}

fn usual(skeleton: &Skeleton) -> Layout {
    layout(skeleton, &PartitionParams::default())
}

#[test]
fn connectors_keep_away_from_places_with_shorter_edges() {
    let long = h_shape(80.0);
    // Edges half as long as usual around the middle of the bridge.
    let points: Vec<Point3> = (0..=80).map(|i| Point3::new(f64::from(i), 0.0, 0.0)).collect();
    let rho = PartitionParams::default().rho;
    let lengths: Vec<f64> = points.iter().map(|p| if (p.x - 40.0).abs() <= 2.0 { 0.9 / rho } else { 9.0 }).collect();
    let field = SizeField::new("size", &points, &lengths).expect("lengths");
    let params = PartitionParams { size_field: Some(field), ..PartitionParams::default() };
    let fine = layout(&long, &params);
    let stations = fine.fine_stations();
    assert!(stations.len() > 2 && stations.iter().all(|station| (station.arc - 40.0).abs() < 3.0), "{stations:?}");
    let explicit = fine.explicit();
    assert_eq!(check_partition(&long, &explicit), Ok(()));
    assert_eq!((explicit.cuts.len(), usual(&long).cuts_len()), (2, 1));
    for station in stations {
        let [lo, hi] = [-1.0, 1.0].map(|sign| station.arc + sign * station.reach());
        assert!(explicit.cut_arcs.iter().all(|&[from, to]| to <= lo || hi <= from), "{:?}", explicit.cut_arcs);
    }
    // The planes lie beside the first and the last station.
    let reach = |sign: f64| stations.iter().map(move |station| sign * station.arc + station.reach());
    let [first, last] = [-1.0, 1.0].map(|sign| sign * reach(sign).fold(f64::NEG_INFINITY, f64::max));
    let [[_, before], [after, _]] = explicit.cut_arcs[..] else { panic!("two cuts") };
    assert!((before - first).abs() < 1e-9 && (after - last).abs() < 1e-9, "{:?}", explicit.cut_arcs);
    // Every station is in the cluster of its piece.
    for piece in explicit.pieces.iter().filter(|piece| piece.branch == BranchId(0)) {
        let inside = stations.iter().filter(|station| piece.arc[0] <= station.arc && station.arc <= piece.arc[1]);
        let places: Vec<_> = inside.map(|station| station.place).collect();
        assert_eq!(explicit.clusters[piece.cluster.0 as usize].fine, places);
    }
}

#[test]
fn sizes_are_interpolated_in_the_middle_of_a_vessel() {
    let vessel = polyline([[0.0; 3], [10.0, 0.0, 0.0], [30.0, 0.0, 0.0]]);
    let sized = |values: &[f64], skeleton: &Skeleton| {
        let sizes = SizeAt::Nodes(NodeSizes::new("size", values).expect("values"));
        usual(skeleton).sized(Some(sizes)).cluster(ClusterId(0)).size
    };
    // The middle is at 15: a quarter of the way from the second node to the third.
    assert!(sized(&[0.1, 0.5, 0.9], &vessel).is_some_and(|size| (size - 0.6).abs() < 1e-12));
    assert_eq!(sized(&[0.25, 0.5], &polyline([[0.0; 3], [10.0, 0.0, 0.0]])), Some(0.375));
    // Clusters with several vessels have none.
    assert_eq!(sized(&[0.5; 6], &h_shape(12.0)), None);
    assert_eq!(usual(&vessel).cluster(ClusterId(0)).size, None);
}

#[test]
fn forks_with_shorter_edges_do_not_depend_on_the_unit() {
    // Arms that bend soon after their junction.
    let points = [[0.0; 3], [-9.0, 0.0, 0.0], [1.5, 1.0, 0.0], [2.0, 9.0, 0.0], [1.5, -1.0, 0.5], [9.0, -2.0, 0.0]];
    let fork = |unit: f64| {
        let points = points.map(|p| (p.map(|x| x * unit), unit));
        let skeleton = skeleton(&points, &[[0, 1], [0, 2], [2, 3], [0, 4], [4, 5]]);
        let fine = usual(&skeleton).sized(Some(SizeAt::Forks(0.5))).cluster(ClusterId(0)).fine;
        assert_eq!(fine.len(), 1);
        assert_eq!((fine[0].at, fine[0].factor), (Point3::origin(), 0.5));
        fine[0].within / unit
    };
    let within = fork(1.0);
    assert!(within > 1.0 && [0.125, 8.0].into_iter().all(|unit| (fork(unit) - within).abs() < 1e-9), "{within}");
}

#[test]
fn clusters_with_a_junction_are_counted() {
    let junctions = |skeleton: &Skeleton| {
        let summary = usual(skeleton).summary();
        (summary.clusters, summary.cuts, summary.junction_clusters)
    };
    assert_eq!(junctions(&h_shape(12.0)), (2, 1, 2));
    assert_eq!(junctions(&polyline([[0.0; 3], [9.0, 0.0, 0.0]])), (1, 0, 0));
    // A ring that is cut twice: the cluster of its first node has two pieces and no junction. With a tail, it has one.
    let ring = |size: f64, tail: bool| {
        let mut points =
            vec![([0.0; 3], 1.0), ([size, 0.0, 0.0], 1.0), ([size, size, 0.0], 1.0), ([0.0, size, 0.0], 1.0)];
        let mut edges = vec![[0, 1], [1, 2], [2, 3], [3, 0]];
        if tail {
            points.push(([-9.0, -9.0, 0.0], 1.0));
            edges.push([0, 4]);
        }
        skeleton(&points, &edges)
    };
    assert_eq!(junctions(&ring(9.0, false)), (2, 2, 0));
    assert_eq!(junctions(&ring(9.0, true)), (2, 2, 1));
    // Two pieces with one end.
    assert_eq!(junctions(&ring(8.0, true)), (1, 0, 1));
}

#[test]
fn obstructed_terminals_are_counted_by_kind() {
    // A tip at this distance from another vessel. All radii are 0.5.
    let layout = |distance: f64| {
        let points =
            [[0.0; 3], [9.0, 0.0, 0.0], [-9.0, 0.0, 0.0], [0.0, 9.0, 0.0], [6.0, 9.0, 0.0], [6.0, distance, 0.0]];
        let points = points.map(|p| (p.map(|x| 0.5 * x), 0.5));
        usual(&skeleton(&points, &[[0, 1], [0, 2], [0, 3], [3, 4], [4, 5]]))
    };
    let counts = |distance: f64| {
        let summary = layout(distance).summary();
        (summary.short_overruns, summary.caps_not_clear)
    };
    assert_eq!([2.3, 2.5, 3.0, 3.2].map(counts), [(0, 1), (1, 0), (1, 0), (0, 0)]);
    // Lengths are in radii.
    for (distance, expected) in [(2.5, 0.459), (3.0, 0.96)] {
        let [PartitionWarning::ShortOverrun { radii, .. }] = layout(distance).warnings()[..] else {
            panic!("{distance}")
        };
        assert!((radii - expected).abs() < 1e-3, "{radii}");
    }
}

#[test]
fn large_clusters_are_cut_where_there_is_little_space() {
    // Both ends need 2.2 radii, and less in large clusters. The connector needs 1.
    let bridge = h_shape(5.2);
    let of = |large: usize| {
        let layout = layout(&bridge, &PartitionParams { large, ..PartitionParams::default() });
        (
            layout.clusters_len(),
            layout.largest_nodes(),
            layout.uncut().iter().any(|(_, why)| *why == UncutReason::Length),
        )
    };
    assert_eq!([of(100), of(6), of(5), of(2)], [(1, 6, true), (1, 6, true), (2, 3, false), (2, 3, false)]);
    // Without a smaller cluster, the usual cuts stay.
    let short = h_shape(4.5);
    let with = |large: usize| layout(&short, &PartitionParams { large, ..PartitionParams::default() });
    assert_eq!(with(2).explicit(), with(100).explicit());
}

#[test]
fn tips_continue_their_vessel() {
    let vessel = polyline([[1.0, 0.0, 0.0], [9.0, 0.0, 0.0]]);
    let chains = vessel.chains(&vessel.adjacency());
    let course = Courses { skeleton: &vessel, chains: &chains }.get(0);
    let params = PartitionParams::default();
    let [back, onward] = [Way::Back, Way::Onward].map(|end| terminal_overrun(&course, end, &params));
    let length = onward.length();
    assert!(length > 0.0 && (back.length() - length).abs() < 1e-12);
    assert_eq!((onward.a.x, back.a.x), (9.0, 1.0));
    assert!((onward.b - Point3::new(9.0 + length, 0.0, 0.0)).norm() < 1e-12);
    assert!((back.b - Point3::new(1.0 - length, 0.0, 0.0)).norm() < 1e-12);
}

/// A cluster without the numbers of its cuts.
fn without_numbers(layout: &Layout, id: usize) -> Cluster {
    let mut cluster = layout.cluster(ClusterId(id as u32));
    for end in &mut cluster.ends {
        if let EndKind::Cut { cut, .. } = &mut end.kind {
            *cut = CutId(0);
        }
    }
    cluster
}

#[test]
fn layouts_with_other_overruns_or_skeletons_have_nothing_in_common() {
    let network = Arc::new(h_shape(30.0));
    let with = |skeleton: &Arc<Skeleton>, overrun| {
        lay_out(skeleton, &PartitionParams { overrun, ..PartitionParams::default() }, &()).expect("a layout")
    };
    let usual = with(&network, 1.0);
    let count = |other: &Layout| {
        let same = usual.same_as(other);
        [same.clusters.iter().flatten().count(), same.cuts.iter().flatten().count()]
    };
    assert_eq!(count(&with(&network, 1.0)), [2, 1]);
    assert_eq!(count(&with(&network, 1.5)), [0, 0]);
    assert_eq!(count(&with(&Arc::new(h_shape(30.0)), 1.0)), [0, 0]);
}

#[test]
fn clusters_without_a_node_are_found_after_those_of_other_vessels_are_gone() {
    // Two vessels with several connectors each, and clusters between them.
    let ends = [[0.0; 3], [1000.0, 0.0, 0.0], [0.0, 50.0, 0.0], [1000.0, 50.0, 0.0]];
    let network = Arc::new(skeleton(&ends.map(|p| (p, 1.0)), &[[0, 1], [2, 3]]));
    let uncut = |branches: &[u32]| {
        let forbidden_cuts = branches.iter().map(|&branch| BranchId(branch)).collect();
        lay_out(&network, &PartitionParams { forbidden_cuts, ..PartitionParams::default() }, &()).expect("a layout")
    };
    let (both, second) = (uncut(&[]), uncut(&[0]));
    assert!(second.cuts_len() > 3 && both.cuts_len() == 2 * second.cuts_len());
    // Both vessels have the same number of clusters. Without cuts, the first is one cluster.
    let count = |same: &[Option<ClusterId>]| same.iter().flatten().count();
    let of_vessel = both.clusters_len() / 2;
    assert_eq!(count(&second.same_as(&both).clusters), of_vessel);
    assert_eq!(count(&both.same_as(&second).clusters), of_vessel);
    assert_eq!(count(&both.same_as(&both).clusters), 2 * of_vessel);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    /// Clusters and cuts are the same if all that their blocks are made of is equal, and only then.
    #[test]
    fn unchanged_clusters_and_cuts_are_found(
        network in any_network(), shift in -1.0..1.0_f64, moved in any::<u8>(), uncut in any::<u8>(),
    ) {
        prop_assume!(network.edge_ids().all(|e| network.length(e) > 1e-6));
        let network = Arc::new(network);
        let before = lay_out(&network, &PartitionParams::default(), &()).expect("a layout");
        let params = PartitionParams {
            shifted_cuts: [(BranchId(u32::from(moved % 16)), shift)].into(),
            forbidden_cuts: [BranchId(u32::from(uncut % 32))].into(),
            cut_terminals: uncut > 250,
            ..PartitionParams::default()
        };
        let after = lay_out(&network, &params, &()).expect("a layout");
        let same = after.same_as(&before);
        let old: Vec<Cluster> = (0..before.clusters_len()).map(|j| without_numbers(&before, j)).collect();
        for (i, found) in same.clusters.iter().enumerate() {
            let equal = old.iter().position(|cluster| *cluster == without_numbers(&after, i));
            prop_assert_eq!(found.map(|id| id.0 as usize), equal);
        }
        let of = |layout: &Layout, cut: u32| {
            let Cut { branch, path, size, .. } = layout.cut(CutId(cut));
            (branch, path, size)
        };
        for (i, found) in (0..).zip(&same.cuts) {
            let equal = (0..before.cuts_len() as u32).find(|&j| of(&before, j) == of(&after, i));
            prop_assert_eq!(found.map(|id| id.0), equal);
        }
    }
}

//! Whole blocks: clusters from tubes, connectors between their end surfaces, dumps.

use super::fixtures::direction;
use super::woven::trim_tests::assert_mesh;
use super::{
    BlockDump, BlockError, BlockParams, ClusterMesh, ConnectorEnd, EndStyle, Finished, StoredEnd, mesh_cluster,
    mesh_connector, mesh_free_connector,
};
use crate::geometry::{Point3, Section, Tube, Vec3};
use crate::mesh::TetMesh;
use crate::mesh::quality::radius_ratio;
use crate::partition::{
    Cluster, ClusterEnd, ClusterId, Cut, CutId, EndKind, PartitionParams, PartitionWarning, partition,
};
use crate::skeleton::{BranchId, Edge, Node, NodeId, Skeleton};
use crate::surface::SharedDisc;
use crate::tet::Watch;

/// A star of vessels from a node: one per direction, ending in a cut or a terminal at 4 radii.
fn star(center: Point3, arms: &[(Vec3, f64, EndKind)]) -> Cluster {
    let mut cluster = Cluster { nodes: vec![NodeId(0)], tubes: Vec::new(), ends: Vec::new() };
    for &(axis, radius, kind) in arms {
        let origin = center + axis * 4.0;
        cluster.tubes.push(Tube { a: center, b: origin, ra: radius, rb: radius });
        cluster.tubes.push(Tube { a: origin, b: origin + axis * (1.7 * radius), ra: radius, rb: radius });
        let overrun = cluster.tubes.len() as u32 - 1;
        cluster.ends.push(ClusterEnd { section: Section { origin, axis, radius }, kind, overrun });
    }
    cluster
}

fn cut(cut: u32, side: u8) -> EndKind {
    EndKind::Cut { cut: CutId(cut), side }
}

/// A bifurcation turned by `seed`; end 0 is side 0 of cut 0.
fn bifurcation(seed: u64) -> Cluster {
    let turn = nalgebra::Rotation3::new(direction(seed) * 2.0);
    let arm = |x: f64, z: f64| turn * Vec3::new(x, 0.1, z).normalize();
    star(
        Point3::origin(),
        &[
            (arm(0.0, 1.0), 1.0, cut(0, 0)),
            (arm(0.8, -0.7), 0.8, EndKind::Terminal(NodeId(1))),
            (arm(-0.8, -0.6), 0.7, cut(1, 0)),
        ],
    )
}

fn worst_ratio(mesh: &TetMesh) -> f64 {
    mesh.tets
        .iter()
        .map(|t| {
            let p = t.map(|v| mesh.points[v as usize]);
            radius_ratio(&p[0], &p[1], &p[2], &p[3])
        })
        .fold(1.0, f64::min)
}

fn meshed(seed: u64, params: &BlockParams) -> (Cluster, ClusterMesh) {
    let cluster = bifurcation(seed);
    let mesh = mesh_cluster(ClusterId(0), &cluster, params).expect("cluster");
    assert_mesh(&mesh.mesh, 2);
    assert_eq!((mesh.ends.len(), mesh.caps.len()), (2, 1));
    for end in &mesh.ends {
        assert_eq!(end.check(&mesh.mesh.points), Ok(()));
    }
    for v in mesh.caps[0].triangles.iter().flatten() {
        assert!(mesh.caps[0].section.height(&mesh.mesh.points[*v as usize]).abs() < 1e-9);
    }
    (cluster, mesh)
}

#[test]
fn bifurcations_are_meshed_and_joined() {
    for seed in 0..6 {
        let style = if seed % 3 == 2 { EndStyle::Disc } else { EndStyle::Trimmed };
        let params = BlockParams { ends: style, ..BlockParams::with_rho(3.0 + (seed % 2) as f64) };
        let (cluster, lower) = meshed(seed, &params);
        // A second cluster opposite to the first one's cut 0, three radii away.
        let first = cluster.ends[0].section;
        let center = first.origin + first.axis * 7.0;
        let facing = star(center, &[(-first.axis, 1.0, cut(0, 1)), (first.axis, 1.0, EndKind::Terminal(NodeId(3)))]);
        let upper = mesh_cluster(ClusterId(1), &facing, &params).expect("facing cluster");
        let path = vec![first, Section { origin: facing.ends[0].section.origin, ..first }];
        let gap = Cut { branch: BranchId(0), sides: [(ClusterId(0), 0), (ClusterId(1), 0)], path };
        let ends = [
            ConnectorEnd { surface: &lower.ends[0], points: &lower.mesh.points },
            ConnectorEnd { surface: &upper.ends[0], points: &upper.mesh.points },
        ];
        let connector = mesh_connector(CutId(0), &gap, ends, &params).expect("connector");
        assert_mesh(&connector.mesh, 2);
        assert!(connector.failed.is_empty());
        for (p, v) in connector.mesh.points.iter().zip(&connector.shared) {
            assert_eq!(*p, ends[v.side as usize].points[v.vertex as usize]);
        }
        assert!(worst_ratio(&connector.mesh) > 0.03, "{}", worst_ratio(&connector.mesh));

        let dump = BlockDump::of_connector(CutId(0), &gap, ends.map(alone), params, vec![1, 2]);
        let again = BlockDump::from_json(dump.to_json().expect("json").as_bytes()).expect("dump");
        assert_eq!(again, dump);
        let copy = again.run(&Watch::NOBODY).expect("connector runs again");
        assert_eq!(copy.mesh, connector.mesh);
    }
}

/// An end over its own points.
fn alone(end: ConnectorEnd) -> StoredEnd {
    let vertices = end.surface.vertices();
    let local = |v: u32| vertices.partition_point(|&x| x < v) as u32;
    let mut surface = end.surface.clone();
    surface.triangles.as_flattened_mut().iter_mut().chain(&mut surface.rim).for_each(|v| *v = local(*v));
    StoredEnd { surface, points: vertices.iter().map(|&v| end.points[v as usize]).collect() }
}

/// The points of a cluster's end, in the order of the shared disc.
fn end_points(mesh: &ClusterMesh, end: usize) -> Vec<Point3> {
    mesh.ends[end].vertices().iter().map(|&v| mesh.mesh.points[v as usize]).collect()
}

#[test]
fn blocks_that_end_in_shared_discs_need_not_know_each_other() {
    for seed in 0..4 {
        let rho = 3.0 + (seed % 3) as f64;
        let params = BlockParams { ends: EndStyle::Shared, ..BlockParams::with_rho(rho) };
        let (cluster, lower) = meshed(seed, &params);
        let first = cluster.ends[0].section;
        let center = first.origin + first.axis * 7.0;
        let facing = star(center, &[(-first.axis, 1.0, cut(0, 1)), (first.axis, 1.0, EndKind::Terminal(NodeId(3)))]);
        // However the neighbour was made, its disc is the same.
        let finer = BlockParams { voxel_factor: 0.75, shift: [0.3, -0.2, 0.1], follow: 0.5, ..params };
        let upper = [params, finer].map(|p| mesh_cluster(ClusterId(1), &facing, &p).expect("facing cluster"));
        assert_eq!(end_points(&upper[0], 0), end_points(&upper[1], 0));
        let path = vec![first, Section { origin: facing.ends[0].section.origin, ..first }];
        let gap = Cut { branch: BranchId(0), sides: [(ClusterId(0), 0), (ClusterId(1), 0)], path };
        let connector = mesh_free_connector(CutId(0), &gap, &params).expect("connector");
        assert_mesh(&connector.mesh, 2);
        let sides = [end_points(&lower, 0), end_points(&upper[1], 0)];
        assert_eq!(connector.shared.len(), sides[0].len() + sides[1].len());
        for (p, v) in connector.mesh.points.iter().zip(&connector.shared) {
            assert_eq!(*p, sides[v.side as usize][v.vertex as usize]);
        }
        assert!(worst_ratio(&connector.mesh) > 0.3, "{}", worst_ratio(&connector.mesh));

        let dump = BlockDump::of_free_connector(CutId(0), &gap, params, Vec::new());
        let copy = dump.run(&Watch::NOBODY).expect("connector runs again");
        assert_eq!(copy.mesh, connector.mesh);
    }
}

#[test]
fn a_shared_disc_is_the_same_from_both_sides() {
    for seed in 0..20 {
        let along = Section { origin: Point3::new(0.3, 1e3, -7.0), axis: direction(seed), radius: 0.7 + seed as f64 };
        let ahead = SharedDisc::at_end(&along, 0, 3.0).expect("disc");
        let behind = SharedDisc::at_end(&Section { axis: -along.axis, ..along }, 1, 3.0).expect("disc");
        assert_eq!(ahead.points, behind.points);
        assert_eq!(ahead, behind.turned());
        let surface = super::EndSurface::of_disc(&ahead, CutId(0), 0, along);
        assert_eq!(surface.check(&ahead.points), Ok(()));
    }
}

#[test]
fn ends_beside_each_other_leave_a_wall_between() {
    // Two vessels that leave a node at an angle so small that the crotch lies just below their planes.
    for (height, seed) in [(1.60, 0), (1.69, 1), (1.75, 2), (1.80, 3), (1.69, 4)] {
        let turn = nalgebra::Rotation3::new(direction(seed) * 2.0);
        let mut cluster = Cluster { nodes: vec![NodeId(0)], tubes: Vec::new(), ends: Vec::new() };
        let arms = [(0.0, 2.92), (2.38, height), (-1.94, -1.04)];
        for (i, (x, z)) in arms.into_iter().enumerate() {
            let origin = turn * Point3::new(x, 0.0, z);
            let axis = origin.coords.normalize();
            cluster.tubes.push(Tube { a: Point3::origin(), b: origin, ra: 1.0, rb: 1.0 });
            cluster.tubes.push(Tube { a: origin, b: origin + axis, ra: 1.0, rb: 1.0 });
            let overrun = cluster.tubes.len() as u32 - 1;
            let kind = cut(i as u32, (i % 2) as u8);
            cluster.ends.push(ClusterEnd { section: Section { origin, axis, radius: 1.0 }, kind, overrun });
        }
        for ends in [EndStyle::Disc, EndStyle::Shared] {
            let params = BlockParams { ends, ..BlockParams::default() };
            let mesh = mesh_cluster(ClusterId(0), &cluster, &params).expect("cluster");
            assert_mesh(&mesh.mesh, 2);
        }
    }
}

#[test]
fn ends_that_take_each_others_wall_take_less() {
    // Two planes so close to each other that taking off the tip at one leaves nothing of the wall before the other.
    let arms = [([-1.634, -0.86, -2.417], 0.899), ([-0.229, 1.085, -3.082], 0.933), ([0.083, -2.087, 0.69], 1.0)];
    for seed in 0..24 {
        let turn = nalgebra::Rotation3::new(direction(seed) * 2.0);
        let mut cluster = Cluster { nodes: vec![NodeId(0)], tubes: Vec::new(), ends: Vec::new() };
        for (i, (place, radius)) in arms.into_iter().enumerate() {
            let origin = turn * Point3::from(place);
            let axis = origin.coords.normalize();
            cluster.tubes.push(Tube { a: origin, b: Point3::origin(), ra: radius, rb: 1.0 });
            cluster.tubes.push(Tube { a: origin, b: origin + axis, ra: radius, rb: radius });
            let overrun = cluster.tubes.len() as u32 - 1;
            cluster.ends.push(ClusterEnd {
                section: Section { origin, axis, radius },
                kind: cut(i as u32, 0),
                overrun,
            });
        }
        let params = BlockParams { ends: EndStyle::Shared, ..BlockParams::default() };
        let mesh = mesh_cluster(ClusterId(0), &cluster, &params).expect("cluster");
        assert_mesh(&mesh.mesh, 2);
    }
}

#[test]
fn a_terminal_that_looks_at_a_thick_vessel_stays_apart_from_it() {
    // Its tip is 1.25 sums of the radii off the axis; with the usual overrun the two walls would touch.
    let points =
        [[0.0, 0.0, 0.0], [-20.0, 0.0, 0.0], [20.0, 0.0, 0.0], [0.0, 14.0, 0.0], [9.0, 14.0, 0.0], [9.0, 5.0, 0.0]];
    let edges = [(0, 1, 3.0), (0, 2, 3.0), (0, 3, 1.0), (3, 4, 1.0), (4, 5, 1.0)];
    let node = |(i, &p): (u32, &[f64; 3])| Node { position: p.into(), radius: 1.0, original: i };
    let skeleton = Skeleton {
        nodes: (0..).zip(&points).map(node).collect(),
        edges: edges.iter().map(|&(a, b, r)| Edge { nodes: [NodeId(a), NodeId(b)], radii: [r; 2] }).collect(),
    };
    let params = PartitionParams { forbidden_cuts: (0..3).map(BranchId).collect(), ..PartitionParams::default() };
    let partition = partition(&skeleton, &params).expect("a partition");
    let [PartitionWarning::ShortOverrun { node: NodeId(5), radii, .. }] = partition.warnings[..] else {
        panic!("{:?}", partition.warnings)
    };
    assert!((0.4..0.8).contains(&radii), "{radii}");
    let mesh = mesh_cluster(ClusterId(0), &partition.clusters[0], &BlockParams::default()).expect("a cluster");
    assert_eq!((mesh.handles, mesh.caps.len()), (0, 3));
    assert_mesh(&mesh.mesh, 2);
}

#[test]
fn a_dumped_cluster_runs_again_to_the_same_bits() {
    let params = BlockParams { shift: [0.1, 0.2, 0.3], ..BlockParams::default() };
    let (cluster, mesh) = meshed(11, &params);
    let dump = BlockDump::of_cluster(ClusterId(0), &cluster, params, Vec::new(), |node| node.0);
    let again = BlockDump::from_json(dump.to_json().expect("json").as_bytes()).expect("dump");
    assert_eq!(again, dump);
    let copy = again.run(&Watch::NOBODY).expect("cluster runs again");
    assert_eq!(copy, Finished::of_cluster(mesh, |node| node.0).expect("closed"));
}

#[test]
fn fused_neighbours_are_told_by_the_genus() {
    // A branch that curls back and ends in its own flank.
    let center = Point3::origin();
    let mut cluster = star(center, &[(Vec3::z(), 1.0, cut(0, 0)), (-Vec3::z(), 1.0, EndKind::Terminal(NodeId(1)))]);
    let p = |x: f64, z: f64| Point3::new(x, 0.0, z);
    let side = [p(0.0, 0.0), p(-8.0, 0.0), p(-8.0, -4.5), p(-4.5, -4.5), p(-4.5, -1.6)];
    for pair in side.windows(2) {
        cluster.tubes.push(Tube { a: pair[0], b: pair[1], ra: 1.0, rb: 1.0 });
    }
    let result = mesh_cluster(ClusterId(4), &cluster, &BlockParams::default());
    let expected = BlockError::Genus { cluster: ClusterId(4), handles: 1, loops: 0 };
    assert_eq!(result.err(), Some(expected));
    let params = BlockParams { allow_fused: true, ..BlockParams::default() };
    let fused = mesh_cluster(ClusterId(4), &cluster, &params).expect("fused");
    assert_eq!((fused.handles, fused.loops), (1, 0));
    assert_mesh(&fused.mesh, 0);
}

#[test]
fn parameters_out_of_range_are_told() {
    let params = BlockParams { rho: f64::NAN, ..BlockParams::default() };
    let result = mesh_cluster(ClusterId(0), &bifurcation(0), &params);
    assert!(matches!(result, Err(BlockError::Parameter { name: "rho", .. })));
}

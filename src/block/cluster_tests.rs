//! Tests of whole blocks: clusters from tubes, and connectors between their end surfaces.

use super::fixtures::{assert_mesh, bifurcation, cut, direction, facing, star, worst_ratio};
use super::{BlockError, BlockParams, ClusterMesh, EndStyle, mesh_cluster, mesh_free_connector};
use crate::partition::{Cluster, ClusterEnd, ClusterId, CutId, EndKind, PartitionParams, PartitionWarning, partition};
use crate::surface::SharedDisc;
use anastomesh_mesh::adjacency::boundary_faces;
use anastomesh_mesh::face_key;
use anastomesh_mesh::geometry::{Point3, Section, Tube, Vec3};
use anastomesh_skeleton::{BranchId, Edge, FinePlace, Node, NodeId, Skeleton};
use rustc_hash::FxHashSet;

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

/// Points of a cluster's end, in the order of the shared disc.
fn end_points(mesh: &ClusterMesh, end: usize) -> Vec<Point3> {
    mesh.ends[end].vertices().iter().map(|&v| mesh.mesh.points[v as usize]).collect()
}

#[test]
fn blocks_that_end_in_shared_discs_need_not_know_each_other() {
    for seed in 0..4 {
        let rho = 3.0 + (seed % 3) as f64;
        let params = BlockParams { ends: EndStyle::Shared, ..BlockParams::with_rho(rho) };
        let (cluster, lower) = meshed(seed, &params);
        let (facing, gap) = facing(&cluster);
        // The neighbour's parameters do not change its disc.
        let finer = BlockParams { voxel_factor: 0.75, shift: [0.3, -0.2, 0.1], follow: 0.5, ..params };
        let upper = [params, finer].map(|p| mesh_cluster(ClusterId(1), &facing, &p).expect("facing cluster"));
        assert_eq!(end_points(&upper[0], 0), end_points(&upper[1], 0));
        let connector = mesh_free_connector(CutId(0), &gap, &params).expect("connector");
        assert_mesh(&connector.mesh, 2);
        let sides = [end_points(&lower, 0), end_points(&upper[1], 0)];
        assert_eq!(connector.shared.len(), sides[0].len() + sides[1].len());
        for (p, v) in connector.mesh.points.iter().zip(&connector.shared) {
            assert_eq!(*p, sides[v.side as usize][v.vertex as usize]);
        }
        assert!(worst_ratio(&connector.mesh) > 0.3, "{}", worst_ratio(&connector.mesh));
    }
}

fn volume(mesh: &anastomesh_mesh::TetMesh) -> f64 {
    let of = |t: &[u32; 4]| {
        let [a, b, c, d] = t.map(|v| mesh.points[v as usize]);
        (b - a).cross(&(c - a)).dot(&(d - a)).abs() / 6.0
    };
    mesh.tets.iter().map(of).sum()
}

/// Bifurcation with edges so short that its volume is accurate.
fn true_wall(seed: u64) -> ClusterMesh {
    let params = BlockParams { ends: EndStyle::Shared, ..BlockParams::with_rho(10.0) };
    mesh_cluster(ClusterId(0), &bifurcation(seed), &params).expect("a cluster")
}

#[test]
fn a_finer_fork_owes_its_neighbours_the_same_discs() {
    for (seed, factor) in [(0, 0.5), (1, 0.25), (2, 0.7)] {
        let whole = volume(&true_wall(seed).mesh);
        for layers in [None, Some(anastomesh_tet::Layers::default())] {
            let params = BlockParams { ends: EndStyle::Shared, layers, ..BlockParams::default() };
            let plain = bifurcation(seed);
            let fork = FinePlace { at: Point3::origin(), within: 1.2, factor };
            let finer = Cluster { fine: vec![fork], ..plain.clone() };
            let [plain, finer] = [plain, finer].map(|cluster| {
                let made = mesh_cluster(ClusterId(0), &cluster, &params).expect("a cluster");
                assert_mesh(&made.mesh, 2);
                made
            });
            for end in 0..2 {
                assert_eq!(end_points(&plain, end), end_points(&finer, end));
            }
            // At least as close to the accurate wall.
            let off = |made: &ClusterMesh| (volume(&made.mesh) / whole - 1.0).abs();
            assert!(off(&finer) < off(&plain) + 5e-4, "{factor}: {} and {}", off(&finer), off(&plain));
            // Edges are shorter within about a third of its vessels.
            assert!(finer.mesh.tets.len() as f64 > plain.mesh.tets.len() as f64 * (1.0 + 0.1 / factor));
            assert!(layers.is_some() || worst_ratio(&finer.mesh) > 0.15, "{}", worst_ratio(&finer.mesh));
        }
    }
}

#[test]
fn no_tetrahedron_has_two_faces_on_the_boundary() {
    for seed in 0..4 {
        let (_, made) = meshed(seed, &BlockParams::with_rho(3.0 + (seed % 3) as f64));
        let joints: FxHashSet<[u32; 3]> =
            made.ends.iter().flat_map(|end| &end.triangles).copied().map(face_key).collect();
        let boundary = boundary_faces(&made.mesh).into_iter().map(face_key).filter(|face| !joints.contains(face));
        let boundary: FxHashSet<[u32; 3]> = boundary.collect();
        for tet in &made.mesh.tets {
            let faces = [0, 1, 2, 3].map(|k| face_key([1, 2, 3].map(|j| tet[(k + j) % 4])));
            assert!(faces.iter().filter(|face| boundary.contains(*face)).count() < 2, "{tet:?}");
        }
        assert!(worst_ratio(&made.mesh) > 0.15, "{}", worst_ratio(&made.mesh));
    }
}

#[test]
fn a_shared_disc_is_the_same_from_both_sides() {
    for seed in 0..20 {
        let along = Section::new(Point3::new(0.3, 1e3, -7.0), direction(seed), 0.7 + seed as f64);
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
    // Two vessels leave a node at a narrow angle, so that the crotch lies just below their planes.
    for (height, seed) in [(1.60, 0), (1.69, 1), (1.75, 2), (1.80, 3), (1.69, 4)] {
        let turn = nalgebra::Rotation3::new(direction(seed) * 2.0);
        let mut cluster = Cluster { nodes: vec![NodeId(0)], ..Cluster::default() };
        let arms = [(0.0, 2.92), (2.38, height), (-1.94, -1.04)];
        for (i, (x, z)) in arms.into_iter().enumerate() {
            let origin = turn * Point3::new(x, 0.0, z);
            let axis = origin.coords.normalize();
            cluster.tubes.push(Tube { a: Point3::origin(), b: origin, ra: 1.0, rb: 1.0 });
            cluster.tubes.push(Tube { a: origin, b: origin + axis, ra: 1.0, rb: 1.0 });
            let overrun = cluster.tubes.len() as u32 - 1;
            let kind = cut(i as u32, (i % 2) as u8);
            cluster.ends.push(ClusterEnd { section: Section::new(origin, axis, 1.0), kind, overrun });
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
    // Two planes so close that removing one tip leaves no wall before the other.
    let arms = [([-1.634, -0.86, -2.417], 0.899), ([-0.229, 1.085, -3.082], 0.933), ([0.083, -2.087, 0.69], 1.0)];
    for seed in 0..24 {
        let turn = nalgebra::Rotation3::new(direction(seed) * 2.0);
        let mut cluster = Cluster { nodes: vec![NodeId(0)], ..Cluster::default() };
        for (i, (place, radius)) in arms.into_iter().enumerate() {
            let origin = turn * Point3::from(place);
            let axis = origin.coords.normalize();
            cluster.tubes.push(Tube { a: origin, b: Point3::origin(), ra: radius, rb: 1.0 });
            cluster.tubes.push(Tube { a: origin, b: origin + axis, ra: radius, rb: radius });
            let overrun = cluster.tubes.len() as u32 - 1;
            cluster.ends.push(ClusterEnd {
                section: Section::new(origin, axis, radius),
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
    // The tip is 1.25 sums of radii off the axis; with the default overrun the walls would touch.
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
fn fused_neighbours_are_told_by_the_genus() {
    // A branch that curls back and ends in its own side.
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

//! The way through all stages, and what happens when a block fails.

use super::effort::Effort;
use super::routes::Tangle;
use super::*;
use crate::block::{Encoded, Finished, Record};
use crate::partition::{Cluster, ClusterId, CutId, PartitionParams, partition};
use anastomesh_mesh::WALL;
use anastomesh_mesh::adjacency::tet_adjacency;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::progress::{Progress, Stage, StopsAfter};
use anastomesh_mesh::source::{MeshSource, gather};
use anastomesh_network::dual;
use anastomesh_network::{Figures, Freedom, RefineError, RefineParams, refine};
use anastomesh_skeleton::fixtures::tangle;
use anastomesh_skeleton::{Edge, Node, NodeId, Skeleton};
use anastomesh_tet::Layers;
use std::sync::atomic::{AtomicUsize, Ordering};
use store::Store;

/// A skeleton of nodes `[x, y, z, radius]` and edges between them.
pub(super) fn skeleton(nodes: &[[f64; 4]], edges: &[[u32; 2]]) -> Skeleton {
    let node =
        |(i, n): (usize, &[f64; 4])| Node { position: Point3::new(n[0], n[1], n[2]), radius: n[3], original: i as u32 };
    let edge = |e: &[u32; 2]| Edge { nodes: e.map(NodeId), radii: e.map(|n| nodes[n as usize][3]) };
    Skeleton { nodes: nodes.iter().enumerate().map(node).collect(), edges: edges.iter().map(edge).collect() }
}

fn run(network: &Skeleton, plan: &MeshPlan) -> Result<Meshed, RunError> {
    mesh_network(network, plan, &())
}

/// Two junctions with room for a cut between them.
fn h(middle: f64) -> Skeleton {
    let nodes = [
        [0.0, 0.0, 0.0, 1.0],
        [middle, 0.0, 0.0, 1.0],
        [-5.0, 6.0, 0.0, 0.9],
        [-5.0, -6.0, 0.0, 0.9],
        [middle + 5.0, 0.0, 6.0, 0.9],
        [middle + 5.0, 0.0, -6.0, 0.9],
    ];
    skeleton(&nodes, &[[0, 1], [0, 2], [0, 3], [1, 4], [1, 5]])
}

#[test]
fn two_clusters_and_a_connector_make_one_valid_mesh() {
    let meshed = run(&h(12.0), &MeshPlan::default()).expect("meshed");
    // Two forks, four ends of vessels.
    assert_eq!((meshed.report.blocks.clusters, meshed.report.blocks.connectors), (6, 5));
    assert!(meshed.check.is_valid(), "{:?}", meshed.check.failed().collect::<Vec<_>>());
    assert!(meshed.report.retries.is_empty() && meshed.report.failed.is_empty());
    let blocks: std::collections::BTreeSet<i32> = meshed.mesh.tet_block.iter().copied().collect();
    assert_eq!(blocks.into_iter().collect::<Vec<_>>(), (0..11).collect::<Vec<_>>());
    let names: Vec<&str> = meshed.mesh.patches.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["wall", "inlet", "outlet_0", "outlet_1", "outlet_2"]);
    assert!(meshed.mesh.boundary_patch.contains(&WALL));
}

#[test]
fn the_threads_do_not_show_in_the_mesh() {
    let mesh = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| run(&h(12.0), &MeshPlan::default())).expect("meshed").mesh
    };
    let one = mesh(1);
    assert_eq!(one, mesh(2));
    assert_eq!(one, mesh(7));
}

#[test]
fn layers_go_through_forks_tubes_joints_and_caps() {
    let plain = run(&h(12.0), &MeshPlan::default()).expect("meshed");
    for layers in [Layers::default(), Layers::default().count(5).growth(1.0).thickness(0.5)] {
        let plan = MeshPlan { layers: Some(layers), ..MeshPlan::default() };
        let meshed = run(&h(12.0), &plan).expect("meshed");
        assert!(meshed.check.is_valid(), "{:?}", meshed.check.failed().collect::<Vec<_>>());
        assert!(meshed.report.retries.is_empty() && meshed.report.failed.is_empty(), "{:?}", meshed.report.retries);
        assert!(meshed.report.thin_layers.is_empty(), "{:?}", meshed.report.thin_layers);
        // The wall is the same; caps have rings in addition.
        let rings = 2 * layers.count as usize * (plain.mesh.patches.len() - 1);
        let more = meshed.report.mesh.cap_triangles - plain.report.mesh.cap_triangles;
        assert_eq!(meshed.report.mesh.wall_triangles, plain.report.mesh.wall_triangles);
        assert!(more >= 8 * rings && more.is_multiple_of(2 * layers.count as usize), "{more}");
        let prisms = 3 * layers.count as usize * plain.report.mesh.wall_triangles;
        assert!(meshed.report.mesh.tets > prisms);
    }
}

#[test]
fn layers_need_discs() {
    for plan in
        [MeshPlan { joint: JointStyle::Woven, ..MeshPlan::default() }, MeshPlan { hollow: true, ..MeshPlan::default() }]
    {
        let plan = MeshPlan { layers: Some(Layers::default()), ..plan };
        assert!(matches!(run(&h(12.0), &plan), Err(RunError::Plan(_))));
    }
}

#[test]
fn tetrahedra_grow_towards_axes_as_asked() {
    let of = |core| {
        let meshed = run(&h(12.0), &MeshPlan { core, rho: 6.0, ..MeshPlan::default() }).expect("meshed");
        assert!(meshed.check.is_valid());
        meshed.report.mesh.tets
    };
    let [fine, plain, coarse] = [0.7, 1.0, 2.0].map(of);
    assert!(fine * 5 > plain * 6 && coarse * 6 < plain * 5, "{fine} {plain} {coarse}");
}

/// Two junctions, thin vessels at one side only: where edges do not follow radii, the clusters' walls are of different
/// fineness.
pub(super) fn uneven() -> Skeleton {
    let mut network = h(16.0);
    for edge in &mut network.edges[3..] {
        edge.radii = [0.5; 2];
    }
    network
}

#[test]
fn every_kind_of_joint_makes_one_valid_mesh() {
    let plans = [(JointStyle::Disc, 1.0), (JointStyle::Disc, 0.0), (JointStyle::Woven, 1.0), (JointStyle::None, 1.0)];
    let plans = plans.into_iter().filter(|(joint, _)| *joint != JointStyle::Woven || cfg!(feature = "woven"));
    for (joint, follow) in plans {
        for frozen_joints in [false, true] {
            let plan = MeshPlan { follow, joint, frozen_joints, ..MeshPlan::default() };
            let mesh = |threads: usize| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
                pool.install(|| run(&uneven(), &plan)).expect("meshed")
            };
            let meshed = mesh(2);
            let blocks = match joint {
                JointStyle::Disc => (6, 5),
                JointStyle::Woven => (2, 1),
                JointStyle::None => (1, 0),
            };
            assert_eq!((meshed.report.blocks.clusters, meshed.report.blocks.connectors), blocks);
            assert!(meshed.check.is_valid(), "{:?}", meshed.check.failed().collect::<Vec<_>>());
            assert!(meshed.report.retries.is_empty() && meshed.report.failed.is_empty(), "{:?}", meshed.report.retries);
            #[cfg(feature = "woven")]
            assert_eq!(meshed.report.joints.is_some(), plan.smooths_joints());
            assert_eq!(meshed.mesh, mesh(1).mesh);
        }
    }
}

/// Blocks, finished, with their sizes in the whole.
fn finished(network: &Skeleton, plan: &MeshPlan) -> Vec<Finished> {
    let params = PartitionParams { rho: plan.rho, ..PartitionParams::default() };
    let partition = partition(network, &params).expect("partitioned");
    let cluster = |(i, cluster): (usize, &Cluster)| {
        attempts::cluster(
            ClusterId(i as u32),
            cluster,
            (plan, Effort::full(1)),
            (Tangle::Free, attempts::RetryStrategy::Usual),
            |node| node.0,
            &anastomesh_tet::parts::Watch::NOBODY,
        )
        .result
        .expect("meshed")
    };
    let mut blocks: Vec<Finished> = partition.clusters.iter().enumerate().map(cluster).collect();
    for (i, cut) in partition.cuts.iter().enumerate() {
        let id = CutId(i as u32);
        blocks.push(attempts::free_connector(id, cut, plan).result.expect("meshed"));
    }
    blocks
}

#[test]
fn hollow_blocks_have_the_boundary_of_filled_ones() {
    let corners = |meshed: &Meshed| {
        let bits = |v: u32| <[f64; 3]>::from(meshed.mesh.mesh.points[v as usize].coords).map(f64::to_bits);
        let faces = meshed.mesh.boundary.iter().zip(&meshed.mesh.boundary_patch);
        let mut corners: Vec<_> = faces
            .map(|(face, patch)| {
                let mut places = face.map(bits);
                let first = places.iter().enumerate().min_by_key(|(_, place)| **place).map_or(0, |(i, _)| i);
                places.rotate_left(first);
                (places, *patch)
            })
            .collect();
        corners.sort_unstable();
        corners
    };
    for network in [h(12.0), uneven()] {
        let filled = run(&network, &MeshPlan::default()).expect("meshed");
        let hollow = run(&network, &MeshPlan { hollow: true, ..MeshPlan::default() }).expect("made");
        assert!(hollow.mesh.mesh.tets.is_empty());
        assert!(hollow.check.is_valid(), "{:?}", hollow.check.failed().collect::<Vec<_>>());
        assert_eq!(corners(&hollow), corners(&filled));
        assert_eq!(hollow.mesh.patches, filled.mesh.patches);
        let volumes = [&hollow, &filled].map(|meshed| meshed.check.counts.volume);
        assert!((volumes[0] / volumes[1] - 1.0).abs() < 1e-9, "{volumes:?}");
    }
}

#[test]
fn finished_blocks_come_back_from_their_bytes() {
    let blocks = finished(&uneven(), &MeshPlan::default());
    for block in &blocks {
        let Encoded { connectivity, hash, geometry } = Encoded::of(block).expect("encoded");
        let record = Record::open(&connectivity[..], &geometry[..]).expect("a record");
        assert_eq!(record.geometry.connectivity(), hash);
        assert_eq!(record.block().expect("decoded"), *block);
        // Every boundary face has one place.
        let mut faces = block.wall.clone();
        faces.extend(block.joints.iter().flat_map(|joint| &joint.faces));
        faces.extend(block.caps.iter().flat_map(|cap| &cap.faces));
        faces.sort_unstable();
        let boundary = tet_adjacency(&block.mesh.tets, block.mesh.points.len());
        assert_eq!(faces, boundary.boundary().collect::<Vec<_>>());
        // Cut short anywhere it is an error, never a panic.
        for length in (0..geometry.len()).step_by(997) {
            assert!(Record::open(&connectivity[..], &geometry[..length]).and_then(|record| record.block()).is_err());
        }
        for length in (0..connectivity.len()).step_by(997) {
            assert!(Record::open(&connectivity[..length], &geometry[..]).and_then(|record| record.block()).is_err());
        }
    }
    let [left, _, connector] = &blocks[..] else { panic!("two clusters and a connector") };
    assert_eq!(connector.shared as usize, connector.joints.iter().map(|joint| joint.vertices.len()).sum::<usize>());
    let position =
        |block: &Finished, joint: usize, k: usize| block.mesh.points[block.joints[joint].vertices[k] as usize];
    for k in 0..left.joints[0].vertices.len() {
        assert_eq!(position(left, 0, k), position(connector, 0, k));
    }
}

#[test]
fn blocks_on_disk_make_the_same_mesh_and_are_found_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let plan = MeshPlan::default();
    let manifest = store::Manifest::new(&uneven(), serde_json::Value::Null);
    let in_memory = run(&uneven(), &plan).expect("meshed");
    for again in [false, true] {
        let store = store::Store::in_folder(folder.path(), &manifest, false).expect("a work directory");
        let stored = mesh_into(&store, &uneven(), &plan, &|_| Ok(()), &()).expect("meshed");
        assert_eq!(gather(&stored.mesh).expect("read"), in_memory.mesh);
        assert_eq!(stored.check, in_memory.check);
        assert_eq!(stored.report.mesh, in_memory.report.mesh);
        assert!(!again || stored.report.block_times.longest_seconds < 0.05, "found, not made");
    }
}

#[test]
fn what_does_not_fit_is_refused_before_anything_is_meshed() {
    let plan = MeshPlan { rho: 1000.0, ..MeshPlan::default() };
    let store = store::Store::in_memory();
    let fits = |estimate: &Estimate| {
        assert!(estimate.largest_block_tets > 1e9 && estimate.largest_block_tets < estimate.tets);
        Err(TooLarge::Block { estimate: *estimate, memory: 1 << 31 })
    };
    let refused = mesh_into(&store, &uneven(), &plan, &fits, &()).expect_err("too large");
    assert!(matches!(refused, RunError::TooLarge(_)), "{refused}");
}

#[test]
fn estimates_come_near_to_what_is_made() {
    for rho in [3.0, 4.0, 5.0] {
        let report = run(&uneven(), &MeshPlan { rho, ..MeshPlan::default() }).expect("meshed").report;
        let ratio = report.estimate.tets / report.mesh.tets as f64;
        assert!((0.6..1.6).contains(&ratio), "rho = {rho}: {ratio}");
    }
}

#[test]
fn vessels_that_overlap_are_meshed_and_named() {
    // The second terminal of the first junction lies inside the vessel between the junctions.
    let mut network = h(12.0);
    network.nodes[2].position = Point3::new(5.0, 0.8, 0.0);
    let meshed = run(&network, &MeshPlan::default()).expect("meshed");
    assert!(!meshed.report.overlaps.is_empty());
    assert!(meshed.report.failed.is_empty());
    assert!(!meshed.check.is_valid());
    let positive = meshed.check.line(anastomesh_mesh::check::Line::PositiveTets).expect("a line");
    assert_eq!(positive.outcome, anastomesh_mesh::check::Outcome::Pass);
}

/// A fork, and a thin straight vessel across it through its crotch, so far from the node.
pub(super) fn through_the_crotch(way: f64) -> Skeleton {
    let nodes = [
        [-12.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, 0.0, 1.0],
        [12.0, 3.0, 0.0, 0.9],
        [12.0, -3.0, 0.0, 0.9],
        [way, 0.0, -6.0, 0.1],
        [way, 0.0, 6.0, 0.1],
    ];
    skeleton(&nodes, &[[0, 1], [1, 2], [1, 3], [4, 5]])
}

#[test]
fn blocks_that_meet_are_made_again_unless_their_vessels_overlap() {
    let finer = ["finer voxel, narrower kernel", "much finer voxel, thin kernel"];
    // Vessels that overlap, where no other wall can help; vessels that do not, whose walls meet all the same; apart.
    // The vessel's connector meets the web: it is not cut, so that it can be made finer, too.
    let both = [finer[0], finer[0], finer[1], finer[1]];
    for (way, remedies, valid) in [(4.0, &both[..0], false), (4.5, &both[..], false), (5.0, &[], true)] {
        let meshed = run(&through_the_crotch(way), &MeshPlan::default()).expect("meshed");
        let tried: Vec<&str> = meshed.report.retries.iter().map(|retry| retry.remedy.as_str()).collect();
        assert!(meshed.report.retries.iter().all(|retry| retry.reason.starts_with("its wall meets that of cluster")));
        assert_eq!((&tried[..], meshed.check.is_valid()), (remedies, valid), "{way}");
        let hollow = run(&through_the_crotch(way), &MeshPlan { hollow: true, ..MeshPlan::default() }).expect("made");
        assert_eq!(hollow.report.retries, meshed.report.retries);
        assert_eq!(hollow.check.is_valid(), valid, "{way}");
    }
}

#[test]
fn vessels_that_overlap_become_one_lumen_on_request() {
    // Two vessels that cross become one piece; a terminal's vessel that crosses the trunk of its own tree makes a loop.
    let crossing = skeleton(
        &[[-9.0, 0.0, 0.0, 1.0], [9.0, 0.0, 0.0, 1.0], [0.0, -9.0, 0.8, 1.0], [0.0, 9.0, 0.8, 1.0]],
        &[[0, 1], [2, 3]],
    );
    let mut bent = h(40.0);
    bent.nodes.push(Node { position: Point3::new(20.0, 9.0, 0.0), radius: 0.9, original: 6 });
    bent.nodes.push(Node { position: Point3::new(20.0, -9.0, 0.5), radius: 0.9, original: 7 });
    bent.edges.push(Edge { nodes: [NodeId(2), NodeId(6)], radii: [0.9; 2] });
    bent.edges.push(Edge { nodes: [NodeId(6), NodeId(7)], radii: [0.9; 2] });
    for (network, loops) in [(crossing, 0), (bent, 1)] {
        let apart = run(&network, &MeshPlan::default()).expect("meshed");
        assert!(!apart.check.is_valid());
        let fused = run(&network, &MeshPlan { fuse: true, ..MeshPlan::default() }).expect("meshed");
        assert_eq!(fused.expectation.loops, [loops]);
        assert!(fused.check.is_valid(), "{:?}", fused.check.failed().collect::<Vec<_>>());
    }
}

/// A vessel so thin beside the other that coordinates have too few bits for both.
fn hair_on_a_trunk() -> Skeleton {
    let nodes = [[0.0, 0.0, 0.0, 1e3], [0.0, 0.0, 5e3, 1e3], [0.0, 3e3, 9e3, 8e2], [0.0, -1.000_000_01e3, 5e3, 1e-6]];
    skeleton(&nodes, &[[0, 1], [1, 2], [1, 3]])
}

#[test]
fn a_block_that_fails_is_named_and_dumped() {
    let folder = tempfile::tempdir().expect("a folder");
    let dumps = folder.path().join("failed");
    for keep_going in [false, true] {
        let plan = MeshPlan { keep_going, dump_dir: Some(dumps.clone()), ..MeshPlan::default() };
        let Err(RunError::BlocksFailed(report)) = run(&hair_on_a_trunk(), &plan) else { panic!("must fail") };
        let [failed] = &report.failed[..] else { panic!("one block") };
        assert_eq!(failed.nodes, [0, 1, 2, 3]);
        let dump = std::fs::read(failed.dump.as_ref().expect("a dump")).expect("readable");
        let again = crate::block::BlockDump::from_json(&dump).expect("a dump");
        assert_eq!((&again.nodes, again.name()), (&failed.nodes, failed.block.clone()));
        let again = super::once::replay(&again, &anastomesh_tet::parts::Watch::NOBODY);
        assert_eq!(again.expect_err("fails again").to_string(), failed.reason);
    }
}

#[test]
fn what_can_be_meshed_is_kept_on_request() {
    let mut network = hair_on_a_trunk();
    let base = network.nodes.len() as u32;
    let other = h(12.0);
    network.nodes.extend(other.nodes.iter().map(|n| Node {
        position: n.position + anastomesh_mesh::geometry::Vec3::new(1e5, 0.0, 0.0),
        original: n.original + base,
        ..*n
    }));
    network.edges.extend(other.edges.iter().map(|e| Edge { nodes: e.nodes.map(|n| NodeId(n.0 + base)), ..*e }));
    assert!(matches!(run(&network, &MeshPlan::default()), Err(RunError::BlocksFailed(_))));
    let meshed = run(&network, &MeshPlan { keep_going: true, ..MeshPlan::default() }).expect("the rest");
    assert_eq!(meshed.report.failed.len(), 1);
    assert!(!meshed.check.is_valid(), "a component is missing");
    assert!(meshed.mesh.tet_block.contains(&1) && !meshed.mesh.tet_block.contains(&0));
}

#[test]
fn some_points_of_a_stored_mesh_are_found_without_the_others() {
    let store = Store::in_memory();
    let stored = mesh_into(&store, &h(40.0), &MeshPlan::default(), &|_| Ok(()), &()).expect("a mesh");
    let all = gather(&stored.mesh).expect("read").mesh.points;
    for step in [1, 7, all.len() / 3] {
        let ids: Vec<u32> = (0..all.len() as u32).step_by(step).collect();
        let expected: Vec<Point3> = ids.iter().map(|&i| all[i as usize]).collect();
        assert_eq!(stored.mesh.points_of(&ids).expect("read"), expected);
    }
    assert!(stored.mesh.points_of(&[all.len() as u32]).is_err());
}

#[test]
fn where_a_block_is_missing_the_others_end_in_patches_of_their_own() {
    let mut network = hair_on_a_trunk();
    // The block fails as well when it is joined to its neighbours. More distant blocks are not affected.
    let mut last = NodeId(0);
    for (k, number) in (1..=6).zip((4..).step_by(2)) {
        let z = -1e5 * f64::from(k);
        for (place, original) in [([0.0, 0.0, z], number), ([3e4, 0.0, z - 2e4], number + 1)] {
            network.nodes.push(Node { position: place.into(), radius: 1e3, original });
        }
        let [fork, tip] = [number, number + 1].map(NodeId);
        network.edges.extend([[last, fork], [fork, tip]].map(|nodes| Edge { nodes, radii: [1e3; 2] }));
        last = fork;
    }
    let (network, _) = anastomesh_skeleton::clean(&network).expect("clean");
    let meshed = run(&network, &MeshPlan { keep_going: true, ..MeshPlan::default() }).expect("the rest");
    let missing: Vec<&anastomesh_mesh::Patch> =
        meshed.mesh.patches.iter().filter(|patch| patch.name.starts_with("missing_")).collect();
    assert!(!missing.is_empty(), "{:?}", meshed.mesh.patches);
    assert!(missing.iter().all(|patch| meshed.mesh.boundary_patch.contains(&patch.id)), "each disc has faces");
    let ids: std::collections::BTreeSet<i32> = meshed.mesh.patches.iter().map(|patch| patch.id).collect();
    assert_eq!(ids.len(), meshed.mesh.patches.len());
}

/// Requests a stop after a number of blocks.
struct Stops {
    after: usize,
    blocks: AtomicUsize,
}

impl Progress for Stops {
    fn at(&self, stage: Stage, done: u64, _: u64) {
        let is_block = done > 0 && matches!(stage, Stage::Blocks | Stage::Clusters | Stage::Connectors);
        self.blocks.fetch_add(usize::from(is_block), Ordering::Relaxed);
    }

    fn is_cancelled(&self) -> bool {
        self.blocks.load(Ordering::Relaxed) >= self.after
    }
}

#[test]
fn a_run_that_is_told_to_stop_stops_and_goes_on_later() {
    let network = h(12.0);
    let plan = MeshPlan::default();
    let run = |store: &Store, progress: &dyn Progress| {
        let stored = mesh_into(store, &network, &plan, &|_| Ok(()), progress)?;
        Ok::<_, RunError>((gather(&stored.mesh)?, stored.report.retries))
    };
    let whole = run(&Store::in_memory(), &()).expect("a mesh");
    let store = Store::in_memory();
    for after in [0, 1, 2] {
        let stopped = run(&store, &Stops { after, blocks: AtomicUsize::new(0) });
        assert!(matches!(stopped, Err(RunError::Cancelled)), "after {after} blocks");
    }
    assert!(run(&store, &()).expect("a mesh") == whole, "what was stopped leaves no trace");
}

#[test]
#[cfg(feature = "woven")]
fn smoothing_stops_as_well() {
    let plan = MeshPlan { joint: JointStyle::Woven, ..MeshPlan::default() };
    let stops = Stops { after: 1, blocks: AtomicUsize::new(0) };
    let stopped = mesh_network(&h(12.0), &plan, &stops);
    assert!(matches!(stopped, Err(RunError::Cancelled)));
}

#[test]
fn a_refinement_stops_as_well() {
    let refined = refine(&h(12.0), &RefineParams::default().freedom(Freedom::Grown), &StopsAfter::new(0));
    assert!(matches!(refined, Err(RefineError::Cancelled)));
}

#[test]
fn refinement_separates_two_trees_that_share_their_terminals() {
    let run = |s: &Skeleton| refine(s, &RefineParams::default(), &()).expect("refined");
    let grown = dual(&run(&tangle(4, 3)).skeleton).skeleton;
    let refined = run(&grown);
    let before = Figures::of(&grown, false);
    let r = &refined.report;
    assert!(before.overlaps > 20 && r.moved.overlaps <= before.overlaps / 20, "{} {:?}", before.overlaps, r.moved);
    assert_eq!(r.moved.metrics.folds.count, 0);
    assert_eq!((grown.check(), refined.skeleton.check()), (Ok(()), Ok(())));
}

#[test]
fn vessels_whose_walls_cannot_be_parted_share_a_cluster_if_they_may_fuse() {
    // Two vessels that cross at a distance of a thousandth of a radius.
    let (c, s) = (14.0 * libm::cos(0.8), 14.0 * libm::sin(0.8));
    let height = 2.001;
    let nodes = [
        [-12.0, 0.0, 0.0, 1.0],
        [0.0, 0.0, 0.0, 1.0],
        [12.0, 0.0, 0.0, 1.0],
        [-c, -s, height, 1.0],
        [0.0, 0.0, height, 1.0],
        [c, s, height, 1.0],
    ];
    let network = skeleton(&nodes, &[[0, 1], [1, 2], [3, 4], [4, 5]]);
    let made = |fuse| run(&network, &MeshPlan { fuse, ..MeshPlan::default() }).expect("meshed");
    let apart = made(false);
    assert!(apart.check.failed().all(|line| line.line == anastomesh_mesh::check::Line::NoSelfIntersection));
    assert!(!apart.check.is_valid());
    let fused = made(true);
    assert!(fused.check.is_valid(), "{:?}", fused.check.failed().collect::<Vec<_>>());
    assert!(!fused.report.keeps_vessels(false) && fused.report.blocks.clusters < apart.report.blocks.clusters);
}

//! `network::Run`: the library does all that the verb `mesh` does.

#[path = "../../examples/mesh_network.rs"]
#[allow(dead_code, reason = "the test calls what `main` calls")]
mod mesh_network;

use crate::common::fixture;
use crate::common::program::{FINE, assert_code, mesh};
use anastomesh::Point3;
use anastomesh::meshing::{Defect, Fault, MeshingError, Run, Strategy};
use anastomesh::network::{RefineParams, Residual, Skeleton};
use anastomesh::skeleton::{Edge, Node, NodeId};

/// A network of straight vessels of one radius each.
fn network(points: &[[f64; 3]], edges: &[(u32, u32, f64)]) -> Skeleton {
    let radius =
        |node: u32| edges.iter().find(|(a, b, _)| [*a, *b].contains(&node)).map_or(0.0, |(.., radius)| *radius);
    let node = |(i, &place): (u32, &[f64; 3])| Node { position: Point3::from(place), radius: radius(i), original: i };
    let edge = |&(a, b, radius): &(u32, u32, f64)| Edge { nodes: [NodeId(a), NodeId(b)], radii: [radius; 2] };
    Skeleton { nodes: (0..).zip(points).map(node).collect(), edges: edges.iter().map(edge).collect() }
}

/// Two vessels that cross at one point.
fn crossing() -> Skeleton {
    let points = [[-20.0, 0.0, 0.0], [20.0, 0.0, 0.0], [0.0, -20.0, 0.3], [0.0, 20.0, 0.3]];
    network(&points, &[(0, 1, 1.0), (2, 3, 0.9)])
}

#[test]
fn the_library_writes_the_bytes_that_the_program_writes() {
    let folder = tempfile::tempdir().unwrap();
    let [ours, theirs] = ["library.vtu", "program.vtu"].map(|name| folder.path().join(name));
    let input = fixture("tree_30.vtp");
    mesh_network::mesh_network(&input, &ours).unwrap();
    assert_code(&mesh(&input, &theirs, &["--refine", "-q"]), FINE);
    assert!(std::fs::read(ours).unwrap() == std::fs::read(theirs).unwrap());
}

#[test]
fn defects_are_listed_and_refinement_removes_them() {
    let as_it_is = Run::of_skeleton(crossing()).mesh(&()).unwrap();
    assert!(!as_it_is.is_valid() && as_it_is.defects.contains(&Defect::Invalid), "{:?}", as_it_is.defects);
    // Without refinement there is nothing to fall back to.
    assert_eq!(as_it_is.attempts.len(), 1);
    assert_eq!(as_it_is.attempts[0].fault, Some(Fault::Invalid));
    let refined = Run::of_skeleton(crossing()).refine(RefineParams::default()).mesh(&()).unwrap();
    assert_eq!((&refined.defects[..], refined.kept), (&[][..], 0));
    assert_eq!((refined.attempts[0].strategy, refined.attempts[0].fault), (Strategy::OverlapsMoved, None));
    assert_ne!(refined.networks.network, refined.networks.prepared);
    assert!(refined.networks.refine.is_some_and(|report| report.result.overlaps == 0));
    assert_eq!(refined.network.nodes.len(), refined.networks.network.nodes.len());
}

#[test]
fn a_refinement_that_does_not_help_is_followed_by_the_fallbacks() {
    // No iteration moves anything. More clearance is not tried, as the vessels still overlap.
    let params = RefineParams::default().iterations(0).residual(Residual::Report);
    let made = Run::of_skeleton(crossing()).refine(params).mesh(&()).unwrap();
    let strategies: Vec<Strategy> = made.attempts.iter().map(|attempt| attempt.strategy).collect();
    assert_eq!(strategies, [Strategy::OverlapsMoved, Strategy::Planned, Strategy::Unrefined]);
    assert!(made.attempts.iter().all(|attempt| attempt.fault == Some(Fault::Invalid)), "{:?}", made.attempts);
    // Where none is better the planned one stays.
    assert_eq!(made.kept, 1);
    assert!(made.networks.refine.is_some());
}

#[test]
fn vessels_that_cannot_be_parted_are_fused_at_last() {
    let params = RefineParams::default().iterations(0);
    let made = Run::of_skeleton(crossing()).refine(params).mesh(&()).unwrap();
    let kept = made.attempts[made.kept];
    assert_eq!((kept.strategy, kept.fault), (Strategy::Fused, None));
    assert!(made.check.is_valid() && made.changes.one_lumen.is_some());
    // The network asked for two lumens.
    assert!(made.defects.contains(&Defect::VesselsNotKept), "{:?}", made.defects);
}

#[test]
fn a_valid_mesh_of_another_size_is_kept_before_an_invalid_one() {
    let points = [[0.0; 3], [3.0, 1.0, 4.0], [5.0, 3.0, 2.0], [3.0, 3.0, 1.0], [1.0, 1.0, 0.0]];
    let radii = [0.25, 0.25, 1.0, 1.0, 0.5];
    let mut given = network(&points, &[(0, 1, 1.0), (1, 2, 1.0), (0, 3, 1.0), (1, 4, 1.0)]);
    given.nodes.iter_mut().zip(radii).for_each(|(node, radius)| node.radius = radius);
    given.edges.iter_mut().for_each(|edge| edge.radii = edge.nodes.map(|node| radii[node.index()]));
    let made = Run::of_skeleton(given).refine(RefineParams::default()).mesh(&()).unwrap();
    let kept = made.attempts[made.kept];
    assert!(matches!(kept.fault, Some(Fault::Volume(_))) && kept.strategy == Strategy::OverlapsMoved, "{kept:?}");
    assert!(made.attempts.iter().all(|attempt| matches!(attempt.fault, Some(Fault::Invalid | Fault::Volume(_)))));
    assert!(made.is_valid() && made.changes.moved.is_some(), "{:?}", made.defects);
}

#[test]
fn thin_branches_of_a_wide_vessel_are_well_shaped() {
    for thin in [0.1, 0.03, 3e-3] {
        let points = [[-20.0, 0.0, 0.0], [0.0; 3], [20.0, 0.0, 0.0], [0.0, 0.0, 4.0]];
        let given = network(&points, &[(0, 1, 1.0), (1, 2, 1.0), (1, 3, thin)]);
        let made = Run::of_skeleton(given).mesh(&()).unwrap();
        assert!(made.defects.is_empty(), "{:?}", made.defects);
        let quality = made.check.quality.expect("tetrahedra");
        assert!(quality.min > 0.2 && quality.dihedral_min > 12.0, "{quality:?}");
    }
}

#[test]
fn a_vessel_wider_than_long_ends_where_it_is_given() {
    for length in [1e-3, 0.2, 0.45] {
        let given = network(&[[0.0; 3], [0.0, 0.0, length]], &[(0, 1, 1.0)]);
        let made = Run::of_skeleton(given).mesh(&()).unwrap();
        assert!(made.defects.is_empty() && made.changes.extended.is_none(), "{:?}", made.defects);
    }
}

#[test]
fn inlets_are_named_as_the_file_names_them() {
    let tree = || network(&[[0.0; 3], [0.0, 0.0, 20.0]], &[(0, 1, 1.0)]);
    let made = Run::of_skeleton(tree()).roots(["1"]).mesh(&()).unwrap();
    let inlet = made.mesh.patches.iter().find(|patch| patch.name == "inlet").and_then(|patch| patch.cap);
    assert_eq!(inlet.map(|cap| cap.node), Some(1));
    let caps = made.caps.expect("the plan is not hollow");
    assert!(caps.rows.len() == 2 && (caps.rows[0].flow / caps.rows[1].flow - 1.0).abs() < 1e-9);
    let refused = Run::of_skeleton(tree()).roots(["7"]).mesh(&());
    assert!(matches!(refused, Err(MeshingError::Inlet(_))), "{refused:?}");
}

/// Two vessels that leave one node at a small angle: their tubes overlap, but make one lumen there.
fn narrow_fork() -> Skeleton {
    let points = [[0.0; 3], [0.0, 0.0, 12.0], [6.0, 0.0, 32.0], [-6.0, 0.0, 32.0]];
    network(&points, &[(0, 1, 1.0), (1, 2, 1.0), (1, 3, 1.0)])
}

#[test]
fn a_network_that_gives_a_valid_mesh_is_not_moved() {
    let given = narrow_fork();
    assert!(!given.overlaps(&given.adjacency()).pairs.is_empty());
    let plain = Run::of_skeleton(given.clone()).mesh(&()).unwrap();
    let refined = Run::of_skeleton(given).refine(RefineParams::default()).mesh(&()).unwrap();
    assert_eq!((&plain.defects[..], &refined.defects[..]), (&[][..], &[][..]));
    assert_eq!((refined.attempts.len(), refined.attempts[0].strategy), (1, Strategy::AsGiven));
    assert!(refined.networks.refine.is_none() && refined.networks.refined.is_none());
    assert_eq!((plain.mesh, plain.network), (refined.mesh, refined.network));
}

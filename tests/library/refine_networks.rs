//! Refinement of real networks against target figures. The data is not in the repository; without it these tests print
//! a note and pass.

use crate::common;
use anastomesh::Point3;
use anastomesh::network::dual;
use anastomesh::network::{Crowded, RefineParams, Refined, Residual, Skeleton, refine};

fn refined(skeleton: &Skeleton, params: &RefineParams) -> Refined {
    let refined = refine(skeleton, params, &()).expect("a cleaned network can be refined");
    assert_eq!(refined.skeleton.check(), Ok(()));
    // Terminals are fixed, except those without space for two caps.
    let adjacency = refined.skeleton.adjacency();
    for n in adjacency.terminals() {
        let is_crowded =
            refined.report.crowded.iter().flat_map(|p| p.nodes).any(|c| c == refined.skeleton.node(n).original);
        let may_move = params.crowded != Crowded::Keep && is_crowded;
        assert!(may_move || refined.skeleton.node(n).position == refined.origin[n.index()]);
    }
    refined
}

#[test]
fn the_fixture_can_be_cut_afterwards() {
    let tree = common::network(&common::fixture("tree_30.swc"));
    let report = refined(&tree, &RefineParams::default()).report;
    assert_eq!((report.result.overlaps, report.result.metrics.cuttable.percent()), (0, 100.0));
}

/// 48,108 nodes of valence up to 5; two terminals are 0.1 radii apart.
#[test]
fn the_kidney_tree() {
    let Some(shared) = common::shared() else { return };
    let tree = common::network(&shared.join("data/kidney/tree_original.vtp"));
    let keep = RefineParams::default().residual(Residual::Report);
    let report = refined(&tree, &keep).report;
    println!("{:?}\n{:?}", report.result, report.displacement);
    let (r, d) = (&report.result, &report.displacement);
    assert_eq!(report.given.far, 739);
    assert!(r.far <= 5 && r.overlaps == 0, "{r:?}");
    assert!(r.metrics.long_enough.percent() >= 99.95 && r.metrics.cuttable.percent() >= 97.0, "{r:?}");
    assert_eq!(r.metrics.shorter_than_2.count, 0, "{r:?}");
    assert!(d.mean <= 42.0 && d.p99 <= 210.0 && d.max <= 500.0, "{d:?}");
    let crowded: Vec<_> = report.crowded.iter().map(|p| (p.nodes, p.resolved)).collect();
    assert_eq!(crowded, [([13299, 43836], true)]);
    assert!(report.crowded[0].moved.iter().all(|m| (9.0..13.0).contains(m)), "{:?}", report.crowded);
    assert!(report.worse.is_empty(), "{:?}", report.worse);
}

/// Part of the tree with a second tree grown beside it: every shared terminal starts as a fold.
#[test]
fn two_trees_that_share_their_terminals() {
    let Some(shared) = common::shared() else { return };
    let tree = common::network(&shared.join("data/kidney/subtree_9947.vtp"));
    let both = dual(&tree).skeleton;
    let report = refined(&both, &RefineParams::default()).report;
    let (before, r) = (&report.given, &report.result);
    println!("{before:?}\n{r:?}\n{:?}", report.residual);
    assert!(before.far > 1000 && report.moved.far <= 5, "{before:?} {r:?}");
    assert!(before.metrics.folds.percent() > 50.0 && r.metrics.folds.percent() <= 1.0, "{r:?}");
    assert_eq!(report.residual.left, 0, "{:?}", report.residual);
    assert!(report.residual.volume_lost <= 0.005 * report.residual.volume);
    assert!(r.metrics.cuttable.percent() >= 97.0, "{r:?}");
}

#[test]
fn the_unit_of_length_makes_no_difference() {
    let Some(shared) = common::shared() else { return };
    let tree = common::network(&shared.join("data/kidney/subtree_989.vtp"));
    let in_micrometres = refined(&tree, &RefineParams::default()).skeleton;
    for unit in [1e-3, 1e-6] {
        let mut other = tree.clone();
        for node in &mut other.nodes {
            (node.position, node.radius) = (Point3::from(node.position.coords * unit), node.radius * unit);
        }
        for edge in &mut other.edges {
            edge.radii = edge.radii.map(|r| r * unit);
        }
        let other = refined(&other, &RefineParams::default()).skeleton;
        assert_eq!(other.edges.len(), in_micrometres.edges.len());
        for (a, b) in in_micrometres.nodes.iter().zip(&other.nodes) {
            let wrong = (a.position.coords * unit - b.position.coords).norm();
            assert!(wrong <= 1e-6 * b.position.coords.norm(), "{wrong} in units of {unit}");
        }
    }
}

/// Networks with overlaps or uncuttable vessels have valid meshes after refinement: loops, duplicate edges, a plane.
#[test]
fn refined_networks_have_valid_meshes() {
    let Some(shared) = common::shared() else { return };
    for name in ["kidney/subtree_989.vtp", "skeletons/flows_breast1.vtp"] {
        let network = common::network(&shared.join("data").join(name));
        let skeleton = refined(&network, &RefineParams::default()).skeleton;
        let meshed = common::mesh(&skeleton, 2.5);
        assert!(meshed.check.is_valid(), "{name}: {:?}", meshed.check);
    }
}

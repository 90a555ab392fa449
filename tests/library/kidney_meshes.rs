//! Tests on subtrees of a real kidney, which are not in the repository: skipped without the shared data.

#[cfg(feature = "woven")]
use crate::common::mesh_by;
use crate::common::{mesh, network, shared};
use anastomesh::Point3;
use anastomesh::check::{CheckReport, Line, Outcome};
#[cfg(feature = "woven")]
use anastomesh::meshing::{JointStyle, MeshPlan};
use anastomesh::meshing::{Meshed, RunReport};
use anastomesh::network::Skeleton;
use anastomesh::skeleton::Edge;
use anastomesh::testing::{Tube, point_tube};

/// Wall triangles of `subtree_289_clear` at ρ = 3 from another implementation of the method.
const WALL_OF_BASELINE: usize = 227_134;

fn kidney(name: &str, rho: f64) -> Option<Meshed> {
    let path = shared()?.join("data/kidney").join(name);
    let meshed = mesh(&network(&path), rho);
    print!("{name}, rho {rho}\n{}{}", meshed.report, meshed.check);
    Some(meshed)
}

fn assert_few_retries(report: &RunReport) {
    let blocks = report.blocks.clusters + report.blocks.connectors;
    // Attempts to keep overlapping vessels apart do not count as failures.
    let retries: Vec<_> = report.retries.iter().filter(|retry| !retry.remedy.contains("taken as one")).collect();
    assert!(retries.len() * 100 <= blocks, "{blocks} blocks\n{retries:#?}");
}

fn assert_quality(check: &CheckReport) {
    let quality = check.quality.as_ref().expect("a mesh whose arrays are sound");
    assert!(quality.mean >= 0.80, "mean radius ratio {}", quality.mean);
    assert!(quality.percentile_1 >= 0.20, "1st percentile {}", quality.percentile_1);
    assert!(quality.dihedral_min >= 1.0, "smallest dihedral {}°", quality.dihedral_min);
}

fn assert_clear(Meshed { report, check, .. }: &Meshed) {
    assert!(check.is_valid(), "{check}");
    assert_eq!(report.failed, []);
    assert_eq!(report.unconnected, [[[0; 2]; 2]; 0], "no vessels meet in this network");
    assert_few_retries(report);
    assert_quality(check);
}

#[test]
fn subtree_59_is_valid() {
    for rho in [3.0, 4.0, 5.0] {
        let Some(meshed) = kidney("subtree_59.vtp", rho) else { return };
        assert_clear(&meshed);
    }
}

#[test]
#[ignore = "three million tetrahedra: half a minute"]
fn subtree_289_clear_is_valid_when_finer() {
    for rho in [4.0, 5.0] {
        let Some(meshed) = kidney("subtree_289_clear.vtp", rho) else { return };
        assert_clear(&meshed);
    }
}

#[test]
fn subtree_289_clear_is_valid() {
    let Some(meshed) = kidney("subtree_289_clear.vtp", 3.0) else { return };
    assert_clear(&meshed);
    let quality = meshed.check.quality.as_ref().expect("sound arrays");
    assert!(quality.mean >= 0.87, "mean radius ratio {}", quality.mean);
    assert!(quality.percentile_1 >= 0.60, "1st percentile {}", quality.percentile_1);
    assert!(quality.dihedral_min >= 8.0, "smallest dihedral {}°", quality.dihedral_min);
    let report = &meshed.report;
    assert!(report.blocks.clusters >= 120, "{} clusters", report.blocks.clusters);
    // Edge length is proportional to the radius, and tube rings are slightly further apart.
    assert!(report.mesh.wall_triangles * 100 >= WALL_OF_BASELINE * 55, "{} triangles", report.mesh.wall_triangles);
}

#[test]
#[cfg(feature = "woven")]
fn subtree_289_clear_is_as_fine_everywhere_on_request() {
    let Some(shared) = shared() else { return };
    let mut plan = MeshPlan::default();
    plan.follow = 0.0;
    // A disc derived from the vessel alone cannot be as fine as an unknown cluster.
    plan.joint = JointStyle::Woven;
    let meshed = mesh_by(&network(&shared.join("data/kidney/subtree_289_clear.vtp")), &plan);
    assert_clear(&meshed);
    let walls = meshed.report.mesh.wall_triangles;
    assert!(walls * 10 >= WALL_OF_BASELINE * 8, "{walls} triangles");
}

/// The network has overlapping vessels, so the mesh cannot be valid. Every fault must be explained by them.
#[test]
fn subtree_989_is_sound_but_for_its_overlaps() {
    let Some(Meshed { report, check, .. }) = kidney("subtree_989.vtp", 3.0) else { return };
    assert_eq!(report.unconnected.len(), 34);
    assert_eq!(report.failed, []);
    assert!(report.blocks.clusters >= 380, "{} clusters", report.blocks.clusters);
    let failing: Vec<Line> = check.failed().map(|line| line.line).collect();
    assert_eq!(failing, [Line::NoSelfIntersection, Line::Loops, Line::CapPerTerminal], "{check}");
    let unchecked: Vec<Line> =
        check.lines.iter().filter(|l| matches!(l.outcome, Outcome::NotChecked(_))).map(|l| l.line).collect();
    assert_eq!(unchecked, [Line::NoDuplicatePoints], "points of walls that meet are looked for where they meet");
    let line = |line: Line| check.line(line).expect("a line of the check");
    // Terminals without a cap are those with tips inside another vessel.
    let mut uncapped: Vec<i64> = report.fused.iter().flat_map(|f| &f.uncapped).map(|&node| i64::from(node)).collect();
    uncapped.sort_unstable();
    let missing: Vec<i64> = line(Line::CapPerTerminal).offenders.iter().flat_map(|o| o.ids.iter().copied()).collect();
    assert_eq!((missing.len() as u64, &missing), (line(Line::CapPerTerminal).count, &uncapped));
    // Handles come from fused vessels.
    let handles: i64 = report.fused.iter().map(|f| f.handles - f.loops).sum();
    let found: u32 = line(Line::Loops).found.iter().flatten().sum();
    assert_eq!(i64::from(found), handles, "a tree has no loops of its own");
    // Walls intersect where vessels overlap.
    let network = network(&shared().expect("the network was there").join("data/kidney/subtree_989.vtp"));
    let overlapping: Vec<Tube> = report.unconnected.iter().flatten().map(|edge| tube(&network, *edge)).collect();
    for offender in &line(Line::NoSelfIntersection).offenders {
        let p = Point3::from(offender.position.expect("a place"));
        let near = |tube: &Tube| point_tube(&p, tube).1 < 0.5 * tube.max_radius();
        assert!(overlapping.iter().filter(|tube| near(tube)).count() >= 2, "walls meet at {p} without a reason");
    }
    assert_few_retries(&report);
    assert_quality(&check);
}

/// Vessel between two nodes of the file.
fn tube(network: &Skeleton, nodes: [u32; 2]) -> Tube {
    let is_it = |edge: &Edge| {
        let original = edge.nodes.map(|n| network.node(n).original);
        original == nodes || [original[1], original[0]] == nodes
    };
    let edge = network.edges.iter().find(|edge| is_it(edge)).expect("an edge of the file");
    let [a, b] = edge.nodes.map(|n| network.node(n).position);
    Tube { a, b, ra: edge.radii[0], rb: edge.radii[1] }
}

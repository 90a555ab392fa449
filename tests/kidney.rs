//! Subtrees of a real kidney, which are not in the repository: skipped where the shared data is absent.

mod common;

use anastomesh::mesh::check::{CheckReport, Line, Outcome};
use anastomesh::pipeline::{JointStyle, MeshPlan, Meshed, RunReport};
use anastomesh::report::check::text;
use common::{mesh, mesh_by, network, shared};

/// Triangles of the wall of `subtree_289_clear` that another implementation of the method makes at ρ = 3.
const WALL_OF_BASELINE: usize = 227_134;

fn kidney(name: &str, rho: f64) -> Option<Meshed> {
    let path = shared()?.join("data/kidney").join(name);
    let meshed = mesh(&network(&path), rho);
    print!("{name}, rho {rho}\n{}{}", meshed.report.text(), text(&meshed.check));
    Some(meshed)
}

fn assert_few_retries(report: &RunReport) {
    let blocks = report.blocks.clusters + report.blocks.connectors;
    // Vessels that overlap are kept apart where that can be: trying it is not a failure.
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
    assert!(check.is_valid(), "{}", text(check));
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
    assert!(quality.mean >= 0.84, "mean radius ratio {}", quality.mean);
    assert!(quality.percentile_1 >= 0.40, "1st percentile {}", quality.percentile_1);
    assert!(quality.dihedral_min >= 8.0, "smallest dihedral {}°", quality.dihedral_min);
    let report = &meshed.report;
    assert!(report.blocks.clusters >= 120, "{} clusters", report.blocks.clusters);
    // Edges in proportion to the radius: wide vessels need fewer than that one makes.
    assert!(report.mesh.wall_triangles * 100 >= WALL_OF_BASELINE * 65, "{} triangles", report.mesh.wall_triangles);
}

#[test]
fn subtree_289_clear_is_as_fine_everywhere_on_request() {
    let Some(shared) = shared() else { return };
    let mut plan = MeshPlan::default();
    plan.follow = 0.0;
    // A disc that the vessel alone gives cannot be as fine as a cluster that it does not know.
    plan.joint = JointStyle::Woven;
    let meshed = mesh_by(&network(&shared.join("data/kidney/subtree_289_clear.vtp")), &plan);
    assert_clear(&meshed);
    let walls = meshed.report.mesh.wall_triangles;
    assert!(walls * 10 >= WALL_OF_BASELINE * 8, "{walls} triangles");
}

/// Vessels overlap in this one: the mesh cannot be valid, but nothing else may be wrong with it.
#[test]
fn subtree_989_is_sound_but_for_its_overlaps() {
    const EXPLAINED: [Line; 8] = [
        Line::NoSelfIntersection,
        Line::Loops,
        Line::CapPerTerminal,
        Line::CapDisc,
        Line::CapFlat,
        Line::CapCentred,
        Line::CapArea,
        Line::CapNormal,
    ];
    let Some(Meshed { report, check, .. }) = kidney("subtree_989.vtp", 3.0) else { return };
    assert_eq!(report.unconnected.len(), 34);
    assert_eq!(report.failed, []);
    assert!(report.blocks.clusters >= 380, "{} clusters", report.blocks.clusters);
    assert!(!check.is_valid(), "vessels that pass through each other cannot have a sound wall");
    for line in &check.lines {
        assert!(line.outcome != Outcome::Fail || EXPLAINED.contains(&line.line), "{}", text(&check));
    }
    assert_few_retries(&report);
    assert_quality(&check);
}

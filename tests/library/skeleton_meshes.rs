//! Tests on networks of other origin, which are not in the repository: skipped without the shared data.

use crate::common::{mesh, network, shared};
use anastomesh::check::{Line, Outcome};
use anastomesh::meshing::Meshed;

fn skeleton(name: &str) -> Option<Meshed> {
    let path = shared()?.join("data/skeletons").join(name);
    let meshed = mesh(&network(&path), 3.0);
    print!("{name}\n{}{}", meshed.report, meshed.check);
    Some(meshed)
}

/// Asserts that no block failed, and that the mesh is valid or only wall and caps suffer from named overlaps.
fn assert_valid_or_explained(Meshed { report, check, .. }: &Meshed) {
    const SOUND: [Line; 7] = [
        Line::PositiveTets,
        Line::FacesSharedByTwo,
        Line::OppositeSides,
        Line::NoDuplicatePoints,
        Line::NoUnusedPoints,
        Line::Components,
        Line::LabelsMatchBoundary,
    ];
    assert_eq!(report.failed, []);
    assert!(check.is_valid() || !report.overlaps.is_empty() || !report.unconnected.is_empty(), "{check}");
    for line in SOUND {
        assert_eq!(check.line(line).map(|l| l.outcome), Some(Outcome::Pass), "{}", line.statement());
    }
}

#[test]
fn a_main_artery_is_valid() {
    let Some(meshed) = skeleton("kidney_xu_main_artery.vtp") else { return };
    assert!(meshed.check.is_valid(), "{}", meshed.check);
}

#[test]
fn a_carotid_artery_of_short_edges() {
    let Some(meshed) = skeleton("vascularmd_ICA.swc") else { return };
    assert_valid_or_explained(&meshed);
}

/// 158 loops in one plane with crossing vessels.
#[test]
#[ignore = "21 million tetrahedra: two minutes"]
fn a_mesentery_of_loops() {
    let Some(meshed) = skeleton("secomb_mesentery_546.vtp") else { return };
    assert_valid_or_explained(&meshed);
}

#[test]
#[ignore = "some 30 million tetrahedra, one cluster of 258 nodes: minutes and 2.6 GB"]
fn a_generated_tree() {
    let Some(meshed) = skeleton("opencco_tree3D_synth.vtp") else { return };
    assert_valid_or_explained(&meshed);
}

#[test]
#[ignore = "four million tetrahedra: half a minute"]
fn a_brain() {
    let Some(meshed) = skeleton("brava_BG001.swc") else { return };
    assert_valid_or_explained(&meshed);
}

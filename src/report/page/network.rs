//! Networks: overlaps before and after refinement.

use super::figures::LengthUnit;
use super::html::{Mark, Section};
use super::pictures::network_picture;
use crate::report::refine::panels;
use crate::report::verdict::Verdict;
use anastomesh_mesh::units::{counted, grouped};
use anastomesh_network::RefineReport;
use anastomesh_skeleton::{EdgeId, Skeleton};
use std::io;

/// Verdict of a refinement for the page header.
pub fn of_refinement(verdict: &Verdict) -> (Mark, String) {
    (if verdict.is_good { Mark::Good } else { Mark::Bad }, verdict.text.clone())
}

/// Edges whose vessels overlap others.
fn overlaps(network: &Skeleton) -> Vec<EdgeId> {
    let pairs = network.overlaps(&network.adjacency()).pairs;
    let mut edges: Vec<EdgeId> = pairs.iter().flat_map(|pair| pair.edges).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// Result of a refinement: network before and after, figures, and their history (Fig. 11 of the paper).
///
/// # Errors
/// A picture cannot be compressed.
pub fn refinement(report: &RefineReport, before: &Skeleton, after: &Skeleton, unit: LengthUnit) -> io::Result<Section> {
    let picture = |network, when: &str, pairs: usize| {
        let caption = format!("{when}: {} of overlapping edges (red)", counted(pairs, "pair"));
        network_picture(network, &overlaps(network), &caption, unit)
    };
    let pictures = [picture(before, "Before", report.given.overlaps), picture(after, "After", report.result.overlaps)];
    let d = &report.displacement;
    Ok(Section::new("Refinement")
        .tiles(&[
            ("overlapping pairs before", grouped(report.given.overlaps)),
            ("overlapping pairs after", grouped(report.result.overlaps)),
            ("mean node displacement", unit.length(d.mean)),
            ("displacement, 99th percentile and max", format!("{} and {}", unit.length(d.p99), unit.length(d.max))),
            ("median radius", unit.length(0.448 * report.unit)),
        ])
        .pictures(&pictures, false)?
        .table(&["", "given", "split", "moved", "result"], &report.figures_table())
        .plots(&panels(report)))
}

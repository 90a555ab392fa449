//! Networks: overlaps before and after refinement.

use super::html::{Mark, Section};
use super::pictures::network_picture;
use crate::report::refine::panels;
use anastomesh_network::RefineReport;
use anastomesh_skeleton::{EdgeId, Skeleton};
use std::io;

/// Verdict of a refinement for the page header.
pub fn overlaps_left(report: &RefineReport) -> (Mark, String) {
    match report.result.overlaps {
        0 => (Mark::Good, "no vessels overlap".into()),
        n => (Mark::Bad, format!("{n} pairs of edges overlap")),
    }
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
pub fn refinement(report: &RefineReport, before: &Skeleton, after: &Skeleton) -> io::Result<Section> {
    let picture = |network, when: &str, pairs: usize| {
        let caption = format!("{when}: {pairs} pairs of edges overlap (red).");
        network_picture(network, &overlaps(network), &caption)
    };
    let pictures =
        [picture(before, "As given", report.given.overlaps), picture(after, "Refined", report.result.overlaps)];
    let d = &report.displacement;
    Ok(Section::new("Refinement")
        .tiles(&[
            ("overlapping pairs, given", report.given.overlaps.to_string()),
            ("in the end", report.result.overlaps.to_string()),
            ("nodes moved by, mean", format!("{:.4}", d.mean)),
            ("99 %, furthest", format!("{:.4}, {:.4}", d.p99, d.max)),
            ("a median radius is", format!("{:.4}", 0.448 * report.unit)),
        ])
        .pictures(&pictures, false)?
        .table(&["", "given", "split", "moved", "result"], &report.figures_table())
        .plots(&panels(report)))
}

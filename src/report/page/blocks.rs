//! Blocks of a run: sizes, times, retries, failures.

use super::figures::{LengthUnit, figure};
use super::html::{Mark, Section};
use super::pictures::network_picture;
use super::shape::bars;
use crate::pipeline::{RunReport, named};
use crate::report::plot::Panel;
use anastomesh_mesh::source::MeshSource;
use anastomesh_mesh::units::{counted, grouped};
use anastomesh_network::NameOf;
use anastomesh_skeleton::{EdgeId, Skeleton};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::io;

/// Maximum number of list items.
const LISTED: usize = 50;

/// Histogram of tetrahedra per block: number of blocks with less than 2, 4, 8, …
///
/// # Errors
/// The mesh cannot be read.
pub fn block_sizes(mesh: &dyn MeshSource) -> io::Result<Vec<u64>> {
    let mut sizes: BTreeMap<i32, u64> = BTreeMap::new();
    mesh.each_tet_labels(|piece| {
        for run in piece.blocks.chunk_by(|a, b| a == b) {
            *sizes.entry(run[0]).or_default() += run.len() as u64;
        }
        Ok(())
    })?;
    let mut bins = Vec::new();
    for size in sizes.into_values() {
        let bin = size.ilog2() as usize;
        bins.resize(bins.len().max(bin + 1), 0);
        bins[bin] += 1;
    }
    Ok(bins)
}

/// Picture of the network with the vessels of failed blocks highlighted.
///
/// # Errors
/// A picture cannot be compressed.
pub fn failed_blocks(network: &Skeleton, run: &RunReport, unit: LengthUnit) -> io::Result<Section> {
    let nodes: BTreeSet<u32> = run.failed.iter().flat_map(|failed| failed.nodes.iter().copied()).collect();
    let is_marked = |&id: &EdgeId| network.edge(id).nodes.iter().any(|&n| nodes.contains(&network.node(n).original));
    let marked: Vec<EdgeId> = network.edge_ids().filter(is_marked).collect();
    let picture = network_picture(network, &marked, "Vessels of failed blocks (red)", unit);
    Section::new("Failed blocks").pictures(&[picture], false)
}

/// Section on blocks, stages, retries and failures; the stages are those of all passes over the network.
pub fn run(run: &RunReport, sizes: &[u64], name: NameOf) -> Section {
    let (blocks, times) = (&run.blocks, &run.block_times);
    let seconds: f64 = run.stages.iter().map(|stage| stage.seconds).sum();
    let stages: Vec<Vec<String>> =
        run.stages.iter().map(|stage| vec![stage.stage.to_owned(), format!("{} s", figure(stage.seconds))]).collect();
    let section = Section::new("Blocks and times")
        .tiles(&[
            ("clusters", grouped(blocks.clusters)),
            ("connectors", grouped(blocks.connectors)),
            ("largest cluster", counted(blocks.largest_cluster_nodes, "node")),
            ("retried blocks", grouped(run.retries.len())),
            ("failed blocks", grouped(run.failed.len())),
            ("longest block", format!("{} ({} s)", times.longest, figure(times.longest_seconds))),
            ("all stages", format!("{} s", figure(seconds))),
        ])
        .plots(&[
            powers("Sizes of blocks", "tetrahedra (log₂)", sizes, 0.0),
            // The first bin ends just below one millisecond.
            powers("Times of blocks", "milliseconds (log₂)", &times.histogram, -1.0),
        ])
        .table(&["stage", "wall time"], &stages);
    let trouble = trouble(run, name);
    if trouble.is_empty() { section } else { section.list(&trouble) }
}

/// Histogram whose bin borders double, starting at `first`.
fn powers(title: &str, axis: &str, counts: &[u64], first: f64) -> Panel {
    let mut panel = bars(title, [axis, "blocks (%)"], 1.0, counts.iter().copied());
    for point in &mut panel.series[0].points {
        point[0] += first;
    }
    panel
}

fn trouble(run: &RunReport, name: NameOf) -> Vec<(Mark, String)> {
    let mut items = Vec::new();
    for failed in &run.failed {
        let mut text = format!("{} (nodes {}): {}", failed.block, named(&failed.nodes, name), failed.reason);
        if let Some(dump) = &failed.dump {
            let _ = write!(text, "; input written to {dump}");
        }
        items.push((Mark::Bad, text));
    }
    for fused in run.fused.iter().take(LISTED) {
        let (nodes, difference) = (named(&fused.nodes, name), fused.difference(name));
        let text = format!("overlapping vessels in {} (nodes {nodes}): {difference}", fused.block);
        items.push((Mark::Bad, text));
    }
    for retry in run.retries.iter().take(LISTED) {
        let nodes = named(&retry.nodes, name);
        let text = format!("retried {} (nodes {nodes}): {}; {}", retry.block, retry.reason, retry.remedy);
        items.push((Mark::Neither, text));
    }
    let hidden = run.retries.len().saturating_sub(LISTED) + run.fused.len().saturating_sub(LISTED);
    if hidden > 0 {
        items.push((Mark::Below, format!("and {hidden} more (--json lists all)")));
    }
    items
}

//! Notes on the network before meshing, and reports on the blocks afterwards.

use std::io;

use rayon::prelude::*;

use super::blocks::{Blocks, cut_nodes, original_nodes};
use super::estimate::Estimate;
use super::make::{BlockResult, Workshop};
use super::plan::{JointStyle, MeshPlan};
use super::report::{BlockCounts, ClosedGaps, FailedBlock, FilledLoops, FusedBlock, RunReport, ThinBlock};
use super::tips;
use crate::block::{About, Astray, BlockDump};
use crate::partition::{ClusterId, CutId};
use anastomesh_mesh::progress::Progress;
use anastomesh_mesh::units::counted;
use anastomesh_skeleton::{NodeId, Skeleton};

/// Reports the number of overlaps; the summary lists the deepest.
pub(super) fn announce(report: &RunReport, observer: &dyn Progress) {
    let places = report.overlapping_places().len();
    if places > 0 {
        let [places, pairs] =
            [(places, "place"), (report.overlaps.len(), "edge pair")].map(|(n, what)| counted(n, what));
        observer.note(&format!("vessels overlap at {places} ({pairs}); the summary lists the deepest overlaps"));
    }
}

/// Data of all clusters that determine the expected topology.
#[derive(Default)]
pub(super) struct Topology {
    /// Clusters with loops that are filled by their own lumen, and how many.
    pub filled: Vec<(ClusterId, i64)>,
    /// Handles of each cluster's wall, none for those that failed; asked for only where vessels are to fuse.
    pub handles: Vec<i64>,
}

/// Clusters of which reports are read at a time.
const READ: usize = 1 << 14;

/// Reads the report data of each finished cluster, in order.
fn each_cluster(shop: &Workshop, blocks: &Blocks, mut found: impl FnMut(usize, Option<About>)) -> io::Result<()> {
    let about = |made: &BlockResult| made.as_ref().ok().map(|kept| shop.about(kept)).transpose();
    for (first, some) in (0..).step_by(READ).zip(blocks.clusters.chunks(READ)) {
        let read: Vec<Option<About>> = some.par_iter().map(about).collect::<io::Result<_>>()?;
        read.into_iter().enumerate().for_each(|(i, about)| found(first + i, about));
    }
    Ok(())
}

/// Fills the report with the data of the blocks.
pub(super) fn describe_blocks(
    skeleton: &Skeleton,
    shop: &Workshop,
    blocks: &mut Blocks,
    report: &mut RunReport,
) -> io::Result<Topology> {
    report.retries = std::mem::take(&mut blocks.retries);
    report.block_times = std::mem::take(&mut blocks.times);
    let (partition, blocks) = (&blocks.partition, &*blocks);
    report.blocks = BlockCounts {
        clusters: partition.clusters_len(),
        connectors: partition.cuts_len(),
        largest_cluster_nodes: partition.largest_nodes(),
    };
    report.partition = Some(partition.summary());
    report.estimate = Estimate::of(partition, shop.plan);
    let mut topology = Topology::default();
    let mut thin = Vec::new();
    each_cluster(shop, blocks, |i, about| {
        let id = ClusterId(i as u32);
        let nodes = || original_nodes(skeleton, partition.nodes(id).iter().copied());
        if shop.plan.fuse {
            topology.handles.push(about.as_ref().map_or(0, |about| about.handles));
        }
        let Some(about) = about else { return };
        if about.filled > 0 {
            topology.filled.push((id, about.filled));
            report.filled.push(FilledLoops { block: format!("cluster {i}"), nodes: nodes(), loops: about.filled });
        }
        if !about.closed_gaps.is_empty() {
            let (block, places) = (format!("cluster {i}"), about.closed_gaps);
            report.closed_gaps.push(ClosedGaps { block, nodes: nodes(), places });
        }
        if about.handles != about.loops || !about.uncapped.is_empty() || about.astray != Astray::default() {
            report.anastomoses += (about.handles - about.loops).max(0);
            report.fused.push(FusedBlock {
                block: format!("cluster {i}"),
                nodes: nodes(),
                handles: about.handles,
                loops: about.loops,
                uncapped: original_nodes(skeleton, about.uncapped.iter().map(|&n| NodeId(n))),
                astray: about.astray,
            });
        }
        thin.extend(about.thin.map(|layers| ThinBlock { block: format!("cluster {i}"), nodes: nodes(), layers }));
    })?;
    if shop.plan.layers.is_some() {
        report.thin_layers = thin_layers(thin, skeleton, shop, blocks)?;
    }
    describe_failures(skeleton, shop, blocks, report)?;
    Ok(topology)
}

fn describe_failures(skeleton: &Skeleton, shop: &Workshop, blocks: &Blocks, report: &mut RunReport) -> io::Result<()> {
    let partition = &blocks.partition;
    for (i, made) in blocks.clusters.iter().enumerate() {
        let Err(error) = made else { continue };
        let id = ClusterId(i as u32);
        let nodes = || original_nodes(skeleton, partition.nodes(id).iter().copied());
        let original = |node| skeleton.node(node).original;
        let cluster = &partition.cluster(id);
        let params = shop.plan.of_tube(cluster.size).block_params();
        let input = BlockDump::of_cluster(id, cluster, params, nodes(), original);
        report.failed.push(FailedBlock {
            block: format!("cluster {i}"),
            nodes: nodes(),
            reason: error.to_string(),
            too_fine: error.is_too_fine(),
            uncapped: tips::to_blame(cluster, error).into_iter().map(original).collect(),
            dump: write_dump(shop.plan, &format!("cluster_{i}"), &input),
        });
    }
    for (i, made) in blocks.connectors.iter().enumerate() {
        let Some(Err(error)) = made else { continue };
        let id = CutId(i as u32);
        let cut = &partition.cut(id);
        let params = shop.plan.of_tube(cut.size).block_params();
        let nodes = || cut_nodes(skeleton, partition, id);
        let input = match shop.plan.joint {
            JointStyle::Woven => {
                let ends = shop.stored_ends(partition, id, cut, &blocks.clusters)?;
                ends.map(|ends| BlockDump::of_connector(id, cut, ends, params, nodes()))
            }
            JointStyle::Disc | JointStyle::None => Some(BlockDump::of_free_connector(id, cut, params, nodes())),
        };
        report.failed.push(FailedBlock {
            block: format!("connector {i}"),
            nodes: nodes(),
            reason: error.to_string(),
            too_fine: error.is_too_fine(),
            uncapped: Vec::new(),
            dump: input.and_then(|input| write_dump(shop.plan, &format!("connector_{i}"), &input)),
        });
    }
    Ok(())
}

/// Lists the blocks with thin layers, the thinnest first; those that are clusters are known.
fn thin_layers(
    mut thin: Vec<ThinBlock>,
    skeleton: &Skeleton,
    shop: &Workshop,
    blocks: &Blocks,
) -> io::Result<Vec<ThinBlock>> {
    let partition = &blocks.partition;
    for (i, made) in blocks.connectors.iter().enumerate() {
        let Some(Ok(kept)) = made else { continue };
        let nodes = || cut_nodes(skeleton, partition, CutId(i as u32));
        let layers = shop.about(kept)?.thin;
        thin.extend(layers.map(|layers| ThinBlock { block: format!("connector {i}"), nodes: nodes(), layers }));
    }
    thin.sort_by(|a, b| a.layers.share.total_cmp(&b.layers.share));
    Ok(thin)
}

/// Writes the input of a failed block; none when there is no folder for it or it cannot be written.
fn write_dump(plan: &MeshPlan, name: &str, input: &BlockDump) -> Option<String> {
    let dir = plan.dump_dir.as_ref()?;
    std::fs::create_dir_all(dir).ok()?;
    let path = dir.join(format!("{name}.json"));
    std::fs::write(&path, input.to_json().ok()?).ok()?;
    Some(path.display().to_string())
}

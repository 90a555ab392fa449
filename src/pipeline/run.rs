//! The whole way from a skeleton to a checked, labelled mesh.

use super::assemble::{self, AssembleError};
use super::attempts;
use super::observer::{Observer, Stage};
use super::plan::{JointStyle, MeshPlan, PlanError};
use super::report::{BlockCounts, FailedBlock, FusedBlock, Meeting, MeshSize, RunReport};
use super::rounds::{self, Blocks, connector_ends, original_nodes};
use super::terminals::{self, NotATerminal};
use super::timing::Clock;
use crate::block::BlockDump;
use crate::mesh::check::{CheckReport, Expectation, check_volume_with};
use crate::mesh::{VolumeMesh, WALL};
use crate::partition::{ClusterId, CutId, PartitionError};
use crate::refine::split;
use crate::skeleton::{NodeId, Overlap, Overlaps, Skeleton};
use std::collections::BTreeMap;

/// A mesh, what it has to be, what was found, what was done.
#[derive(Debug)]
#[non_exhaustive]
pub struct Meshed {
    /// The mesh.
    pub mesh: VolumeMesh,
    /// What the network asks of it.
    pub expectation: Expectation,
    /// The result of the check.
    pub check: CheckReport,
    /// What was done.
    pub report: RunReport,
}

/// Why there is no mesh.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The plan cannot be run.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A root that is none.
    #[error(transparent)]
    Root(#[from] NotATerminal),
    /// The network could not be partitioned.
    #[error(transparent)]
    Partition(#[from] PartitionError),
    /// Blocks failed to the end; the report lists them.
    #[error("{} block(s) could not be meshed", .0.failed.len())]
    BlocksFailed(Box<RunReport>),
    /// Blocks do not fit together: a fault of the program.
    #[error("{0}; this is a fault of the program")]
    Assemble(#[from] AssembleError),
}

/// Meshes a cleaned network. Uses the current rayon pool; the result does not depend on its size.
///
/// # Errors
/// See [`RunError`]. With `plan.keep_going`, blocks that fail are left out and listed in the report instead.
pub fn mesh_network(
    network: &Skeleton,
    plan: &MeshPlan,
    observer: &dyn Observer,
    clock: &mut Clock,
) -> Result<Meshed, RunError> {
    plan.validate()?;
    let mut report = RunReport::default();
    let (skeleton, overlaps) = clock.time(observer, Stage::Prepare, 0, || prepare(network, &mut report));
    let terminals = terminals::assign(&skeleton, &plan.roots)?;
    announce(&report, observer);
    let blocks = rounds::build(&skeleton, &overlaps, plan, observer, clock)?;
    describe_blocks(&skeleton, plan, &blocks, &mut report);
    let nothing_left = blocks.clusters.iter().all(Result::is_err);
    if !report.failed.is_empty() && (nothing_left || !plan.keep_going) {
        report.stages = clock.stages();
        return Err(RunError::BlocksFailed(Box::new(report)));
    }
    let mut expectation = expectation(&skeleton);
    if plan.fuse {
        expectation.loops = fused_loops(&blocks);
    }
    let mut assembly = clock.time(observer, Stage::Merge, 0, || assemble::join(&skeleton, blocks, &terminals))?;
    if !plan.frozen_joints {
        report.joints = Some(clock.time(observer, Stage::Joints, 0, || assembly.smooth()));
    }
    let (mesh, neighbors) = clock.time(observer, Stage::Merge, 0, || assembly.label())?;
    let check = clock.time(observer, Stage::Check, 0, || check_volume_with(&mesh, neighbors, Some(&expectation)));
    report.mesh = size(&mesh);
    report.stages = clock.stages();
    Ok(Meshed { mesh, expectation, check, report })
}

/// Splits nodes of high valence and looks for vessels that overlap.
fn prepare(network: &Skeleton, report: &mut RunReport) -> (Skeleton, Overlaps) {
    let (skeleton, splits) = split(network);
    report.network = [skeleton.nodes.len(), skeleton.edges.len()];
    report.nodes_split = splits.nodes.len();
    let original = |node: NodeId| skeleton.node(node).original;
    let meeting = |o: &Overlap| Meeting {
        edges: o.edges.map(|e| skeleton.edge(e).nodes.map(original)),
        distance: o.distance,
        radii: o.radii,
    };
    let overlaps = skeleton.overlaps(&skeleton.adjacency());
    report.overlaps = overlaps.pairs.iter().map(meeting).collect();
    report.unconnected = overlaps.unconnected.iter().map(|e| e.map(|e| skeleton.edge(e).nodes.map(original))).collect();
    (skeleton, overlaps)
}

/// How many overlapping pairs are spelt out for people.
const LISTED: usize = 50;

fn announce(report: &RunReport, observer: &dyn Observer) {
    let more = |n: usize| {
        if n > LISTED {
            observer.note(&format!("  and {} more (--json lists all)", n - LISTED));
        }
    };
    let n = report.overlaps.len();
    if n > 0 {
        observer.note(&format!("{n} pairs of vessels overlap; the wall may meet itself there (edges by their nodes):"));
        for o in report.overlaps.iter().take(LISTED) {
            let [[a, b], [c, d]] = o.edges;
            observer.note(&format!("  {a}-{b} and {c}-{d}: distance {:.4}, radii {:.4}", o.distance, o.radii));
        }
        more(n);
    }
    let n = report.unconnected.len();
    if n > 0 {
        observer.note(&format!("{n} pairs of edges that share no node meet (neighbours along a vessel included):"));
        for [[a, b], [c, d]] in report.unconnected.iter().take(LISTED) {
            observer.note(&format!("  {a}-{b} and {c}-{d}"));
        }
        more(n);
    }
}

fn describe_blocks(skeleton: &Skeleton, plan: &MeshPlan, blocks: &Blocks, report: &mut RunReport) {
    let partition = &blocks.partition;
    report.blocks = BlockCounts {
        clusters: partition.clusters.len(),
        connectors: partition.cuts.len(),
        largest_cluster_nodes: partition.clusters.iter().map(|c| c.nodes.len()).max().unwrap_or(0),
    };
    report.partition = Some(partition.summary());
    report.retries.clone_from(&blocks.retries);
    for (i, (cluster, mesh)) in partition.clusters.iter().zip(&blocks.clusters).enumerate() {
        let nodes = || original_nodes(skeleton, cluster.nodes.iter().copied());
        if let Ok(mesh) = mesh
            && (mesh.handles != mesh.loops || !mesh.uncapped.is_empty())
        {
            report.fused.push(FusedBlock {
                block: format!("cluster {i}"),
                nodes: nodes(),
                handles: mesh.handles,
                loops: mesh.loops,
                uncapped: original_nodes(skeleton, mesh.uncapped.iter().copied()),
            });
        }
        if let Err(error) = mesh {
            report.failed.push(FailedBlock {
                block: format!("cluster {i}"),
                nodes: original_nodes(skeleton, cluster.nodes.iter().copied()),
                reason: error.to_string(),
                dump: write_dump(
                    plan,
                    &format!("cluster_{i}"),
                    &attempts::cluster_input(ClusterId(i as u32), cluster, plan),
                ),
            });
        }
    }
    for (i, (cut, mesh)) in partition.cuts.iter().zip(&blocks.connectors).enumerate() {
        let Some(Err(error)) = mesh else { continue };
        let id = CutId(i as u32);
        let input = match plan.joint {
            JointStyle::Woven => connector_ends(partition, cut, &blocks.clusters)
                .map(|ends| attempts::connector_input(id, cut, ends, plan)),
            JointStyle::Disc => attempts::free_connector_input(id, cut, plan),
        };
        report.failed.push(FailedBlock {
            block: format!("connector {i}"),
            nodes: rounds::cut_nodes(skeleton, partition, cut),
            reason: error.to_string(),
            dump: input.and_then(|input| write_dump(plan, &format!("connector_{i}"), &input)),
        });
    }
}

/// Writes the input of a failed block; none when there is no folder for it or it cannot be written.
fn write_dump(plan: &MeshPlan, name: &str, input: &BlockDump) -> Option<String> {
    let dir = plan.dump_dir.as_ref()?;
    std::fs::create_dir_all(dir).ok()?;
    let path = dir.join(format!("{name}.json"));
    std::fs::write(&path, input.to_json().ok()?).ok()?;
    Some(path.display().to_string())
}

/// What the network asks of its mesh.
fn expectation(skeleton: &Skeleton) -> Expectation {
    let adjacency = skeleton.adjacency();
    let components = skeleton.components(&adjacency);
    Expectation {
        loops: components.list.iter().map(|c| c.loops() as u32).collect(),
        terminals: adjacency.terminals().iter().map(|&n| skeleton.node(n).original).collect(),
    }
}

/// Loops of each connected piece when vessels are meshed together on purpose: the handles of its clusters, and the loops
/// of the graph in which clusters are nodes and connectors are edges. Sorted, as pieces have no other name.
fn fused_loops(blocks: &Blocks) -> Vec<u32> {
    let clusters = &blocks.partition.clusters;
    let mut piece: Vec<usize> = (0..clusters.len()).collect();
    let root = |piece: &mut [usize], mut i: usize| {
        while piece[i] != i {
            piece[i] = piece[piece[i]];
            i = piece[i];
        }
        i
    };
    for cut in &blocks.partition.cuts {
        let [a, b] = cut.sides.map(|(cluster, _)| root(&mut piece, cluster.0 as usize));
        piece[a.max(b)] = a.min(b);
    }
    let mut loops: BTreeMap<usize, i64> = BTreeMap::new();
    for (i, cluster) in blocks.clusters.iter().enumerate() {
        let handles = cluster.as_ref().map_or(0, |mesh| mesh.handles);
        *loops.entry(root(&mut piece, i)).or_insert(1) += handles - 1;
    }
    for cut in &blocks.partition.cuts {
        *loops.entry(root(&mut piece, cut.sides[0].0.0 as usize)).or_insert(1) += 1;
    }
    let mut loops: Vec<u32> = loops.into_values().map(|n| u32::try_from(n).unwrap_or(0)).collect();
    loops.sort_unstable();
    loops
}

fn size(mesh: &VolumeMesh) -> MeshSize {
    let wall = mesh.boundary_patch.iter().filter(|&&p| p == WALL).count();
    MeshSize {
        tets: mesh.mesh.tets.len(),
        points: mesh.mesh.points.len(),
        wall_triangles: wall,
        cap_triangles: mesh.boundary.len() - wall,
    }
}

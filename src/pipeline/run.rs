//! Meshing of a skeleton, up to a checked and labelled mesh.

use std::collections::BTreeMap;
use std::io;
use std::sync::Arc;

use super::apart::Apart;
use super::blocks::Blocks;
use super::describe::{Topology, announce, describe_blocks};
use super::error::RunError;
use super::estimate::{Estimate, TooLarge};
use super::make::Workshop;
use super::plan::{JointStyle, MeshPlan};
use super::report::{Meeting, RunReport};
use super::rounds::RunContext;
use super::routes::Uncut;
use super::seen::Seen;
use super::store::Store;
use super::timing::Clock;
use super::whole::Whole;
use crate::partition::CutId;
use anastomesh_flow::TerminalPatches;
use anastomesh_mesh::VolumeMesh;
use anastomesh_mesh::check::parts::PartsCheck;
use anastomesh_mesh::check::{CheckReport, Expectation};
use anastomesh_mesh::progress::{Progress, Stage, ask};
use anastomesh_mesh::source::MeshSource;
use anastomesh_network::split_shared;
use anastomesh_skeleton::{NodeId, Overlap, Overlaps, Skeleton};

/// Mesh of a network, with its expected topology, check and report.
#[derive(Debug)]
#[non_exhaustive]
pub struct Meshed<M = VolumeMesh> {
    /// Mesh with a labelled boundary: in memory, or to be read from its store in passes.
    pub mesh: M,
    /// Expected topology.
    pub expectation: Expectation,
    /// Result of the check.
    pub check: CheckReport,
    /// Report of the run.
    pub report: RunReport,
    /// Network that was meshed: the given one with nodes of more than three vessels split.
    pub network: Arc<Skeleton>,
}

/// Meshes a cleaned network into a store. The mesh is never in memory as a whole. Joints are not smoothed. Uses the
/// current rayon pool; the result does not depend on its size.
///
/// `fits` receives the estimate of the run before any block is meshed, and may refuse it. Passes over the result also ask
/// `progress` whether to stop; a cancelled pass ends with an error of the kind `Other`.
///
/// ```
/// use anastomesh::io::{MeshNotes, NetworkOptions, read_network, write_mesh};
/// use anastomesh::meshing::{MeshPlan, Store, mesh_into};
/// use anastomesh::network::clean;
///
/// let file = read_network("fixtures/tree_30.swc".as_ref(), &NetworkOptions::default())?;
/// let (network, _) = clean(&file.skeleton)?;
/// let folder = tempfile::tempdir()?;
/// let store = Store::in_passing(folder.path())?;
/// let made = mesh_into(&store, &network, &MeshPlan::default(), &|_| Ok(()), &())?;
/// assert!(made.check.is_valid());
/// write_mesh(&folder.path().join("tree.vtu"), &made.mesh, &MeshNotes::default())?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// See [`RunError`]. With `plan.keep_going`, blocks that fail are left out and listed in the report instead.
pub fn mesh_into<'a>(
    store: &'a Store,
    network: &Skeleton,
    plan: &MeshPlan,
    fits: &dyn Fn(&Estimate) -> Result<(), TooLarge>,
    progress: &'a dyn Progress,
) -> Result<Meshed<Whole<'a>>, RunError> {
    mesh_shared(store, &Arc::new(network.clone()), plan, fits, progress)
}

/// Meshes a shared network into a store.
pub(crate) fn mesh_shared<'a>(
    store: &'a Store,
    network: &Arc<Skeleton>,
    plan: &MeshPlan,
    fits: &dyn Fn(&Estimate) -> Result<(), TooLarge>,
    progress: &'a dyn Progress,
) -> Result<Meshed<Whole<'a>>, RunError> {
    mesh_timed(store, network, plan, fits, progress, &mut Clock::default())
}

pub(super) fn mesh_timed<'a>(
    store: &'a Store,
    network: &Arc<Skeleton>,
    plan: &MeshPlan,
    fits: &dyn Fn(&Estimate) -> Result<(), TooLarge>,
    progress: &'a dyn Progress,
    clock: &mut Clock,
) -> Result<Meshed<Whole<'a>>, RunError> {
    let job = Job::of(network, plan, store, progress, clock)?;
    let mut run = job.run(clock);
    let mut blocks = run.build(&Uncut::default(), None, fits)?;
    let mut apart = Apart::default();
    loop {
        let whole = job.numbered(&mut blocks, clock)?;
        let looked = clock.time(progress, Stage::Check, 0, || whole.look(plan.memory))?;
        ask(progress)?;
        // Intersecting blocks are made again without checking all others. Then all blocks are checked again, because only the
        // check of the whole mesh decides. Woven connectors depend on their clusters, so they are excepted.
        let mut run = job.run(clock);
        if plan.joint != JointStyle::Woven && apart.part(&whole.blocks_that_meet(&looked), &blocks, &run) {
            let seen = Seen::of(&blocks, &whole, looked);
            drop(whole);
            blocks = run.part(blocks, &mut apart, seen)?;
            continue;
        }
        // Data of the blocks is dropped before the rest is checked.
        let meshed = Arc::clone(&job.skeleton);
        let (mut report, expectation) = job.described(blocks)?;
        let rest = || looked.check(whole.patches(), Some(&expectation));
        let PartsCheck { report: check, .. } = clock.time(progress, Stage::Check, 0, rest)?;
        ask(progress)?;
        report.mesh = whole.size();
        report.stages = clock.stages();
        return Ok(Meshed { mesh: whole, expectation, check, report, network: meshed });
    }
}

/// Input and store of a run.
pub(super) struct Job<'a, 'b> {
    pub(super) skeleton: Arc<Skeleton>,
    overlaps: Overlaps,
    terminals: TerminalPatches,
    plan: &'b MeshPlan,
    store: &'a Store,
    progress: &'a dyn Progress,
    report: RunReport,
}

impl<'a, 'b> Job<'a, 'b> {
    pub(super) fn of(
        network: &Arc<Skeleton>,
        plan: &'b MeshPlan,
        store: &'a Store,
        progress: &'a dyn Progress,
        clock: &mut Clock,
    ) -> Result<Self, RunError> {
        plan.validate()?;
        let mut report = RunReport::default();
        let (skeleton, overlaps) = clock.time(progress, Stage::Prepare, 0, || prepare(network, &mut report));
        let terminals = TerminalPatches::assign(&skeleton, &plan.roots)?;
        announce(&report, progress);
        Ok(Self { skeleton, overlaps, terminals, plan, store, progress, report })
    }

    fn shop(&self) -> Workshop<'_> {
        Workshop::new(&self.skeleton, self.plan, self.store)
    }

    pub(super) fn run<'c>(&'c self, clock: &'c mut Clock) -> RunContext<'c> {
        RunContext { overlaps: &self.overlaps, shop: self.shop(), progress: self.progress, clock }
    }

    /// Combines all blocks.
    ///
    /// # Errors
    /// Blocks failed without `keep_going`, there are too many vertices, or the work directory cannot be written.
    pub(super) fn numbered(&self, blocks: &mut Blocks, clock: &mut Clock) -> Result<Whole<'a>, RunError> {
        let Self { skeleton, terminals, plan, store, progress, .. } = self;
        let nothing_left = blocks.clusters.iter().all(Result::is_err);
        let number = || Whole::new(store, *progress, skeleton, blocks, terminals);
        if blocks.any_failed() && (nothing_left || !plan.keep_going) {
            // What there is can be looked at.
            if !nothing_left {
                number()?.leave()?;
            }
            let mut report = self.report.clone();
            describe_blocks(skeleton, &self.shop(), blocks, &mut report)?;
            report.stages = clock.stages();
            return Err(RunError::BlocksFailed(Box::new(report)));
        }
        let whole = clock.time(*progress, Stage::Merge, 0, number)?;
        whole.leave()?;
        Ok(whole)
    }

    /// Report of the run and expected topology.
    pub(super) fn described(self, mut blocks: Blocks) -> io::Result<(RunReport, Expectation)> {
        let mut report = self.report.clone();
        let topology = describe_blocks(&self.skeleton, &self.shop(), &mut blocks, &mut report)?;
        let mut expectation = expectation(&self.skeleton, &blocks, &topology);
        if self.plan.fuse {
            expectation.loops = fused_loops(&blocks, &topology.handles);
        }
        Ok((report, expectation))
    }
}

/// Splits nodes of high valence and looks for vessels that overlap.
fn prepare(network: &Arc<Skeleton>, report: &mut RunReport) -> (Arc<Skeleton>, Overlaps) {
    let (skeleton, splits) = split_shared(network);
    report.network = [skeleton.nodes.len(), skeleton.edges.len()];
    report.nodes_split = splits.nodes.len();
    let original = |node: NodeId| skeleton.node(node).original;
    let adjacency = skeleton.adjacency();
    let vessel_of = skeleton.branches(&adjacency).of_edge;
    let meeting = |o: &Overlap| Meeting {
        edges: o.edges.map(|e| skeleton.edge(e).nodes.map(original)),
        vessels: o.edges.map(|e| vessel_of[e.index()].0.0),
        distance: o.distance,
        radii: o.radii,
    };
    let overlaps = skeleton.overlaps(&adjacency);
    report.overlaps = overlaps.pairs.iter().map(meeting).collect();
    report.unconnected = overlaps.unconnected.iter().map(|e| e.map(|e| skeleton.edge(e).nodes.map(original))).collect();
    (skeleton, overlaps)
}

/// Expected topology of the mesh. Loops that are filled by their own lumen are not counted.
fn expectation(skeleton: &Skeleton, blocks: &Blocks, topology: &Topology) -> Expectation {
    let adjacency = skeleton.adjacency();
    let components = skeleton.components(&adjacency);
    let mut loops: Vec<u32> = components.list.iter().map(|c| c.loops() as u32).collect();
    for &(cluster, filled) in &topology.filled {
        if let Some(node) = blocks.partition.nodes(cluster).first() {
            let of_component = &mut loops[components.of_node[node.index()] as usize];
            *of_component = of_component.saturating_sub(u32::try_from(filled).unwrap_or(0));
        }
    }
    Expectation { loops, terminals: adjacency.terminals().iter().map(|&n| skeleton.node(n).original).collect() }
}

/// Loops of each connected piece when vessels are fused on purpose, sorted because pieces have no names.
///
/// They are the handles of its clusters, and the loops of the graph with clusters as nodes and connectors as edges.
fn fused_loops(blocks: &Blocks, handles: &[i64]) -> Vec<u32> {
    let sides = || (0..blocks.partition.cuts_len() as u32).map(|cut| blocks.partition.sides_of_cut(CutId(cut)));
    let mut piece: Vec<usize> = (0..blocks.partition.clusters_len()).collect();
    let root = |piece: &mut [usize], mut i: usize| {
        while piece[i] != i {
            piece[i] = piece[piece[i]];
            i = piece[i];
        }
        i
    };
    for cut in sides() {
        let [a, b] = cut.map(|(cluster, _)| root(&mut piece, cluster.0 as usize));
        piece[a.max(b)] = a.min(b);
    }
    let mut loops: BTreeMap<usize, i64> = BTreeMap::new();
    for (i, handles) in handles.iter().enumerate() {
        *loops.entry(root(&mut piece, i)).or_insert(1) += handles - 1;
    }
    for [(cluster, _), _] in sides() {
        *loops.entry(root(&mut piece, cluster.0 as usize)).or_insert(1) += 1;
    }
    let mut loops: Vec<u32> = loops.into_values().map(|n| u32::try_from(n).unwrap_or(0)).collect();
    loops.sort_unstable();
    loops
}

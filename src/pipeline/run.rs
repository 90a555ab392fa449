//! The whole way from a skeleton to a checked, labelled mesh.

use std::collections::BTreeMap;
use std::io;
use std::sync::Arc;

use super::apart::Apart;
use super::attempts::Way;
use super::blocks::Blocks;
use super::describe::{Clusters, announce, describe_blocks};
use super::error::RunError;
use super::estimate::{Estimate, TooLarge};
use super::make::Workshop;
use super::plan::{JointStyle, MeshPlan};
use super::report::{Meeting, MeshSize, RunReport};
use super::rounds::Run;
use super::routes::Overlapping;
use super::store::Store;
use super::terminals;
use super::timing::Clock;
use super::whole::Whole;
use crate::mesh::check::parts::PartsCheck;
use crate::mesh::check::{CheckReport, Expectation, check_volume_with};
use crate::mesh::source::{MeshSource, SourceCounts, gather};
use crate::mesh::{VolumeMesh, WALL};
use crate::partition::{ClusterId, CutId, Layout};
use crate::progress::{Progress, Stage, ask};
use crate::refine::split;
use crate::skeleton::{NodeId, Overlap, Overlaps, Skeleton};
use crate::woven::Assembly;

/// A mesh in memory, what it has to be, what was found, what was done.
#[derive(Debug)]
#[non_exhaustive]
pub struct Meshed {
    /// The mesh of the network, its boundary labelled.
    pub mesh: VolumeMesh,
    /// What the network asks of it.
    pub expectation: Expectation,
    /// The result of the check.
    pub check: CheckReport,
    /// What was done.
    pub report: RunReport,
}

/// A mesh whose blocks are in a store, what it has to be, what was found, what was done.
#[derive(Debug)]
#[non_exhaustive]
pub struct Stored<'a> {
    /// The mesh, to be read in passes.
    pub whole: Whole<'a>,
    /// What the network asks of it.
    pub expectation: Expectation,
    /// The result of the check.
    pub check: CheckReport,
    /// What was done.
    pub report: RunReport,
}

/// Meshes a cleaned network in memory. Uses the current rayon pool; the result does not depend on its size.
///
/// ```
/// use anastomesh::io::{NetworkOptions, read_network};
/// use anastomesh::network::{MeshPlan, clean, mesh_network};
///
/// let file = read_network("fixtures/tree_30.swc".as_ref(), &NetworkOptions::default())?;
/// let (network, _) = clean(&file.skeleton)?;
/// let made = mesh_network(&network, &MeshPlan::default(), &())?;
/// assert!(made.check.is_valid(), "{}", made.check);
/// assert_eq!(made.mesh.patches[0].name, "wall");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// See [`RunError`]. With `plan.keep_going`, blocks that fail are left out and listed in the report instead.
pub fn mesh_network(network: &Skeleton, plan: &MeshPlan, progress: &dyn Progress) -> Result<Meshed, RunError> {
    let store = Store::in_memory();
    let clock = &mut Clock::default();
    if plan.smooths_joints() {
        return join_blocks(network, plan, &store, &Apart::default(), &|_| Ok(()), progress, clock)?
            .smoothed(progress, clock);
    }
    let Stored { whole, expectation, check, mut report } =
        mesh_timed(&store, network, plan, &|_| Ok(()), progress, clock)?;
    let mesh = clock.time(progress, Stage::Merge, 0, || gather(&whole))?;
    report.stages = clock.stages();
    Ok(Meshed { mesh, expectation, check, report })
}

/// Meshes a cleaned network into a store; the mesh is never in memory as a whole. Joints are not smoothed. Uses the
/// current rayon pool; the result does not depend on its size. `fits` hears what the run will take before anything is
/// meshed, and may refuse. `progress` is also asked by every pass over what comes of it: one that is to stop ends with
/// an error of the kind `Other`.
///
/// ```
/// use anastomesh::io::{MeshNotes, NetworkOptions, read_network, write_mesh};
/// use anastomesh::network::{MeshPlan, Store, clean, mesh_into};
///
/// let file = read_network("fixtures/tree_30.swc".as_ref(), &NetworkOptions::default())?;
/// let (network, _) = clean(&file.skeleton)?;
/// let folder = tempfile::tempdir()?;
/// let store = Store::in_passing(folder.path())?;
/// let made = mesh_into(&store, &network, &MeshPlan::default(), &|_| Ok(()), &())?;
/// assert!(made.check.is_valid());
/// write_mesh(&folder.path().join("tree.vtu"), &made.whole, &MeshNotes::default())?;
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
) -> Result<Stored<'a>, RunError> {
    mesh_timed(store, network, plan, fits, progress, &mut Clock::default())
}

fn mesh_timed<'a>(
    store: &'a Store,
    network: &Skeleton,
    plan: &MeshPlan,
    fits: &dyn Fn(&Estimate) -> Result<(), TooLarge>,
    progress: &'a dyn Progress,
    clock: &mut Clock,
) -> Result<Stored<'a>, RunError> {
    // What is in memory for the blocks is not while the whole is checked. In the rare case that blocks meet everything is
    // done again, which finds all blocks but these in the store. Woven connectors belong to the clusters as they are.
    let mut apart = Apart::default();
    loop {
        let joined = join_blocks(network, plan, store, &apart, fits, progress, clock)?;
        ask(progress)?;
        let (stored, goes_on) = joined.checked(plan, &mut apart, progress, clock)?;
        ask(progress)?;
        if !goes_on {
            return Ok(stored);
        }
    }
}

/// Blocks that are done and numbered, before anybody has looked at the whole.
struct Joined<'a> {
    whole: Whole<'a>,
    expectation: Expectation,
    overlapping: Overlapping,
    partition: Layout,
    report: RunReport,
}

/// `apart`: what is done about blocks that met when this was done before.
fn join_blocks<'a>(
    network: &Skeleton,
    plan: &MeshPlan,
    store: &'a Store,
    apart: &Apart,
    fits: &dyn Fn(&Estimate) -> Result<(), TooLarge>,
    progress: &'a dyn Progress,
    clock: &mut Clock,
) -> Result<Joined<'a>, RunError> {
    plan.validate()?;
    let mut report = RunReport::default();
    let (skeleton, overlaps) = clock.time(progress, Stage::Prepare, 0, || prepare(network, &mut report));
    let terminals = terminals::assign(&skeleton, &plan.roots)?;
    let first = apart.met.is_empty() && apart.uncut.is_empty();
    if first {
        announce(&report, progress);
    }
    let shop = Workshop { skeleton: &skeleton, plan, store };
    let mut run = Run { overlaps: &overlaps, shop, tells: first, progress, clock };
    let mut blocks = run.build(&apart.uncut, if first { fits } else { &|_| Ok(()) })?;
    for (way, meetings) in Way::APART.into_iter().zip(&apart.met) {
        run.set_apart(&mut blocks, meetings, way)?;
    }
    let overlapping = Overlapping::of(&skeleton, &blocks.partition, &overlaps);
    let clusters = Clusters::of(&shop, &blocks)?;
    describe_blocks(&skeleton, &shop, &blocks, &clusters, &mut report)?;
    let nothing_left = blocks.clusters.iter().all(Result::is_err);
    let number = || Whole::new(store, progress, &skeleton, &blocks, &terminals);
    if !report.failed.is_empty() && (nothing_left || !plan.keep_going) {
        // What there is can be looked at.
        #[cfg(feature = "cli")]
        if !nothing_left {
            number()?.leave()?;
        }
        report.stages = clock.stages();
        return Err(RunError::BlocksFailed(Box::new(report)));
    }
    let mut expectation = expectation(&skeleton, &blocks, &clusters);
    if plan.fuse {
        expectation.loops = fused_loops(&blocks, &clusters);
    }
    let whole = clock.time(progress, Stage::Merge, 0, number)?;
    #[cfg(feature = "cli")]
    whole.leave()?;
    Ok(Joined { whole, expectation, overlapping, partition: blocks.partition, report })
}

impl<'a> Joined<'a> {
    /// With the mesh comes whether it is made again, because blocks of it meet.
    fn checked(
        self,
        plan: &MeshPlan,
        apart: &mut Apart,
        progress: &dyn Progress,
        clock: &mut Clock,
    ) -> io::Result<(Stored<'a>, bool)> {
        let Self { whole, expectation, overlapping, partition, mut report } = self;
        let check = || whole.check(&expectation, plan.memory);
        let PartsCheck { report: check, meeting } = clock.time(progress, Stage::Check, 0, check)?;
        report.mesh = whole.size();
        report.stages = clock.stages();
        let goes_on = plan.joint != JointStyle::Woven && apart.part(meeting, &partition, &overlapping);
        Ok((Stored { whole, expectation, check, report }, goes_on))
    }

    fn smoothed(self, progress: &dyn Progress, clock: &mut Clock) -> Result<Meshed, RunError> {
        let Self { whole, expectation, mut report, .. } = self;
        ask(progress)?;
        let mut assembly = clock.time(progress, Stage::Merge, 0, || Assembly::new(&whole, whole.joint_vertices()?))?;
        report.joints = Some(clock.time(progress, Stage::Joints, 0, || assembly.smooth(progress)));
        ask(progress)?;
        let (mesh, neighbors) = clock.time(progress, Stage::Merge, 0, || assembly.label())?;
        ask(progress)?;
        let check = || check_volume_with(&mesh, neighbors, Some(&expectation));
        let check = clock.time(progress, Stage::Check, 0, check);
        report.mesh = mesh_size(&mesh)?;
        report.stages = clock.stages();
        Ok(Meshed { mesh, expectation, check, report })
    }
}

/// Counts a mesh, in one pass over its boundary.
fn mesh_size(mesh: &dyn MeshSource) -> io::Result<MeshSize> {
    let SourceCounts { points, tets, boundary } = mesh.counts();
    let mut wall_triangles = 0;
    mesh.each_faces(|piece| {
        wall_triangles += piece.patches.iter().filter(|&&patch| patch == WALL).count();
        Ok(())
    })?;
    Ok(MeshSize { tets, points, wall_triangles, cap_triangles: boundary - wall_triangles })
}

/// Splits nodes of high valence and looks for vessels that overlap.
fn prepare(network: &Skeleton, report: &mut RunReport) -> (Arc<Skeleton>, Overlaps) {
    let (skeleton, splits) = split(network);
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
    (Arc::new(skeleton), overlaps)
}

/// What the network asks of its mesh. Loops that are filled by their own lumen are none of the mesh.
fn expectation(skeleton: &Skeleton, blocks: &Blocks, clusters: &Clusters) -> Expectation {
    let adjacency = skeleton.adjacency();
    let components = skeleton.components(&adjacency);
    let mut loops: Vec<u32> = components.list.iter().map(|c| c.loops() as u32).collect();
    for (cluster, about) in (0..).zip(&clusters.0) {
        if let (Some(node), Some(about)) = (blocks.partition.nodes(ClusterId(cluster)).first(), about) {
            let of_component = &mut loops[components.of_node[node.index()] as usize];
            *of_component = of_component.saturating_sub(u32::try_from(about.filled).unwrap_or(0));
        }
    }
    Expectation { loops, terminals: adjacency.terminals().iter().map(|&n| skeleton.node(n).original).collect() }
}

/// Loops of each connected piece when vessels are meshed together on purpose: the handles of its clusters, and the loops
/// of the graph in which clusters are nodes and connectors are edges. Sorted, as pieces have no other name.
fn fused_loops(blocks: &Blocks, about: &Clusters) -> Vec<u32> {
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
    for (i, about) in about.0.iter().enumerate() {
        let handles = about.as_ref().map_or(0, |about| about.handles);
        *loops.entry(root(&mut piece, i)).or_insert(1) += handles - 1;
    }
    for [(cluster, _), _] in sides() {
        *loops.entry(root(&mut piece, cluster.0 as usize)).or_insert(1) += 1;
    }
    let mut loops: Vec<u32> = loops.into_values().map(|n| u32::try_from(n).unwrap_or(0)).collect();
    loops.sort_unstable();
    loops
}

//! All blocks of a network, with retries: a block that fails is tried with other parameters, then with its cuts moved,
//! then joined to its neighbours.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use rayon::prelude::*;

use super::attempts::{self, Tried};
use super::observer::{Observer, Stage};
use super::plan::{JointStyle, MeshPlan};
use super::report::Retry;
use super::timing::Clock;
use crate::block::{BlockError, ClusterMesh, ConnectorEnd, ConnectorMesh};
use crate::partition::{self, Cluster, ClusterId, Cut, CutId, EndKind, Partition, PartitionError, PartitionParams};
use crate::skeleton::{BranchId, NodeId, Overlaps, Skeleton};

/// How often the partition is changed because of blocks that fail.
const ROUNDS: usize = 6;

/// How many nodes of a block a report lists.
const LISTED: usize = 20;

/// The blocks of a network.
#[derive(Debug)]
pub struct Blocks {
    /// The partition that they belong to.
    pub partition: Partition,
    /// By `ClusterId`; an error for a cluster that failed to the end.
    pub clusters: Vec<Result<Arc<ClusterMesh>, BlockError>>,
    /// By `CutId`; none beside a failed cluster.
    pub connectors: Vec<Option<Result<Arc<ConnectorMesh>, BlockError>>>,
    /// What was retried.
    pub retries: Vec<Retry>,
}

/// How far the cure of a branch whose cut gave trouble has gone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cure {
    /// The plane at the branch's start is moved towards its end.
    Forward,
    /// The plane at its end is moved towards its start.
    Backward,
    /// It is not cut: its clusters are joined.
    NotCut,
}

/// Share of the room by which a plane is moved.
const SHIFT: f64 = 0.5;

/// Meshes every block, changing the partition where blocks fail.
///
/// # Errors
/// When the network cannot be partitioned.
pub fn build(
    skeleton: &Skeleton,
    overlaps: &Overlaps,
    plan: &MeshPlan,
    observer: &dyn Observer,
    clock: &mut Clock,
) -> Result<Blocks, PartitionError> {
    let mut cures: BTreeMap<BranchId, Cure> = BTreeMap::new();
    let together = if plan.fuse { overlapping_branches(skeleton, overlaps) } else { BTreeSet::new() };
    let mut retries = Vec::new();
    let mut settled: Option<Blocks> = None;
    let mut round = 0;
    loop {
        let partition = clock.time(observer, Stage::Partition, 0, || {
            partition::partition(skeleton, &partition_params(plan, &cures, &together))
        })?;
        let reuse = Reuse::new(settled.as_ref());
        let tangled = tangled_clusters(skeleton, &partition, overlaps);
        let (clusters, connectors) = match plan.joint {
            JointStyle::Woven => {
                two_passes(skeleton, &partition, &tangled, plan, &reuse, observer, clock, &mut retries)
            }
            JointStyle::Disc => one_pass(skeleton, &partition, &tangled, plan, &reuse, observer, clock, &mut retries),
        };
        let blocks = Blocks { partition, clusters, connectors, retries: Vec::new() };
        let found = if round < ROUNDS { cure(skeleton, &blocks, &mut cures) } else { Vec::new() };
        if found.is_empty() {
            let mut blocks = Blocks { retries, ..blocks };
            if plan.joint == JointStyle::Disc {
                name_shared_vertices(&mut blocks);
            }
            return Ok(blocks);
        }
        retries.extend(found);
        settled = Some(blocks);
        round += 1;
    }
}

type Clusters = Vec<Result<Arc<ClusterMesh>, BlockError>>;
type Connectors = Vec<Option<Result<Arc<ConnectorMesh>, BlockError>>>;

/// Clusters first, then the connectors between them.
#[allow(clippy::too_many_arguments)]
fn two_passes(
    skeleton: &Skeleton,
    partition: &Partition,
    tangled: &[bool],
    plan: &MeshPlan,
    reuse: &Reuse,
    observer: &dyn Observer,
    clock: &mut Clock,
    retries: &mut Vec<Retry>,
) -> (Clusters, Connectors) {
    let clusters = clock.time(observer, Stage::Clusters, partition.clusters.len() as u64, || {
        let mesh = |i: usize| mesh_cluster(partition, tangled, plan, reuse, observer, i);
        (0..partition.clusters.len()).into_par_iter().with_max_len(1).map(mesh).collect()
    });
    let clusters = note_clusters(skeleton, partition, clusters, retries);
    let connectors = clock.time(observer, Stage::Connectors, partition.cuts.len() as u64, || {
        mesh_connectors(partition, plan, &clusters, observer)
    });
    let connectors = note_connectors(skeleton, partition, connectors, retries);
    (clusters, connectors)
}

/// A block that was tried.
enum TriedBlock {
    Cluster(Tried<ClusterMesh>),
    Connector(Tried<ConnectorMesh>),
}

/// All blocks at once: none needs another.
#[allow(clippy::too_many_arguments)]
fn one_pass(
    skeleton: &Skeleton,
    partition: &Partition,
    tangled: &[bool],
    plan: &MeshPlan,
    reuse: &Reuse,
    observer: &dyn Observer,
    clock: &mut Clock,
    retries: &mut Vec<Retry>,
) -> (Clusters, Connectors) {
    let count = partition.clusters.len();
    let total = count + partition.cuts.len();
    let tried: Vec<TriedBlock> = clock.time(observer, Stage::Blocks, total as u64, || {
        let mesh = |i: usize| {
            if i < count {
                return TriedBlock::Cluster(mesh_cluster(partition, tangled, plan, reuse, observer, i));
            }
            let cut = &partition.cuts[i - count];
            let tried = match reuse.connector(cut) {
                Some(mesh) => Tried { result: Ok(mesh), failures: Vec::new() },
                None => attempts::free_connector(CutId((i - count) as u32), cut, plan),
            };
            observer.step();
            TriedBlock::Connector(tried)
        };
        (0..total).into_par_iter().with_max_len(1).map(mesh).collect()
    });
    let (mut clusters, mut connectors) = (Vec::with_capacity(count), Vec::with_capacity(total - count));
    for block in tried {
        match block {
            TriedBlock::Cluster(tried) => clusters.push(tried),
            TriedBlock::Connector(tried) => connectors.push(Some(tried)),
        }
    }
    let clusters = note_clusters(skeleton, partition, clusters, retries);
    let connectors = note_connectors(skeleton, partition, connectors, retries);
    (clusters, connectors)
}

/// Names the vertices that connectors share by those of their clusters, which have the discs' vertices in the discs'
/// order. A connector beside a failed cluster goes.
fn name_shared_vertices(blocks: &mut Blocks) {
    let Blocks { partition, clusters, connectors, .. } = blocks;
    for (cut, slot) in partition.cuts.iter().zip(connectors) {
        let Some(ends) = connector_ends(partition, cut, clusters) else {
            *slot = None;
            continue;
        };
        let Some(Ok(connector)) = slot else { continue };
        let vertices = ends.map(|end| end.surface.vertices());
        for shared in &mut Arc::make_mut(connector).shared {
            shared.vertex = vertices[usize::from(shared.side)].get(shared.vertex as usize).copied().unwrap_or(u32::MAX);
        }
    }
}

/// The branches of vessels that overlap.
fn overlapping_branches(skeleton: &Skeleton, overlaps: &Overlaps) -> BTreeSet<[BranchId; 2]> {
    let branches = skeleton.branches(&skeleton.adjacency());
    overlaps.pairs.iter().map(|o| o.edges.map(|e| branches.of_edge[e.index()].0)).collect()
}

fn partition_params(
    plan: &MeshPlan,
    cures: &BTreeMap<BranchId, Cure>,
    together: &BTreeSet<[BranchId; 2]>,
) -> PartitionParams {
    let mut params = PartitionParams {
        rho: plan.rho,
        kappa: plan.block_params().kappa,
        together: together.clone(),
        ..PartitionParams::default()
    };
    for (&branch, &cure) in cures {
        match cure {
            Cure::Forward => drop(params.shifted_cuts.insert(branch, SHIFT)),
            Cure::Backward => drop(params.shifted_cuts.insert(branch, -SHIFT)),
            Cure::NotCut => drop(params.forbidden_cuts.insert(branch)),
        }
    }
    params
}

/// Blocks of the round before, to be taken over where nothing changed.
struct Reuse<'a> {
    before: Option<&'a Blocks>,
    by_first_node: BTreeMap<NodeId, usize>,
    by_branch: BTreeMap<BranchId, Vec<usize>>,
}

impl<'a> Reuse<'a> {
    fn new(before: Option<&'a Blocks>) -> Self {
        let clusters = before.map_or(&[][..], |b| &b.partition.clusters);
        let first = |(i, c): (usize, &Cluster)| c.nodes.first().map(|&n| (n, i));
        let mut by_branch: BTreeMap<BranchId, Vec<usize>> = BTreeMap::new();
        for (i, cut) in before.iter().flat_map(|b| b.partition.cuts.iter().enumerate()) {
            by_branch.entry(cut.branch).or_default().push(i);
        }
        Self { before, by_first_node: clusters.iter().enumerate().filter_map(first).collect(), by_branch }
    }

    /// The mesh of a connector that has not changed, if it was made without its clusters.
    fn connector(&self, cut: &Cut) -> Option<Arc<ConnectorMesh>> {
        let before = self.before?;
        let i = *self.by_branch.get(&cut.branch)?.iter().find(|&&i| before.partition.cuts[i].path == cut.path)?;
        before.connectors[i].as_ref()?.as_ref().ok().cloned()
    }

    /// The mesh of a cluster that has not changed.
    fn cluster(&self, cluster: &Cluster) -> Option<Arc<ClusterMesh>> {
        let (before, &i) = (self.before?, self.by_first_node.get(cluster.nodes.first()?)?);
        same_shape(&before.partition.clusters[i], cluster).then(|| before.clusters[i].as_ref().ok().cloned()).flatten()
    }
}

/// Whether two clusters have the same geometry; the numbers of their cuts may differ.
fn same_shape(a: &Cluster, b: &Cluster) -> bool {
    a.tubes == b.tubes
        && a.ends.len() == b.ends.len()
        && a.ends.iter().zip(&b.ends).all(|(x, y)| x.section == y.section && x.overrun == y.overrun)
}

/// For each cluster, whether two vessels overlap that both run through it.
fn tangled_clusters(skeleton: &Skeleton, partition: &Partition, overlaps: &Overlaps) -> Vec<bool> {
    let branches = skeleton.branches(&skeleton.adjacency());
    let mut clusters_of: BTreeMap<BranchId, BTreeSet<ClusterId>> = BTreeMap::new();
    for piece in &partition.pieces {
        clusters_of.entry(piece.branch).or_default().insert(piece.cluster);
    }
    let mut tangled = vec![false; partition.clusters.len()];
    for pair in overlaps.pairs.iter().map(|o| &o.edges).chain(&overlaps.unconnected) {
        let [a, b] = pair.map(|e| clusters_of.get(&branches.of_edge[e.index()].0));
        for cluster in a.into_iter().flatten().filter(|c| b.is_some_and(|b| b.contains(c))) {
            tangled[cluster.0 as usize] = true;
        }
    }
    tangled
}

fn mesh_cluster(
    partition: &Partition,
    tangled: &[bool],
    plan: &MeshPlan,
    reuse: &Reuse,
    observer: &dyn Observer,
    i: usize,
) -> Tried<ClusterMesh> {
    let cluster = &partition.clusters[i];
    let tried = match reuse.cluster(cluster) {
        Some(mesh) => Tried { result: Ok(mesh), failures: Vec::new() },
        None => attempts::cluster(ClusterId(i as u32), cluster, plan, tangled[i]),
    };
    observer.step();
    tried
}

fn mesh_connectors(
    partition: &Partition,
    plan: &MeshPlan,
    clusters: &[Result<Arc<ClusterMesh>, BlockError>],
    observer: &dyn Observer,
) -> Vec<Option<Tried<ConnectorMesh>>> {
    let mesh = |(i, cut): (usize, &Cut)| {
        let id = CutId(i as u32);
        let tried = connector_ends(partition, cut, clusters).map(|ends| attempts::connector(id, cut, ends, plan));
        observer.step();
        tried
    };
    partition.cuts.par_iter().enumerate().with_max_len(1).map(mesh).collect()
}

/// The two end surfaces of a connector; none beside a failed cluster.
///
/// They are found by their place among the cluster's ends: a mesh that was taken over from a round before may know its
/// cuts by other numbers.
pub fn connector_ends<'a>(
    partition: &Partition,
    cut: &Cut,
    clusters: &'a [Result<Arc<ClusterMesh>, BlockError>],
) -> Option<[ConnectorEnd<'a>; 2]> {
    let end = |side: usize| {
        let (cluster, end) = cut.sides[side];
        let mesh = clusters[cluster.0 as usize].as_ref().ok()?;
        let before = &partition.clusters[cluster.0 as usize].ends[..end as usize];
        let place = before.iter().filter(|e| matches!(e.kind, EndKind::Cut { .. })).count();
        Some(ConnectorEnd { surface: &mesh.ends[place], points: &mesh.mesh.points })
    };
    Some([end(0)?, end(1)?])
}

/// Names of the nodes at the ends of a block's branches, as in the file that was read.
pub fn original_nodes(skeleton: &Skeleton, nodes: impl Iterator<Item = NodeId>) -> Vec<u32> {
    let mut list: Vec<u32> = nodes.map(|n| skeleton.node(n).original).collect();
    list.sort_unstable();
    list.dedup();
    list.truncate(LISTED);
    list
}

/// Decides what to do about blocks that failed; says so. Nothing when all is well or nothing is left to try.
fn cure(skeleton: &Skeleton, blocks: &Blocks, cures: &mut BTreeMap<BranchId, Cure>) -> Vec<Retry> {
    let mut found = Vec::new();
    for (i, (cluster, mesh)) in blocks.partition.clusters.iter().zip(&blocks.clusters).enumerate() {
        let Err(error) = mesh else { continue };
        let mut remedies = Vec::new();
        for branch in troubled_branches(blocks, cluster, error) {
            remedies.extend(advance(cures, branch));
        }
        if !remedies.is_empty() {
            found.push(Retry {
                block: format!("cluster {i}"),
                nodes: original_nodes(skeleton, cluster.nodes.iter().copied()),
                reason: error.to_string(),
                remedy: remedies.join(", "),
            });
        }
    }
    for (i, (cut, mesh)) in blocks.partition.cuts.iter().zip(&blocks.connectors).enumerate() {
        let Some(Err(error)) = mesh else { continue };
        if let Some(remedy) = advance(cures, cut.branch) {
            found.push(Retry {
                block: format!("connector {i}"),
                nodes: cut_nodes(skeleton, &blocks.partition, cut),
                reason: error.to_string(),
                remedy,
            });
        }
    }
    found
}

/// The branches whose cuts may be the cause of a cluster's failure: the one that the error names, else all.
fn troubled_branches(blocks: &Blocks, cluster: &Cluster, error: &BlockError) -> Vec<BranchId> {
    let branch = |cut: CutId| blocks.partition.cuts[cut.0 as usize].branch;
    if let Some(cut) = error.cut() {
        return vec![branch(cut)];
    }
    let of_end = |kind: EndKind| match kind {
        EndKind::Cut { cut, .. } => Some(branch(cut)),
        EndKind::Terminal(_) => None,
    };
    cluster.ends.iter().filter_map(|end| of_end(end.kind)).collect()
}

/// The next cure of a branch, and what it is called; none when all have been tried.
fn advance(cures: &mut BTreeMap<BranchId, Cure>, branch: BranchId) -> Option<String> {
    let (next, words) = match cures.get(&branch) {
        None => (Cure::Forward, "cut moved"),
        Some(Cure::Forward) => (Cure::Backward, "cut moved the other way"),
        Some(Cure::Backward) => (Cure::NotCut, "joined to its neighbour"),
        Some(Cure::NotCut) => return None,
    };
    cures.insert(branch, next);
    Some(format!("{words} (branch {})", branch.0))
}

/// The nodes of the two clusters that a cut separates.
pub fn cut_nodes(skeleton: &Skeleton, partition: &Partition, cut: &Cut) -> Vec<u32> {
    let nodes = cut.sides.iter().flat_map(|(cluster, _)| &partition.clusters[cluster.0 as usize].nodes);
    original_nodes(skeleton, nodes.copied())
}

fn note_clusters(
    skeleton: &Skeleton,
    partition: &Partition,
    tried: Vec<Tried<ClusterMesh>>,
    retries: &mut Vec<Retry>,
) -> Vec<Result<Arc<ClusterMesh>, BlockError>> {
    let note = |(i, tried): (usize, Tried<ClusterMesh>)| {
        if let (Ok(_), Some(first)) = (&tried.result, tried.failures.first()) {
            retries.push(Retry {
                block: format!("cluster {i}"),
                nodes: original_nodes(skeleton, partition.clusters[i].nodes.iter().copied()),
                reason: first.to_string(),
                remedy: attempts::remedy(tried.failures.len()),
            });
        }
        tried.result
    };
    tried.into_iter().enumerate().map(note).collect()
}

fn note_connectors(
    skeleton: &Skeleton,
    partition: &Partition,
    tried: Vec<Option<Tried<ConnectorMesh>>>,
    retries: &mut Vec<Retry>,
) -> Vec<Option<Result<Arc<ConnectorMesh>, BlockError>>> {
    let note = |(i, tried): (usize, Option<Tried<ConnectorMesh>>)| {
        let tried = tried?;
        if let Ok(mesh) = &tried.result
            && let Some(first) = mesh.failed.first()
        {
            retries.push(Retry {
                block: format!("connector {i}"),
                nodes: cut_nodes(skeleton, partition, &partition.cuts[i]),
                reason: first.failure.to_string(),
                remedy: "other division of the tube".to_owned(),
            });
        }
        Some(tried.result)
    };
    tried.into_iter().enumerate().map(note).collect()
}

//! Cures for blocks that fail with all parameters: their cuts are moved, then they are joined to their
//! neighbours.

use std::collections::{BTreeMap, BTreeSet};

use super::blocks::{Blocks, cut_nodes, original_nodes};
use super::estimate::too_fine;
use super::plan::{JointStyle, MeshPlan};
use super::report::Retry;
use super::tips::is_buried;
use crate::block::BlockError;
use crate::partition::{Cluster, ClusterEnd, ClusterId, CutId, EndKind, Layout, PartitionParams};
use anastomesh_skeleton::{BranchId, SizeAt, Skeleton};
use rayon::prelude::*;

/// Stage of the cure of a branch with a failed cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cure {
    /// The plane at the branch's start is moved towards its end.
    Forward,
    /// The plane at its end is moved towards its start.
    Backward,
    /// It is not cut: its clusters are joined.
    NotCut,
}

/// Share of the room by which a plane is moved.
const SHIFT: f64 = 0.5;

pub(super) fn partition_params(
    skeleton: &Skeleton,
    plan: &MeshPlan,
    cures: &BTreeMap<BranchId, Cure>,
    together: &BTreeSet<[BranchId; 2]>,
) -> PartitionParams {
    let mut params = PartitionParams {
        rho: plan.rho,
        kappa: plan.block_params().kappa,
        together: together.clone(),
        cut_terminals: plan.joint == JointStyle::Disc,
        size_field: plan.size_at.as_ref().and_then(SizeAt::field).cloned(),
        ..PartitionParams::default()
    };
    if plan.joint == JointStyle::None {
        let branches = skeleton.branches(&skeleton.adjacency());
        params.forbidden_cuts.extend((0..branches.list.len() as u32).map(BranchId));
    }
    for (&branch, &cure) in cures {
        match cure {
            Cure::Forward => drop(params.shifted_cuts.insert(branch, SHIFT)),
            Cure::Backward => drop(params.shifted_cuts.insert(branch, -SHIFT)),
            Cure::NotCut => drop(params.forbidden_cuts.insert(branch)),
        }
    }
    params
}

/// Chooses cures for clusters that fail before they are made, as their walls cross too many grid cells.
pub(super) fn cure_too_fine(
    skeleton: &Skeleton,
    partition: &Layout,
    plan: &MeshPlan,
    cures: &mut BTreeMap<BranchId, Cure>,
) -> Vec<Retry> {
    let ids = (0..partition.clusters_len() as u32).into_par_iter().map(ClusterId);
    let failure = |id| Some((id, too_fine(id, &partition.cluster(id), plan)?));
    let failures: Vec<(ClusterId, BlockError)> = ids.filter_map(failure).collect();
    failures.iter().filter_map(|(id, error)| cure_cluster(skeleton, partition, (*id, error), cures)).collect()
}

/// Chooses cures for failed blocks and returns them as retries; empty without failures or remaining cures.
pub(super) fn cure(skeleton: &Skeleton, blocks: &Blocks, cures: &mut BTreeMap<BranchId, Cure>) -> Vec<Retry> {
    let mut found = Vec::new();
    for (i, mesh) in (0..).zip(&blocks.clusters) {
        if let Err(error) = mesh
            && !is_buried(error)
        {
            found.extend(cure_cluster(skeleton, &blocks.partition, (ClusterId(i), error), cures));
        }
    }
    for (i, mesh) in blocks.connectors.iter().enumerate() {
        let Some(Err(error)) = mesh else { continue };
        let cut = &blocks.partition.cut(CutId(i as u32));
        if let Some(remedy) = advance(cures, cut.branch) {
            found.push(Retry {
                block: format!("connector {i}"),
                nodes: cut_nodes(skeleton, &blocks.partition, CutId(i as u32)),
                reason: error.to_string(),
                remedy,
            });
        }
    }
    found
}

/// Chooses cures for a failed cluster; `None` if all were tried.
fn cure_cluster(
    skeleton: &Skeleton,
    partition: &Layout,
    (id, error): (ClusterId, &BlockError),
    cures: &mut BTreeMap<BranchId, Cure>,
) -> Option<Retry> {
    let cluster = partition.cluster(id);
    let branches = troubled_branches(partition, &cluster, error);
    let remedies: Vec<String> = branches.into_iter().filter_map(|branch| advance(cures, branch)).collect();
    (!remedies.is_empty()).then(|| Retry {
        block: format!("cluster {}", id.0),
        nodes: original_nodes(skeleton, cluster.nodes.iter().copied()),
        reason: error.to_string(),
        remedy: remedies.join(", "),
    })
}

/// The branches whose cuts may be the cause of a cluster's failure: the one at which it failed, else all.
fn troubled_branches(partition: &Layout, cluster: &Cluster, error: &BlockError) -> Vec<BranchId> {
    let of_end = |end: &ClusterEnd| match end.kind {
        EndKind::Cut { cut, .. } => Some(partition.branch_of_cut(cut)),
        EndKind::Terminal(_) => None,
    };
    if let BlockError::End { end, .. } = error {
        return cluster.ends.get(*end as usize).and_then(of_end).into_iter().collect();
    }
    cluster.ends.iter().filter_map(of_end).collect()
}

/// Advances to the next cure of a branch and returns its name; `None` if all were tried.
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

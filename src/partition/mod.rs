//! Floor 3: 3.2.1 of the paper. Long vessels are cut; what stays together is a cluster.

mod check;
mod clearance;
mod layout;
mod near;
mod params;
mod parts;
mod path;
mod settle;
mod summary;
mod window;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use anastomesh_skeleton::course::Courses;
use anastomesh_skeleton::cuttability::BranchEnd;
use anastomesh_skeleton::{BranchId, Skeleton};

pub use check::{PartitionFlaw, check_partition};
pub use layout::Layout;
pub use params::{PartitionError, PartitionParams};
pub use parts::{Cluster, ClusterEnd, ClusterId, Cut, CutId, EndKind, Partition, PartitionWarning, Piece, UncutReason};
pub use summary::{PartitionSummary, UncutCounts};

/// Cuts a skeleton into clusters and connectors (3.2.1 of the paper, read for graphs with loops).
///
/// The skeleton is a cleaned one. Branches, not edges, are cut. Where that leaves a cluster too large, as equations 11 and 12
/// forbid every cut in a dense place, its branches are cut wherever there is room for discs. The result depends on nothing but
/// the arguments; clusters are ordered by their lowest node, cuts by branch and place.
///
/// # Errors
/// If a parameter is not positive or the skeleton has an edge without length, radius or node.
pub fn partition(skeleton: &Skeleton, params: &PartitionParams) -> Result<Partition, PartitionError> {
    Ok(lay_out(&Arc::new(skeleton.clone()), params)?.explicit())
}

/// The same, held as where the skeleton is cut.
///
/// # Errors
/// As [`partition`].
pub fn lay_out(skeleton: &Arc<Skeleton>, params: &PartitionParams) -> Result<Layout, PartitionError> {
    params.check()?;
    params::check_skeleton(skeleton)?;
    let mut params = params.clone();
    params.forbidden_cuts.extend(params.together.iter().flatten());
    let usual = cut(skeleton, &params);
    let large = usual.in_clusters_above(params.large);
    if large.is_empty() {
        return Ok(usual);
    }
    params.eager.extend(large);
    let eager = cut(skeleton, &params);
    Ok(if eager.largest_nodes() < usual.largest_nodes() { eager } else { usual })
}

fn cut(skeleton: &Arc<Skeleton>, params: &PartitionParams) -> Layout {
    let adjacency = skeleton.adjacency();
    let chains = skeleton.chains(&adjacency);
    let courses = Courses { skeleton, chains: &chains };
    let cutter = window::Cutter::new(&adjacency, courses, params);
    let mut slots = Vec::with_capacity(courses.len());
    let mut uncut = Vec::new();
    for branch in 0..courses.len() as u32 {
        if let Some(reason) = cutter.slots(branch, &mut slots) {
            uncut.push((BranchId(branch), reason));
        }
    }
    // Large networks ask for the room.
    drop(cutter);
    let terminal = |node| BranchEnd::of(&adjacency, node) == BranchEnd::Terminal;
    let terminals = (0..courses.len() as u32).map(|branch| chains.ends(branch).map(terminal)).collect();
    drop(adjacency);
    let mut settler = settle::Settler::new(skeleton.nodes.len(), courses, params, slots, terminals);
    uncut.extend(settler.settle());
    let layout = Layout::new(Arc::clone(skeleton), settler, uncut);
    layout.with(chains)
}

//! Partition (section 3.2.1 of the paper): long vessels are cut, and the parts between cuts are clusters.

mod check;
mod clearance;
mod fine;
mod layout;
mod near;
mod params;
mod parts;
mod path;
mod settle;
mod summary;
mod window;

#[cfg(test)]
mod frame_tests;
#[cfg(test)]
mod layout_tests;
#[cfg(test)]
mod recorded;
#[cfg(test)]
mod settle_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod window_tests;

use std::sync::Arc;

use anastomesh_mesh::progress::Progress;
use anastomesh_skeleton::course::Courses;
use anastomesh_skeleton::cuttability::BranchEnd;
use anastomesh_skeleton::{BranchId, Skeleton};

pub use check::{PartitionFlaw, check_partition};
pub use layout::Layout;
pub use params::{PartitionError, PartitionParams};
pub use parts::{
    BranchPiece, Cluster, ClusterEnd, ClusterId, Cut, CutId, EndKind, FORK_PLACES, ForkCell, ForkCells, Partition,
    PartitionWarning, SHARP_BEND, UncutReason,
};
pub use summary::{PartitionSummary, UncutCounts};

/// Partitions a skeleton into clusters and connectors (section 3.2.1 of the paper, generalized to graphs with loops).
///
/// The skeleton must be cleaned. Cuts apply to branches, not to edges. If equations 11 and 12 forbid all cuts in a
/// dense region, clusters may be too large. Their branches are then cut wherever two discs fit. The result depends only
/// on the arguments. Clusters are ordered by their lowest node, cuts by branch and position.
///
/// # Errors
/// A parameter is not positive, or the skeleton has an edge without length, radius or node.
pub fn partition(skeleton: &Skeleton, params: &PartitionParams) -> Result<Partition, PartitionError> {
    Ok(lay_out(&Arc::new(skeleton.clone()), params, &())?.explicit())
}

/// Partitions a skeleton and returns the compact form.
///
/// # Errors
/// See [`partition`]; `Cancelled` if the caller asks for a stop.
pub fn lay_out(
    skeleton: &Arc<Skeleton>,
    params: &PartitionParams,
    progress: &dyn Progress,
) -> Result<Layout, PartitionError> {
    params.check()?;
    params::check_skeleton(skeleton)?;
    let mut params = params.clone();
    params.forbidden_cuts.extend(params.together.iter().flatten());
    let usual = cut(skeleton, &params, progress)?;
    let large = usual.in_clusters_above(params.large);
    if large.is_empty() {
        return Ok(usual);
    }
    params.eager.extend(large);
    let eager = cut(skeleton, &params, progress)?;
    Ok(if eager.largest_nodes() < usual.largest_nodes() { eager } else { usual })
}

fn cut(skeleton: &Arc<Skeleton>, params: &PartitionParams, progress: &dyn Progress) -> Result<Layout, PartitionError> {
    let adjacency = skeleton.adjacency();
    let chains = skeleton.chains(&adjacency);
    let courses = Courses { skeleton, chains: &chains };
    let fine = params.size_field.as_ref().map_or_else(Vec::new, |field| fine::stations(courses, field, params.rho));
    let cutter = window::CutFinder::new(&adjacency, courses, params, &fine);
    let mut slots = Vec::with_capacity(courses.len());
    let mut uncut = Vec::new();
    for branch in 0..courses.len() as u32 {
        if progress.is_cancelled() {
            return Err(PartitionError::Cancelled);
        }
        if let Some(reason) = cutter.slots(branch, &mut slots) {
            uncut.push((BranchId(branch), reason));
        }
    }
    // Frees memory, which matters for large networks.
    drop(cutter);
    let terminal = |node| BranchEnd::of(&adjacency, node) == BranchEnd::Terminal;
    let terminals = (0..courses.len() as u32).map(|branch| chains.ends(branch).map(terminal)).collect();
    drop(adjacency);
    let mut settler = settle::Settler::new(skeleton.nodes.len(), courses, params, slots, terminals);
    uncut.extend(settler.settle(progress)?);
    let layout = Layout::new(Arc::clone(skeleton), settler, uncut);
    Ok(layout.with(chains, fine))
}

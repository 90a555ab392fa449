//! The parameters with which a block is tried, one after the other, before its cuts are touched.

use super::plan::{JointStyle, MeshPlan};
use crate::block::{
    BlockDump, BlockError, BlockParams, ConnectorEnd, ConnectorMesh, EndStyle, Finished, dump_cluster, dump_connector,
    dump_free_connector, mesh_cluster, mesh_connector, mesh_free_connector,
};
use crate::partition::{Cluster, ClusterId, Cut, CutId};
use crate::skeleton::NodeId;

/// Result of a block, and the failures before it.
#[derive(Debug)]
pub struct Tried<T> {
    /// The block, or the failure of the first attempt.
    pub result: Result<T, BlockError>,
    /// Failures of the other attempts.
    pub failures: Vec<BlockError>,
}

/// What is changed from attempt to attempt; the first is the usual way.
const CHANGES: [&str; 7] = [
    "as usual",
    "grid shifted",
    "narrower kernel",
    "other ends or grid",
    "finer voxel, grid shifted",
    "finer voxel, narrower kernel",
    "much finer voxel, thin kernel",
];

/// What helped after so many failures.
pub fn remedy(failures: usize) -> String {
    match CHANGES.get(failures) {
        Some(change) => (*change).to_owned(),
        None => format!("vessels that overlap taken as one, {}", CHANGES[failures % CHANGES.len()]),
    }
}

fn variants(plan: &MeshPlan) -> [BlockParams; CHANGES.len()] {
    let usual = plan.block_params();
    let shifted = BlockParams { shift: [0.37, -0.23, 0.11], ..usual };
    // Parallel vessels fuse when their axes are closer than √(1 + 2 κ² ln 2) times the sum of their radii.
    let narrower = BlockParams { kappa: 0.3, ..usual };
    let other = match plan.joint {
        JointStyle::Woven => BlockParams { ends: EndStyle::Trimmed, ..usual },
        JointStyle::Disc | JointStyle::None => BlockParams { shift: [-0.29, 0.43, 0.31], kappa: 0.35, ..usual },
    };
    let finer = |params| BlockParams { voxel_factor: 0.75, ..params };
    let finest = BlockParams { kappa: 0.22, voxel_factor: 0.5, ..shifted };
    [usual, shifted, narrower, other, finer(shifted), finer(narrower), finest]
}

/// The ways in which a cluster is tried, each with its place in the list of all. `overlapping`: vessels of the network
/// overlap in it, or come so close to each other that they may. If neither another grid nor a finer one with a narrower
/// kernel keeps them apart they are taken as one, at once if that is what is wanted.
fn ways(plan: &MeshPlan, overlapping: bool) -> Vec<(usize, BlockParams)> {
    let apart = variants(plan);
    let fused = apart.map(|params| BlockParams { allow_fused: true, ..params });
    let places = (0..).zip([apart, fused].concat());
    let is_tried = |place: usize| match (overlapping, plan.fuse) {
        (false, _) => place < CHANGES.len(),
        (true, true) => place >= CHANGES.len(),
        (true, false) => [0, 1, 5].contains(&place) || place >= CHANGES.len(),
    };
    places.filter(|(place, _)| is_tried(*place)).collect()
}

/// A cluster with a smaller radius ratio is tried in other ways, too.
const FLAT: f64 = 0.1;

/// Meshes a cluster and finishes it, with other parameters after each failure, and as long as a tetrahedron is all but
/// flat or the block's own check finds a fault; of such ones the best is taken. When nothing helps, the failure of the usual
/// way counts: it is what the dump of the input reproduces. What was not tried in between counts as failed like the attempt
/// before.
pub fn cluster(
    id: ClusterId,
    cluster: &Cluster,
    plan: &MeshPlan,
    overlapping: bool,
    original: impl Fn(NodeId) -> u32,
) -> Tried<Finished> {
    let mut failures: Vec<BlockError> = Vec::new();
    let mut best: Option<(usize, Finished)> = None;
    for (place, params) in ways(plan, overlapping) {
        // Vessels that can be kept apart are not taken as one for the sake of a tetrahedron.
        if params.allow_fused && !plan.fuse && best.as_ref().is_some_and(|(before, _)| *before < CHANGES.len()) {
            break;
        }
        let block = || format!("cluster {}", id.0);
        let finish =
            |mesh| Finished::of_cluster(mesh, &original).map_err(|source| BlockError::Faces { block: block(), source });
        if let Some(last) = failures.last().cloned() {
            failures.resize(place, last);
        }
        match mesh_cluster(id, cluster, &params).and_then(finish) {
            Ok(block) if goodness(&block) >= (true, FLAT) => return Tried { result: Ok(block), failures },
            Ok(block) => {
                failures.push(BlockError::Flat { cluster: id, ratio: block.certificate.worst_ratio() });
                if best.as_ref().is_none_or(|(_, best)| goodness(&block) > goodness(best)) {
                    best = Some((place, block));
                }
            }
            Err(error) => failures.push(error),
        }
    }
    match best {
        Some((place, block)) => {
            failures.truncate(place);
            Tried { result: Ok(block), failures }
        }
        None => Tried { result: Err(failures.swap_remove(0)), failures },
    }
}

/// A block is better if it is sound, and of sound ones the one whose flattest tetrahedron is rounder.
fn goodness(block: &Finished) -> (bool, f64) {
    (block.certificate.is_sound(), block.certificate.worst_ratio())
}

/// Meshes a connector; it varies the division of its tube by itself.
pub fn connector(id: CutId, cut: &Cut, ends: [ConnectorEnd; 2], plan: &MeshPlan) -> Tried<ConnectorMesh> {
    let result = mesh_connector(id, cut, ends, &plan.block_params());
    Tried { result, failures: Vec::new() }
}

/// The same for a connector that is made without its clusters.
pub fn free_connector(id: CutId, cut: &Cut, plan: &MeshPlan) -> Tried<ConnectorMesh> {
    let result = mesh_free_connector(id, cut, &plan.block_params());
    Tried { result, failures: Vec::new() }
}

/// The input of a cluster as it is first tried.
pub fn cluster_input(id: ClusterId, cluster: &Cluster, plan: &MeshPlan) -> BlockDump {
    dump_cluster(id, cluster, &plan.block_params())
}

/// The input of a connector as it is first tried.
pub fn connector_input(id: CutId, cut: &Cut, ends: [ConnectorEnd; 2], plan: &MeshPlan) -> BlockDump {
    dump_connector(id, cut, ends, &plan.block_params())
}

/// The input of a connector that is made without its clusters; none when it has no path or its discs cannot be made.
pub fn free_connector_input(id: CutId, cut: &Cut, plan: &MeshPlan) -> Option<BlockDump> {
    dump_free_connector(id, cut, &plan.block_params())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vessels_that_may_overlap_are_kept_apart_if_they_can_be() {
        let fused = |plan: &MeshPlan, overlapping| -> Vec<bool> {
            ways(plan, overlapping).iter().map(|(_, params)| params.allow_fused).collect()
        };
        let plan = MeshPlan::default();
        assert_eq!(fused(&plan, false), [false; CHANGES.len()]);
        assert_eq!(fused(&plan, true), [[false; 3].as_slice(), &[true; CHANGES.len()]].concat());
        assert_eq!(fused(&MeshPlan { fuse: true, ..plan.clone() }, true), [true; CHANGES.len()]);
        let words: Vec<String> = ways(&plan, true).iter().map(|(place, _)| remedy(*place)).collect();
        assert_eq!(words[2], "finer voxel, narrower kernel");
        assert_eq!(words[3], "vessels that overlap taken as one, as usual");
    }
}

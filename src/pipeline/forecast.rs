//! Forecast of the cost of a run from its partition, without meshing.

use super::cures::partition_params;
use super::error::RunError;
use super::estimate::{Estimate, cluster_cost, contoured};
use super::plan::MeshPlan;
use super::routes::{Tangle, tangled_clusters};
use crate::block::shared_cells;
use crate::partition::{self, ClusterId};
use anastomesh_network::split_in_place;
use anastomesh_skeleton::Skeleton;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Tetrahedra that a thread makes, checks and writes per second: images of templates as measured with kidneys, others as measured
/// with vessels of brains.
const TEMPLATE_TETS_PER_SECOND: f64 = 1.6e6;
const TETS_PER_SECOND: f64 = 2.5e5;
/// Operations per tetrahedron in that figure, and seconds per operation beyond: walls of wide vessels contoured at the
/// resolution of thin ones.
const OPERATIONS_PER_TET: f64 = 100.0;
const SECONDS_PER_OPERATION: f64 = 5e-8;
/// Mean attempts at a cluster in which vessels overlap.
const ATTEMPTS: f64 = 2.0;
/// Memory of the program itself, with a network of some thousand edges.
const AT_LEAST: u64 = 60_000_000;

/// Number of blocks of a network, and estimate of their cost.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Forecast {
    /// Number of clusters.
    pub clusters: usize,
    /// Number of connectors.
    pub connectors: usize,
    /// Nodes of the largest cluster.
    pub largest_nodes: usize,
    /// Tetrahedra, memory and disk.
    pub estimate: Estimate,
    /// Tetrahedra and operations of clusters that are contoured, as they are no images of templates.
    pub contoured: [f64; 2],
    /// Clusters in which vessels overlap. Most of them take several attempts, or fail.
    pub overlapping: usize,
    /// Operations of those attempts beyond the first.
    pub retry_operations: f64,
}

impl Forecast {
    /// Of a network.
    ///
    /// # Errors
    /// The network cannot be partitioned.
    pub fn of(network: &Skeleton, plan: &MeshPlan) -> Result<Self, RunError> {
        let (network, _) = split_in_place(network);
        let params = partition_params(&network, plan, &BTreeMap::new(), &BTreeSet::new());
        let network = Arc::new(network);
        let partition = partition::lay_out(&network, &params, &())?.sized(plan.size_at.clone());
        let clusters = partition.clusters_len() as u32;
        let cells = shared_cells(clusters, plan.stretch, |i| partition.cluster(ClusterId(i)));
        let partition = partition.with_cells(cells);
        let overlaps = network.overlaps(&network.adjacency());
        let tangled = tangled_clusters(&network, &partition, &overlaps, &BTreeSet::new());
        let again = partition.clusters().zip(&tangled).filter(|(_, tangled)| **tangled == Tangle::Overlapping);
        let again: f64 = again.map(|(cluster, _)| cluster_cost(&cluster, plan).operations).sum();
        Ok(Self {
            overlapping: tangled.iter().filter(|tangled| **tangled == Tangle::Overlapping).count(),
            retry_operations: (ATTEMPTS - 1.0) * again,
            clusters: partition.clusters_len(),
            connectors: partition.cuts_len(),
            largest_nodes: partition.largest_nodes(),
            estimate: Estimate::of(&partition, plan),
            contoured: contoured(&partition, plan),
        })
    }

    /// Seconds on this number of threads.
    pub fn seconds(&self, threads: usize) -> f64 {
        let [tets, operations] = self.contoured;
        let more = (operations - OPERATIONS_PER_TET * tets).max(0.0) + self.retry_operations;
        let images = (self.estimate.tets - tets) / TEMPLATE_TETS_PER_SECOND;
        (images + tets / TETS_PER_SECOND + SECONDS_PER_OPERATION * more) / threads.max(1) as f64
    }

    /// Bytes of memory on this number of threads.
    pub fn memory(&self, threads: usize) -> u64 {
        AT_LEAST + (self.estimate.largest_block_bytes * threads as u64).max(self.estimate.regions_bytes)
    }
}

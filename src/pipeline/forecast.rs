//! Forecast of the cost of a run from its partition, without meshing.

use super::cures::partition_params;
use super::error::RunError;
use super::estimate::Estimate;
use super::plan::MeshPlan;
use crate::partition;
use anastomesh_network::split;
use anastomesh_skeleton::Skeleton;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Tetrahedra that a thread makes, checks and writes per second: as measured with kidneys.
const TETS_PER_SECOND: f64 = 3.1e5;
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
}

impl Forecast {
    /// Of a network.
    ///
    /// # Errors
    /// The network cannot be partitioned.
    pub fn of(network: &Skeleton, plan: &MeshPlan) -> Result<Self, RunError> {
        let (network, _) = split(network);
        let params = partition_params(&network, plan, &BTreeMap::new(), &BTreeSet::new());
        let partition = partition::lay_out(&Arc::new(network), &params)?.sized(plan.size_at.clone());
        Ok(Self {
            clusters: partition.clusters_len(),
            connectors: partition.cuts_len(),
            largest_nodes: partition.largest_nodes(),
            estimate: Estimate::of(&partition, plan),
        })
    }

    /// Seconds on this number of threads.
    pub fn seconds(&self, threads: usize) -> f64 {
        self.estimate.tets / TETS_PER_SECOND / threads.max(1) as f64
    }

    /// Bytes of memory on this number of threads.
    pub fn memory(&self, threads: usize) -> u64 {
        AT_LEAST + self.estimate.largest_block_bytes * threads as u64
    }
}

//! A shard: the share of the blocks that one of several runs in a work directory makes.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use serde::{Deserialize, Serialize};

use super::attempts::RetryStrategy;
use super::error::RunError;
use super::estimate::{Estimate, TooLarge, costs_of};
use super::make::Workshop;
use super::plan::MeshPlan;
use super::rounds::RunContext;
use super::routes::{Tangle, tangled_clusters};
use super::store::{KeyMaker, Shard, Store, fingerprint};
use super::timing::{BlockTimes, Clock, StageTime, Stopwatch};
use crate::partition::{ClusterId, CutId};
use anastomesh_mesh::progress::{Progress, Stage};
use anastomesh_network::split_shared;
use anastomesh_skeleton::{BranchId, Overlaps, Skeleton};
use anastomesh_tet::parts::Watch;

/// Report of a shard.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ShareReport {
    /// Blocks of the whole network.
    pub blocks: usize,
    /// Those of them that are this shard's.
    pub share: usize,
    /// Those of its blocks that were there before.
    pub found: usize,
    /// Failed blocks. The run that joins the shards cuts the network again there.
    pub failed: usize,
    /// Seconds that its blocks took.
    pub seconds: f64,
    /// Expected costs of all blocks.
    pub estimate: Estimate,
    /// Wall time.
    pub stages: Vec<StageTime>,
}

/// Makes the blocks of a shard in the first round. The run that joins the shards handles blocks that fail or intersect
/// others. `fits` receives the estimate for all blocks, and may refuse it.
///
/// # Errors
/// See [`RunError`]. A failed block is not an error.
pub fn make_share(
    store: &Store,
    network: Arc<Skeleton>,
    plan: &MeshPlan,
    shard: Shard,
    fits: &dyn Fn(&Estimate) -> Result<(), TooLarge>,
    progress: &dyn Progress,
) -> Result<ShareReport, RunError> {
    plan.validate()?;
    let mut clock = Clock::default();
    let skeleton = split_shared(&network).0;
    drop(network);
    let shop = Workshop::new(&skeleton, plan, store);
    let tasks = clock.time(progress, Stage::Prepare, 0, || Tasks::of(&shop, progress))?;
    let mut run = RunContext { overlaps: &Overlaps::default(), shop, progress, clock: &mut clock };
    let mut report = run.share(shard, &tasks, fits)?;
    store.mark_done(shard)?;
    report.stages = clock.stages();
    Ok(report)
}

/// Data of the first round that all shards need besides the partition. One shard computes them.
#[derive(Debug, Serialize, Deserialize)]
struct Tasks {
    /// Branches that are to be in one cluster.
    together: BTreeSet<[BranchId; 2]>,
    /// Tangle of each cluster.
    tangled: Vec<Tangle>,
    /// Cost of each block: clusters by their ids, then connectors.
    weights: Vec<u64>,
    estimate: Estimate,
}

impl Tasks {
    fn of(shop: &Workshop, progress: &dyn Progress) -> Result<Self, RunError> {
        let key = || {
            let mut key = KeyMaker::new("tasks");
            // Memory and places of dumps say nothing about it.
            let plan = MeshPlan { memory: 0, dump_dir: None, ..shop.plan.clone() };
            key.text(&format!("{:?} {plan:?}", fingerprint(shop.skeleton)));
            key.finish()
        };
        let find = || {
            let overlaps = shop.skeleton.overlaps(&shop.skeleton.adjacency());
            let mut run = RunContext { overlaps: &overlaps, shop: *shop, progress, clock: &mut Clock::default() };
            let together = run.together();
            let partition = run.partition(&BTreeMap::new(), &together)?;
            let weights = run.costs(&partition).iter().map(|cost| 1 + cost.tets as u64).collect();
            let tangled = tangled_clusters(shop.skeleton, &partition, &overlaps, &BTreeSet::new());
            Ok(Self { together, tangled, weights, estimate: Estimate::of(&partition, shop.plan) })
        };
        shop.store.once(("tasks", key), progress, find)
    }
}

impl RunContext<'_> {
    fn share(
        &mut self,
        shard: Shard,
        tasks: &Tasks,
        fits: &dyn Fn(&Estimate) -> Result<(), TooLarge>,
    ) -> Result<ShareReport, RunError> {
        let (shop, progress) = (self.shop, self.progress);
        let partition = self.partition(&BTreeMap::new(), &tasks.together)?;
        fits(&tasks.estimate)?;
        let clusters = partition.clusters_len();
        let shop = shop.among(clusters);
        let own = dealt(&tasks.weights, shard);
        let costs = costs_of(&partition, &own, shop.plan);
        let (watch, failed) = (Watch::asking(progress), AtomicUsize::new(0));
        let before = shop.store.blocks_made();
        let stopwatch = Stopwatch::new(BlockTimes::default(), clusters);
        let make = |i: u32| {
            let made = match i.checked_sub(clusters as u32) {
                None => {
                    let (id, tangled) = (ClusterId(i), tasks.tangled[i as usize]);
                    shop.cluster(id, &partition.cluster(id), tangled, RetryStrategy::Usual, &watch)?
                }
                Some(cut) => shop.free_connector(CutId(cut), &partition.cut(CutId(cut)))?,
            };
            failed.fetch_add(usize::from(made.is_err()), Ordering::Relaxed);
            Ok(())
        };
        self.timed(Stage::Blocks, &costs, |k| stopwatch.time(own[k] as usize, || make(own[k])))?;
        let times = stopwatch.times();
        let failed = failed.into_inner();
        Ok(ShareReport {
            blocks: tasks.weights.len(),
            share: own.len(),
            found: own.len() - failed - (shop.store.blocks_made() - before),
            failed,
            seconds: times.clusters + times.connectors,
            estimate: tasks.estimate,
            stages: Vec::new(),
        })
    }
}

/// The blocks of a shard, ascending: the costliest are dealt first, each to the shard that has least.
fn dealt(weights: &[u64], shard: Shard) -> Vec<u32> {
    let weight = |i: u32| weights[i as usize];
    let mut order: Vec<u32> = (0..weights.len() as u32).collect();
    order.sort_unstable_by_key(|&i| (Reverse(weight(i)), i));
    let mut shards: BinaryHeap<Reverse<(u64, usize)>> = (0..shard.of()).map(|s| Reverse((0, s))).collect();
    let mut own = Vec::new();
    for i in order {
        let Some(Reverse((load, least))) = shards.pop() else { break };
        if least == shard.index() {
            own.push(i);
        }
        shards.push(Reverse((load.saturating_add(weight(i)), least)));
    }
    own.sort_unstable();
    own
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_block_is_dealt_once_and_shards_have_as_much_to_do() {
        let weights: Vec<u64> = (0..1000).map(|i| (i * 7919 % 1000) * (i * 7919 % 1000)).collect();
        for of in [1, 2, 7, 64] {
            let shards: Vec<Vec<u32>> =
                (1..=of).map(|i| dealt(&weights, Shard::new(i, of).expect("a shard"))).collect();
            let mut all = shards.concat();
            all.sort_unstable();
            assert_eq!(all, (0..1000).collect::<Vec<_>>());
            let load = |own: &Vec<u32>| own.iter().map(|&i| weights[i as usize] as f64).sum::<f64>();
            let mean = weights.iter().sum::<u64>() as f64 / f64::from(of);
            assert!(shards.iter().all(|own| (load(own) / mean - 1.0).abs() < 0.02), "{of}");
        }
        // More shards than blocks leave some with nothing.
        assert!(dealt(&weights[..3], Shard::new(4, 5).expect("a shard")).is_empty());
    }
}

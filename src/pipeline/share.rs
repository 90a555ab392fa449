//! A shard: the share of the blocks that one of several runs in a work directory makes.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use std::sync::atomic::{AtomicUsize, Ordering};

use serde::Serialize;

use super::attempts::Way;
use super::error::RunError;
use super::estimate::{Estimate, TooLarge};
use super::make::Workshop;
use super::plan::MeshPlan;
use super::report::RunReport;
use super::rounds::Run;
use super::routes::tangled_clusters;
use super::run::prepare;
use super::schedule::Cost;
use super::store::{Shard, Store};
use super::timing::{Clock, StageTime};
use crate::partition::{ClusterId, CutId};
use crate::progress::{Progress, Stage};
use crate::skeleton::Skeleton;
use crate::tet::Watch;

/// What a shard did.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ShareReport {
    /// Blocks of the whole network.
    pub blocks: usize,
    /// Those of them that are this shard's.
    pub share: usize,
    /// Those of its blocks that were there before.
    pub found: usize,
    /// Those that fail: the run that joins the shards cuts the network anew there.
    pub failed: usize,
    /// Seconds that its blocks took.
    pub seconds: f64,
    /// Wall time.
    pub stages: Vec<StageTime>,
}

/// Makes the share of the blocks of a network that is a shard's, in the first round: what fails, or meets another block, is
/// seen to by the run that joins the shards. `fits` hears what all blocks will take, and may refuse.
///
/// # Errors
/// See [`RunError`]; a block that fails is none.
pub fn make_share(
    store: &Store,
    network: &Skeleton,
    plan: &MeshPlan,
    shard: Shard,
    fits: &dyn Fn(&Estimate) -> Result<(), TooLarge>,
    progress: &dyn Progress,
) -> Result<ShareReport, RunError> {
    plan.validate()?;
    let mut clock = Clock::default();
    let (skeleton, overlaps) = clock.time(progress, Stage::Prepare, 0, || prepare(network, &mut RunReport::default()));
    let shop = Workshop { skeleton: &skeleton, plan, store };
    let mut run = Run { overlaps: &overlaps, shop, progress, clock: &mut clock };
    let mut report = run.share(shard, fits)?;
    store.mark_done(shard)?;
    report.stages = clock.stages();
    Ok(report)
}

impl Run<'_> {
    fn share(
        &mut self,
        shard: Shard,
        fits: &dyn Fn(&Estimate) -> Result<(), TooLarge>,
    ) -> Result<ShareReport, RunError> {
        let (shop, progress) = (self.shop, self.progress);
        let together = self.together();
        let partition = self.partition(&BTreeMap::new(), &together)?;
        fits(&Estimate::of(&partition, shop.plan))?;
        let tangled = tangled_clusters(shop.skeleton, &partition, self.overlaps);
        let costs = self.costs(&partition);
        let own = dealt(&costs, shard);
        let own_costs: Vec<Cost> = own.iter().map(|&i| costs[i as usize]).collect();
        let (watch, failed) = (Watch::asking(progress), AtomicUsize::new(0));
        let before = shop.store.own_records();
        let one = |k: usize| {
            let i = own[k] as usize;
            let made = match i.checked_sub(partition.clusters.len()) {
                None => shop.cluster(ClusterId(i as u32), &partition.clusters[i], tangled[i], Way::Usual, &watch)?,
                Some(cut) => shop.free_connector(CutId(cut as u32), &partition.cuts[cut])?,
            };
            failed.fetch_add(usize::from(made.is_err()), Ordering::Relaxed);
            Ok(())
        };
        let (_, seconds) = self.timed(Stage::Blocks, &own_costs, one)?;
        let failed = failed.into_inner();
        Ok(ShareReport {
            blocks: costs.len(),
            share: own.len(),
            found: own.len() - failed - (shop.store.own_records() - before),
            failed,
            seconds: seconds.iter().sum(),
            stages: Vec::new(),
        })
    }
}

/// The blocks of a shard, ascending: the costliest are dealt first, each to the shard that has least.
fn dealt(costs: &[Cost], shard: Shard) -> Vec<u32> {
    let weight = |i: u32| 1 + costs[i as usize].tets as u64;
    let mut order: Vec<u32> = (0..costs.len() as u32).collect();
    order.sort_by_key(|&i| (Reverse(weight(i)), i));
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
        let costs: Vec<Cost> = (0..1000).map(|i| Cost { tets: f64::from(i * 7919 % 1000).powi(2), bytes: 0 }).collect();
        for of in [1, 2, 7, 64] {
            let shards: Vec<Vec<u32>> = (1..=of).map(|i| dealt(&costs, Shard::new(i, of).expect("a shard"))).collect();
            let mut all = shards.concat();
            all.sort_unstable();
            assert_eq!(all, (0..1000).collect::<Vec<_>>());
            let load = |own: &Vec<u32>| own.iter().map(|&i| costs[i as usize].tets).sum::<f64>();
            let mean = costs.iter().map(|c| c.tets).sum::<f64>() / f64::from(of);
            assert!(shards.iter().all(|own| (load(own) / mean - 1.0).abs() < 0.02), "{of}");
        }
        // More shards than blocks leave some with nothing.
        assert!(dealt(&costs[..3], Shard::new(4, 5).expect("a shard")).is_empty());
    }
}

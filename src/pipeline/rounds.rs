//! All blocks of a network, with retries.
//!
//! A failed block is tried with other parameters, then with its cuts moved, then joined to its neighbours. A round makes
//! the blocks that it changes; all others are kept.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use rustc_hash::FxHashMap;

use super::attempts::RetryStrategy;
use super::blocks::{Blocks, cut_nodes, original_nodes};
use super::carried::Carried;
use super::cures::{Cure, cure, cure_too_fine, partition_params};
use super::error::RunError;
use super::estimate::{Estimate, TooLarge, costs_of};
use super::make::{BlockResult, Workshop};
use super::plan::JointStyle;
use super::report::Retry;
use super::routes::{Tangle, Uncut, branch_pairs, tangled_clusters};
use super::schedule::{Cost, costliest_first};
use super::sizes;
use super::store::{KeyMaker, RecordId, StoreError, fingerprint};
use super::timing::{Clock, Stopwatch};
use crate::block::{Cured, shared_cells};
use crate::partition::{self, ClusterId, CutId, Layout};
use anastomesh_mesh::progress::{Progress, Stage};
use anastomesh_skeleton::{BranchId, Overlaps};
use anastomesh_tet::parts::Watch;

/// Maximum changes of the partition because of blocks that failed, and as many because of clusters that are known to fail.
const MAX_PARTITION_CHANGES: usize = 6;

/// Environment of a run.
pub struct RunContext<'a> {
    /// Vessels of the network that overlap.
    pub overlaps: &'a Overlaps,
    pub shop: Workshop<'a>,
    pub progress: &'a dyn Progress,
    pub clock: &'a mut Clock,
}

impl RunContext<'_> {
    /// Meshes every block, and changes the partition where blocks fail.
    ///
    /// - `uncut`: vessels that are not cut, or share a cluster
    /// - `before`: blocks of the previous partition
    /// - `fits`: receives the estimate before the first block, and may refuse it
    ///
    /// # Errors
    /// The network cannot be partitioned, or blocks cannot be stored.
    pub fn build(
        &mut self,
        uncut: &Uncut,
        mut before: Option<Blocks>,
        fits: &dyn Fn(&Estimate) -> Result<(), TooLarge>,
    ) -> Result<Blocks, RunError> {
        let mut cures: BTreeMap<BranchId, Cure> = uncut.branches.iter().map(|&branch| (branch, Cure::NotCut)).collect();
        let mut together = self.together();
        together.extend(&uncut.joined);
        let mut retries = Vec::new();
        let mut told = BTreeSet::new();
        let (mut round, mut foreseen) = (0, 0);
        loop {
            let partition = self.partition(&cures, &together)?;
            if round + foreseen == 0 {
                let estimate = Estimate::of(&partition, self.shop.plan);
                self.shop.store.ledger().expect(estimate.operations);
                fits(&estimate)?;
                if before.is_none() {
                    sizes::announce(self.shop.skeleton, &partition, self.shop.plan, self.progress);
                }
            }
            if foreseen < MAX_PARTITION_CHANGES {
                let found = cure_too_fine(self.shop.skeleton, &partition, self.shop.plan, &mut cures);
                if !found.is_empty() {
                    retries.extend(found);
                    foreseen += 1;
                    continue;
                }
            }
            let blocks = self.pass(partition, before, &uncut.joined)?;
            self.tell_cured(&blocks, &mut told, &mut retries);
            let may_change = round < MAX_PARTITION_CHANGES && !self.shop.store.ledger().is_hopeless();
            let found = if may_change { cure(self.shop.skeleton, &blocks, &mut cures) } else { Vec::new() };
            if found.is_empty() {
                return Ok(Blocks { retries, ..blocks });
            }
            retries.extend(found);
            before = Some(blocks);
            round += 1;
        }
    }

    /// Branches that must be in one cluster because their vessels overlap.
    pub(super) fn together(&self) -> BTreeSet<[BranchId; 2]> {
        let overlapping = self.overlaps.pairs.iter().filter(|_| self.shop.plan.fuse).map(|o| o.edges);
        branch_pairs(self.shop.skeleton, overlapping).into_iter().collect()
    }

    /// Cuts the network, unless another run has done so in this work directory.
    pub(super) fn partition(
        &mut self,
        cures: &BTreeMap<BranchId, Cure>,
        together: &BTreeSet<[BranchId; 2]>,
    ) -> Result<Layout, RunError> {
        let (Workshop { skeleton, plan, store, .. }, progress) = (self.shop, self.progress);
        let params = partition_params(skeleton, plan, cures, together);
        let key = || {
            let mut key = KeyMaker::new("partition");
            key.text(&format!("{:?} {params:?}", fingerprint(skeleton)));
            key.finish()
        };
        let cut = || partition::lay_out(skeleton, &params, progress).map_err(RunError::from);
        let kept = || {
            let layout = store.once(("partition", key), progress, cut)?.of(Arc::clone(skeleton));
            let layout = layout.sized(plan.size_at.clone());
            let cells = shared_cells(layout.clusters_len() as u32, plan.stretch, |i| layout.cluster(ClusterId(i)));
            Ok(layout.with_cells(cells))
        };
        self.clock.time(progress, Stage::Partition, 0, kept)
    }

    /// Expected costs of blocks: clusters by their ids, then connectors.
    pub(super) fn costs(&self, partition: &Layout) -> Vec<Cost> {
        let blocks: Vec<u32> = (0..(partition.clusters_len() + partition.cuts_len()) as u32).collect();
        costs_of(partition, &blocks, self.shop.plan)
    }

    /// Makes all blocks of a partition. Blocks are independent, unless joints are woven.
    fn pass(
        &mut self,
        partition: Layout,
        before: Option<Blocks>,
        joined: &BTreeSet<[BranchId; 2]>,
    ) -> Result<Blocks, RunError> {
        let shop = self.shop.among(partition.clusters_len());
        let tangled = tangled_clusters(shop.skeleton, &partition, self.overlaps, joined);
        let is_woven = shop.plan.joint == JointStyle::Woven;
        let Carried { clusters, connectors, cured, times } = Carried::over(before, &partition, &tangled, is_woven);
        let making = Making {
            shop,
            partition: &partition,
            tangled: &tangled,
            watch: Watch::asking(self.progress),
            stopwatch: Stopwatch::new(times, partition.clusters_len()),
            heard: Mutex::new(cured),
        };
        let made = if is_woven { Self::woven } else { Self::free };
        let (clusters, mut connectors) = made(self, &making, clusters, connectors)?;
        let is_made = |(cluster, _): (ClusterId, u32)| clusters[cluster.0 as usize].is_ok();
        for (cut, made) in (0..).zip(&mut connectors) {
            if !partition.sides_of_cut(CutId(cut)).into_iter().all(is_made) {
                *made = None;
            }
        }
        let Making { stopwatch, heard, .. } = making;
        let (times, cured) = (stopwatch.times(), heard.into_inner().unwrap_or_else(PoisonError::into_inner));
        let (apart, retries) = (BTreeSet::new(), Vec::new());
        Ok(Blocks { partition, tangled, clusters, connectors, apart, cured, retries, times })
    }

    /// Makes missing blocks, clusters and connectors in any order.
    fn free(
        &mut self,
        making: &Making,
        mut clusters: Vec<Option<BlockResult>>,
        mut connectors: Vec<Option<BlockResult>>,
    ) -> Result<(Vec<BlockResult>, Vec<Option<BlockResult>>), RunError> {
        let count = clusters.len();
        let todo: Vec<u32> = missing(&clusters, 0).chain(missing(&connectors, count)).collect();
        let costs = costs_of(making.partition, &todo, self.shop.plan);
        let made = self.timed(Stage::Blocks, &costs, |k| making.block(todo[k]))?;
        for (&block, made) in todo.iter().zip(made) {
            let block = block as usize;
            *(if block < count { &mut clusters[block] } else { &mut connectors[block - count] }) = Some(made);
        }
        Ok((all(clusters), connectors))
    }

    /// Makes missing blocks; connectors follow their two clusters.
    fn woven(
        &mut self,
        making: &Making,
        mut clusters: Vec<Option<BlockResult>>,
        mut connectors: Vec<Option<BlockResult>>,
    ) -> Result<(Vec<BlockResult>, Vec<Option<BlockResult>>), RunError> {
        let todo: Vec<u32> = missing(&clusters, 0).collect();
        let costs = costs_of(making.partition, &todo, self.shop.plan);
        let made = self.timed(Stage::Clusters, &costs, |k| making.block(todo[k]))?;
        todo.iter().zip(made).for_each(|(&block, made)| clusters[block as usize] = Some(made));
        let clusters = all(clusters);
        let todo: Vec<u32> = missing(&connectors, 0).collect();
        let blocks: Vec<u32> = todo.iter().map(|cut| cut + clusters.len() as u32).collect();
        let costs = costs_of(making.partition, &blocks, self.shop.plan);
        let made = self.timed(Stage::Connectors, &costs, |k| making.woven(CutId(todo[k]), &clusters))?;
        todo.iter().zip(made).for_each(|(&cut, made)| connectors[cut as usize] = made);
        Ok((clusters, connectors))
    }

    /// Runs one stage over blocks, and returns their results. Blocks that a cancellation stops do not count as failures.
    pub(super) fn timed<T: Send>(
        &mut self,
        stage: Stage,
        costs: &[Cost],
        work: impl Fn(usize) -> Result<T, StoreError> + Sync,
    ) -> Result<Vec<T>, RunError> {
        let (progress, memory) = (self.progress, self.shop.plan.memory);
        let weight = |cost: &Cost| 1 + cost.tets as u64;
        let ask = || if progress.is_cancelled() { Err(RunError::Cancelled) } else { Ok(()) };
        let (done, total) = (AtomicU64::new(0), costs.iter().map(weight).sum());
        let step = |i: usize| {
            ask()?;
            let made = work(i)?;
            ask()?;
            let weight = weight(&costs[i]);
            progress.at(stage, done.fetch_add(weight, Ordering::Relaxed) + weight, total);
            Ok::<_, RunError>(made)
        };
        self.clock.time(progress, stage, total, || costliest_first(costs, memory, step))
    }

    /// Adds the failed attempts of successful blocks that have not been reported.
    fn tell_cured(&self, blocks: &Blocks, told: &mut BTreeSet<RecordId>, retries: &mut Vec<Retry>) {
        let (skeleton, partition) = (self.shop.skeleton, &blocks.partition);
        for (block, record) in (0_u32..).zip(blocks.records()) {
            let Some((record, cured)) = record.and_then(|record| Some((record, blocks.cured.get(&record)?))) else {
                continue;
            };
            if !told.insert(record) {
                continue;
            }
            let nodes = match block.checked_sub(blocks.clusters.len() as u32) {
                None => original_nodes(skeleton, partition.nodes(ClusterId(block)).iter().copied()),
                Some(cut) => cut_nodes(skeleton, partition, CutId(cut)),
            };
            let Cured { failure: reason, remedy } = cured.clone();
            retries.push(Retry { block: blocks.name(block), nodes, reason, remedy });
        }
    }
}

/// Shared data for making the blocks of a partition, on all threads.
struct Making<'a> {
    shop: Workshop<'a>,
    partition: &'a Layout,
    tangled: &'a [Tangle],
    watch: Watch<'a>,
    stopwatch: Stopwatch,
    /// Strategies that helped failed blocks.
    heard: Mutex<FxHashMap<RecordId, Cured>>,
}

impl Making<'_> {
    /// A cluster, or a connector between the discs that its vessel gives.
    fn block(&self, block: u32) -> Result<BlockResult, StoreError> {
        let (shop, partition) = (self.shop, self.partition);
        let make = || match block.checked_sub(self.tangled.len() as u32) {
            None => {
                let (id, tangled) = (ClusterId(block), self.tangled[block as usize]);
                shop.cluster(id, &partition.cluster(id), tangled, RetryStrategy::Usual, &self.watch)
            }
            Some(cut) => shop.free_connector(CutId(cut), &partition.cut(CutId(cut))),
        };
        self.hear(self.stopwatch.time(block as usize, make)?)
    }

    /// Makes a connector between the ends of its clusters; `None` beside a failed one.
    fn woven(&self, id: CutId, clusters: &[BlockResult]) -> Result<Option<BlockResult>, StoreError> {
        let cut = &self.partition.cut(id);
        let Some(ends) = self.shop.stored_ends(self.partition, id, cut, clusters)? else { return Ok(None) };
        let make = || self.shop.woven_connector(id, cut, &ends);
        self.hear(self.stopwatch.time(clusters.len() + id.0 as usize, make)?).map(Some)
    }

    /// Records the failed attempts of a successful block.
    fn hear(&self, made: BlockResult) -> Result<BlockResult, StoreError> {
        if let Ok(kept) = &made
            && let Some(cured) = self.shop.about(kept)?.cured
        {
            self.heard.lock().unwrap_or_else(PoisonError::into_inner).insert(kept.records.geometry, cured);
        }
        Ok(made)
    }
}

/// Numbers of the blocks to make; the first block has the number `from`.
fn missing(made: &[Option<BlockResult>], from: usize) -> impl Iterator<Item = u32> {
    made.iter().enumerate().filter(|(_, made)| made.is_none()).map(move |(i, _)| (from + i) as u32)
}

/// Returns the blocks if none is missing.
fn all(made: Vec<Option<BlockResult>>) -> Vec<BlockResult> {
    made.into_iter().map_while(|made| made).collect()
}

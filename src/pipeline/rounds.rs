//! All blocks of a network, with retries: a block that fails is tried with other parameters, then with its cuts moved,
//! then joined to its neighbours.

use super::blocks::{Blocks, cut_nodes, original_nodes};
use std::collections::{BTreeMap, BTreeSet};
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::attempts::Way;
use super::cures::{Cure, cure, partition_params};
use super::error::RunError;
use super::estimate::{Estimate, TooLarge, cluster_cost, connector_cost};
use super::make::{Kept, Made, Workshop};
use super::plan::JointStyle;
use super::report::Retry;
use super::routes::{branch_pairs, tangled_clusters};
use super::schedule::{Cost, costliest_first};
use super::sizes;
use super::store::{KeyMaker, RecordId, StoreError, fingerprint};
use super::timing::{BlockTimes, Clock};
use crate::block::Cured;
use crate::partition::{self, ClusterId, CutId, Layout};
use crate::progress::{Progress, Stage};
use crate::skeleton::{BranchId, Overlaps};
use crate::tet::Watch;

/// How often the partition is changed because of blocks that fail.
const ROUNDS: usize = 6;

/// What a run works with.
pub struct Run<'a> {
    /// Vessels of the network that overlap.
    pub overlaps: &'a Overlaps,
    pub shop: Workshop<'a>,
    /// Whether it says what becomes of sizes that are asked for: once is enough.
    pub tells: bool,
    pub progress: &'a dyn Progress,
    pub clock: &'a mut Clock,
}

/// Clusters and connectors.
type Pass = (Vec<Made>, Vec<Option<Made>>);

impl Run<'_> {
    /// Meshes every block, changing the partition where blocks fail. `uncut`: vessels that are not cut. `fits` is asked before
    /// the first block.
    ///
    /// # Errors
    /// When the network cannot be partitioned, or blocks cannot be kept.
    pub fn build(
        &mut self,
        uncut: &BTreeSet<BranchId>,
        fits: &dyn Fn(&Estimate) -> Result<(), TooLarge>,
    ) -> Result<Blocks, RunError> {
        let plan = self.shop.plan;
        let mut cures: BTreeMap<BranchId, Cure> = uncut.iter().map(|&branch| (branch, Cure::NotCut)).collect();
        let together = self.together();
        let mut notes = Notes::default();
        let mut times = BlockTimes::default();
        let mut round = 0;
        loop {
            let partition = self.partition(&cures, &together)?;
            if round == 0 {
                fits(&Estimate::of(&partition, plan))?;
                if self.tells {
                    sizes::announce(self.shop.skeleton, &partition, plan, self.progress);
                }
            }
            let (clusters, connectors) = self.pass(&partition, &mut times)?;
            notes.take(self, &partition, &clusters, &connectors)?;
            let blocks = Blocks { partition, clusters, connectors, retries: Vec::new(), times: BlockTimes::default() };
            let found = if round < ROUNDS { cure(self.shop.skeleton, &blocks, &mut cures) } else { Vec::new() };
            if found.is_empty() {
                return Ok(Blocks { retries: notes.retries, times, ..blocks });
            }
            notes.retries.extend(found);
            round += 1;
        }
    }

    /// Branches that are to be in one cluster, as their vessels overlap.
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
        let (Workshop { skeleton, plan, store }, progress) = (self.shop, self.progress);
        let params = partition_params(skeleton, plan, cures, together);
        let key = || {
            let mut key = KeyMaker::new("partition");
            key.text(&format!("{:?} {params:?}", fingerprint(skeleton)));
            key.finish()
        };
        let cut = || partition::lay_out(skeleton, &params).map_err(RunError::from);
        let kept =
            || Ok(store.once(("partition", key), progress, cut)?.of(Arc::clone(skeleton)).sized(plan.size_at.clone()));
        self.clock.time(progress, Stage::Partition, 0, kept)
    }

    /// What blocks are expected to take: clusters by their ids, then connectors.
    pub(super) fn costs(&self, partition: &Layout) -> Vec<Cost> {
        let plan = self.shop.plan;
        let clusters = partition.clusters().map(|c| cluster_cost(&c, plan));
        clusters.chain(partition.cuts().map(|cut| connector_cost(&cut, plan))).collect()
    }

    /// All blocks of a partition; none needs another, unless joints are woven.
    fn pass(&mut self, partition: &Layout, times: &mut BlockTimes) -> Result<Pass, RunError> {
        let (plan, shop) = (self.shop.plan, self.shop);
        let tangled = tangled_clusters(self.shop.skeleton, partition, self.overlaps);
        let count = partition.clusters_len();
        let costs = self.costs(partition);
        let progress = self.progress;
        let watch = Watch::asking(progress);
        let cluster = |i: usize| {
            let id = ClusterId(i as u32);
            shop.cluster(id, &partition.cluster(id), tangled[i], Way::Usual, &watch)
        };
        if plan.joint != JointStyle::Woven {
            let connector = |i: usize| shop.free_connector(CutId(i as u32), &partition.cut(CutId(i as u32)));
            let one = |i: usize| if i < count { cluster(i) } else { connector(i - count) };
            let (mut clusters, seconds) = self.timed(Stage::Blocks, &costs, one)?;
            times.add(&seconds, count);
            let connectors = clusters.split_off(count);
            let is_made = |(cluster, _): (ClusterId, u32)| clusters[cluster.0 as usize].is_ok();
            let beside = |cut: u32| partition.sides_of_cut(CutId(cut)).into_iter().all(is_made);
            let connectors = (0..).zip(connectors).map(|(cut, made)| beside(cut).then_some(made)).collect();
            return Ok((clusters, connectors));
        }
        let (clusters, mut seconds) = self.timed(Stage::Clusters, &costs[..count], cluster)?;
        let woven = |i: usize| {
            let (id, cut) = (CutId(i as u32), &partition.cut(CutId(i as u32)));
            let ends = shop.stored_ends(partition, id, cut, &clusters)?;
            ends.map(|ends| shop.woven_connector(id, cut, &ends)).transpose()
        };
        let (connectors, more) = self.timed(Stage::Connectors, &costs[count..], woven)?;
        seconds.extend(more);
        times.add(&seconds, count);
        Ok((clusters, connectors))
    }

    /// One stage over blocks: what became of them, and their seconds. Ends early when it is told to: blocks that
    /// failed because of that are no failures.
    pub(super) fn timed<T: Send>(
        &mut self,
        stage: Stage,
        costs: &[Cost],
        work: impl Fn(usize) -> Result<T, StoreError> + Sync,
    ) -> Result<(Vec<T>, Vec<f64>), RunError> {
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
        let run = || costliest_first(costs, memory, step);
        Ok(self.clock.time(progress, stage, total, run)?.into_iter().unzip())
    }
}

/// What blocks say of failures before they came out; each block says it once.
#[derive(Default)]
struct Notes {
    retries: Vec<Retry>,
    heard: BTreeSet<RecordId>,
}

impl Notes {
    fn take(
        &mut self,
        run: &Run,
        partition: &Layout,
        clusters: &[Made],
        connectors: &[Option<Made>],
    ) -> io::Result<()> {
        for (i, kept) in clusters.iter().enumerate().filter_map(|(i, made)| Some((i, made.as_ref().ok()?))) {
            let nodes = || original_nodes(run.shop.skeleton, partition.nodes(ClusterId(i as u32)).iter().copied());
            self.hear(run, kept, &format!("cluster {i}"), nodes)?;
        }
        for (i, made) in connectors.iter().enumerate() {
            let Some(Ok(kept)) = made else { continue };
            let nodes = || cut_nodes(run.shop.skeleton, partition, CutId(i as u32));
            self.hear(run, kept, &format!("connector {i}"), nodes)?;
        }
        Ok(())
    }

    fn hear(&mut self, run: &Run, kept: &Kept, block: &str, nodes: impl Fn() -> Vec<u32>) -> io::Result<()> {
        if self.heard.insert(kept.record)
            && let Some(Cured { failure, remedy }) = run.shop.about(kept)?.cured
        {
            self.retries.push(Retry { block: block.into(), nodes: nodes(), reason: failure, remedy });
        }
        Ok(())
    }
}

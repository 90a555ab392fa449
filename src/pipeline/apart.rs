//! Blocks that intersect each other.
//!
//! A block is meshed without knowledge of the vessels of other blocks. A web in the crotch of a bifurcation, or the facets
//! of a thick vessel, may reach a vessel nearby. The check of the whole mesh finds this. The clusters are then meshed
//! again with a finer grid. If their walls still meet, and vessels may fuse, theirs are meshed in one cluster.

use std::collections::BTreeMap;

use super::attempts::RetryStrategy;
use super::blocks::{Blocks, Meetings, original_nodes};
use super::error::RunError;
use super::estimate::cluster_cost;
use super::report::Retry;
use super::rounds::RunContext;
use super::routes::{Overlapping, Uncut, branches_of_pairs};
use super::seen::Seen;
use super::whole::Whole;
use crate::partition::{ClusterId, CutId};
use anastomesh_mesh::progress::{Stage, ask};
use anastomesh_skeleton::BranchId;
use anastomesh_tet::parts::Watch;

/// Cures of intersecting blocks, in this round and earlier ones.
#[derive(Debug, Default)]
pub struct Apart {
    /// Intersecting blocks, once per remeshed cluster.
    met: Vec<Meetings>,
    uncut: Uncut,
    /// Number of times that vessels were left uncut.
    rounds: usize,
}

/// Maximum passes that leave vessels uncut because their connectors intersect another block.
const MAX_UNCUT_PASSES: usize = 2;

/// Maximum pairs of intersecting blocks that are meshed in one cluster. Where more intersect, clusters would become large.
const MAX_JOINED: usize = 16;

impl Apart {
    /// Decides how to cure intersecting blocks. Returns false if no cure is left.
    pub fn part(&mut self, meetings: &Meetings, blocks: &Blocks, run: &RunContext) -> bool {
        if meetings.is_empty() {
            return false;
        }
        let partition = &blocks.partition;
        let overlapping = Overlapping::of(run.shop.skeleton, partition, run.overlaps);
        let mut meetings: Meetings = meetings.iter().copied().filter(|pair| !overlapping.do_overlap(*pair)).collect();
        let clusters = partition.clusters_len();
        let is_cluster = |block: u32| (block as usize) < clusters;
        let tried = self.met.len() == RetryStrategy::APART.len();
        // Connectors are not made finer.
        let stuck = meetings.iter().filter(|pair| tried || !is_cluster(pair[0]));
        let connectors = stuck.flatten().filter(|&&block| !is_cluster(block));
        let branches: Vec<BranchId> =
            connectors.map(|&i| partition.branch_of_cut(CutId(i - clusters as u32))).collect();
        if !branches.is_empty() && self.rounds < MAX_UNCUT_PASSES {
            self.rounds += 1;
            self.uncut.branches.extend(branches);
            self.met.clear();
            return true;
        }
        let is_stuck = tried || !meetings.iter().any(|pair| is_cluster(pair[0]));
        let may_join = is_stuck && run.shop.plan.fuse && self.uncut.joined.is_empty();
        if may_join && (1..=MAX_JOINED).contains(&meetings.len()) {
            let count = meetings.len();
            run.progress
                .note(&format!("walls intersect with finer edges, too: meshed as one cluster at {count} places"));
            self.uncut.joined = branches_of_pairs(partition, &meetings);
            self.met.clear();
            return true;
        }
        meetings.retain(|pair| is_cluster(pair[0]));
        if meetings.is_empty() || tried {
            return false;
        }
        self.met.push(meetings);
        true
    }
}

impl RunContext<'_> {
    /// Remeshes blocks while some intersect and cures remain, and checks their walls and the walls nearby. `seen`: facts about
    /// the present walls. Also ends when a block fails.
    ///
    /// # Errors
    /// The network cannot be cut otherwise, the store fails, or the run is cancelled.
    pub fn part(&mut self, mut blocks: Blocks, apart: &mut Apart, mut seen: Seen) -> Result<Blocks, RunError> {
        loop {
            match apart.met.last() {
                Some(meetings) => self.set_apart(&mut blocks, meetings, RetryStrategy::APART[apart.met.len() - 1])?,
                None => blocks = self.build(&apart.uncut, Some(blocks), &|_| Ok(()))?,
            }
            if blocks.any_failed() && !self.shop.plan.keep_going {
                return Ok(blocks);
            }
            let follow = || seen.follow(&blocks, &Whole::of_walls(self.shop.store, self.progress, &blocks)?);
            self.clock.time(self.progress, Stage::Check, 0, follow)?;
            ask(self.progress)?;
            if !apart.part(&seen.meetings, &blocks, self) {
                return Ok(blocks);
            }
        }
    }

    /// Remeshes the clusters whose walls intersect others, with the given strategy. A cluster for which it fails is unchanged.
    ///
    /// # Errors
    /// The store fails, or the run is cancelled.
    fn set_apart(&mut self, blocks: &mut Blocks, meetings: &Meetings, way: RetryStrategy) -> Result<(), RunError> {
        let (plan, partition) = (self.shop.plan, &blocks.partition);
        let shop = self.shop.among(partition.clusters_len());
        let mut again: BTreeMap<u32, u32> = BTreeMap::new();
        for &[a, b] in meetings {
            again.entry(a).or_insert(b);
            again.entry(b).or_insert(a);
        }
        let again: Vec<(usize, u32)> = again.into_iter().map(|(block, other)| (block as usize, other)).collect();
        let clusters = again.partition_point(|(block, _)| *block < partition.clusters_len());
        let again = &again[..clusters];
        let tangled = &blocks.tangled;
        let costs: Vec<_> =
            again.iter().map(|(i, _)| cluster_cost(&partition.cluster(ClusterId(*i as u32)), plan)).collect();
        let progress = self.progress;
        let watch = Watch::asking(progress);
        let make = |k: usize| {
            let i = again[k].0;
            let id = ClusterId(i as u32);
            shop.cluster(id, &partition.cluster(id), tangled[i], way, &watch)
        };
        let made = self.timed(Stage::Blocks, &costs, make)?;
        for (&(i, other), made) in again.iter().zip(made) {
            let remedy = match &made {
                Ok(_) => way.name().into(),
                Err(error) => format!("left as it is, for finer it fails: {error}"),
            };
            blocks.retries.push(Retry {
                block: blocks.name(i as u32),
                nodes: original_nodes(shop.skeleton, blocks.partition.nodes(ClusterId(i as u32)).iter().copied()),
                reason: format!("its wall meets that of {}", blocks.name(other)),
                remedy,
            });
            if made.is_ok() {
                blocks.clusters[i] = made;
                blocks.apart.insert(i as u32);
            }
        }
        Ok(())
    }
}

//! Blocks that a network keeps when it is cut otherwise.

use rustc_hash::FxHashMap;

use super::blocks::Blocks;
use super::make::BlockResult;
use super::routes::Tangle;
use super::store::RecordId;
use super::timing::BlockTimes;
use crate::block::Cured;
use crate::partition::{ClusterId, CutId, Layout};

/// Blocks by their numbers as the network is cut now; none where one has to be made.
#[derive(Default)]
pub(super) struct Carried {
    pub clusters: Vec<Option<BlockResult>>,
    pub connectors: Vec<Option<BlockResult>>,
    pub cured: FxHashMap<RecordId, Cured>,
    pub times: BlockTimes,
}

impl Carried {
    /// Those of `before` that are made from the same in `partition`: the store would find them by the same keys. `woven`:
    /// connectors are made from the ends of their clusters.
    pub(super) fn over(before: Option<Blocks>, partition: &Layout, tangled: &[Tangle], woven: bool) -> Self {
        let none = |count: usize| (0..count).map(|_| None).collect();
        let Some(mut before) = before else {
            let (clusters, connectors) = (none(partition.clusters_len()), none(partition.cuts_len()));
            return Self { clusters, connectors, ..Self::default() };
        };
        let same = partition.same_as(&before.partition);
        let cluster = |(i, j): (usize, Option<_>)| {
            let j: usize = j.map(|id: ClusterId| id.0 as usize)?;
            let usual = tangled[i] == before.tangled[j] && !before.apart.contains(&(j as u32));
            usual.then(|| take(&mut before.clusters[j], i == j)).flatten()
        };
        let clusters: Vec<Option<BlockResult>> = same.clusters.into_iter().enumerate().map(cluster).collect();
        let is_kept = |cut: u32| {
            let is_kept = |side: (ClusterId, u32)| clusters[side.0.0 as usize].is_some();
            !woven || partition.sides_of_cut(CutId(cut)).into_iter().all(is_kept)
        };
        let connector = |(i, j): (usize, Option<CutId>)| {
            let j = j.filter(|_| is_kept(i as u32))?.0 as usize;
            before.connectors[j].as_mut().and_then(|made| take(made, i == j))
        };
        let connectors = same.cuts.into_iter().enumerate().map(connector).collect();
        Self { clusters, connectors, cured: before.cured, times: before.times }
    }
}

/// Result of a block. The reason of a failure names the block by its number, which must be the same.
fn take(made: &mut BlockResult, same_number: bool) -> Option<BlockResult> {
    match made {
        Ok(kept) => Some(Ok(*kept)),
        Err(error) => same_number.then(|| Err(error.clone())),
    }
}

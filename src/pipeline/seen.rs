//! Cached facts about the walls of all blocks. After some are remade, only these are updated, and what is near
//! them, is looked at.

use std::io;

use super::blocks::{Blocks, Meetings};
use super::store::RecordId;
use super::whole::Whole;
use crate::partition::{CutId, Layout};
use anastomesh_mesh::check::parts::{Changed, Looked, meetings_of};
use anastomesh_mesh::geometry::Aabb;

const NONE: u32 = u32::MAX;

/// Walls that were looked at, by the numbers of their blocks: clusters by their ids, then connectors.
pub struct Seen {
    /// Place of each finished block in the store.
    records: Vec<Option<RecordId>>,
    /// Boxes of their walls.
    boxes: Vec<Aabb>,
    /// Pairs whose walls meet.
    pub meetings: Meetings,
}

impl Seen {
    /// Of a whole that was looked at in full.
    pub fn of(blocks: &Blocks, whole: &Whole, looked: Looked) -> Self {
        let records: Vec<Option<RecordId>> = blocks.records().collect();
        let meetings = whole.blocks_that_meet(&looked);
        let mut boxes = looked.into_boxes();
        if boxes.len() < records.len() {
            // Some blocks have no part.
            let of_parts = std::mem::replace(&mut boxes, vec![Aabb::EMPTY; records.len()]);
            for (part, aabb) in (0..).zip(of_parts) {
                boxes[whole.block_of(part) as usize] = aabb;
            }
        }
        Self { records, boxes, meetings }
    }

    /// Updates the facts for other blocks, most of which are unchanged. `whole`: all of them.
    ///
    /// # Errors
    /// A block cannot be read.
    pub fn follow(&mut self, blocks: &Blocks, whole: &Whole) -> io::Result<()> {
        let records: Vec<Option<RecordId>> = blocks.records().collect();
        let (old, new) = (by_record(&self.records), by_record(&records));
        let at = |places: &[u32], record: RecordId| places.get(record.index()).copied().filter(|&place| place != NONE);
        // The number that a block had, if it is the only one with its record before and after.
        let before = |block: u32| {
            let record = records[block as usize]?;
            at(&new, record)?;
            at(&old, record)
        };
        let mut boxes = vec![Aabb::EMPTY; records.len()];
        let is_changed = changed(&blocks.partition, |block| before(block).is_none());
        let (mut of_parts, mut parts) = (Vec::new(), Vec::new());
        for (part, block) in (0..).zip(whole.blocks()) {
            let aabb = match before(block) {
                Some(old) => self.boxes[old as usize],
                None => whole.bounds(part)?,
            };
            boxes[block as usize] = aabb;
            of_parts.push(aabb);
            if is_changed[block as usize] {
                parts.push(part);
            }
        }
        let now = |block: u32| at(&new, self.records[block as usize]?).filter(|&block| !is_changed[block as usize]);
        let mut meetings: Meetings = self
            .meetings
            .iter()
            .filter_map(|&[a, b]| Some([now(a)?, now(b)?]))
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        let found = meetings_of(whole, Changed { boxes: &of_parts, parts: &parts })?;
        meetings.extend(found.into_iter().map(|pair| pair.map(|part| whole.block_of(part))));
        meetings.sort_unstable();
        *self = Self { records, boxes, meetings };
        Ok(())
    }
}

/// The block that each record belongs to; none where it belongs to several.
fn by_record(records: &[Option<RecordId>]) -> Vec<u32> {
    let count = records.iter().flatten().map(|record| record.index() + 1).max().unwrap_or(0);
    let mut places = vec![(NONE, false); count];
    for (block, record) in (0..).zip(records) {
        let Some(record) = record else { continue };
        let (place, is_met) = &mut places[record.index()];
        *place = if *is_met { NONE } else { block };
        *is_met = true;
    }
    places.into_iter().map(|(place, _)| place).collect()
}

/// Blocks whose walls have changed: new blocks, and their neighbours, because an unjoined joint is wall.
fn changed(partition: &Layout, is_new: impl Fn(u32) -> bool) -> Vec<bool> {
    let clusters = partition.clusters_len() as u32;
    let blocks = clusters + partition.cuts_len() as u32;
    let mut changed: Vec<bool> = (0..blocks).map(&is_new).collect();
    for cut in 0..partition.cuts_len() as u32 {
        let [a, b] = partition.sides_of_cut(CutId(cut)).map(|(cluster, _)| cluster.0);
        let beside = [a, clusters + cut, b];
        if beside.into_iter().any(&is_new) {
            for block in beside {
                changed[block as usize] = true;
            }
        }
    }
    changed
}

#[cfg(test)]
mod tests {
    use super::super::make::Workshop;
    use super::super::plan::MeshPlan;
    use super::super::rounds::RunContext;
    use super::super::routes::Uncut;
    use super::super::store::Store;
    use super::super::tests::through_the_crotch;
    use super::super::timing::Clock;
    use super::*;
    use anastomesh_flow::TerminalPatches;
    use anastomesh_mesh::geometry::{Point3, Vec3};
    use anastomesh_mesh::progress::{Progress, Stage};
    use anastomesh_skeleton::{Edge, Node, NodeId, Skeleton};
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Counts blocks that are made or looked up, and records that passes over a whole read.
    #[derive(Default)]
    struct Counts {
        blocks: AtomicUsize,
        read: AtomicUsize,
    }

    impl Progress for Counts {
        fn at(&self, stage: Stage, done: u64, _: u64) {
            self.blocks.fetch_add(usize::from(stage == Stage::Blocks && done > 0), Ordering::Relaxed);
        }

        fn is_cancelled(&self) -> bool {
            self.read.fetch_add(1, Ordering::Relaxed);
            false
        }
    }

    impl Counts {
        fn taken(&self) -> [usize; 2] {
            [&self.blocks, &self.read].map(|count| count.swap(0, Ordering::Relaxed))
        }
    }

    /// A fork with a vessel through its crotch, and `count` forks far from it.
    fn many_forks(count: u32) -> Skeleton {
        let mut network = through_the_crotch(4.0);
        for k in 1..=count {
            let (first, at) = (network.nodes.len() as u32, Point3::new(0.0, 100.0 * f64::from(k), 0.0));
            let arms = [[0.0, 0.0, 0.0], [-14.0, 0.0, 0.0], [14.0, 5.0, 0.0], [14.0, -5.0, 0.0]];
            for (i, arm) in (0..).zip(arms) {
                network.nodes.push(Node { position: at + Vec3::from(arm), radius: 1.0, original: first + i });
            }
            let edge = |i: u32| Edge { nodes: [NodeId(first), NodeId(first + i)], radii: [1.0; 2] };
            network.edges.extend((1..4).map(edge));
        }
        network
    }

    #[test]
    fn a_second_round_looks_at_what_changed_and_at_what_is_near_it() {
        let (skeleton, plan, store) = (Arc::new(many_forks(20)), MeshPlan::default(), Store::in_memory());
        let overlaps = skeleton.overlaps(&skeleton.adjacency());
        let patches = TerminalPatches::assign(&skeleton, &[]).expect("terminals");
        let (counts, mut clock) = (Counts::default(), Clock::default());
        let shop = Workshop::new(&skeleton, &plan, &store);
        let mut run = RunContext { overlaps: &overlaps, shop, progress: &counts, clock: &mut clock };
        let fits = |_: &_| Ok(());
        let first = run.build(&Uncut::default(), None, &fits).expect("blocks");
        let blocks = first.clusters.len() + first.connectors.len();
        assert!(blocks > 140 && counts.taken()[0] > blocks);
        let whole = Whole::new(&store, &counts, &skeleton, &first, &patches).expect("numbered");
        let mut seen = Seen::of(&first, &whole, whole.look(1 << 30).expect("readable"));
        assert!(!seen.meetings.is_empty() && counts.taken()[1] > 2 * blocks);
        drop(whole);
        // The trunk of the first fork is left uncut, then cut again: numbers of all blocks but the first change.
        let branches = [first.partition.branch_of_cut(CutId(0))].into();
        let uncut = Uncut { branches, ..Uncut::default() };
        let mut before = first;
        for uncut in [&uncut, &Uncut::default()] {
            counts.taken();
            let after = run.build(uncut, Some(before), &fits).expect("blocks");
            assert!((1..8).contains(&counts.taken()[0]), "most are carried over");
            let walls = Whole::of_walls(&store, &counts, &after).expect("numbered");
            seen.follow(&after, &walls).expect("readable");
            assert!((1..60).contains(&counts.taken()[1]), "most are not looked at");
            let full = Seen::of(&after, &walls, walls.look(1 << 30).expect("readable"));
            assert_eq!((&seen.records, &seen.boxes, &seen.meetings), (&full.records, &full.boxes, &full.meetings));
            assert!(!seen.meetings.is_empty());
            let alone = run.build(uncut, None, &fits).expect("blocks");
            assert_eq!((&alone.clusters, &alone.connectors), (&after.clusters, &after.connectors));
            before = after;
        }
    }
}

//! What is known of the walls of all blocks, kept true while some of them are made again: only these, and what is near
//! them, is looked at.

use std::io;

use super::blocks::{Blocks, Meetings};
use super::store::RecordId;
use super::whole::Whole;
use crate::geometry::Aabb;
use crate::mesh::check::parts::{Changed, Looked, meetings_of};
use crate::partition::{CutId, Layout};

const NONE: u32 = u32::MAX;

/// Walls that were looked at, by the numbers of their blocks: clusters by their ids, then connectors.
pub struct Seen {
    /// Where each block is kept, as far as it is there.
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
        let mut boxes = vec![Aabb::EMPTY; records.len()];
        for (part, aabb) in (0..).zip(looked.into_boxes()) {
            boxes[whole.block_of(part) as usize] = aabb;
        }
        Self { records, boxes, meetings }
    }

    /// The same of other blocks, of which most are those that were there before. `whole`: all of them.
    ///
    /// # Errors
    /// When a block cannot be read.
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

/// Blocks whose walls are not what they were: those that are new, and those beside them, for a joint to which nothing is
/// joined is wall.
fn changed(partition: &Layout, is_new: impl Fn(u32) -> bool) -> Vec<bool> {
    let clusters = partition.clusters_len() as u32;
    let blocks = clusters + partition.cuts_len() as u32;
    let mut changed: Vec<bool> = (0..blocks).map(&is_new).collect();
    for cut in 0..partition.cuts_len() as u32 {
        let [a, b] = partition.sides_of_cut(CutId(cut)).map(|(cluster, _)| cluster.0);
        let beside = [a, clusters + cut, b];
        if beside.into_iter().any(&is_new) {
            beside.into_iter().for_each(|block| changed[block as usize] = true);
        }
    }
    changed
}

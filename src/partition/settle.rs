//! Selects cuts and places their planes so that every end of a cluster is clear of the cluster's other vessels.
//!
//! The vessels of a cluster depend on its cuts, and cuts depend on the vessels of their clusters. All candidate cuts
//! start enabled. Planes without clearance move away from their cluster; cuts without any clear place are dropped,
//! which joins two clusters. Both changes are monotone, so the iteration terminates.

use super::clearance::{Tip, tip_middle};
use super::near::{Near, Obstacle, ObstacleKind, terminal_overrun};
use super::params::{PartitionError, PartitionParams};
use super::parts::UncutReason;
use super::window::Slot;
use anastomesh_mesh::geometry::{DisjointSets, Section, Tube};
use anastomesh_mesh::progress::Progress;
use anastomesh_skeleton::course::{Course, Courses, Way};
use anastomesh_skeleton::{BranchId, NodeId};
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use std::sync::Arc;

/// Piece of a branch that lies in one cluster.
#[derive(Clone, Copy, Debug)]
pub(super) struct BranchSpan {
    pub branch: u32,
    /// Cuts at its start and end; `None` at the branch's own ends.
    pub slots: [Option<u32>; 2],
    /// Its cluster, identified by an element of the union.
    pub root: u32,
}

pub(super) struct Settler<'a> {
    pub courses: Courses<'a>,
    pub params: &'a PartitionParams,
    pub slots: Vec<Slot>,
    /// Offsets of the slots per branch: `first_slot[branch]..first_slot[branch + 1]`.
    pub first_slot: Vec<u32>,
    pub runs: Vec<BranchSpan>,
    /// Offsets of the runs per branch: `first_run[branch]..first_run[branch + 1]`.
    pub first_run: Vec<u32>,
    /// Run indices sorted by cluster.
    by_root: Vec<u32>,
    /// Terminal flags of each branch's start and end.
    pub terminals: Vec<[bool; 2]>,
    union: DisjointSets,
    /// Smallest radius of each cluster, by root.
    r_min: Vec<f64>,
    /// Cached obstacles of large clusters, by root.
    large: FxHashMap<u32, Arc<Near>>,
    blending: f64,
}

/// Maximum number of runs in a cluster whose obstacles are not cached.
const LARGE: usize = 24;

/// Length before a plane, in radii, in which a vessel cannot obstruct its own tip. The axis of a straight vessel is
/// clear of the tip from 2.8 radii on. These are 0.5 of tip, 1 radius, and a margin of 1.3 for parallel vessels. The
/// rest is for bends.
const OWN_LEAD: f64 = 3.5;

/// Step of a moving plane, in radii; it grows after `STEADY_STEPS` steps.
const STEP: f64 = 0.25;
const STEPS: u32 = 96;
const STEADY_STEPS: u32 = 24;

impl<'a> Settler<'a> {
    pub fn new(
        nodes: usize,
        courses: Courses<'a>,
        params: &'a PartitionParams,
        slots: Vec<Slot>,
        terminals: Vec<[bool; 2]>,
    ) -> Self {
        let first_slot: Vec<u32> =
            (0..=courses.len() as u32).map(|b| slots.partition_point(|s| s.branch < b) as u32).collect();
        let blending = params.blending();
        let union = DisjointSets::new(slots.len() + courses.len() + nodes);
        let mut settler = Self {
            courses,
            params,
            r_min: vec![f64::INFINITY; union.len()],
            union,
            slots,
            first_slot,
            runs: Vec::new(),
            first_run: Vec::new(),
            by_root: Vec::new(),
            terminals,
            large: FxHashMap::default(),
            blending,
        };
        settler.join_pieces();
        settler
    }

    /// Union element of the `i`-th piece of a branch, counted with all of its slots.
    fn piece(&self, branch: u32, i: u32) -> u32 {
        self.first_slot[branch as usize] + branch + i
    }

    /// Union element of a node.
    fn node(&self, node: NodeId) -> u32 {
        (self.slots.len() + self.courses.len()) as u32 + node.0
    }

    fn join_pieces(&mut self) {
        for branch in 0..self.courses.len() as u32 {
            let [a, b] = self.courses.chains.ends(branch);
            let count = self.first_slot[branch as usize + 1] - self.first_slot[branch as usize];
            self.union.join(self.piece(branch, 0), self.node(a));
            self.union.join(self.piece(branch, count), self.node(b));
        }
        for &[a, b] in &self.params.together {
            self.union.join(self.piece(a.0, 0), self.piece(b.0, 0));
        }
    }

    /// Moves planes and drops cuts until every end is clear. Returns the reasons for dropped cuts, by branch.
    ///
    /// # Errors
    /// [`PartitionError::Cancelled`].
    pub fn settle(&mut self, progress: &dyn Progress) -> Result<Vec<(BranchId, UncutReason)>, PartitionError> {
        let mut given_up = Vec::new();
        let mut dirty = vec![true; self.union.len()];
        loop {
            self.gather();
            self.leave_clear(&mut dirty, progress)?;
            let mut changed: Vec<u32> = Vec::new();
            for run in 0..self.runs.len() {
                if progress.is_cancelled() {
                    return Err(PartitionError::Cancelled);
                }
                let BranchSpan { branch, slots, root } = self.runs[run];
                if !dirty[root as usize] {
                    continue;
                }
                let is_alive = |slot: Option<u32>| slot.is_some_and(|s| self.slots[s as usize].alive);
                if !slots.into_iter().any(is_alive) {
                    continue;
                }
                let near = self.near(root);
                for (way, slot) in [(Way::Back, slots[0]), (Way::Onward, slots[1])] {
                    let Some(slot) = slot.map(|s| s as usize).filter(|&s| self.slots[s].alive) else { continue };
                    let stands = self.slots[slot].planes[way.side()];
                    let Err(reason) = self.clear_at(&near, run, way, stands) else { continue };
                    changed.push(slot as u32);
                    if let Some(s) = self.clear_place(&near, run, way, slot) {
                        self.slots[slot].planes[way.side()] = s;
                    } else {
                        self.slots[slot].alive = false;
                        given_up.push((BranchId(branch), UncutReason::Clearance { near: reason }));
                    }
                }
            }
            if changed.is_empty() {
                break;
            }
            self.mark(&changed, &mut dirty);
        }
        Ok(given_up)
    }

    /// Removes the marks of small clusters whose ends are clear, which depends on the planes of a cluster alone.
    fn leave_clear(&self, dirty: &mut [bool], progress: &dyn Progress) -> Result<(), PartitionError> {
        let root_of = |&run: &u32| self.runs[run as usize].root;
        let marked: Vec<&[u32]> = self
            .by_root
            .chunk_by(|a, b| root_of(a) == root_of(b))
            .filter(|runs| dirty[root_of(&runs[0]) as usize])
            .collect();
        let is_clear = |runs: &&[u32]| {
            if progress.is_cancelled() {
                return Err(PartitionError::Cancelled);
            }
            Ok(runs.len() <= LARGE && self.is_clear(runs))
        };
        let clear: Vec<bool> = marked.par_iter().map(is_clear).collect::<Result<_, _>>()?;
        for (runs, is_clear) in marked.into_iter().zip(clear) {
            dirty[root_of(&runs[0]) as usize] = !is_clear;
        }
        Ok(())
    }

    /// True if all ends of a cluster's runs are clear.
    fn is_clear(&self, runs: &[u32]) -> bool {
        let near = self.near_of(runs);
        runs.iter().all(|&run| {
            let slots = self.runs[run as usize].slots;
            [(Way::Back, slots[0]), (Way::Onward, slots[1])].into_iter().all(|(way, slot)| {
                let slot = slot.map(|s| &self.slots[s as usize]).filter(|slot| slot.alive);
                slot.is_none_or(|slot| self.clear_at(&near, run as usize, way, slot.planes[way.side()]).is_ok())
            })
        })
    }

    /// Joins the pieces on both sides of dropped cuts and marks the clusters of all changed slots.
    fn mark(&mut self, changed: &[u32], dirty: &mut [bool]) {
        dirty.fill(false);
        let pieces = |s: &Self, slot: u32| {
            let branch = s.slots[slot as usize].branch;
            let i = slot - s.first_slot[branch as usize];
            [s.piece(branch, i), s.piece(branch, i + 1)]
        };
        for &slot in changed {
            if !self.slots[slot as usize].alive {
                let [a, b] = pieces(self, slot);
                self.union.join(a, b);
            }
        }
        for &slot in changed {
            for piece in pieces(self, slot) {
                dirty[self.union.find(piece) as usize] = true;
            }
        }
    }

    /// Updates the runs and the smallest radius of each cluster.
    fn gather(&mut self) {
        self.union.flatten();
        self.runs.clear();
        self.first_run.clear();
        for branch in 0..self.courses.len() as u32 {
            self.first_run.push(self.runs.len() as u32);
            let slots = self.first_slot[branch as usize]..self.first_slot[branch as usize + 1];
            let mut start = None;
            for slot in slots.clone().filter(|&s| self.slots[s as usize].alive) {
                let root = self.union.find(self.piece(branch, slot - slots.start));
                self.runs.push(BranchSpan { branch, slots: [start, Some(slot)], root });
                start = Some(slot);
            }
            let root = self.union.find(self.piece(branch, slots.end - slots.start));
            self.runs.push(BranchSpan { branch, slots: [start, None], root });
        }
        self.first_run.push(self.runs.len() as u32);
        self.r_min.fill(f64::INFINITY);
        for branch in 0..self.courses.len() {
            let course = self.courses.get(branch as u32);
            for run in self.first_run[branch] as usize..self.first_run[branch + 1] as usize {
                let run = self.runs[run];
                let [lo, hi] = self.range(&run, &course);
                let r = &mut self.r_min[run.root as usize];
                *r = r.min(course.radius_range(lo, hi)[0]);
            }
        }
        self.by_root.clear();
        self.by_root.extend(0..self.runs.len() as u32);
        let runs = &self.runs;
        self.by_root.sort_unstable_by_key(|&run| (runs[run as usize].root, run));
        self.large.clear();
    }

    /// Runs of a cluster, in ascending order.
    pub fn runs_of(&self, root: u32) -> &[u32] {
        let from = self.by_root.partition_point(|&run| self.runs[run as usize].root < root);
        let count = self.by_root[from..].partition_point(|&run| self.runs[run as usize].root == root);
        &self.by_root[from..from + count]
    }

    /// Returns the obstacles for the ends of a cluster.
    pub fn near(&mut self, root: u32) -> Arc<Near> {
        if let Some(near) = self.large.get(&root) {
            return Arc::clone(near);
        }
        let runs = self.runs_of(root);
        let is_large = runs.len() > LARGE;
        let near = Arc::new(self.near_of(runs));
        if is_large {
            self.large.insert(root, Arc::clone(&near));
        }
        near
    }

    /// Obstacles for the ends of some runs of a cluster, in ascending order.
    fn near_of(&self, runs: &[u32]) -> Near {
        let mut branches: Vec<u32> = runs.iter().map(|&run| self.runs[run as usize].branch).collect();
        branches.dedup();
        Near::new(self.courses, &self.terminals, &branches, self.params, self.blending)
    }

    /// Start and end of a run of a course.
    pub fn range(&self, run: &BranchSpan, course: &Course) -> [f64; 2] {
        let lo = run.slots[0].map_or(0.0, |s| self.slots[s as usize].planes[1]);
        let hi = run.slots[1].map_or_else(|| course.length(), |s| self.slots[s as usize].planes[0]);
        [lo, hi]
    }

    /// Smallest radius of a cluster.
    pub fn r_min(&self, root: u32) -> f64 {
        self.r_min[root as usize]
    }

    /// Overrun length of a vessel of radius `radius` in the cluster `root`.
    pub fn overrun(&self, radius: f64, root: u32) -> f64 {
        self.params.overruns().length(radius, self.r_min[root as usize])
    }

    /// Returns the next clear position for a plane, moving away from its cluster.
    fn clear_place(&self, near: &Near, run: usize, way: Way, slot: usize) -> Option<f64> {
        let Slot { branch, planes, .. } = self.slots[slot];
        let course = near.course(branch);
        let mut planes = planes;
        let mut step = STEP * course.radius(planes[way.side()], way);
        for i in 0..STEPS {
            planes[way.side()] += way.sign() * step;
            if planes[1] - planes[0] < self.params.rules(branch).room_between(course, planes[0], planes[1]) {
                return None;
            }
            if self.clear_at(near, run, way, planes[way.side()]).is_ok() {
                return Some(planes[way.side()]);
            }
            if i >= STEADY_STEPS {
                step *= 1.1;
            }
        }
        None
    }

    /// Checks that a run ending at `s` is clear of its cluster's other vessels. The error names an obstructing branch.
    fn clear_at(&self, near: &Near, run: usize, way: Way, s: f64) -> Result<(), BranchId> {
        let BranchSpan { branch, root, .. } = self.runs[run];
        let section = near.course(branch).section(s, way);
        let overrun = self.overrun(section.radius, root);
        self.tip_clear(near, run, way, s, &section, overrun)?;
        self.ends_clear(near, run, way, &Tip::new(section, overrun))
    }

    /// Checks that a tip is clear of the straight ends of its cluster's other vessels. These leave the course of the
    /// vessel: a straight run leads to the end plane, and the overrun continues it.
    fn ends_clear(&self, near: &Near, own: usize, way: Way, tip: &Tip) -> Result<(), BranchId> {
        let mut first: Option<u32> = None;
        near.query(&tip.aabb(self.blending), |obstacle| {
            let ObstacleKind::Edge(edge) = obstacle.kind else { return };
            let branch = obstacle.branch;
            if first.is_some_and(|b| b <= branch) {
                return;
            }
            let course = near.course(branch);
            for run in self.first_run[branch as usize] as usize..self.first_run[branch as usize + 1] as usize {
                let ends = Way::BOTH.into_iter().filter(|&end| !(run == own && end == way));
                let here = self.runs[run].root == self.runs[own].root;
                if here && ends.into_iter().any(|end| self.end_in_the_way(course, run, end, edge, tip, run == own)) {
                    first = Some(branch);
                }
            }
        });
        first.map_or(Ok(()), |b| Err(BranchId(b)))
    }

    /// True if the straight end of a run obstructs a tip. Only ends that overlap the edge `edge` of the course are
    /// checked. The tip's own vessel obstructs it only with the overrun at its other end.
    fn end_in_the_way(&self, course: &Course, run: usize, end: Way, edge: u32, tip: &Tip, own: bool) -> bool {
        let run = &self.runs[run];
        let arc = self.range(run, course);
        let flat = [0, 1].map(|i| run.slots[i].is_some() || self.terminals[run.branch as usize][i]);
        let (i, s) = (end.end_index(), arc[end.end_index()]);
        if !flat[i] {
            return false;
        }
        let start = course.run_start(s, end);
        if course.clipped(edge as usize, start.min(s), start.max(s)).is_none() {
            return false;
        }
        let section = course.section(s, end);
        let r = section.radius;
        let beyond = section.origin + section.axis * self.overrun(r, run.root);
        let overrun = Tube { a: section.origin, b: beyond, ra: r, rb: r };
        let straight = || {
            let tubes = course.tubes(arc[0], arc[1], flat);
            tubes[i * (tubes.len() - 1)]
        };
        !tip.rim_clears(&overrun, self.blending) || (!own && !tip.rim_clears(&straight(), self.blending))
    }

    /// Checks an end with a given overrun.
    pub fn tip_clear(
        &self,
        near: &Near,
        run: usize,
        way: Way,
        s: f64,
        section: &Section,
        overrun: f64,
    ) -> Result<(), BranchId> {
        let tip = Tip::new(*section, overrun);
        let mut first = None;
        near.query(&tip.aabb(self.blending), |obstacle| {
            if first.is_none_or(|b| obstacle.branch < b)
                && self.in_the_way(near.course(obstacle.branch), run, way, s, &tip, obstacle)
            {
                first = Some(obstacle.branch);
            }
        });
        first.map_or(Ok(()), |b| Err(BranchId(b)))
    }

    fn in_the_way(&self, course: &Course, own: usize, way: Way, s: f64, tip: &Tip, obstacle: &Obstacle) -> bool {
        let root = self.runs[own].root;
        let branch = obstacle.branch as usize;
        for run in self.first_run[branch] as usize..self.first_run[branch + 1] as usize {
            if self.runs[run].root != root {
                continue;
            }
            let slots = self.runs[run].slots;
            let mut reach = self.range(&self.runs[run], course);
            if run == own {
                reach[way.end_index()] = s;
            }
            // Overruns are close enough to the continued course.
            let beyond = |radius| tip_middle(radius, self.overrun(radius, root));
            if slots[0].is_some() {
                reach[0] -= beyond(course.radius(reach[0], Way::Back));
            }
            if slots[1].is_some() {
                reach[1] += beyond(course.radius(reach[1], Way::Onward));
            }
            let tube = match obstacle.kind {
                ObstacleKind::Edge(i) => {
                    let i = i as usize;
                    if run == own {
                        // The vessel that leads to the tip does not obstruct it, unless it returns to it.
                        let r = course.radii[i][0].max(course.radii[i][1]).max(course.radius(s, way));
                        let lead = s - way.sign() * OWN_LEAD * r;
                        match way {
                            Way::Onward => reach[1] = lead,
                            Way::Back => reach[0] = lead,
                        }
                    }
                    course.clipped(i, reach[0], reach[1])
                }
                ObstacleKind::Overrun(end) => {
                    let here = slots[end.end_index()].is_none() && !(run == own && end == way);
                    here.then(|| terminal_overrun(course, end, self.params))
                }
            };
            if tube.is_some_and(|tube| !tip.clears(&tube, self.blending)) {
                return true;
            }
        }
        false
    }
}

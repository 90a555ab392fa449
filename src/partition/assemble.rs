//! From settled cuts to the blocks' tubes, ends and paths.

use std::collections::BTreeMap;

use super::parts::{
    Cluster, ClusterEnd, ClusterId, Cut, CutId, EndKind, Partition, PartitionWarning, Piece, UncutReason,
};
use super::path::path;
use super::settle::{Run, Settler};
use crate::geometry::{Section, Tube};
use crate::skeleton::course::Way;
use crate::skeleton::{BranchId, NodeId};

const NONE: u32 = u32::MAX;

pub(super) fn assemble(mut settler: Settler, mut uncut: Vec<(BranchId, UncutReason)>) -> Partition {
    let (clusters, of_root) = clusters(&settler);
    let Shortened { overruns, warnings } = Shortened::of(&settler, &of_root);
    // Large networks ask for the room.
    settler.forget_obstacles();
    let mut assembly = Assembly {
        settler: &settler,
        of_root,
        overruns,
        cut_of_slot: vec![NONE; settler.slots.len()],
        partition: Partition { clusters, warnings, ..Partition::default() },
    };
    assembly.cuts();
    assembly.runs();
    // A branch of several cuts may have lost only some of them.
    let is_cut = |branch: u32| {
        let slots = settler.first_slot[branch as usize] as usize..settler.first_slot[branch as usize + 1] as usize;
        settler.slots[slots].iter().any(|s| s.alive)
    };
    uncut.retain(|(branch, _)| !is_cut(branch.0));
    uncut.sort_by_key(|(branch, _)| *branch);
    uncut.dedup_by_key(|(branch, _)| *branch);
    assembly.partition.uncut = uncut;
    assembly.partition
}

/// The clusters with their nodes, ordered by lowest node, those without a node last; and the cluster of each root.
fn clusters(settler: &Settler) -> (Vec<Cluster>, Vec<u32>) {
    let mut members: Vec<(u32, NodeId)> = Vec::new();
    for run in &settler.runs {
        let course = &settler.courses[run.branch as usize];
        let [lo, hi] = settler.range(run);
        let nodes = &course.branch.nodes;
        for (i, (&node, &s)) in nodes.iter().zip(&course.branch.arc).enumerate() {
            let end = i == 0 || i + 1 == nodes.len();
            if !end && s > lo && s < hi {
                members.push((run.root, node));
            }
        }
        for (node, slot) in course.branch.ends().into_iter().zip(run.slots) {
            if slot.is_none() {
                members.push((run.root, node));
            }
        }
    }
    members.sort_unstable();
    members.dedup();
    let mut roots: Vec<(NodeId, u32)> = Vec::new();
    for m in members.chunk_by(|a, b| a.0 == b.0) {
        roots.push((m[0].1, m[0].0));
    }
    roots.sort_unstable();
    let size = settler.runs.iter().map(|r| r.root + 1).max().unwrap_or(0);
    let mut of_root = vec![NONE; size as usize];
    let mut list = Vec::with_capacity(roots.len());
    let mut open = |root: u32| {
        if of_root[root as usize] == NONE {
            of_root[root as usize] = list.len() as u32;
            list.push(Cluster { nodes: Vec::new(), tubes: Vec::new(), ends: Vec::new() });
        }
    };
    for root in roots.iter().map(|r| r.1).chain(settler.runs.iter().map(|r| r.root)) {
        open(root);
    }
    for (root, node) in members {
        list[of_root[root as usize] as usize].nodes.push(node);
    }
    (list, of_root)
}

/// Terminals with another vessel in their way.
#[derive(Default)]
struct Shortened {
    /// Length of the overrun beyond an end (0 or 1) of a run, if it is not the usual one.
    overruns: BTreeMap<(u32, usize), f64>,
    warnings: Vec<PartitionWarning>,
}

impl Shortened {
    fn of(settler: &Settler, of_root: &[u32]) -> Self {
        let mut found = Self::default();
        for (index, run) in (0..).zip(&settler.runs) {
            let terminals = settler.terminals[run.branch as usize];
            for end in (0..2).filter(|&end| run.slots[end].is_none() && terminals[end]) {
                found.terminal(settler, index, end, ClusterId(of_root[run.root as usize]));
            }
        }
        found
    }

    fn terminal(&mut self, settler: &Settler, index: u32, end: usize, cluster: ClusterId) {
        let run = settler.runs[index as usize];
        let course = &settler.courses[run.branch as usize];
        let (way, s) = (Way::BOTH[end], settler.range(&run)[end]);
        let section = course.section(s, way);
        let r = section.radius;
        let full = settler.overrun(r, run.root);
        let Err(near) = settler.tip_clear(index as usize, way, s, &section, full) else { return };
        let node = course.branch.ends()[end];
        let least = (settler.params.shortest_overrun * r).min(full);
        let mut length = full;
        while length > least {
            length = (0.9 * length).max(least);
            if settler.tip_clear(index as usize, way, s, &section, length).is_ok() {
                self.overruns.insert((index, end), length);
                self.warnings.push(PartitionWarning::ShortOverrun { cluster, node, near, radii: length / r });
                return;
            }
        }
        self.overruns.insert((index, end), least);
        self.warnings.push(PartitionWarning::CapNotClear { cluster, node, near });
    }
}

struct Assembly<'a> {
    settler: &'a Settler<'a>,
    of_root: Vec<u32>,
    overruns: BTreeMap<(u32, usize), f64>,
    cut_of_slot: Vec<u32>,
    partition: Partition,
}

impl Assembly<'_> {
    fn cuts(&mut self) {
        let count = self.settler.slots.iter().filter(|s| s.alive).count();
        self.partition.cuts.reserve_exact(count);
        self.partition.cut_arcs.reserve_exact(count);
        for (i, slot) in self.settler.slots.iter().enumerate().filter(|(_, s)| s.alive) {
            self.cut_of_slot[i] = self.partition.cuts.len() as u32;
            self.partition.cuts.push(Cut {
                branch: BranchId(slot.branch),
                sides: Cut::NOWHERE,
                path: path(&self.settler.courses[slot.branch as usize], slot.planes),
            });
            self.partition.cut_arcs.push(slot.planes);
        }
    }

    /// Takes the runs cluster by cluster, so that no list keeps room for longer than it grows.
    fn runs(&mut self) {
        let cluster_of = |&run: &u32| self.of_root[self.settler.runs[run as usize].root as usize];
        let mut order: Vec<u32> = (0..self.settler.runs.len() as u32).collect();
        order.sort_by_key(cluster_of);
        let clusters: Vec<&[u32]> = order.chunk_by(|a, b| cluster_of(a) == cluster_of(b)).collect();
        self.partition.pieces.reserve_exact(order.len());
        for runs in clusters {
            for &run in runs {
                self.run(run);
            }
            let Some(piece) = self.partition.pieces.last() else { continue };
            let Cluster { nodes, tubes, ends } = &mut self.partition.clusters[piece.cluster.0 as usize];
            nodes.shrink_to_fit();
            tubes.shrink_to_fit();
            ends.shrink_to_fit();
        }
        self.partition.pieces.sort_unstable_by(|a, b| a.branch.cmp(&b.branch).then(a.arc[0].total_cmp(&b.arc[0])));
    }

    /// Gives a run's tubes and ends to its cluster.
    fn run(&mut self, index: u32) {
        let run = self.settler.runs[index as usize];
        let course = &self.settler.courses[run.branch as usize];
        let arc = self.settler.range(&run);
        let terminals = self.settler.terminals[run.branch as usize];
        let flat = [0, 1].map(|end| run.slots[end].is_some() || terminals[end]);
        let id = ClusterId(self.of_root[run.root as usize]);
        let cluster = &mut self.partition.clusters[id.0 as usize];
        let first = cluster.tubes.len() as u32;
        cluster.tubes.extend(course.tubes(arc[0], arc[1], flat));
        let tubes = first..cluster.tubes.len() as u32;
        self.partition.pieces.push(Piece { cluster: id, branch: BranchId(run.branch), arc, tubes });
        for (end, way) in Way::BOTH.into_iter().enumerate() {
            let section = course.section(arc[end], way);
            if let Some(slot) = run.slots[end] {
                self.cut_end(id, run, slot, way, section);
            } else if terminals[end] {
                let usual = self.settler.overrun(section.radius, run.root);
                let overrun = self.overruns.get(&(index, end)).copied().unwrap_or(usual);
                self.end(id, section, overrun, EndKind::Terminal(course.branch.ends()[end]));
            }
        }
    }

    fn cut_end(&mut self, id: ClusterId, run: Run, slot: u32, way: Way, section: Section) {
        let cut = CutId(self.cut_of_slot[slot as usize]);
        let overrun = self.settler.overrun(section.radius, run.root);
        let end = self.end(id, section, overrun, EndKind::Cut { cut, side: way.side() as u8 });
        self.partition.cuts[cut.0 as usize].sides[way.side()] = (id, end);
    }

    /// Adds an end and its overrun; returns the end's index.
    fn end(&mut self, id: ClusterId, section: Section, overrun: f64, kind: EndKind) -> u32 {
        let cluster = &mut self.partition.clusters[id.0 as usize];
        let tube = cluster.tubes.len() as u32;
        let Section { origin, axis, radius } = section;
        cluster.tubes.push(Tube { a: origin, b: origin + axis * overrun, ra: radius, rb: radius });
        cluster.ends.push(ClusterEnd { section, kind, overrun: tube });
        cluster.ends.len() as u32 - 1
    }
}

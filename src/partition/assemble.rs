//! From settled cuts to the blocks' tubes, ends and paths.

use super::course::Way;
use super::path::path;
use super::settle::{Run, Settler};
use super::{Cluster, ClusterEnd, ClusterId, Cut, CutId, EndKind, Partition, PartitionWarning, Piece, UncutReason};
use crate::geometry::{Section, Tube};
use crate::skeleton::{BranchId, NodeId};

const NONE: u32 = u32::MAX;

pub(super) fn assemble(settler: &Settler, mut uncut: Vec<(BranchId, UncutReason)>) -> Partition {
    let (clusters, of_root) = clusters(settler);
    let mut assembly = Assembly {
        settler,
        of_root,
        cut_of_slot: vec![NONE; settler.slots.len()],
        partition: Partition { clusters, ..Partition::default() },
    };
    assembly.cuts();
    for run in 0..settler.runs.len() {
        assembly.run(run);
    }
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

struct Assembly<'a> {
    settler: &'a Settler<'a>,
    of_root: Vec<u32>,
    cut_of_slot: Vec<u32>,
    partition: Partition,
}

impl Assembly<'_> {
    fn cuts(&mut self) {
        for (i, slot) in self.settler.slots.iter().enumerate().filter(|(_, s)| s.alive) {
            self.cut_of_slot[i] = self.partition.cuts.len() as u32;
            self.partition.cuts.push(Cut {
                branch: BranchId(slot.branch),
                sides: [(ClusterId(NONE), NONE); 2],
                path: path(&self.settler.courses[slot.branch as usize], slot.planes),
            });
            self.partition.cut_arcs.push(slot.planes);
        }
    }

    /// Gives a run's tubes and ends to its cluster.
    fn run(&mut self, index: usize) {
        let run = self.settler.runs[index];
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
        for (end, way) in [Way::Back, Way::Onward].into_iter().enumerate() {
            let section = course.section(arc[end], way);
            if let Some(slot) = run.slots[end] {
                self.cut_end(id, run, slot, way, section);
            } else if terminals[end] {
                let node = course.branch.ends()[end];
                let overrun = self.terminal_overrun(id, index, way, arc[end], node, &section);
                self.end(id, section, overrun, EndKind::Terminal(node));
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
        cluster.ends.push(ClusterEnd { section, kind, overrun: vec![tube] });
        cluster.ends.len() as u32 - 1
    }

    /// Length of the overrun beyond a terminal, shortened where another vessel is in its way.
    fn terminal_overrun(
        &mut self,
        cluster: ClusterId,
        run: usize,
        way: Way,
        s: f64,
        node: NodeId,
        section: &Section,
    ) -> f64 {
        let r = section.radius;
        let full = self.settler.overrun(r, self.settler.runs[run].root);
        let Err(near) = self.settler.tip_clear(run, way, s, section, full) else { return full };
        let least = (self.settler.params.shortest_overrun * r).min(full);
        let mut length = full;
        while length > least {
            length = (0.9 * length).max(least);
            if self.settler.tip_clear(run, way, s, section, length).is_ok() {
                let radii = length / r;
                self.partition.warnings.push(PartitionWarning::ShortOverrun { cluster, node, near, radii });
                return length;
            }
        }
        self.partition.warnings.push(PartitionWarning::CapNotClear { cluster, node, near });
        least
    }
}

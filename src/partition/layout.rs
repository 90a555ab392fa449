//! Compact form of a partition: only the cut positions are stored. The inputs of clusters and connectors are built on
//! access. For millions of vessels this takes a tenth of the memory of tubes, ends and paths.

mod same;
mod up;

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::fine::of_branch;
use super::params::Overruns;
use super::parts::{
    BranchPiece, Cluster, ClusterEnd, ClusterId, Cut, CutId, EndKind, ForkCells, Partition, PartitionWarning,
    UncutReason,
};
use super::path::path;
use super::settle::{BranchSpan, Settler};
use super::summary::{PartitionSummary, UncutCounts};
use anastomesh_mesh::geometry::{Section, Tube};
use anastomesh_skeleton::course::{Course, Courses, Way};
use anastomesh_skeleton::{BranchId, Chains, FinePlace, FineStation, Leg, NodeId, SizeAt, Skeleton};
use rayon::prelude::*;

const NONE: u32 = u32::MAX;
/// Length over which a vessel's direction at a bifurcation is measured, in radii of the node.
const LEG: f64 = 3.0;

/// Cut positions of a network. Clusters are ordered by their lowest node, cuts by branch and position.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Layout {
    #[serde(skip)]
    skeleton: Arc<Skeleton>,
    /// Requested edge sizes.
    #[serde(skip)]
    sizes: Option<SizeAt>,
    /// Cells of the forks, by cluster; empty if no fork has a template.
    #[serde(skip)]
    cells: ForkCells,
    chains: Chains,
    overrun: Overruns,
    /// Branch pieces of the clusters, cluster by cluster.
    pieces: Vec<Placed>,
    /// Offset of each cluster's pieces, plus the total.
    first_piece: Vec<u32>,
    /// Smallest radius of each cluster.
    r_min: Vec<f64>,
    /// Nodes of the clusters, and the offset for each cluster.
    nodes: Vec<NodeId>,
    first_node: Vec<u32>,
    cuts: Vec<PlacedCut>,
    /// Overrun lengths that differ from the default, by piece and end (0 or 1).
    overruns: BTreeMap<(u32, u8), f64>,
    uncut: Vec<(BranchId, UncutReason)>,
    warnings: Vec<PartitionWarning>,
    /// Places with shorter edges, by branch and arc length.
    #[serde(default)]
    fine: Vec<FineStation>,
}

/// Piece of a branch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Placed {
    branch: u32,
    /// Cuts at its ends; `NONE` at the branch's own ends.
    cuts: [u32; 2],
    /// True for ends that are terminals.
    terminals: [bool; 2],
}

/// Position of a cut.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct PlacedCut {
    branch: u32,
    planes: [f64; 2],
    sides: [(ClusterId, u32); 2],
}

impl Layout {
    pub(super) fn new(skeleton: Arc<Skeleton>, mut settler: Settler, mut uncut: Vec<(BranchId, UncutReason)>) -> Self {
        let found = Clusters::of(&settler);
        let Shortened { overruns, warnings } = Shortened::of(&mut settler, &found.of_root);
        let mut cut_of_slot = vec![NONE; settler.slots.len()];
        let mut cuts = Vec::with_capacity(settler.slots.iter().filter(|s| s.alive).count());
        for (i, slot) in settler.slots.iter().enumerate().filter(|(_, s)| s.alive) {
            cut_of_slot[i] = cuts.len() as u32;
            cuts.push(PlacedCut { branch: slot.branch, planes: slot.planes, sides: Cut::NOWHERE });
        }
        // A branch with several cuts may have lost only some of them.
        let is_cut = |branch: u32| {
            let slots = settler.first_slot[branch as usize] as usize..settler.first_slot[branch as usize + 1] as usize;
            settler.slots[slots].iter().any(|s| s.alive)
        };
        uncut.retain(|(branch, _)| !is_cut(branch.0));
        uncut.sort_by_key(|(branch, _)| *branch);
        uncut.dedup_by_key(|(branch, _)| *branch);
        let mut layout = Self {
            skeleton,
            sizes: None,
            cells: ForkCells::default(),
            // The settler still borrows the chains.
            chains: Chains::default(),
            overrun: settler.params.overruns(),
            pieces: Vec::with_capacity(settler.runs.len()),
            first_piece: Vec::with_capacity(found.count + 1),
            r_min: Vec::with_capacity(found.count),
            nodes: found.nodes,
            first_node: found.first_node,
            cuts,
            overruns: BTreeMap::new(),
            uncut,
            warnings,
            fine: Vec::new(),
        };
        layout.place(&settler, &found.of_root, &cut_of_slot, &overruns);
        layout
    }

    /// Adds the runs cluster by cluster and records the end index of each cut.
    fn place(
        &mut self,
        settler: &Settler,
        of_root: &[u32],
        cut_of_slot: &[u32],
        overruns: &BTreeMap<(u32, usize), f64>,
    ) {
        let cluster_of = |run: u32| of_root[settler.runs[run as usize].root as usize];
        let mut order: Vec<u32> = (0..settler.runs.len() as u32).collect();
        order.sort_unstable_by_key(|&run| (cluster_of(run), run));
        let mut ends = 0;
        for index in order {
            let run = settler.runs[index as usize];
            let cluster = cluster_of(index);
            if self.first_piece.len() <= cluster as usize {
                self.first_piece.push(self.pieces.len() as u32);
                self.r_min.push(settler.r_min(run.root));
                ends = 0;
            }
            let terminals = settler.terminals[run.branch as usize];
            let terminals = [0, 1].map(|end| run.slots[end].is_none() && terminals[end]);
            for (end, way) in Way::BOTH.into_iter().enumerate() {
                if let Some(slot) = run.slots[end] {
                    let cut = &mut self.cuts[cut_of_slot[slot as usize] as usize];
                    cut.sides[way.side()] = (ClusterId(cluster), ends);
                } else if let Some(&length) = overruns.get(&(index, end)) {
                    self.overruns.insert((self.pieces.len() as u32, end as u8), length);
                }
                ends += u32::from(run.slots[end].is_some() || terminals[end]);
            }
            let cuts = run.slots.map(|slot| slot.map_or(NONE, |slot| cut_of_slot[slot as usize]));
            self.pieces.push(Placed { branch: run.branch, cuts, terminals });
        }
        self.first_piece.push(self.pieces.len() as u32);
    }

    /// Sets the chains from which the layout was created, and the places with shorter edges.
    pub(super) fn with(self, chains: Chains, fine: Vec<FineStation>) -> Self {
        Self { chains, fine, ..self }
    }
}

/// Nodes of the clusters.
struct Clusters {
    count: usize,
    nodes: Vec<NodeId>,
    first_node: Vec<u32>,
    /// Cluster of each root.
    of_root: Vec<u32>,
}

impl Clusters {
    /// Numbers clusters by lowest node; those without a node come last.
    fn of(settler: &Settler) -> Self {
        let mut members: Vec<(u32, NodeId)> = Vec::new();
        for branch in 0..settler.courses.len() {
            let course = settler.courses.get(branch as u32);
            for run in &settler.runs[settler.first_run[branch] as usize..settler.first_run[branch + 1] as usize] {
                collect_nodes(settler, run, &course, &mut members);
            }
        }
        members.sort_unstable();
        members.dedup();
        let mut roots: Vec<(NodeId, u32)> = members.chunk_by(|a, b| a.0 == b.0).map(|m| (m[0].1, m[0].0)).collect();
        roots.sort_unstable();
        let size = settler.runs.iter().map(|r| r.root + 1).max().unwrap_or(0);
        let mut of_root = vec![NONE; size as usize];
        let mut count = 0;
        for root in roots.iter().map(|r| r.1).chain(settler.runs.iter().map(|r| r.root)) {
            if of_root[root as usize] == NONE {
                of_root[root as usize] = count;
                count += 1;
            }
        }
        drop(roots);
        for member in &mut members {
            member.0 = of_root[member.0 as usize];
        }
        members.sort_unstable();
        let first_node = (0..=count).map(|c| members.partition_point(|m| m.0 < c) as u32).collect();
        Self { count: count as usize, nodes: members.iter().map(|m| m.1).collect(), first_node, of_root }
    }
}

/// Collects the inner nodes of a run and those at ends without a cut.
fn collect_nodes(settler: &Settler, run: &BranchSpan, course: &Course, members: &mut Vec<(u32, NodeId)>) {
    let [lo, hi] = settler.range(run, course);
    let nodes = &course.branch.nodes;
    // Ends of the branch are at the range or beyond it.
    let inner = nodes.iter().zip(&course.branch.arc).filter(|&(_, &s)| s > lo && s < hi);
    members.extend(inner.map(|(&node, _)| (run.root, node)));
    for (node, slot) in course.branch.ends().into_iter().zip(run.slots) {
        if slot.is_none() {
            members.push((run.root, node));
        }
    }
}

/// Terminals obstructed by another vessel.
#[derive(Default)]
struct Shortened {
    /// Overrun lengths that differ from the default, by run and end (0 or 1).
    overruns: BTreeMap<(u32, usize), f64>,
    warnings: Vec<PartitionWarning>,
}

impl Shortened {
    fn of(settler: &mut Settler, of_root: &[u32]) -> Self {
        let mut found = Self::default();
        for index in 0..settler.runs.len() {
            let run = settler.runs[index];
            let terminals = settler.terminals[run.branch as usize];
            for end in (0..2).filter(|&end| run.slots[end].is_none() && terminals[end]) {
                found.terminal(settler, index as u32, end, ClusterId(of_root[run.root as usize]));
            }
        }
        found
    }

    fn terminal(&mut self, settler: &mut Settler, index: u32, end: usize, cluster: ClusterId) {
        let run = settler.runs[index as usize];
        let near = settler.near(run.root);
        let course = near.course(run.branch);
        let (way, s) = (Way::BOTH[end], settler.range(&run, course)[end]);
        let section = course.section(s, way);
        let r = section.radius;
        let full = settler.overrun(r, run.root);
        let Err(by) = settler.tip_clear(&near, index as usize, way, s, &section, full) else { return };
        let node = course.branch.ends()[end];
        let least = (settler.params.shortest_overrun * r).min(full);
        let mut length = full;
        while length > least {
            length = (0.9 * length).max(least);
            if settler.tip_clear(&near, index as usize, way, s, &section, length).is_ok() {
                self.overruns.insert((index, end), length);
                self.warnings.push(PartitionWarning::ShortOverrun { cluster, node, near: by, radii: length / r });
                return;
            }
        }
        self.overruns.insert((index, end), least);
        self.warnings.push(PartitionWarning::CapNotClear { cluster, node, near: by });
    }
}

impl Layout {
    /// Sets the skeleton, which is not stored with layouts.
    #[must_use]
    pub fn of(self, skeleton: Arc<Skeleton>) -> Self {
        Self { skeleton, ..self }
    }

    /// Sets the requested edge sizes.
    #[must_use]
    pub fn sized(self, sizes: Option<SizeAt>) -> Self {
        Self { sizes, ..self }
    }

    /// Sets the cells of the forks, by cluster.
    #[must_use]
    pub fn with_cells(self, cells: ForkCells) -> Self {
        Self { cells, ..self }
    }

    /// Number of clusters.
    pub fn clusters_len(&self) -> usize {
        self.r_min.len()
    }

    /// Number of cuts.
    pub fn cuts_len(&self) -> usize {
        self.cuts.len()
    }

    /// All clusters, by `ClusterId`.
    pub fn clusters(&self) -> impl ExactSizeIterator<Item = Cluster> + '_ {
        (0..self.clusters_len()).map(|i| self.cluster(ClusterId(i as u32)))
    }

    /// All cuts, by `CutId`.
    pub fn cuts(&self) -> impl ExactSizeIterator<Item = Cut> + '_ {
        (0..self.cuts_len()).map(|i| self.cut(CutId(i as u32)))
    }

    /// Places with shorter edges that a size field requests.
    pub fn fine_stations(&self) -> &[FineStation] {
        &self.fine
    }

    /// Branches that lie in one cluster from end to end, with the reason.
    pub(super) fn uncut(&self) -> &[(BranchId, UncutReason)] {
        &self.uncut
    }

    /// Possible defects of cluster meshes.
    pub(super) fn warnings(&self) -> &[PartitionWarning] {
        &self.warnings
    }

    /// Node count of the largest cluster.
    pub fn largest_nodes(&self) -> usize {
        self.first_node.windows(2).map(|w| (w[1] - w[0]) as usize).max().unwrap_or(0)
    }

    /// Branches in clusters with more than `nodes` nodes.
    pub(super) fn in_clusters_above(&self, nodes: usize) -> Vec<BranchId> {
        let large = |(_, cluster): &(BranchId, ClusterId)| self.nodes(*cluster).len() > nodes;
        self.branches_of_clusters().filter(large).map(|(branch, _)| branch).collect()
    }

    /// Branch and cluster of each piece, cluster by cluster.
    pub fn branches_of_clusters(&self) -> impl Iterator<Item = (BranchId, ClusterId)> + '_ {
        let of = |cluster: usize| self.pieces_of(cluster).iter().map(move |p| (p.branch, cluster));
        (0..self.clusters_len()).flat_map(of).map(|(branch, cluster)| (BranchId(branch), ClusterId(cluster as u32)))
    }

    /// Number of branch pieces in a cluster.
    pub(super) fn pieces_in(&self, cluster: ClusterId) -> usize {
        self.pieces_of(cluster.0 as usize).len()
    }

    /// Branch of a cut.
    pub fn branch_of_cut(&self, cut: CutId) -> BranchId {
        BranchId(self.cuts[cut.0 as usize].branch)
    }

    /// Clusters on the two sides of a cut, each with its end index.
    pub fn sides_of_cut(&self, cut: CutId) -> [(ClusterId, u32); 2] {
        self.cuts[cut.0 as usize].sides
    }

    /// Nodes of a cluster.
    pub fn nodes(&self, cluster: ClusterId) -> &[NodeId] {
        let i = cluster.0 as usize;
        &self.nodes[self.first_node[i] as usize..self.first_node[i + 1] as usize]
    }

    /// Number of cuts among the cluster's ends before the given end.
    pub fn cuts_before(&self, cluster: ClusterId, end: u32) -> u32 {
        let at = |piece: &Placed, i: usize| (piece.cuts[i] != NONE, piece.cuts[i] != NONE || piece.terminals[i]);
        let ends = self.pieces_of(cluster.0 as usize).iter().flat_map(|piece| [at(piece, 0), at(piece, 1)]);
        ends.filter(|(_, is_end)| *is_end).take(end as usize).filter(|(is_cut, _)| *is_cut).count() as u32
    }

    fn pieces_of(&self, cluster: usize) -> &[Placed] {
        &self.pieces[self.first_piece[cluster] as usize..self.first_piece[cluster + 1] as usize]
    }

    fn course(&self, branch: u32) -> Course {
        Courses { skeleton: &self.skeleton, chains: &self.chains }.get(branch)
    }

    fn arc_of(&self, piece: &Placed, course: &Course) -> [f64; 2] {
        let at = |end: usize| (piece.cuts[end] != NONE).then(|| self.cuts[piece.cuts[end] as usize].planes[1 - end]);
        [at(0).unwrap_or(0.0), at(1).unwrap_or_else(|| course.length())]
    }

    /// Returns the input of a connector.
    pub fn cut(&self, id: CutId) -> Cut {
        let PlacedCut { branch, planes, sides } = self.cuts[id.0 as usize];
        let course = self.course(branch);
        let size = self.size_amid(&course, planes);
        let mut path = path(&course, planes);
        let [first, last] = self.ups(id);
        path.first_mut().into_iter().for_each(|section| section.up = first);
        path.last_mut().into_iter().for_each(|section| section.up = last);
        Cut { branch: BranchId(branch), sides, path, size }
    }

    /// Returns the input of a cluster.
    pub fn cluster(&self, id: ClusterId) -> Cluster {
        self.cluster_with(id, |_| {})
    }

    fn cluster_with(&self, id: ClusterId, mut each: impl FnMut(BranchPiece)) -> Cluster {
        let (nodes, cells) = (self.nodes(id).to_vec(), self.cells.of(id.0));
        let mut cluster = Cluster { nodes, cells, ..Cluster::default() };
        let mut legs: Vec<(NodeId, Leg)> = Vec::new();
        let r_min = self.r_min[id.0 as usize];
        for (index, piece) in (self.first_piece[id.0 as usize]..).zip(self.pieces_of(id.0 as usize)) {
            let course = self.course(piece.branch);
            let arc = self.arc_of(piece, &course);
            let flat = [0, 1].map(|end| piece.cuts[end] != NONE || piece.terminals[end]);
            let first = cluster.tubes.len() as u32;
            cluster.tubes.extend(course.tubes(arc[0], arc[1], flat));
            let tubes = first..cluster.tubes.len() as u32;
            let within = |station: &&FineStation| arc[0] <= station.arc && station.arc <= arc[1];
            let fine = of_branch(&self.fine, piece.branch).iter().filter(within);
            cluster.fine.extend(fine.map(|station| station.place));
            each(BranchPiece { cluster: id, branch: BranchId(piece.branch), arc, tubes });
            if self.sizes.is_some() {
                let ways = Way::BOTH.into_iter().enumerate().filter(|(end, _)| !flat[*end]);
                legs.extend(ways.map(|(end, way)| (course.branch.ends()[end], self.leg(&course, end, way))));
                cluster.size = self.size_amid(&course, arc);
            }
            for (end, way) in Way::BOTH.into_iter().enumerate().filter(|(end, _)| flat[*end]) {
                let mut section = course.section(arc[end], way);
                if piece.cuts[end] != NONE {
                    section.up = self.ups(CutId(piece.cuts[end]))[way.side()];
                }
                let usual = self.overrun.length(section.radius, r_min);
                let overrun = self.overruns.get(&(index, end as u8)).copied().unwrap_or(usual);
                let kind = match piece.cuts[end] {
                    NONE => EndKind::Terminal(course.branch.ends()[end]),
                    cut => EndKind::Cut { cut: CutId(cut), side: way.side() as u8 },
                };
                add_end(&mut cluster, section, overrun, kind);
            }
        }
        cluster.size = cluster.size.filter(|_| self.pieces_in(id) == 1);
        cluster.fine.extend(self.fine_forks(legs));
        cluster
    }

    /// Direction and radius of a vessel that leaves the node at one of its ends.
    fn leg(&self, course: &Course, end: usize, way: Way) -> Leg {
        let node = self.skeleton.node(course.branch.ends()[end]);
        // Directions out of a node are named in reverse.
        let out = [Way::Onward, Way::Back][end];
        let radius = course.radius([0.0, course.length()][end], way);
        Leg { direction: course.leaving(out, LEG * node.radius), radius }
    }

    /// Bifurcations of a cluster with shorter edges, from the vessels that leave each node.
    fn fine_forks(&self, mut legs: Vec<(NodeId, Leg)>) -> Vec<FinePlace> {
        let Some(sizes) = &self.sizes else { return Vec::new() };
        legs.sort_by_key(|(node, _)| *node);
        let fork = |legs: &[(NodeId, Leg)]| {
            let node = self.skeleton.node(legs[0].0);
            let legs: Vec<Leg> = legs.iter().map(|(_, leg)| *leg).collect();
            FinePlace::of_fork(node.position, &legs, sizes.at_fork(node.original))
        };
        legs.chunk_by(|a, b| a.0 == b.0).filter_map(fork).collect()
    }

    /// Requested edge size in the middle of a vessel piece, interpolated between adjacent nodes.
    fn size_amid(&self, course: &Course, [lo, hi]: [f64; 2]) -> Option<f64> {
        let (sizes, branch) = (self.sizes.as_ref()?, &course.branch);
        let middle = 0.5 * (lo + hi);
        let next = branch.arc.partition_point(|&s| s <= middle).clamp(1, branch.arc.len() - 1);
        let [a, b] = [next - 1, next].map(|i| self.skeleton.node(branch.nodes[i]).original);
        let share = (middle - branch.arc[next - 1]) / (branch.arc[next] - branch.arc[next - 1]);
        sizes.between([a, b], share.clamp(0.0, 1.0))
    }

    /// Expands the layout into a full partition.
    pub(super) fn explicit(&self) -> Partition {
        let mut pieces = Vec::with_capacity(self.pieces.len());
        let clusters = (0..self.clusters_len() as u32).map(|i| self.cluster_with(ClusterId(i), |p| pieces.push(p)));
        let clusters = clusters.collect();
        pieces.sort_unstable_by(|a, b| a.branch.cmp(&b.branch).then(a.arc[0].total_cmp(&b.arc[0])));
        Partition {
            clusters,
            cuts: self.cuts().collect(),
            cut_arcs: self.cuts.iter().map(|cut| cut.planes).collect(),
            pieces,
            uncut: self.uncut.clone(),
            warnings: self.warnings.clone(),
            summary: self.summary(),
        }
    }
}

/// Appends an end and its overrun.
fn add_end(cluster: &mut Cluster, section: Section, overrun: f64, kind: EndKind) {
    let tube = cluster.tubes.len() as u32;
    let Section { origin, axis, radius, .. } = section;
    cluster.tubes.push(Tube { a: origin, b: origin + axis * overrun, ra: radius, rb: radius });
    cluster.ends.push(ClusterEnd { section, kind, overrun: tube });
}

impl Layout {
    /// Summary figures of the partition.
    pub fn summary(&self) -> PartitionSummary {
        let mut summary = PartitionSummary {
            clusters: self.clusters_len(),
            largest_nodes: self.largest_nodes(),
            cuts: self.cuts_len(),
            uncut: UncutCounts::of(self.uncut()),
            ..PartitionSummary::default()
        };
        let sizes = |i| {
            let (id, cluster) = (ClusterId(i), self.cluster(ClusterId(i)));
            // Clusters with a junction have three pieces, or one that closes on the junction; others have one piece.
            let pieces = self.pieces_in(id);
            (usize::from(pieces > 2 || (pieces == 2 && cluster.ends.len() != 2)), cluster.tubes.len())
        };
        let sizes = (0..self.clusters_len() as u32).into_par_iter().map(sizes);
        (summary.junction_clusters, summary.largest_tubes) = sizes.reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1.max(b.1)));
        let short = |w: &&PartitionWarning| matches!(w, PartitionWarning::ShortOverrun { .. });
        summary.short_overruns = self.warnings().iter().filter(short).count();
        summary.caps_not_clear = self.warnings().len() - summary.short_overruns;
        summary
    }
}

impl UncutCounts {
    fn of(branches: &[(BranchId, UncutReason)]) -> Self {
        let mut uncut = Self::default();
        for (_, reason) in branches {
            *match reason {
                UncutReason::Terminal => &mut uncut.terminal,
                UncutReason::Forbidden => &mut uncut.forbidden,
                UncutReason::Length => &mut uncut.length,
                UncutReason::Angle => &mut uncut.angle,
                UncutReason::Bend => &mut uncut.bend,
                UncutReason::Clearance { .. } => &mut uncut.clearance,
            } += 1;
        }
        uncut
    }
}

//! What is left when the nodes have come to rest, and what is done about it.

use super::params::{RefineParams, Residual};
use crate::geometry::{Point3, Tube};
use crate::skeleton::{Edge, EdgeId, Node, NodeId, Overlap, Skeleton};
use serde::Serialize;

/// Rounds of shrinking at most: a vessel may have several others in its way.
const ROUNDS: usize = 8;
/// Length over which a radius returns to its old value, in radii.
const TAPER: f64 = 3.0;
/// Pieces that shrinking makes are at least this long, in radii.
const SHORTEST: f64 = 2.0;

/// What became of a pair of vessels that still overlapped.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "treatment", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Treatment {
    /// Nothing: they overlap.
    Left,
    /// Radii were reduced where they meet; `kept` is the smaller share that is left of a radius.
    Shrunk {
        /// Share of the radius that is left.
        kept: f64,
    },
    /// They are to be meshed together.
    Fused,
}

/// A pair of vessels that still overlapped when the nodes had come to rest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ResidualPair {
    /// The nodes of both edges, as indices into the input.
    pub edges: [[u32; 2]; 2],
    /// Whether both edges end in a terminal and these two are closer than their radii: no refinement can help.
    pub terminals_too_close: bool,
    /// Distance of the axes.
    pub distance: f64,
    /// Sum of the radii there.
    pub radii: f64,
    /// What was done.
    #[serde(flatten)]
    pub treatment: Treatment,
}

/// What was done about the pairs that were left.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ResidualReport {
    /// The pairs, in the order in which they were found.
    pub pairs: Vec<ResidualPair>,
    /// Edges of which the radius was reduced.
    pub shrunk_edges: usize,
    /// Lumen volume before shrinking.
    pub volume: f64,
    /// Lumen volume that was lost.
    pub volume_lost: f64,
    /// Pairs that overlap still.
    pub left: usize,
}

/// Lumen volume of an edge: a frustum.
fn volume(tube: &Tube) -> f64 {
    std::f64::consts::PI / 3.0 * tube.length() * (tube.ra * tube.ra + tube.ra * tube.rb + tube.rb * tube.rb)
}

fn total_volume(skeleton: &Skeleton) -> f64 {
    skeleton.edge_ids().map(|e| volume(&skeleton.tube(e))).sum()
}

/// Treats what overlaps. New nodes are added to `origin`, too.
pub(super) fn treat(skeleton: &mut Skeleton, origin: &mut Vec<Point3>, params: &RefineParams) -> ResidualReport {
    let found = skeleton.overlaps(&skeleton.adjacency()).pairs;
    let mut report = ResidualReport { volume: total_volume(skeleton), ..ResidualReport::default() };
    let treatment = if params.residual == Residual::Fuse { Treatment::Fused } else { Treatment::Left };
    let entry = |skeleton: &Skeleton, o: &Overlap| ResidualPair {
        edges: o.nodes.map(|ends| ends.map(|n| skeleton.node(n).original)),
        terminals_too_close: terminals_too_close(skeleton, o),
        distance: o.distance,
        radii: o.radii,
        treatment,
    };
    report.pairs = found.iter().map(|o| entry(skeleton, o)).collect();
    if params.residual != Residual::Shrink || found.is_empty() {
        report.left = if params.residual == Residual::Fuse { 0 } else { found.len() };
        return report;
    }
    let adjacency = skeleton.adjacency();
    let is_terminal = skeleton.node_ids().map(|n| adjacency.valence(n) == 1).collect();
    let mut shrinker = Shrinker { skeleton, origin, params, least: Vec::new(), is_terminal };
    let edges_before = shrinker.skeleton.edges.len();
    let mut touched = vec![false; edges_before];
    for round in 0..ROUNDS {
        let overlaps = shrinker.skeleton.overlaps(&shrinker.skeleton.adjacency()).pairs;
        let mut changed = false;
        for overlap in &overlaps {
            let kept = shrinker.shrink(overlap);
            changed |= kept.is_some();
            for e in overlap.edges.iter().filter(|e| kept.is_some() && e.index() < edges_before) {
                touched[e.index()] = true;
            }
            if let (0, Some(kept)) = (round, kept)
                && let Some(i) = found.iter().position(|o| o.edges == overlap.edges)
            {
                report.pairs[i].treatment = Treatment::Shrunk { kept };
            }
        }
        if !changed {
            break;
        }
    }
    let after = skeleton.overlaps(&skeleton.adjacency()).pairs;
    for pair in &mut report.pairs {
        let same = |o: &Overlap| {
            let ends = o.nodes.map(|ends| ends.map(|n| skeleton.node(n).original));
            ends == pair.edges
        };
        if after.iter().any(same) {
            pair.treatment = Treatment::Left;
        }
    }
    report.left = after.len();
    report.shrunk_edges = touched.iter().filter(|t| **t).count();
    report.volume_lost = (report.volume - total_volume(skeleton)).max(0.0);
    report
}

fn terminals_too_close(skeleton: &Skeleton, overlap: &Overlap) -> bool {
    let adjacency = skeleton.adjacency();
    let terminals = overlap.nodes.map(|ends| ends.into_iter().find(|&n| adjacency.valence(n) == 1));
    let [Some(a), Some(b)] = terminals else { return false };
    let (a, b) = (skeleton.node(a), skeleton.node(b));
    (a.position - b.position).norm() < a.radius + b.radius
}

struct Shrinker<'a> {
    skeleton: &'a mut Skeleton,
    origin: &'a mut Vec<Point3>,
    params: &'a RefineParams,
    /// Radius of an edge's ends before anything was shrunk; for edges in the order of their ids as far as it was asked.
    least: Vec<[f64; 2]>,
    is_terminal: Vec<bool>,
}

impl Shrinker<'_> {
    /// Reduces the radii of an overlapping pair where they meet; the share kept, none when it cannot be helped.
    fn shrink(&mut self, overlap: &Overlap) -> Option<f64> {
        self.remember();
        let thin = overlap.edges.map(|e| self.skeleton.tube(e).min_radius()).into_iter().fold(f64::INFINITY, f64::min);
        let voxel = 2.0 * thin / self.params.rho;
        // Clear by a voxel if that can be had, else as far as it goes.
        let wanted = ((overlap.distance - voxel) / overlap.radii).max(1.0 - self.params.shrink).min(1.0);
        if overlap.distance < (1.0 - self.params.shrink) * overlap.radii {
            return None;
        }
        let mut least_kept: f64 = 1.0;
        for (edge, point) in overlap.edges.into_iter().zip(overlap.points) {
            least_kept = least_kept.min(self.pinch(edge, &point, wanted)?);
        }
        (least_kept < 1.0).then_some(least_kept)
    }

    fn remember(&mut self) {
        for edge in &self.skeleton.edges[self.least.len()..] {
            self.least.push(edge.radii);
        }
    }

    /// Reduces the radius of an edge at a point to `share` of what it is, tapering back to either side.
    fn pinch(&mut self, edge: EdgeId, point: &Point3, share: f64) -> Option<f64> {
        let tube = self.skeleton.tube(edge);
        let length = tube.length();
        let t = (point - tube.a).norm() / length;
        let room = SHORTEST * tube.max_radius() / length;
        let floor = 1.0 - self.params.shrink;
        let was = self.least[edge.index()];
        let before = was[0] + (was[1] - was[0]) * t;
        let radius = (tube.radius(t) * share).max(floor * before);
        if t < room || t > 1.0 - room {
            // Too close to an end for a node of its own.
            let end = usize::from(t > 0.5);
            let narrow = (tube.radius(end as f64) * share).max(floor * was[end]);
            self.taper(edge, end, narrow);
            return Some(narrow / was[end]);
        }
        self.insert(edge, t, radius);
        let after = EdgeId(self.skeleton.edges.len() as u32 - 1);
        // The radius is back to what it was a few radii on: nodes there, where the pieces are long enough for them.
        for (piece, end) in [(edge, 1), (after, 0)] {
            self.taper(piece, end, radius);
        }
        Some(radius / before)
    }

    /// Gives one end of an edge a radius and keeps the rest as it was from `TAPER` radii on, if it is long enough.
    fn taper(&mut self, edge: EdgeId, end: usize, radius: f64) {
        let tube = self.skeleton.tube(edge);
        let length = tube.length();
        let reach = TAPER * tube.max_radius();
        if length >= reach + SHORTEST * tube.max_radius() {
            let t = if end == 0 { reach / length } else { 1.0 - reach / length };
            let was = self.least[edge.index()];
            let full = was[0] + (was[1] - was[0]) * t;
            let full = full.min(tube.radius(t).max(full * (1.0 - self.params.shrink)));
            self.insert(edge, t, full);
            let near = if end == 0 { edge } else { EdgeId(self.skeleton.edges.len() as u32 - 1) };
            self.skeleton.edges[near.index()].radii[end] = radius;
        } else {
            self.skeleton.edges[edge.index()].radii[end] = radius;
        }
    }

    /// Puts a node into an edge.
    fn insert(&mut self, edge: EdgeId, t: f64, radius: f64) {
        self.remember();
        let Edge { nodes: [a, b], radii } = *self.skeleton.edge(edge);
        let tube = self.skeleton.tube(edge);
        let node = NodeId(self.skeleton.nodes.len() as u32);
        // Not a terminal: these are found by their number.
        let inner = |n: NodeId| !self.is_terminal.get(n.index()).copied().unwrap_or(false);
        let nearer = if (t < 0.5 || !inner(b)) && inner(a) { a } else { b };
        let original = self.skeleton.node(nearer).original;
        self.skeleton.nodes.push(Node { position: tube.point(t), radius, original });
        let (p, q) = (self.origin[a.index()], self.origin[b.index()]);
        self.origin.push(p + (q - p) * t);
        self.skeleton.edges[edge.index()] = Edge { nodes: [a, node], radii: [radii[0], radius] };
        self.skeleton.edges.push(Edge { nodes: [node, b], radii: [radius, radii[1]] });
        let was = self.least[edge.index()];
        let middle = was[0] + (was[1] - was[0]) * t;
        self.least[edge.index()] = [was[0], middle];
        self.least.push([middle, was[1]]);
    }
}

//! Treatment of overlaps that remain after the iterations.

use super::overlapping::overlapping;
use super::params::{RefineParams, Residual};
use anastomesh_mesh::geometry::{Point3, Tube};
use anastomesh_skeleton::{Adjacency, Edge, EdgeId, Node, NodeId, Overlap, Skeleton};
use rustc_hash::{FxHashMap, FxHashSet};
use serde::{Deserialize, Serialize};

/// Maximum shrink rounds: a vessel may have several obstacles, and each round treats one.
const MAX_SHRINK_PASSES: usize = 12;
/// Length over which a shrunk radius recovers, in radii.
const TAPER: f64 = 3.0;
/// Minimum length of the pieces created by shrinking, in radii.
const SHORTEST: f64 = 2.0;

/// Treatment of a vessel pair that still overlapped.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "treatment", rename_all = "snake_case")]
#[non_exhaustive]
pub enum Treatment {
    /// None: the vessels overlap.
    Left,
    /// The radii were reduced at the overlap. `kept` is the smaller remaining fraction.
    Shrunk {
        /// Remaining fraction of the radius.
        kept: f64,
    },
    /// The treatment of other pairs also separated this one.
    Cleared,
    /// The vessels are to be meshed together.
    Fused,
}

/// Vessel pair that overlapped after the iterations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResidualPair {
    /// Nodes of both edges, as indices into the input.
    pub edges: [[u32; 2]; 2],
    /// True if both edges end in terminals closer than the sum of their radii: refinement cannot help.
    pub terminals_too_close: bool,
    /// Distance of the axes.
    pub distance: f64,
    /// Sum of the radii at the overlap.
    pub radii: f64,
    /// Treatment of the pair.
    #[serde(flatten)]
    pub treatment: Treatment,
}

/// Report of the residual treatment.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ResidualReport {
    /// Pairs in the order of discovery.
    pub pairs: Vec<ResidualPair>,
    /// Edges with a reduced radius.
    pub shrunk_edges: usize,
    /// Lumen volume before shrinking.
    pub volume: f64,
    /// Lost lumen volume.
    pub volume_lost: f64,
    /// Pairs that still overlap.
    pub left: usize,
}

/// Lumen volume of an edge (a frustum).
fn volume(tube: &Tube) -> f64 {
    std::f64::consts::PI / 3.0 * tube.length() * (tube.ra * tube.ra + tube.ra * tube.rb + tube.rb * tube.rb)
}

fn total_volume(skeleton: &Skeleton) -> f64 {
    skeleton.edge_ids().map(|e| volume(&skeleton.tube(e))).sum()
}

/// Treats remaining overlaps; in `measured` networks, crotches are none. New nodes are also added to `origin`.
pub(super) fn treat(
    skeleton: &mut Skeleton,
    origin: &mut Vec<Point3>,
    measured: bool,
    params: &RefineParams,
) -> ResidualReport {
    let adjacency = skeleton.adjacency();
    let overlaps_of = |s: &Skeleton| overlapping(s, &s.adjacency(), !measured, 1.0).pairs;
    let found = overlaps_of(skeleton);
    let mut report = ResidualReport { volume: total_volume(skeleton), ..ResidualReport::default() };
    let treatment = if params.residual == Residual::Fuse { Treatment::Fused } else { Treatment::Left };
    let entry = |skeleton: &Skeleton, o: &Overlap| ResidualPair {
        edges: o.nodes.map(|ends| ends.map(|n| skeleton.node(n).original)),
        terminals_too_close: terminals_too_close(skeleton, &adjacency, o),
        distance: o.distance,
        radii: o.radii,
        treatment,
    };
    report.pairs = found.iter().map(|o| entry(skeleton, o)).collect();
    if params.residual != Residual::Shrink || found.is_empty() {
        report.left = if params.residual == Residual::Fuse { 0 } else { found.len() };
        return report;
    }
    let around: Vec<Vec<EdgeId>> = skeleton.node_ids().map(|n| adjacency.edges(n).to_vec()).collect();
    let was = skeleton.edges.iter().map(|e| e.radii).collect();
    let mut shrinker = Shrinker { skeleton, origin, params, was, around };
    let place: FxHashMap<[EdgeId; 2], usize> = found.iter().enumerate().map(|(i, o)| (o.edges, i)).collect();
    let edges_before = shrinker.skeleton.edges.len();
    let mut touched = vec![false; edges_before];
    for round in 0..MAX_SHRINK_PASSES {
        let overlaps = overlaps_of(shrinker.skeleton);
        let mut changed = false;
        for overlap in &overlaps {
            let kept = shrinker.shrink(overlap);
            changed |= kept.is_some();
            for e in overlap.edges.iter().filter(|e| kept.is_some() && e.index() < edges_before) {
                touched[e.index()] = true;
            }
            if let (0, Some(kept)) = (round, kept)
                && let Some(&i) = place.get(&overlap.edges)
            {
                report.pairs[i].treatment = Treatment::Shrunk { kept };
            }
        }
        if !changed {
            break;
        }
    }
    let after = overlaps_of(skeleton);
    let originals = |o: &Overlap| o.nodes.map(|ends| ends.map(|n| skeleton.node(n).original));
    let still: FxHashSet<[[u32; 2]; 2]> = after.iter().map(originals).collect();
    for pair in &mut report.pairs {
        if still.contains(&pair.edges) {
            pair.treatment = Treatment::Left;
        } else if pair.treatment == Treatment::Left {
            pair.treatment = Treatment::Cleared;
        }
    }
    report.left = after.len();
    report.shrunk_edges = touched.iter().filter(|t| **t).count();
    report.volume_lost = (report.volume - total_volume(skeleton)).max(0.0);
    report
}

/// A terminal has one vessel, or two vessels of the trees that share it, which reverse there.
fn terminals_too_close(skeleton: &Skeleton, adjacency: &Adjacency, overlap: &Overlap) -> bool {
    let ends = |n: NodeId| match *adjacency.edges(n) {
        [_] => true,
        [e, f] => skeleton.angle(n, [e, f]) < std::f64::consts::FRAC_PI_2,
        _ => false,
    };
    let terminals = overlap.nodes.map(|nodes| nodes.into_iter().find(|&n| ends(n)));
    let [Some(a), Some(b)] = terminals else { return false };
    let (a, b) = (skeleton.node(a), skeleton.node(b));
    a != b && (a.position - b.position).norm() < a.radius + b.radius
}

struct Shrinker<'a> {
    skeleton: &'a mut Skeleton,
    origin: &'a mut Vec<Point3>,
    params: &'a RefineParams,
    /// Radii at each edge's ends before shrinking.
    was: Vec<[f64; 2]>,
    /// Edges at each node.
    around: Vec<Vec<EdgeId>>,
}

impl Shrinker<'_> {
    /// Reduces the radii of an overlapping pair at the overlap and returns the remaining fraction. Returns `None` if
    /// shrinking cannot help or an edge was divided since the search.
    fn shrink(&mut self, overlap: &Overlap) -> Option<f64> {
        let is_whole = |(e, nodes): (EdgeId, [NodeId; 2])| self.skeleton.edge(e).nodes == nodes;
        if !overlap.edges.into_iter().zip(overlap.nodes).all(is_whole) {
            return None;
        }
        let thin = overlap.edges.map(|e| self.skeleton.tube(e).min_radius()).into_iter().fold(f64::INFINITY, f64::min);
        let voxel = 2.0 * thin / self.params.rho;
        // Aims at a gap of one voxel, limited by the maximum reduction.
        let wanted = ((overlap.distance - voxel) / overlap.radii).max(1.0 - self.params.shrink).min(1.0);
        if overlap.distance < (1.0 - self.params.shrink) * overlap.radii {
            return None;
        }
        let mut least_kept: f64 = 1.0;
        for (edge, point) in overlap.edges.into_iter().zip(overlap.points) {
            least_kept = least_kept.min(self.pinch(edge, &point, wanted));
        }
        (least_kept < 1.0).then_some(least_kept)
    }

    /// Reduces the radius of an edge at a point to the fraction `share`, with a taper on both sides.
    fn pinch(&mut self, edge: EdgeId, point: &Point3, share: f64) -> f64 {
        let tube = self.skeleton.tube(edge);
        let length = tube.length();
        let t = (point - tube.a).norm() / length;
        let room = SHORTEST * tube.max_radius() / length;
        if t < room || t > 1.0 - room {
            // Too close to an end for an additional node.
            return self.pinch_end(self.skeleton.edge(edge).nodes[usize::from(t > 0.5)], edge, share);
        }
        let was = self.was[edge.index()];
        let before = was[0] + (was[1] - was[0]) * t;
        let radius = (tube.radius(t) * share).max((1.0 - self.params.shrink) * before);
        // From far to near, so that the first part keeps its id.
        let reach = TAPER * tube.max_radius() / length;
        if t + reach <= 1.0 - room {
            self.insert(edge, t + reach, tube.radius(t + reach));
        }
        let rest = self.skeleton.tube(edge).length() / length;
        self.insert(edge, t / rest, radius);
        if t - reach >= room {
            self.insert(edge, (t - reach) / t, tube.radius(t - reach));
        }
        radius / before
    }

    /// Reduces the radius of an edge at one of its nodes, and of both edges if the vessel continues there.
    fn pinch_end(&mut self, node: NodeId, edge: EdgeId, share: f64) -> f64 {
        let around = &self.around[node.index()];
        let all = if around.len() == 2 { around.clone() } else { vec![edge] };
        let floor = 1.0 - self.params.shrink;
        let mut kept: f64 = 1.0;
        for edge in all {
            let end = self.skeleton.edge(edge).end(node);
            let was = self.was[edge.index()][end];
            let narrow = (self.skeleton.edge(edge).radii[end] * share).max(floor * was);
            kept = kept.min(narrow / was);
            self.taper(edge, end, narrow);
        }
        kept
    }

    /// Sets the radius at one end of an edge. From `TAPER` radii on, a long enough edge keeps its old radius.
    fn taper(&mut self, edge: EdgeId, end: usize, radius: f64) {
        let tube = self.skeleton.tube(edge);
        let length = tube.length();
        let reach = TAPER * tube.max_radius() / length;
        let mut near = edge;
        if reach + SHORTEST * tube.max_radius() / length <= 1.0 {
            let t = if end == 0 { reach } else { 1.0 - reach };
            self.insert(edge, t, tube.radius(t));
            if end == 1 {
                near = EdgeId(self.skeleton.edges.len() as u32 - 1);
            }
        }
        self.skeleton.edges[near.index()].radii[end] = radius;
    }

    /// Inserts a node into an edge.
    fn insert(&mut self, edge: EdgeId, t: f64, radius: f64) {
        let Edge { nodes: [a, b], radii } = *self.skeleton.edge(edge);
        let tube = self.skeleton.tube(edge);
        let node = NodeId(self.skeleton.nodes.len() as u32);
        // Not a terminal, because terminals are identified by this index.
        let inner = |n: NodeId| self.around[n.index()].len() > 1;
        let nearer = if (t < 0.5 || !inner(b)) && inner(a) { a } else { b };
        let original = self.skeleton.node(nearer).original;
        self.skeleton.nodes.push(Node { position: tube.point(t), radius, original });
        let (p, q) = (self.origin[a.index()], self.origin[b.index()]);
        self.origin.push(p + (q - p) * t);
        self.skeleton.edges[edge.index()] = Edge { nodes: [a, node], radii: [radii[0], radius] };
        let beyond = EdgeId(self.skeleton.edges.len() as u32);
        self.skeleton.edges.push(Edge { nodes: [node, b], radii: [radius, radii[1]] });
        self.around.push(vec![edge, beyond]);
        for e in self.around[b.index()].iter_mut().filter(|e| **e == edge) {
            *e = beyond;
        }
        let was = self.was[edge.index()];
        let middle = was[0] + (was[1] - was[0]) * t;
        self.was[edge.index()] = [was[0], middle];
        self.was.push([middle, was[1]]);
    }
}

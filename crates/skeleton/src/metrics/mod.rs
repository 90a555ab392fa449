//! Meshability of a skeleton: the figures of the paper's Fig. 11, and the conditions for cuts.

mod barrier;

pub use barrier::{Barrier, PairGradient, paper_unit};

use super::course::Courses;
use super::cuttability::{BranchEnd, CUT_DISTANCE, CutRules, Cuttability, separation};
use super::{Adjacency, EdgeId, NodeId, Skeleton};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Angle between vessels at a node below which the paper counts them as narrow (Fig. 11), in radians.
pub const NARROW: f64 = std::f64::consts::PI / 10.0;

/// Angle between the two vessels of a node of valence 2 below which it is a fold, in radians.
pub const FOLD: f64 = std::f64::consts::PI / 6.0;

/// A count and its total.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Share {
    /// The count.
    pub count: usize,
    /// The total.
    pub of: usize,
}

impl Share {
    /// Percentage; 0 for an empty total.
    pub fn percent(self) -> f64 {
        if self.of == 0 { 0.0 } else { 100.0 * self.count as f64 / self.of as f64 }
    }
}

/// Dimensionless measures of a skeleton besides its overlaps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Metrics {
    /// Barrier potential (equations 1 to 6) over all pairs of edges without a common node, in 1 / (sum of the radii)².
    pub barrier: f64,
    /// Edges shorter than 2 radii (the larger of the edge's two).
    pub shorter_than_2: Share,
    /// Edges shorter than 2.5 radii.
    pub shorter_than_2_5: Share,
    /// Edges shorter than 3 radii.
    pub shorter_than_3: Share,
    /// Pairs of edges that leave a node at less than π/10.
    pub narrow: Share,
    /// Nodes of valence 2 where the vessel turns back: less than 30 degrees between its two edges.
    pub folds: Share,
    /// Edges that satisfy equation 11.
    pub long_enough: Share,
    /// Edges longer than the lengths required by equation 12 at their two ends.
    pub open_enough: Share,
    /// Inner branches (no end is a terminal) with a straight part for a cut by equations 11 and 12.
    pub cuttable: Share,
}

impl Skeleton {
    /// Measures the skeleton.
    pub fn metrics(&self, adjacency: &Adjacency) -> Metrics {
        let mut m = Metrics { barrier: Barrier::default().potential(self), ..Metrics::default() };
        self.measure_edges(adjacency, &mut m);
        self.measure_angles(adjacency, &mut m);
        m.cuttable = self.cuttable(adjacency);
        m
    }

    /// Inner branches, and those that the partition may cut.
    fn cuttable(&self, adjacency: &Adjacency) -> Share {
        let chains = self.chains(adjacency);
        let cuttability = Cuttability::new(adjacency, Courses { skeleton: self, chains: &chains }, CutRules::default());
        let is_inner =
            |branch: &u32| chains.ends(*branch).iter().all(|&n| BranchEnd::of(adjacency, n) == BranchEnd::Junction);
        let inner: Vec<u32> = (0..chains.len() as u32).filter(is_inner).collect();
        let count = inner.par_iter().filter(|&&branch| cuttability.window(branch).is_ok()).count();
        Share { count, of: inner.len() }
    }

    fn measure_edges(&self, adjacency: &Adjacency, m: &mut Metrics) {
        for id in self.edge_ids() {
            let (edge, length) = (self.edge(id), self.length(id));
            let radius = edge.radii[0].max(edge.radii[1]);
            for (share, limit) in
                [(&mut m.shorter_than_2, 2.0), (&mut m.shorter_than_2_5, 2.5), (&mut m.shorter_than_3, 3.0)]
            {
                share.of += 1;
                share.count += usize::from(length < limit * radius);
            }
            m.long_enough.of += 1;
            m.long_enough.count += usize::from(length > CUT_DISTANCE * (edge.radii[0] + edge.radii[1]));
            let apart: f64 = edge.nodes.iter().map(|&n| self.separation_at(adjacency, id, n)).sum();
            m.open_enough.of += 1;
            m.open_enough.count += usize::from(length > apart);
        }
    }

    /// Length required by equation 12 at one end of an edge: the largest over the other edges of the node.
    fn separation_at(&self, adjacency: &Adjacency, edge: EdgeId, node: NodeId) -> f64 {
        let away = |e: EdgeId| self.node(self.edge(e).other(node)).position - self.node(node).position;
        let radius = |e: EdgeId| self.edge(e).radii[self.edge(e).end(node)];
        let others = adjacency.edges(node).iter().filter(|&&e| e != edge);
        others.map(|&e| separation(&away(edge), &away(e), [radius(edge), radius(e)])).fold(0.0, f64::max)
    }

    fn measure_angles(&self, adjacency: &Adjacency, m: &mut Metrics) {
        for node in self.node_ids() {
            let edges = adjacency.edges(node);
            for (i, &e) in edges.iter().enumerate() {
                for &f in &edges[..i] {
                    let angle = self.angle(node, [e, f]);
                    m.narrow.of += 1;
                    m.narrow.count += usize::from(angle < NARROW);
                    if edges.len() == 2 {
                        m.folds.of += 1;
                        m.folds.count += usize::from(angle < FOLD);
                    }
                }
            }
        }
    }

    /// Angle between two edges that leave `node`, in radians.
    pub fn angle(&self, node: NodeId, edges: [EdgeId; 2]) -> f64 {
        let [u, v] = edges.map(|e| self.node(self.edge(e).other(node)).position - self.node(node).position);
        libm::atan2(u.cross(&v).norm(), u.dot(&v))
    }
}

//! Branches: maximal chains of edges through nodes of valence 2.
//!
//! Measured networks consist of polylines whose edges are often shorter than their radius. Cuts apply to the branch as
//! a whole, measured by arc length.

use super::{Adjacency, BranchId, EdgeId, NodeId, Skeleton};
use anastomesh_mesh::geometry::{Point3, Tube};

impl BranchId {
    /// Index into `Branches::list`.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Maximal chain of edges through nodes of valence 2. Its ends are nodes of another valence. A loop that leaves and
/// returns to one junction has equal ends, and so has a ring without junctions.
#[derive(Clone, Debug, PartialEq)]
pub struct Branch {
    /// Nodes in order, one more than edges.
    pub nodes: Vec<NodeId>,
    /// Edges in order.
    pub edges: Vec<EdgeId>,
    /// Arc length from the start to each of `nodes`.
    pub arc: Vec<f64>,
}

/// A position on a branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Index into `Branch::edges`.
    pub piece: usize,
    /// Parameter in [0, 1] along that edge, in the direction of the branch.
    pub t: f64,
}

impl Branch {
    /// Total arc length.
    pub fn length(&self) -> f64 {
        self.arc.last().copied().unwrap_or(0.0)
    }

    /// First and last node.
    pub fn ends(&self) -> [NodeId; 2] {
        [self.nodes[0], self.nodes[self.nodes.len() - 1]]
    }

    /// True if it returns to its start.
    pub fn is_closed(&self) -> bool {
        let [a, b] = self.ends();
        a == b
    }

    /// The `piece`-th edge in the direction of the branch.
    pub fn tube(&self, skeleton: &Skeleton, piece: usize) -> Tube {
        let tube = skeleton.tube(self.edges[piece]);
        if skeleton.edge(self.edges[piece]).nodes[0] == self.nodes[piece] {
            tube
        } else {
            Tube { a: tube.b, b: tube.a, ra: tube.rb, rb: tube.ra }
        }
    }

    /// All edges in the direction of the branch.
    pub fn tubes<'a>(&'a self, skeleton: &'a Skeleton) -> impl ExactSizeIterator<Item = Tube> + 'a {
        (0..self.edges.len()).map(|i| self.tube(skeleton, i))
    }

    /// Position at arc length `s`, clamped to the branch. A node belongs to the edge that starts there, the last one to
    /// the edge that ends there.
    pub fn locate(&self, s: f64) -> Place {
        let last = self.edges.len() - 1;
        let piece = self.arc[1..=last].partition_point(|&end| end <= s);
        let (start, end) = (self.arc[piece], self.arc[piece + 1]);
        let t = if end > start { ((s - start) / (end - start)).clamp(0.0, 1.0) } else { 0.0 };
        Place { piece, t }
    }

    /// Axis point at arc length `s`.
    pub fn point(&self, skeleton: &Skeleton, s: f64) -> Point3 {
        let place = self.locate(s);
        self.tube(skeleton, place.piece).point(place.t)
    }

    /// Radius at arc length `s`.
    pub fn radius(&self, skeleton: &Skeleton, s: f64) -> f64 {
        let place = self.locate(s);
        self.tube(skeleton, place.piece).radius(place.t)
    }

    /// Plane across the vessel at arc length `s`; its axis is the direction of the edge there.
    pub fn section(&self, skeleton: &Skeleton, s: f64) -> anastomesh_mesh::geometry::Section {
        let place = self.locate(s);
        let tube = self.tube(skeleton, place.piece);
        anastomesh_mesh::geometry::Section::new(
            tube.point(place.t),
            (tube.b - tube.a).normalize(),
            tube.radius(place.t),
        )
    }

    /// Mean radius, weighted by length.
    pub fn mean_radius(&self, skeleton: &Skeleton) -> f64 {
        let (mut sum, mut length) = (0.0, 0.0);
        for tube in self.tubes(skeleton) {
            sum += tube.length() * 0.5 * (tube.ra + tube.rb);
            length += tube.length();
        }
        sum / length
    }
}

/// All branches of a skeleton. Every edge belongs to exactly one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Branches {
    /// Branches, by `BranchId`: those that start at junctions and terminals by their first node, then the rings.
    pub list: Vec<Branch>,
    /// Branch of each edge, and the edge's index in it.
    pub of_edge: Vec<(BranchId, u32)>,
}

impl Skeleton {
    /// Splits the skeleton at its junctions into branches.
    pub fn branches(&self, adjacency: &Adjacency) -> Branches {
        let chains = self.chains(adjacency);
        let mut of_edge = vec![(BranchId(0), 0); self.edges.len()];
        for branch in 0..chains.len() as u32 {
            for (i, edge) in (0..).zip(chains.edges(branch)) {
                of_edge[edge.index()] = (BranchId(branch), i);
            }
        }
        Branches { list: (0..chains.len() as u32).map(|branch| chains.branch(self, branch)).collect(), of_edge }
    }
}

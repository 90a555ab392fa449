//! State of a refinement that rarely changes: connectivity, mobility, and chains.

use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_skeleton::{Adjacency, CUT_DISTANCE, Edge, EdgeId, Node, NodeId, Skeleton};
use rayon::prelude::*;

/// Length that a vessel keeps while it overlaps another, in radii. Separation has priority over cuts, and two close
/// terminals require a nearby bifurcation.
pub(super) const LEAST: f64 = 2.5;

/// Vessel between two special nodes: a branch, or a part of one between fixed nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chain<'a> {
    /// Nodes along the chain, one more than edges.
    pub nodes: &'a [NodeId],
    /// Edges along the chain.
    pub edges: &'a [EdgeId],
}

impl Chain<'_> {
    /// First and last node.
    pub fn ends(&self) -> [NodeId; 2] {
        [self.nodes[0], self.nodes[self.nodes.len() - 1]]
    }
}

/// All chains in flat arrays, as there are millions of them.
#[derive(Debug, Default)]
pub(super) struct AllChains {
    nodes: Vec<NodeId>,
    edges: Vec<EdgeId>,
    /// End offset of each chain's edges. Its nodes end at this offset plus the number of chains up to it.
    ends: Vec<u32>,
}

impl AllChains {
    /// Appends an edge and its end node to the open chain.
    fn add(&mut self, edge: EdgeId, node: NodeId) {
        self.edges.push(edge);
        self.nodes.push(node);
    }

    fn close(&mut self) {
        self.ends.push(self.edges.len() as u32);
    }

    fn get(&self, i: usize) -> Chain<'_> {
        let end = |i: usize| self.ends[i] as usize;
        let first = i.checked_sub(1).map_or(0, end);
        Chain { nodes: &self.nodes[first + i..=end(i) + i], edges: &self.edges[first..end(i)] }
    }

    pub fn iter(&self) -> impl Iterator<Item = Chain<'_>> {
        (0..self.ends.len()).map(|i| self.get(i))
    }

    pub fn par_iter(&self) -> impl IndexedParallelIterator<Item = Chain<'_>> {
        (0..self.ends.len()).into_par_iter().map(|i| self.get(i))
    }
}

/// Moving skeleton and its constant properties.
pub(super) struct Frame {
    /// Skeleton at its current position.
    pub skeleton: Skeleton,
    /// Original node positions.
    pub origin: Vec<Point3>,
    /// Adjacency of the skeleton, without the nodes inserted since `rejoin`.
    pub adjacency: Adjacency,
    /// Number of nodes in `adjacency`.
    chained: usize,
    /// Mobility of each node; 0 if fixed.
    pub mobility: Vec<f64>,
    /// Displacement limit of free nodes, and the paper's unit.
    furthest: f64,
    unit: f64,
    /// True if only overlapping vessels move.
    is_held: bool,
    /// Displacement limit of each node.
    pub leash: Vec<f64>,
    /// Nodes of valence 2 at which the vessel reverses: terminals that two trees share.
    pub is_fold: Vec<bool>,
    /// Nodes added as bends.
    pub is_bend: Vec<bool>,
    /// Nodes of vessels that overlapped at the last count. Their separation has priority over cuts.
    pub urgent: Vec<bool>,
    /// Minimum length of each edge: its old length, or that of equation 11 if less.
    pub kept: Vec<f64>,
    /// Vessels between junctions, terminals and folds.
    pub chains: AllChains,
}

impl Frame {
    /// Creates a frame with displacement limits for nodes (`furthest`) and for terminals (`free_terminals`).
    pub fn new(skeleton: Skeleton, free_terminals: f64, furthest: f64, unit: f64) -> Self {
        let adjacency = skeleton.adjacency();
        let is_fold = skeleton.folds(&adjacency);
        let mut leash = vec![furthest; skeleton.nodes.len()];
        let mut mobility = Vec::with_capacity(skeleton.nodes.len());
        for node in skeleton.node_ids() {
            let i = node.index();
            if adjacency.valence(node) == 1 || is_fold[i] {
                leash[i] = free_terminals.min(furthest);
            }
            mobility.push(if leash[i] > 0.0 { readiness(skeleton.node(node).radius, unit) } else { 0.0 });
        }
        let origin = skeleton.nodes.iter().map(|n| n.position).collect();
        let is_bend = vec![false; skeleton.nodes.len()];
        let urgent = is_bend.clone();
        let chains = AllChains::default();
        let kept = Vec::new();
        let mut frame = Self {
            chained: skeleton.nodes.len(),
            skeleton,
            origin,
            adjacency,
            mobility,
            furthest,
            unit,
            is_held: false,
            leash,
            is_fold,
            is_bend,
            urgent,
            kept,
            chains,
        };
        frame.kept = frame.skeleton.edge_ids().map(|e| frame.keep(e)).collect();
        frame.chains = frame.find_chains();
        frame
    }

    /// Fixes every node except terminals until it is released.
    pub fn hold(&mut self) {
        self.is_held = true;
        for node in self.skeleton.node_ids().filter(|&n| self.adjacency.valence(n) > 1) {
            self.leash[node.index()] = 0.0;
            self.mobility[node.index()] = 0.0;
        }
    }

    /// Releases a node with a displacement limit, unless it is a terminal.
    pub fn loosen(&mut self, node: NodeId, way: f64) {
        if self.adjacency.valence(node) > 1 {
            self.leash[node.index()] = way.min(self.furthest);
            self.mobility[node.index()] = self.readiness(self.skeleton.node(node).radius);
        }
    }

    /// Shortens the steps of nodes to their displacement limits. Nodes beside them would else follow steps that are not made.
    pub fn clip(&self, steps: &mut [Vec3]) {
        for (i, step) in steps.iter_mut().enumerate().filter(|(_, step)| step.norm_squared() > 0.0) {
            let (from, home) = (self.skeleton.nodes[i].position, self.origin[i]);
            let way = from + *step - home;
            if way.norm() > self.leash[i] {
                *step = home + way * (self.leash[i] / way.norm()) - from;
            }
        }
    }

    /// Mobility of a released node. If only overlapping vessels move, each moves in proportion to its radius: displacements are
    /// measured in radii.
    fn readiness(&self, radius: f64) -> f64 {
        if self.is_held { radius / self.unit } else { readiness(radius, self.unit) }
    }

    fn keep(&self, edge: EdgeId) -> f64 {
        let radii = self.skeleton.edge(edge).radii;
        self.skeleton.length(edge).min(CUT_DISTANCE * (radii[0] + radii[1]))
    }

    fn find_chains(&self) -> AllChains {
        let branches = self.skeleton.chains(&self.adjacency);
        let mut chains = AllChains::default();
        for branch in 0..branches.len() as u32 {
            let (nodes, edges) = (branches.nodes(branch), branches.edges(branch));
            chains.nodes.push(nodes[0]);
            for (i, (&edge, &node)) in edges.iter().zip(&nodes[1..]).enumerate() {
                chains.add(edge, node);
                if self.is_fold[node.index()] && i + 1 < edges.len() {
                    chains.close();
                    chains.nodes.push(node);
                }
            }
            chains.close();
        }
        chains
    }

    /// Inserts a node into an edge at parameter `t`, so that the vessel can bend.
    pub fn add_bend(&mut self, edge: EdgeId, t: f64) {
        self.insert(edge, t);
        self.mobility.push(readiness(self.skeleton.nodes[self.mobility.len()].radius, self.unit));
        self.leash.push(self.furthest);
        self.is_bend.push(true);
    }

    /// Inserts nodes into an edge at ascending parameters, so that a part of the vessel can move. It is as stiff as before.
    pub fn divide(&mut self, edge: EdgeId, places: &[f64]) {
        let ends = self.skeleton.edge(edge).nodes;
        let [a, b] = ends.map(|n| self.leash[n.index()]);
        let mut rest = 1.0;
        // From the end to the start, as the first part keeps its number.
        for &t in places.iter().rev() {
            self.insert(edge, t / rest);
            rest = t;
            let i = self.leash.len();
            let (node, home) = (&self.skeleton.nodes[i], self.origin[i]);
            let moved = (node.position - home).norm();
            let leash = (a + (b - a) * t).max(moved);
            self.mobility.push(if leash > 0.0 { self.readiness(node.radius) } else { 0.0 });
            self.leash.push(leash);
            self.is_bend.push(false);
        }
    }

    fn insert(&mut self, edge: EdgeId, t: f64) {
        let [a, b] = self.skeleton.edge(edge).nodes;
        let tube = self.skeleton.tube(edge);
        let (radius, node) = (tube.radius(t), NodeId(self.skeleton.nodes.len() as u32));
        // Not a terminal, because terminals are identified by this index.
        let inner = |n: NodeId| n.index() >= self.chained || self.adjacency.valence(n) > 1;
        let nearer = if (t < 0.5 || !inner(b)) && inner(a) { a } else { b };
        let nearer = self.skeleton.node(nearer).original;
        self.skeleton.nodes.push(Node { position: tube.point(t), radius, original: nearer });
        let first = &mut self.skeleton.edges[edge.index()];
        let old = first.radii[1];
        *first = Edge { nodes: [a, node], radii: [first.radii[0], radius] };
        self.skeleton.edges.push(Edge { nodes: [node, b], radii: [radius, old] });
        self.origin.push(self.origin[a.index()] + (self.origin[b.index()] - self.origin[a.index()]) * t);
        self.is_fold.push(false);
        self.urgent.push(true);
        self.kept[edge.index()] = self.keep(edge);
        self.kept.push(self.keep(EdgeId(self.kept.len() as u32)));
    }

    /// Updates adjacency, folds and chains after nodes were added or moved.
    pub fn rejoin(&mut self) {
        self.adjacency = self.skeleton.adjacency();
        self.chained = self.skeleton.nodes.len();
        for (fold, now) in self.is_fold.iter_mut().zip(self.skeleton.folds(&self.adjacency)) {
            *fold |= now;
        }
        self.chains = AllChains::default();
        self.chains = self.find_chains();
    }

    /// Position of a node.
    pub fn at(&self, node: NodeId) -> Point3 {
        self.skeleton.nodes[node.index()].position
    }

    /// Radius of an edge at one of its nodes.
    pub fn radius_at(&self, edge: EdgeId, node: NodeId) -> f64 {
        let e = self.skeleton.edge(edge);
        e.radii[e.end(node)]
    }

    /// True if the vessels from a node to two fixed ends are at minimum length. The node must not approach the ends,
    /// which is its only way to open the angle.
    pub fn is_as_close_as_may_be(&self, node: NodeId, ends: [NodeId; 2]) -> bool {
        let radius = self.skeleton.node(node).radius;
        let is_close = |n: NodeId| (self.at(n) - self.at(node)).norm() <= LEAST * radius;
        ends.iter().all(|n| self.mobility[n.index()] <= 0.0) && ends.into_iter().any(is_close)
    }

    /// Node that defines the direction in which a vessel leaves `node` by `edge`: the first at a distance of three
    /// radii, or the vessel's end.
    pub fn lever(&self, node: NodeId, mut edge: EdgeId) -> NodeId {
        let start = self.at(node);
        let window = 3.0 * self.skeleton.node(node).radius;
        let mut at = node;
        for _ in 0..64 {
            at = self.skeleton.edge(edge).other(at);
            let stops = self.adjacency.valence(at) != 2 || self.is_fold[at.index()];
            if stops || (self.at(at) - start).norm() >= window {
                break;
            }
            let pair = self.adjacency.edges(at);
            edge = if pair[0] == edge { pair[1] } else { pair[0] };
        }
        at
    }
}

/// Mobility of a node. Thick vessels move more readily: a thin one with fixed terminals close to a thick one cannot
/// move. The displacement is small relative to the thick vessel.
fn readiness(radius: f64, unit: f64) -> f64 {
    (radius / unit).sqrt()
}

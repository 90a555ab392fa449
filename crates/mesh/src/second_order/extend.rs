//! Extension of displacements from surfaces into the inside of a mesh.
//!
//! Nodes are visited by their depth, the distance from the surfaces along edges (Dijkstra's algorithm). A node takes the mean of its
//! visited neighbours, weighted by the inverse squares of their distances. So thin layers move with their surface. The displacement
//! decreases linearly with the depth, and is zero beyond the reach.

use super::edges::Edges;
use super::midpoints::SecondOrder;
use crate::adjacency::{Incidence, NONE};
use crate::geometry::{Point3, Vec3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Depth at which displacements end, in edges of the surface. With 1, the conductance of bent tubes does not change, and curving takes
/// twice the time.
const REACH: f64 = 0.5;

/// Displacement of a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Carried {
    /// Displacement at the surface.
    full: Vec3,
    /// Depth at which it ends.
    reach: f64,
    /// Distance from the surface along edges.
    depth: f64,
}

impl Carried {
    /// Displacement on a surface with edges of this length.
    pub fn on_surface(full: Vec3, edge: f64) -> Self {
        Self { full, reach: REACH * edge, depth: 0.0 }
    }

    fn displacement(&self) -> Vec3 {
        if self.depth < self.reach { self.full * (1.0 - self.depth / self.reach) } else { Vec3::zeros() }
    }
}

/// Planes in which a node stays.
#[derive(Clone, Debug, Default)]
pub(super) struct Planes {
    /// Orthonormal directions across the planes.
    across: Vec<Vec3>,
}

/// Least length of the part of a plane's normal that other planes do not contain. Below, both planes are the same.
const SAME_PLANE: f64 = 1e-3;

impl Planes {
    /// Adds the plane with this normal.
    pub fn add(&mut self, normal: Vec3) {
        self.across.extend(self.within(normal).try_normalize(SAME_PLANE));
    }

    /// Part of a displacement within the planes.
    pub fn within(&self, displacement: Vec3) -> Vec3 {
        self.across.iter().fold(displacement, |rest, across| rest - across * across.dot(&rest))
    }
}

/// Nodes with their positions and neighbours.
pub(super) trait Net: Sync {
    fn place(&self, node: u32) -> Point3;

    /// Neighbours of a node, perhaps several times, in an order that depends on the mesh alone.
    fn neighbours(&self, node: u32) -> impl Iterator<Item = u32>;

    /// Sum of the inverse squares of the distances from points that never move.
    fn held(&self, node: u32) -> f64;

    /// Part of a displacement that a node may follow.
    fn allowed(&self, node: u32, displacement: Vec3) -> Vec3;
}

/// Displacements of all nodes. Those that are not given follow from the others.
pub(super) fn extend(net: &impl Net, nodes: usize, given: impl Iterator<Item = (u32, Carried)>) -> Vec<Vec3> {
    let known = Known { index: vec![NONE; nodes], carried: Vec::new() };
    let mut front = Front { net, nearest: vec![f64::INFINITY; nodes], known, queue: BinaryHeap::new() };
    given.for_each(|(node, carried)| front.known.set(node, carried));
    for node in 0..nodes as u32 {
        front.spread(node);
    }
    while let Some(Reverse((_, node))) = front.queue.pop() {
        if let (None, Some(carried)) = (front.known.get(node), front.known.mean(net, node)) {
            front.known.set(node, carried);
            front.spread(node);
        }
    }
    let known = front.known;
    (0..nodes as u32).map(|node| known.get(node).map_or(Vec3::zeros(), Carried::displacement)).collect()
}

/// Displacements of the nodes that have been visited.
struct Known {
    /// Position of each node in the other list, or `NONE`.
    index: Vec<u32>,
    carried: Vec<Carried>,
}

impl Known {
    fn get(&self, node: u32) -> Option<&Carried> {
        self.carried.get(self.index[node as usize] as usize)
    }

    /// Adds a node, or replaces its displacement.
    fn set(&mut self, node: u32, carried: Carried) {
        match self.index[node as usize] {
            NONE => {
                self.index[node as usize] = self.carried.len() as u32;
                self.carried.push(carried);
            }
            at => self.carried[at as usize] = carried,
        }
    }

    /// Weighted mean of the neighbours of a node that are known.
    fn mean(&self, net: &impl Net, node: u32) -> Option<Carried> {
        let place = net.place(node);
        let (mut full, mut reach, mut total, mut depth) = (Vec3::zeros(), 0.0, 0.0, f64::INFINITY);
        for other in net.neighbours(node) {
            if let Some(known) = self.get(other) {
                let distance2 = (net.place(other) - place).norm_squared();
                let weight = 1.0 / distance2.max(f64::MIN_POSITIVE);
                full += known.full * weight;
                reach += known.reach * weight;
                total += weight;
                depth = depth.min(known.depth + distance2.sqrt());
            }
        }
        let full = net.allowed(node, full / (total + net.held(node)));
        (total > 0.0).then(|| Carried { full, reach: reach / total, depth })
    }
}

/// Nodes that are visited, and the next ones.
struct Front<'a, N> {
    net: &'a N,
    known: Known,
    /// Least depth of each node in the queue.
    nearest: Vec<f64>,
    /// Depths with their nodes. Depths are positive, so that their bits have their order. Of equal depths, the first node comes first.
    queue: BinaryHeap<Reverse<(u64, u32)>>,
}

impl<N: Net> Front<'_, N> {
    /// Adds the neighbours of a visited node, up to its reach. Nodes of the surface without a displacement have neighbours, too, which
    /// do not move either.
    fn spread(&mut self, node: u32) {
        let Some(own) = self.known.get(node) else { return };
        let place = self.net.place(node);
        for other in self.net.neighbours(node) {
            let depth = own.depth + (self.net.place(other) - place).norm();
            let nearest = &mut self.nearest[other as usize];
            if depth < own.reach && depth < *nearest && self.known.get(other).is_none() {
                *nearest = depth;
                self.queue.push(Reverse((depth.to_bits(), other)));
            }
        }
    }
}

/// Vertices of a mesh, joined by its edges. Some may move only in certain directions.
pub(super) struct Vertices<'a, F> {
    pub points: &'a [Point3],
    pub around: Incidence,
    pub allowed: F,
}

impl<F: Fn(u32, Vec3) -> Vec3 + Sync> Net for Vertices<'_, F> {
    fn place(&self, node: u32) -> Point3 {
        self.points[node as usize]
    }

    fn neighbours(&self, node: u32) -> impl Iterator<Item = u32> {
        self.around.get(node).iter().copied()
    }

    fn held(&self, _: u32) -> f64 {
        0.0
    }

    fn allowed(&self, node: u32, displacement: Vec3) -> Vec3 {
        (self.allowed)(node, displacement)
    }
}

impl<'a, F> Vertices<'a, F> {
    pub fn new(points: &'a [Point3], edges: &Edges, allowed: F) -> Self {
        Self { points, around: Incidence::of_vertices(edges.list(), points.len()), allowed }
    }
}

/// Midpoints of edges, joined by tetrahedra. The ends of the edges never move.
pub(super) struct Middles<'a> {
    /// Planes of edges in flat faces.
    pub planes: FxHashMap<u32, Planes>,
    second: &'a SecondOrder,
    /// Edges of each tetrahedron.
    edges: Vec<[u32; 6]>,
    /// Tetrahedra at each edge.
    around: Incidence,
    points: &'a [Point3],
}

impl<'a> Middles<'a> {
    pub fn new(
        second: &'a SecondOrder,
        (points, tets): (&'a [Point3], &[[u32; 4]]),
        planes: FxHashMap<u32, Planes>,
    ) -> Self {
        let edges: Vec<[u32; 6]> = tets.par_iter().map(|&tet| second.edges_of(tet)).collect();
        let around = Incidence::of_cells(&edges, second.edges().len());
        Self { planes, second, edges, around, points }
    }
}

impl Net for Middles<'_> {
    fn place(&self, node: u32) -> Point3 {
        self.second.middles[node as usize]
    }

    fn neighbours(&self, node: u32) -> impl Iterator<Item = u32> {
        let tets = self.around.get(node).iter();
        tets.flat_map(|&tet| self.edges[tet as usize]).filter(move |&other| other != node)
    }

    fn held(&self, node: u32) -> f64 {
        let [a, b] = self.second.edges()[node as usize].map(|v| self.points[v as usize]);
        2.0 * 4.0 / (b - a).norm_squared()
    }

    fn allowed(&self, node: u32, displacement: Vec3) -> Vec3 {
        self.planes.get(&node).map_or(displacement, |planes| planes.within(displacement))
    }
}

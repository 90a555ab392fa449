//! Connections between the ends of arteries and veins and the capillary bed.
//!
//! A vessel from an end may replace a capillary that was removed from a node of the bed. Otherwise it leads to the
//! middle of a capillary. Either way three vessels meet.

use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use super::bed::BedParams;
use super::random::{Random, Stream};
use super::tubes::{TubeTree, meet};
use anastomesh_mesh::geometry::{Aabb, Point3, Tube, Vec3};
use anastomesh_skeleton::{Adjacency, Edge, EdgeId, Node, NodeId, Skeleton};

/// Maximum length of a joining vessel, in edge lengths.
const REACH: f64 = 1.8;
/// Cosine of the minimum angle between joined vessels.
const SIDE_BY_SIDE: f64 = 0.6;

/// Joins tree ends to the bed (nodes from `first` on) and returns the joined ends. Nodes that lost a vessel are
/// preferred to the middles of vessels.
pub(super) fn join(
    network: &mut Skeleton,
    ends: &[NodeId],
    first: usize,
    bed: &BedParams,
    random: Random,
) -> Vec<NodeId> {
    let adjacency = network.adjacency();
    // The two inlets remain unchanged.
    let leads_on = |end: &NodeId| network.edge(adjacency.edges(*end)[0]).nodes[0] != *end;
    let ends: Vec<NodeId> = ends.iter().copied().filter(leads_on).collect();
    let around = Surroundings {
        network,
        adjacency,
        first,
        bed,
        tubes: TubeTree::new(network.edge_ids().map(|edge| network.tube(edge))),
    };
    let wanted: Vec<Vec<AttachmentPoint>> = ends.par_iter().map(|&end| around.targets(end)).collect();
    drop(around);
    let mut taken = FxHashSet::default();
    let mut joined = Joined::new(REACH * bed.length + 3.0 * bed.radius);
    let mut done = Vec::new();
    for (k, (&end, wanted)) in ends.iter().zip(&wanted).enumerate() {
        let from = network.node(end).position;
        let vessel = |target: &AttachmentPoint| Tube { a: from, b: target.place, ra: bed.radius, rb: bed.radius };
        let Some(target) = wanted.iter().find(|t| !taken.contains(&t.at) && joined.clear(&vessel(t))) else { continue };
        taken.insert(target.at);
        joined.add(vessel(target));
        done.push(end);
        let to = match target.at {
            At::Node(node) => node,
            At::Middle(edge) => split(network, edge, target.place),
        };
        let radius = bed.any_radius(random, Stream::Joint, k as u64);
        network.edges.push(Edge { nodes: [end, to], radii: [radius; 2] });
    }
    done
}

/// Inserts a node into a vessel.
fn split(network: &mut Skeleton, edge: EdgeId, place: Point3) -> NodeId {
    let middle = NodeId(network.nodes.len() as u32);
    let whole = *network.edge(edge);
    network.nodes.push(Node { position: place, radius: whole.radii[0], original: 0 });
    network.edges[edge.index()].nodes[1] = middle;
    network.edges.push(Edge { nodes: [middle, whole.nodes[1]], ..whole });
    middle
}

/// Position at which a tree's end can be joined to the bed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
enum At {
    Node(NodeId),
    Middle(EdgeId),
}

#[derive(Clone, Copy, Debug)]
struct AttachmentPoint {
    at: At,
    place: Point3,
}

/// Trees and bed, as search context for joining an end.
struct Surroundings<'a> {
    network: &'a Skeleton,
    adjacency: Adjacency,
    first: usize,
    bed: &'a BedParams,
    tubes: TubeTree,
}

impl Surroundings<'_> {
    /// Possible targets of an end: nodes before middles, nearer ones first.
    fn targets(&self, end: NodeId) -> Vec<AttachmentPoint> {
        let from = self.network.node(end).position;
        let reach = REACH * self.bed.length;
        let mut found: Vec<(bool, f64, At)> = Vec::new();
        self.tubes.tree.query(&Aabb::of_points([&from]).grown(reach), |i| {
            let edge = EdgeId(i);
            let nodes = self.network.edge(edge).nodes;
            if nodes.iter().any(|n| n.index() < self.first) {
                return;
            }
            let lost = nodes.into_iter().filter(|&n| self.adjacency.valence(n) < 3).map(At::Node);
            found.extend(lost.chain([At::Middle(edge)]).filter_map(|at| {
                let distance = (self.place(at) - from).norm();
                (distance <= reach).then_some((matches!(at, At::Middle(_)), distance, at))
            }));
        });
        found.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        found.dedup();
        let targets = found.into_iter().map(|(.., at)| AttachmentPoint { at, place: self.place(at) });
        targets.filter(|target| self.fits(end, target)).collect()
    }

    fn place(&self, at: At) -> Point3 {
        match at {
            At::Node(node) => self.network.node(node).position,
            At::Middle(edge) => {
                let [a, b] = self.network.edge(edge).nodes.map(|n| self.network.node(n).position);
                nalgebra::center(&a, &b)
            }
        }
    }

    /// True if a vessel from an end is clear of others and of its neighbours at both ends.
    fn fits(&self, end: NodeId, target: &AttachmentPoint) -> bool {
        let from = self.network.node(end).position;
        let way = (target.place - from).normalize();
        let vessel = Tube { a: from, b: target.place, ra: self.bed.radius, rb: self.bed.radius };
        let whole = self.network.edge(self.adjacency.edges(end)[0]);
        let (there, but) = match target.at {
            At::Node(node) => (self.ways(node), None),
            At::Middle(edge) => {
                let tube = self.network.tube(edge);
                let along = (tube.b - tube.a).normalize();
                (vec![along, -along], Some(edge.0))
            }
        };
        let open = |ways: &[Vec3], way: &Vec3| ways.iter().all(|other| other.dot(way) < SIDE_BY_SIDE);
        vessel.length() > 4.0 * whole.radii[0]
            && open(&self.ways(end), &way)
            && open(&there, &-way)
            && !self.tubes.meets(&vessel, &[from, target.place], but)
    }

    /// Directions in which vessels leave a node.
    fn ways(&self, node: NodeId) -> Vec<Vec3> {
        let here = self.network.node(node).position;
        let others = self.adjacency.edges(node).iter().map(|&e| self.network.edge(e).other(node));
        others.map(|other| (self.network.node(other).position - here).normalize()).collect()
    }
}

/// Joining vessels, hashed by their start. No vessel is longer than the side of a cell.
struct Joined {
    side: f64,
    cells: FxHashMap<[i64; 3], Vec<Tube>>,
}

impl Joined {
    fn new(side: f64) -> Self {
        Self { side, cells: FxHashMap::default() }
    }

    fn cell(&self, tube: &Tube) -> [i64; 3] {
        [0, 1, 2].map(|axis| (tube.a[axis] / self.side).floor() as i64)
    }

    /// True if a vessel is clear of all joining vessels.
    fn clear(&self, vessel: &Tube) -> bool {
        let cell = self.cell(vessel);
        let near = (0..125_i64)
            .filter_map(|i| self.cells.get(&[cell[0] + i / 25 - 2, cell[1] + i / 5 % 5 - 2, cell[2] + i % 5 - 2]));
        !near.flatten().any(|other| meet(vessel, other))
    }

    fn add(&mut self, vessel: Tube) {
        self.cells.entry(self.cell(&vessel)).or_default().push(vessel);
    }
}

//! Vessels that leave the organ: their network is cut at the organ's surface, or inside.

use super::error::DomainError;
use super::inside::{Closed, passes, tidy};
use super::plan::{DomainPlan, Site, TissueShape};
use anastomesh_mesh::geometry::predicates::orient3d;
use anastomesh_mesh::geometry::{Aabb, Point3, point_triangle};
use anastomesh_skeleton::{Adjacency, Edge, EdgeId, Node, NodeId, Skeleton};
use anastomesh_tet::Tetrahedralizer;
use rayon::prelude::*;
use rustc_hash::FxHashSet;
use serde::Serialize;

/// Least distance to the organ of ends inside, in outer radii.
const CLEARANCE: f64 = 1.5;
/// Distance beyond a terminal, in radii, within which its vessel leaves if it ends at the organ.
const BEYOND: f64 = 1.5;
/// Steps in which the place of an end inside is searched along an edge.
const STEPS: usize = 64;

/// Place where vessels end that leave the organ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[non_exhaustive]
pub enum VesselEnds {
    /// At its surface, which gets openings there.
    #[default]
    AtSurface,
    /// Inside, at 1.5 outer radii from the surface.
    Inside,
}

/// Network without the vessels outside an organ.
///
/// ```
/// use anastomesh_domain::{CutNetwork, DomainPlan, TissuePlan, TissueShape, VesselEnds};
/// use anastomesh_mesh::shapes::sphere_surface;
/// use anastomesh_skeleton::{Edge, Node, NodeId, Skeleton};
///
/// let node = |z: f64, original| Node { position: [0.0, 0.0, z].into(), radius: 0.1, original };
/// let edges = vec![Edge { nodes: [NodeId(0), NodeId(1)], radii: [0.1; 2] }];
/// let vessel = Skeleton { nodes: vec![node(0.0, 0), node(2.0, 1)], edges };
/// let organ = TissuePlan::new(TissueShape::Organ(sphere_surface(3)));
/// let plan = DomainPlan::default().tissue(organ);
/// let cut = CutNetwork::of(&vessel, &plan, VesselEnds::AtSurface, &[1])?;
/// assert!((cut.network.nodes[1].position.z - 1.0).abs() < 0.01);
/// assert_eq!((cut.gates, cut.report.vessels), (vec![1], 1));
/// # Ok::<(), anastomesh_domain::DomainError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct CutNetwork {
    /// Network.
    pub network: Skeleton,
    /// Nodes of the network as it was read at which vessels leave; for [`TissuePlan::gates`](super::TissuePlan).
    pub gates: Vec<u32>,
    /// Nodes outside with several ends. Each further end has a number after those of all nodes that were read, in this order.
    pub copies: Vec<u32>,
    /// Summary of the cuts.
    pub report: CutReport,
}

/// Vessels that were cut at an organ.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct CutReport {
    /// Number of cuts.
    pub vessels: usize,
    /// Node at the first cut or gate, and its place.
    pub first: Option<(u32, [f64; 3])>,
    /// Number of nodes removed outside.
    pub outside: usize,
    /// Number of nodes removed inside, near the organ.
    pub inside: usize,
}

/// Network while it is cut.
struct Cutter<'a> {
    network: &'a Skeleton,
    plan: &'a DomainPlan,
    organ: Closed<'a>,
    adjacency: Adjacency,
    is_inside: Vec<bool>,
}

/// New end of an edge.
struct End {
    edge: EdgeId,
    /// Node of the edge that stays.
    from: NodeId,
    /// Fraction of the way to the other node.
    t: f64,
    /// First node outside.
    outer: NodeId,
}

impl CutNetwork {
    /// Cuts a network at the organ of a plan. `roots` are nodes of the network as it was read. A root outside gives its
    /// number to the end of its vessel. Without an organ, nothing changes.
    ///
    /// # Errors
    /// The organ's surface cannot be filled, or no vessel lies inside.
    pub fn of(network: &Skeleton, plan: &DomainPlan, ends: VesselEnds, roots: &[u32]) -> Result<Self, DomainError> {
        let (gates, copies, report) = (Vec::new(), Vec::new(), CutReport::default());
        let unchanged = || Self { network: network.clone(), gates, copies, report };
        let shape = plan.tissue.as_ref().map(|tissue| &tissue.shape);
        let Some(TissueShape::Organ(surface)) = shape else { return Ok(unchanged()) };
        // Preparation reports faults of networks.
        if !is_readable(network) {
            return Ok(unchanged());
        }
        Tetrahedralizer::new().check(surface).map_err(DomainError::Organ)?;
        let surface = tidy(surface);
        let organ = Closed::new(&surface);
        let is_inside: Vec<bool> = network.nodes.par_iter().map(|node| organ.contains(&node.position)).collect();
        let adjacency = network.adjacency();
        let cutter = Cutter { network, plan, organ, adjacency, is_inside };
        let at_organ = cutter.ends_at_organ();
        let is_cut = cutter.is_inside.contains(&false) || ends == VesselEnds::Inside && !at_organ.is_empty();
        let mut cut = if is_cut { cutter.cut(ends, roots, &at_organ)? } else { unchanged() };
        if ends == VesselEnds::AtSurface {
            let node = |node: NodeId| network.node(node);
            if let Some(&first) = at_organ.first() {
                cut.report.first.get_or_insert((node(first).original, node(first).position.coords.into()));
            }
            cut.gates.extend(at_organ.into_iter().map(|end| node(end).original));
            cut.gates.sort_unstable();
            cut.gates.dedup();
        }
        Ok(cut)
    }
}

/// True if all positions are finite and all edges have their nodes.
fn is_readable(network: &Skeleton) -> bool {
    let finite = |node: &Node| node.position.iter().all(|x| x.is_finite());
    let known = |edge: &Edge| edge.nodes.iter().all(|node| node.index() < network.nodes.len());
    network.nodes.iter().all(finite) && network.edges.iter().all(known)
}

impl Cutter<'_> {
    fn place(&self, node: NodeId) -> Point3 {
        self.network.node(node).position
    }

    /// Radius of a vessel with all shells, at a fraction of its length from one of its nodes.
    fn outer(&self, edge: EdgeId, from: NodeId, t: f64) -> f64 {
        let edge = self.network.edge(edge);
        let start = edge.end(from);
        let radius = edge.radii[start] * (1.0 - t) + edge.radii[1 - start] * t;
        let nodes = [from, edge.other(from)];
        let site = Site { radius, ends: nodes.map(|node| self.network.node(node).original), t };
        radius + self.plan.thickness(&site)
    }

    /// Fraction of a segment up to the organ.
    fn meets_organ(&self, p: &Point3, q: &Point3) -> Option<f64> {
        let near = self.organ.near(&Aabb::of_points([p, q])).into_iter().map(|t| self.organ.corners(t));
        let met = near.filter(|&corners| passes([p, q], corners, true)).map(|[a, b, c]| {
            let [from, to] = [p, q].map(|end| orient3d(a, b, c, end));
            from / (from - to)
        });
        met.min_by(f64::total_cmp)
    }

    /// Terminals inside whose vessels lead straight to the organ, nearby.
    fn ends_at_organ(&self) -> Vec<NodeId> {
        let leaves = |&node: &NodeId| {
            let &[edge] = self.adjacency.edges(node) else { return false };
            let edge = self.network.edge(edge);
            let [from, to] = [edge.other(node), node].map(|end| self.place(end));
            let length = (to - from).norm();
            let beyond = to + (to - from) * (BEYOND * edge.radii[edge.end(node)] / length);
            self.is_inside[node.index()] && length > 0.0 && self.meets_organ(&to, &beyond).is_some()
        };
        self.network.node_ids().filter(leaves).collect()
    }

    fn cut(&self, ends: VesselEnds, roots: &[u32], at_organ: &[NodeId]) -> Result<CutNetwork, DomainError> {
        let mut kept = self.is_inside.clone();
        let mut cuts = self.ends(ends, &mut kept);
        if ends == VesselEnds::Inside {
            cuts.extend(at_organ.iter().map(|&end| self.retracted(end, &mut kept)));
        }
        let roots = self.roots_outside(roots);
        let outside = self.is_inside.iter().filter(|&&inside| !inside).count();
        let inside = kept.iter().filter(|&&kept| !kept).count() - outside;
        let mut report = CutReport { outside, inside, ..CutReport::default() };
        let (mut network, number) = self.rest(&kept, &cuts);
        let (mut gates, mut copies) = (Vec::new(), Vec::new());
        let known = self.network.nodes.iter().map(|node| node.original + 1).max().unwrap_or(0);
        let mut used: FxHashSet<u32> = FxHashSet::default();
        for End { edge, from, t, outer } in cuts.into_iter().filter(|end| kept[end.from.index()]) {
            let old = self.network.edge(edge);
            let start = old.end(from);
            let mix = |a: f64, b: f64| a + (b - a) * t;
            let [p, q] = [from, old.other(from)].map(|node| self.network.node(node));
            let root = roots[outer.index()].filter(|root| !used.contains(root));
            let own = root.unwrap_or(self.network.node(outer).original);
            let original = if used.insert(own) { own } else { known + copies.len() as u32 };
            if original != own {
                copies.push(own);
            }
            let position = p.position + (q.position - p.position) * t;
            let at = position.coords.into();
            let end = NodeId(network.nodes.len() as u32);
            network.nodes.push(Node { position, radius: mix(p.radius, q.radius), original });
            let radii = [old.radii[start], mix(old.radii[start], old.radii[1 - start])];
            network.edges.push(Edge { nodes: [number[from.index()], end], radii });
            report.first.get_or_insert((original, at));
            report.vessels += 1;
            if ends == VesselEnds::AtSurface {
                gates.push(original);
            }
        }
        if network.edges.is_empty() {
            return Err(DomainError::NoVesselInside);
        }
        Ok(CutNetwork { network, gates, copies, report })
    }

    /// New ends of the edges from inside to outside. Nodes that are removed inside are no longer kept.
    fn ends(&self, ends: VesselEnds, kept: &mut [bool]) -> Vec<End> {
        let mut cuts = Vec::new();
        for edge in self.network.edge_ids() {
            let [a, b] = self.network.edge(edge).nodes;
            let [from, outer] = match [a, b].map(|node| self.is_inside[node.index()]) {
                [true, false] => [a, b],
                [false, true] => [b, a],
                _ => continue,
            };
            let (edge, from, t) = match ends {
                VesselEnds::AtSurface => (edge, from, self.at_surface(edge, from)),
                VesselEnds::Inside => self.inside(edge, from, kept),
            };
            cuts.push(End { edge, from, t, outer });
        }
        cuts
    }

    /// End inside of a vessel that ends at the organ.
    fn retracted(&self, end: NodeId, kept: &mut [bool]) -> End {
        let edge = self.adjacency.edges(end)[0];
        kept[end.index()] = false;
        let (edge, from, t) = self.inside(edge, self.network.edge(edge).other(end), kept);
        End { edge, from, t, outer: end }
    }

    /// Root of the connected part outside, for each node outside.
    fn roots_outside(&self, roots: &[u32]) -> Vec<Option<u32>> {
        let mut root_of = vec![None; self.network.nodes.len()];
        let is_root = |node: &NodeId| roots.contains(&self.network.node(*node).original);
        for first in self.network.node_ids().filter(is_root) {
            let root = self.network.node(first).original;
            let mut queue = vec![first];
            while let Some(node) = queue.pop() {
                if self.is_inside[node.index()] || root_of[node.index()].replace(root).is_some() {
                    continue;
                }
                let beside = self.adjacency.edges(node).iter();
                queue.extend(beside.map(|&edge| self.network.edge(edge).other(node)));
            }
        }
        root_of
    }

    /// Nodes that are kept and the edges between them, without those that get a new end; and the new number of each node.
    fn rest(&self, kept: &[bool], cuts: &[End]) -> (Skeleton, Vec<NodeId>) {
        let mut network = Skeleton::default();
        let mut number = vec![NodeId(u32::MAX); kept.len()];
        for node in self.network.node_ids().filter(|node| kept[node.index()]) {
            number[node.index()] = NodeId(network.nodes.len() as u32);
            network.nodes.push(*self.network.node(node));
        }
        let ended: FxHashSet<EdgeId> = cuts.iter().map(|end| end.edge).collect();
        for edge in self.network.edge_ids().filter(|edge| !ended.contains(edge)) {
            let old = self.network.edge(edge);
            if old.nodes.iter().all(|node| kept[node.index()]) {
                network.edges.push(Edge { nodes: old.nodes.map(|node| number[node.index()]), ..*old });
            }
        }
        (network, number)
    }

    /// Fraction of an edge up to the organ, but not within the lumen of a fork.
    fn at_surface(&self, edge: EdgeId, from: NodeId) -> f64 {
        let old = self.network.edge(edge);
        let [p, q] = [from, old.other(from)].map(|node| self.place(node));
        let at = self.meets_organ(&p, &q).unwrap_or(1.0);
        let is_branching = self.adjacency.valence(from) > 2;
        if is_branching { at.max((old.radii[old.end(from)] / (q - p).norm()).min(1.0)) } else { at }
    }

    /// Edge with the end of a vessel inside, this one or one before it, and the fraction up to there. Nodes after it are not kept.
    fn inside(&self, mut edge: EdgeId, mut from: NodeId, kept: &mut [bool]) -> (EdgeId, NodeId, f64) {
        loop {
            let old = self.network.edge(edge);
            let [p, q] = [from, old.other(from)].map(|node| self.place(node));
            let fits = |&t: &f64| self.is_clear(&(p + (q - p) * t), CLEARANCE * self.outer(edge, from, t));
            let steps = (0..STEPS).rev().map(|i| i as f64 / STEPS as f64);
            let least = (old.radii[old.end(from)] / (q - p).norm()).min(1.0);
            match (steps.take_while(|&t| t > least).find(fits), self.adjacency.edges(from)) {
                (None, &[first, second]) if kept[from.index()] => {
                    kept[from.index()] = false;
                    edge = if first == edge { second } else { first };
                    from = self.network.edge(edge).other(from);
                }
                (found, _) => return (edge, from, found.unwrap_or(least)),
            }
        }
    }

    /// True if a point is inside the organ, at least this far from its surface.
    fn is_clear(&self, p: &Point3, distance: f64) -> bool {
        let place = Aabb { min: *p, max: *p }.grown(distance);
        let is_far = |t| point_triangle(p, self.organ.corners(t)).1 >= distance;
        self.organ.contains(p) && self.organ.near(&place).into_iter().all(is_far)
    }
}

#[cfg(test)]
mod tests {
    use super::super::plan::TissuePlan;
    use super::*;
    use anastomesh_mesh::TriMesh;
    use anastomesh_mesh::shapes::sphere_surface;
    use anastomesh_skeleton::fixtures::network;

    /// Ball of radius 10 around the origin.
    fn plan() -> DomainPlan {
        let ball = sphere_surface(4);
        let points = ball.points.iter().map(|p| p * 10.0).collect();
        let shape = TissueShape::Organ(TriMesh { points, ..ball });
        DomainPlan::default().tissue(TissuePlan::new(shape))
    }

    fn cut(
        points: &[[f64; 3]],
        edges: &[(u32, u32)],
        ends: VesselEnds,
        roots: &[u32],
    ) -> Result<CutNetwork, DomainError> {
        CutNetwork::of(&network(points, 1.0, edges), &plan(), ends, roots)
    }

    /// Trunk of four nodes, of which two lie outside, and two branches inside.
    const TRUNK: ([[f64; 3]; 6], [(u32, u32); 5]) = (
        [[0.0, 0.0, 20.0], [0.0, 0.0, 12.0], [0.0, 0.0, 8.0], [0.0; 3], [4.0, 0.0, -4.0], [-4.0, 0.0, -4.0]],
        [(0, 1), (1, 2), (2, 3), (3, 4), (3, 5)],
    );

    #[test]
    fn the_root_gives_its_number_to_the_end_at_the_surface() {
        let (points, edges) = TRUNK;
        for (roots, original) in [(&[0][..], 0), (&[], 1)] {
            let cut = cut(&points, &edges, VesselEnds::AtSurface, roots).expect("cut");
            assert_eq!((cut.gates.as_slice(), cut.report.outside, cut.report.vessels), (&[original][..], 2, 1));
            let end = cut.network.nodes.last().expect("an end");
            assert!(end.original == original && (end.position.z - 10.0).abs() < 0.05, "{end:?}");
            assert_eq!((cut.network.nodes.len(), cut.network.edges.len()), (5, 4));
        }
    }

    #[test]
    fn ends_inside_keep_their_distance() {
        let (points, edges) = TRUNK;
        let far = cut(&points, &edges, VesselEnds::Inside, &[0]).expect("cut");
        assert_eq!((far.gates.len(), far.report.inside), (0, 1));
        let end = far.network.nodes.last().expect("an end");
        assert!(end.original == 0 && end.position.z < 8.5 && end.position.z > 7.5, "{end:?}");
        // The node inside is nearer than that.
        let mut near = points;
        near[2][2] = 9.0;
        let shorter = cut(&near, &edges, VesselEnds::Inside, &[0]).expect("cut");
        let end = shorter.network.nodes.last().expect("an end");
        assert!(shorter.report.inside == 1 && end.position.z < 8.5, "{end:?}");
    }

    #[test]
    fn terminals_at_the_surface_are_gates_or_retracted() {
        let (points, edges) = ([[0.0; 3], [0.0, 0.0, 9.5]], [(0, 1)]);
        let open = cut(&points, &edges, VesselEnds::AtSurface, &[]).expect("unchanged");
        assert_eq!((open.gates.as_slice(), open.report.vessels), (&[1][..], 0));
        assert_eq!(open.network, network(&points, 1.0, &edges));
        let inside = cut(&points, &edges, VesselEnds::Inside, &[]).expect("retracted");
        let end = inside.network.nodes.last().expect("an end");
        assert!(inside.gates.is_empty() && end.original == 1 && end.position.z < 8.5, "{end:?}");
    }

    #[test]
    fn networks_outside_are_refused() {
        let outside = cut(&[[0.0, 0.0, 11.0], [0.0, 0.0, 20.0]], &[(0, 1)], VesselEnds::AtSurface, &[]);
        assert!(matches!(outside, Err(DomainError::NoVesselInside)), "{outside:?}");
    }

    #[test]
    fn a_node_outside_may_have_several_ends() {
        let points = [[-5.0, 0.0, 0.0], [0.0, 0.0, 20.0], [5.0, 0.0, 0.0]];
        let cut = cut(&points, &[(0, 1), (1, 2)], VesselEnds::AtSurface, &[1]).expect("cut");
        let originals: Vec<u32> = cut.network.nodes.iter().map(|node| node.original).collect();
        assert_eq!((originals.as_slice(), cut.gates.as_slice(), cut.copies.as_slice()), {
            (&[0, 2, 1, 3][..], &[1, 3][..], &[1][..])
        });
    }
}

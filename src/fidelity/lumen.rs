//! Volume of the given lumen, the union of its tubes.
//!
//! Each tube is sampled. A sample inside n tubes has weight 1/n, so common volume counts once. At inner nodes a ball
//! fills the wedge between tubes at an angle, except beyond the end of a vessel.

use anastomesh_mesh::geometry::{Aabb, Point3, Section, Vec3, point_segment};
use anastomesh_skeleton::Tubes;
use anastomesh_skeleton::{Adjacency, EdgeId, NodeId, Skeleton};
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use std::f64::consts::{PI, TAU};

/// Approximate number of samples over all tubes, and its bounds per tube.
const SAMPLES: usize = 1 << 17;
const LEAST: usize = 8;
const MOST: usize = 512;

/// Minimum turning angle, in radians, of a vessel that needs a ball in its wedge.
const STRAIGHT: f64 = 0.3;

/// Steps of an additive recurrence that fills a cube evenly (Roberts 2018): powers of the inverse of the root of x⁴ = x
/// + 1.
const EVEN: [f64; 3] = [0.819_172_513_396_164_4, 0.671_043_606_703_789_3, 0.549_700_477_901_970_3];

/// Volume of the union of a network's tubes and of the balls at its inner nodes.
pub(super) fn volume(network: &Skeleton, tubes: &Tubes) -> f64 {
    let adjacency = network.adjacency();
    let mut lumen = Lumen { network, tubes, adjacency: &adjacency, ends: FxHashMap::default() };
    for tip in adjacency.terminals() {
        lumen.end(tip);
    }
    let count = (SAMPLES / network.edges.len().max(1)).clamp(LEAST, MOST);
    let edges: Vec<EdgeId> = network.edge_ids().collect();
    let nodes: Vec<NodeId> = network.node_ids().filter(|&n| adjacency.valence(n) > 1).collect();
    let of_tubes: Vec<f64> = edges.par_iter().with_min_len(64).map(|&e| lumen.of_tube(e, count)).collect();
    let of_balls: Vec<f64> = nodes.par_iter().with_min_len(64).map(|&n| lumen.of_ball(n, count)).collect();
    of_tubes.iter().sum::<f64>() + of_balls.iter().sum::<f64>()
}

struct Lumen<'a> {
    network: &'a Skeleton,
    tubes: &'a Tubes,
    adjacency: &'a Adjacency,
    /// Vessel ends (point and outward direction) within reach of a node's ball.
    ends: FxHashMap<NodeId, Vec<(Point3, Vec3)>>,
}

impl Lumen<'_> {
    /// Clips the balls of nodes near a tip at its plane.
    fn end(&mut self, tip: NodeId) {
        let place = self.network.node(tip).position;
        let (mut node, mut before, mut within) = (tip, None, Vec::new());
        let mut outwards = None;
        while let Some(&edge) = self.adjacency.edges(node).iter().find(|&&e| Some(e) != before) {
            (node, before) = (self.network.edge(edge).other(node), Some(edge));
            let from = place - self.network.node(node).position;
            // Direction over the last radius, as much shorter edges have no reliable direction.
            if outwards.is_none() || from.norm() <= self.network.node(tip).radius {
                outwards = from.try_normalize(0.0);
            }
            if from.norm() >= self.network.tube(edge).max_radius() || self.adjacency.valence(node) != 2 {
                break;
            }
            within.push(node);
        }
        let Some(outwards) = outwards else { return };
        for node in within {
            self.ends.entry(node).or_default().push((place, outwards));
        }
    }

    /// True if a point in a node's ball lies beyond the end of its vessel.
    fn beyond(&self, node: NodeId, point: &Point3) -> bool {
        self.ends.get(&node).is_some_and(|ends| ends.iter().any(|(place, way)| (point - place).dot(way) > 0.0))
    }

    /// Volume contribution of a tube, weighted by overlap.
    fn of_tube(&self, edge: EdgeId, count: usize) -> f64 {
        let tube = self.network.tube(edge);
        let (length, [ra, rb]) = (tube.length(), [tube.ra, tube.rb]);
        let Some(axis) = (tube.b - tube.a).try_normalize(0.0) else { return 0.0 };
        let (u, w) = Section::new(tube.a, axis, ra).frame();
        let (mut sum, mut seen) = (0.0, Vec::new());
        for [x, y, z] in evenly(edge.index(), count) {
            // Uniform along the axis and over each section; a sample has the weight of its section's area.
            let radius = tube.radius(x);
            let (r, angle) = (radius * y.sqrt(), TAU * z);
            let point = tube.point(x) + u * (r * libm::cos(angle)) + w * (r * libm::sin(angle));
            sum += radius * radius / self.holders(&point, ra.max(rb), &mut seen);
        }
        PI * length * sum / count as f64
    }

    fn of_ball(&self, node: NodeId, count: usize) -> f64 {
        let (center, radius) = (self.network.node(node).position, self.ball(node));
        let (mut sum, mut seen) = (0.0, Vec::new());
        for [x, y, z] in evenly(node.index(), count) {
            let (r, height, angle) = (radius * libm::cbrt(x), 2.0 * y - 1.0, TAU * z);
            let across = (1.0 - height * height).sqrt();
            let point = center + Vec3::new(across * libm::cos(angle), across * libm::sin(angle), height) * r;
            if !self.beyond(node, &point) {
                sum += 1.0 / self.holders(&point, radius, &mut seen);
            }
        }
        4.0 / 3.0 * PI * radius.powi(3) * sum / count as f64
    }

    /// Radius of the ball at an inner node: that of the thickest vessel that needs a ball. Zero if a vessel is almost
    /// straight.
    fn ball(&self, node: NodeId) -> f64 {
        let edges = self.adjacency.edges(node);
        if let &[e, f] = edges
            && self.network.angle(node, [e, f]) > PI - STRAIGHT
        {
            return 0.0;
        }
        self.network.shared_radius(self.adjacency, node)
    }

    /// Number of tubes and balls that contain a point, at least 1.
    fn holders(&self, point: &Point3, reach: f64, seen: &mut Vec<NodeId>) -> f64 {
        let mut count = 0_u32;
        seen.clear();
        self.tubes.tree.query(&Aabb::of_points([point]).grown(1e-3 * reach), |id| {
            let tube = &self.tubes.list[id as usize];
            let (t, distance) = point_segment(point, &tube.a, &tube.b);
            // Only between the end planes; balls cover the rest.
            let axis = tube.b - tube.a;
            let between = (point - tube.a).dot(&axis) >= 0.0 && (point - tube.b).dot(&axis) <= 0.0;
            count += u32::from(between && distance <= tube.radius(t));
            let ends = self.network.edge(EdgeId(id)).nodes;
            seen.extend(ends.iter().filter(|&&n| self.adjacency.valence(n) > 1));
        });
        seen.sort_unstable();
        seen.dedup();
        let holds =
            |&n: &NodeId| (point - self.network.node(n).position).norm() < self.ball(n) && !self.beyond(n, point);
        count += seen.iter().filter(|n| holds(n)).count() as u32;
        f64::from(count.max(1))
    }
}

/// Points that fill the unit cube evenly. Each place uses the next `count` points, because repeated points would repeat
/// the error.
fn evenly(place: usize, count: usize) -> impl Iterator<Item = [f64; 3]> {
    let first = place * count + 1;
    (first..first + count).map(|i| EVEN.map(|step| (0.5 + step * i as f64).fract()))
}

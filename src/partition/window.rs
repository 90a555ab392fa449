//! Where a branch may be cut: equations 11 and 12, measured along the branch, and straight enough for a connector.

use super::course::{Course, Way};
use super::{PartitionParams, UncutReason};
use crate::geometry::Vec3;
use crate::skeleton::{Adjacency, BranchId, NodeId, Skeleton};

/// A place for one cut: the planes may stand anywhere in `window` with room for the connector between them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    pub branch: u32,
    /// Where planes may stand, as arc lengths.
    pub window: [f64; 2],
    /// Where they stand now: side 0 and side 1.
    pub planes: [f64; 2],
    /// Whether the cut is made.
    pub alive: bool,
}

/// What a branch ends in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BranchEnd {
    Junction,
    Terminal,
    /// The node where a ring was opened: of valence 2.
    Seam,
}

/// The two ends of a branch leave a node with these directions and radii.
#[derive(Clone, Copy)]
struct Leaving {
    branch: u32,
    way: Way,
    direction: Vec3,
    /// Radius over the window in which the direction is measured.
    radius: f64,
    /// Radius at the node.
    root_radius: f64,
}

/// Looks for places to cut, branch by branch.
pub(super) struct Cutter<'a> {
    skeleton: &'a Skeleton,
    courses: &'a [Course<'a>],
    params: &'a PartitionParams,
    adjacency: &'a Adjacency,
    /// What leaves each node: a range of `leaving`.
    first: Vec<u32>,
    leaving: Vec<Leaving>,
}

/// How much of equation 11's distance is counted in radii of the vessel itself, the rest in those of its neighbours.
const OWN_SHARE: f64 = 0.6;
/// Over how many radii of the node the direction of a branch is measured.
const DIRECTION_WINDOW: f64 = 3.0;
/// How much of the vessel a terminal keeps at least when its branch is cut, in radii.
const TERMINAL_KEEPS: f64 = 3.0;
/// Shortest piece between two cuts of a branch, in radii.
const SHORTEST_PIECE: f64 = 4.0;

impl<'a> Cutter<'a> {
    pub fn new(
        skeleton: &'a Skeleton,
        adjacency: &'a Adjacency,
        courses: &'a [Course<'a>],
        params: &'a PartitionParams,
    ) -> Self {
        let mut first = vec![0_u32; skeleton.nodes.len() + 1];
        for course in courses {
            for node in course.branch.ends() {
                first[node.0 as usize + 1] += 1;
            }
        }
        for i in 1..first.len() {
            first[i] += first[i - 1];
        }
        let mut next = first.clone();
        let blank = Leaving { branch: 0, way: Way::Onward, direction: Vec3::zeros(), radius: 0.0, root_radius: 0.0 };
        let mut leaving = vec![blank; 2 * courses.len()];
        for (branch, course) in courses.iter().enumerate() {
            for (node, way) in course.branch.ends().into_iter().zip([Way::Onward, Way::Back]) {
                let at = &mut next[node.0 as usize];
                leaving[*at as usize] = Self::leave(skeleton, course, branch as u32, node, way);
                *at += 1;
            }
        }
        Self { skeleton, courses, params, adjacency, first, leaving }
    }

    fn leave(skeleton: &Skeleton, course: &Course, branch: u32, node: NodeId, way: Way) -> Leaving {
        let window = DIRECTION_WINDOW * skeleton.nodes[node.0 as usize].radius;
        let half = (0.5 * window).min(0.5 * course.length());
        let s = if way == Way::Onward { half } else { course.length() - half };
        let root_radius = course.radius(if way == Way::Onward { 0.0 } else { course.length() }, way);
        Leaving { branch, way, direction: course.leaving(way, window), radius: course.radius(s, way), root_radius }
    }

    pub fn end_kind(&self, node: NodeId) -> BranchEnd {
        match self.adjacency.valence(node) {
            1 => BranchEnd::Terminal,
            2 => BranchEnd::Seam,
            _ => BranchEnd::Junction,
        }
    }

    /// Least distances of a plane from the end of `branch` that leaves its node by `way`: by (11), and by (12).
    fn distances(&self, branch: u32, way: Way) -> [f64; 2] {
        let course = &self.courses[branch as usize];
        let node = course.branch.ends()[way.side()];
        let radius = self.skeleton.nodes[node.0 as usize].radius;
        if self.end_kind(node) == BranchEnd::Terminal {
            return [TERMINAL_KEEPS * radius, 0.0];
        }
        let around = self.first[node.0 as usize] as usize..self.first[node.0 as usize + 1] as usize;
        let around = &self.leaving[around];
        let Some(own) = around.iter().find(|l| l.branch == branch && l.way == way) else {
            return [self.params.node_distance * radius, 0.0];
        };
        let (mut angle, mut thickest) = (0.0_f64, 0.0_f64);
        for other in around.iter().filter(|l| !(l.branch == branch && l.way == way)) {
            angle = angle.max(separation(own, other));
            thickest = thickest.max(other.root_radius);
        }
        // What has to be passed is the wall of the thickest neighbour; with equal radii that is equation 11.
        let wall = (self.params.node_distance - OWN_SHARE) * thickest + OWN_SHARE * own.root_radius;
        [wall.min(self.params.node_distance * radius), self.params.angle_margin * angle]
    }

    /// The places where `branch` is to be cut, in order along it, or why there is none.
    pub fn slots(&self, branch: u32, out: &mut Vec<Slot>) -> Option<UncutReason> {
        let course = &self.courses[branch as usize];
        if self.params.forbidden_cuts.contains(&BranchId(branch)) {
            return Some(UncutReason::Forbidden);
        }
        let ends = course.branch.ends().map(|n| self.end_kind(n));
        if ends.contains(&BranchEnd::Terminal) && !self.terminal_wants_cut(course) {
            return Some(UncutReason::Terminal);
        }
        let [[near0, angle0], [near1, angle1]] =
            [self.distances(branch, Way::Onward), self.distances(branch, Way::Back)];
        let (lo, hi) = (near0.max(angle0), course.length() - near1.max(angle1));
        if !self.roomy(course, lo, hi) {
            let by_length = self.roomy(course, near0, course.length() - near1);
            return Some(if by_length { UncutReason::Angle } else { UncutReason::Length });
        }
        let start = out.len();
        self.choose(branch, lo, hi, out);
        if out.len() == start {
            return Some(UncutReason::Bend);
        }
        out[start..].sort_by(|a, b| a.window[0].total_cmp(&b.window[0]));
        None
    }

    fn terminal_wants_cut(&self, course: &Course) -> bool {
        let [small, large] = course.radius_range(0.0, course.length());
        course.length() > self.params.long * course.mean_radius() || large > self.params.taper * small
    }

    /// Whether a connector has room between planes at `lo` and `hi`.
    fn roomy(&self, course: &Course, lo: f64, hi: f64) -> bool {
        hi > lo && hi - lo >= room(course, self.params, lo, hi)
    }

    /// Takes the longest straight part of [lo, hi]; then, where a long piece is left beside it, the same there.
    fn choose(&self, branch: u32, lo: f64, hi: f64, out: &mut Vec<Slot>) {
        let course = &self.courses[branch as usize];
        let parts = course.straight_parts(lo, hi, self.params.max_turn);
        // Stretches to search, each with the piece of vessel that stays whole unless a cut is found in it.
        let mut pending = vec![(lo, hi, 0.0, course.length())];
        while let Some((lo, hi, piece_lo, piece_hi)) = pending.pop() {
            let clipped = parts.iter().map(|p| [p[0].max(lo), p[1].min(hi)]);
            // Another cut only for a fair length of connector; the first one as soon as there is room.
            let least = if piece_lo > 0.0 || piece_hi < course.length() { 2.0 } else { 1.0 };
            let fits = |p: &[f64; 2]| p[1] > p[0] && p[1] - p[0] >= least * room(course, self.params, p[0], p[1]);
            let best = clipped.filter(fits).reduce(|a, b| {
                // Not the first of nearly equal ones by rounding.
                if b[1] - b[0] > (a[1] - a[0]) * (1.0 + 1e-9) { b } else { a }
            });
            let Some(window) = best else { continue };
            self.divide(branch, window, out);
            let gap = |s: f64| SHORTEST_PIECE * course.radius(s, Way::Onward).max(course.radius(s, Way::Back));
            for (from, to, piece) in [
                (lo, window[0] - gap(window[0]), [piece_lo, window[0]]),
                (window[1] + gap(window[1]), hi, [window[1], piece_hi]),
            ] {
                let middle = 0.5 * (piece[0] + piece[1]);
                if to > from && piece[1] - piece[0] > self.params.long * course.radius(middle, Way::Onward) {
                    pending.push((from, to, piece[0], piece[1]));
                }
            }
        }
    }

    /// Makes a slot of a window, or several with short pieces between them if it is longer than a connector may be.
    fn divide(&self, branch: u32, window: [f64; 2], out: &mut Vec<Slot>) {
        let course = &self.courses[branch as usize];
        let radius = course.radius_range(window[0], window[1])[1];
        let length = window[1] - window[0];
        let piece = 1.5 * SHORTEST_PIECE * radius;
        let count = (length / (self.params.longest_connector * radius)).ceil().clamp(1.0, 1e5);
        let connector = (length - (count - 1.0) * piece) / count;
        for i in 0..count as usize {
            let lo = window[0] + i as f64 * (connector + piece);
            let part = [lo, if i + 1 == count as usize { window[1] } else { lo + connector }];
            out.push(Slot { branch, window: part, planes: self.planes(course, branch, part), alive: true });
        }
    }

    /// Where the planes stand first: at the ends of the window, or shifted as the caller asks.
    fn planes(&self, course: &Course, branch: u32, window: [f64; 2]) -> [f64; 2] {
        let shift = self.params.shifted_cuts.get(&BranchId(branch)).copied().unwrap_or(0.0).clamp(-1.0, 1.0);
        let largest = course.radius_range(window[0], window[1])[1];
        let slack = (window[1] - window[0] - self.params.room * largest).max(0.0);
        // A NaN is no shift.
        if shift > 0.0 {
            [window[0] + shift * slack, window[1]]
        } else if shift < 0.0 {
            [window[0], window[1] + shift * slack]
        } else {
            window
        }
    }
}

/// Room that a connector between planes at `lo` and `hi` needs.
pub(super) fn room(course: &Course, params: &PartitionParams, lo: f64, hi: f64) -> f64 {
    params.room * 0.5 * (course.radius(lo, Way::Onward) + course.radius(hi, Way::Back))
}

/// Equation 12: how far from their node two vessels that leave it at an acute angle are separate.
fn separation(own: &Leaving, other: &Leaving) -> f64 {
    let cos = own.direction.dot(&other.direction);
    if cos <= 0.0 {
        return 0.0;
    }
    let sin = own.direction.cross(&other.direction).norm();
    (other.radius + own.radius * cos) / sin
}

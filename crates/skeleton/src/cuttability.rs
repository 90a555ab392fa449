//! Cut conditions of a branch.
//!
//! They are equations 11 and 12 of the paper, measured along the branch, and a straight part that is long enough for a
//! connector. Reports and the partition use the same conditions.

use super::course::{Course, Courses, Way};
use super::{Adjacency, NodeId, Skeleton};
use anastomesh_mesh::geometry::Vec3;

/// 2 ω of equation 11 with ω = 1.1: minimum distance of a cut from a node, in radii of the node. Also the minimum
/// length of an edge between two such nodes, in sums of their radii.
pub const CUT_DISTANCE: f64 = 2.2;

/// ω of equation 12. Walls are level sets of a convolution field, whose tubes fuse at distances below 1.1 sums of their
/// radii. With the paper's 1.1 they would fuse at cuts.
pub const ANGLE_MARGIN: f64 = 1.25;

/// Minimum length of a connector between its two planes, in radii.
pub const CONNECTOR_ROOM: f64 = 1.0;

/// Fraction of equation 11's distance in radii of the vessel itself; the rest is in those of its neighbours.
const OWN_SHARE: f64 = 0.6;
/// Radius of a thin vessel relative to that of its neighbour. It counts from the neighbour's wall, not from the node.
pub const THIN: f64 = 0.125;
/// Its part of the distance in the neighbour's radii.
const THIN_DISTANCE: f64 = 1.25;
/// Length over which the direction of a branch is measured, in radii of the node.
const DIRECTION_WINDOW: f64 = 3.0;
/// Minimum length that a terminal keeps when its branch is cut, in radii.
const TERMINAL_KEEPS: f64 = 3.0;

/// Requirements of a cut. Lengths are in radii of the vessel concerned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutRules {
    /// Minimum distance of a cut plane from a junction, in radii of the node (2 ω of equation 11).
    pub node_distance: f64,
    /// Margin factor on the angle condition (ω of equation 12).
    pub angle_margin: f64,
    /// Minimum length of a connector between its two planes.
    pub room: f64,
    /// Maximum turn, in radians, of a vessel over one radius inside a connector. Bends are left to the clusters.
    pub max_turn: f64,
}

impl Default for CutRules {
    fn default() -> Self {
        Self {
            node_distance: CUT_DISTANCE,
            angle_margin: ANGLE_MARGIN,
            room: CONNECTOR_ROOM,
            max_turn: 20.0_f64.to_radians(),
        }
    }
}

impl CutRules {
    /// Minimum length of a connector between planes at `lo` and `hi`.
    pub fn room_between(&self, course: &Course, lo: f64, hi: f64) -> f64 {
        self.room * 0.5 * (course.radius(lo, Way::Onward) + course.radius(hi, Way::Back))
    }

    /// True if a connector between planes at `lo` and `hi` has at least `times` its minimum length.
    pub fn fits(&self, course: &Course, [lo, hi]: [f64; 2], times: f64) -> bool {
        hi > lo && hi - lo >= times * self.room_between(course, lo, hi)
    }
}

/// Distance from the node at which two vessels along `u` and `v` are separate (equation 12), measured along the first.
/// Zero unless the angle is acute.
pub fn separation(u: &Vec3, v: &Vec3, radii: [f64; 2]) -> f64 {
    let lengths = u.norm() * v.norm();
    separation_at(u.dot(v) / lengths, u.cross(v).norm() / lengths, radii)
}

/// Equation 12 by cosine and sine of the angle: (r2 + r1 cos φ) / sin φ.
fn separation_at(cosine: f64, sine: f64, radii: [f64; 2]) -> f64 {
    if cosine <= 0.0 { 0.0 } else { (radii[1] + radii[0] * cosine) / sine }
}

/// Reason why a branch cannot be cut, regardless of other vessels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Uncuttable {
    /// Too short (equation 11, and length of a connector).
    Length,
    /// Too short for the angle at which it leaves another branch (equation 12).
    Angle,
    /// Nowhere straight enough for a connector.
    Bend,
}

/// Part of a branch that may be cut.
#[derive(Clone, Debug, PartialEq)]
pub struct CutWindow {
    /// Arc lengths between which planes may lie.
    pub reach: [f64; 2],
    /// Subranges that are straight enough for a connector.
    pub straight: Vec<[f64; 2]>,
}

/// Kind of node at the end of a branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BranchEnd {
    /// A node of three or more edges.
    Junction,
    /// A node of one edge.
    Terminal,
    /// Node where a ring was opened, of valence 2.
    Seam,
}

impl BranchEnd {
    /// Kind of end at a node.
    pub fn of(adjacency: &Adjacency, node: NodeId) -> Self {
        match adjacency.valence(node) {
            1 => Self::Terminal,
            2 => Self::Seam,
            _ => Self::Junction,
        }
    }
}

/// Direction and radii of a branch that leaves a node.
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

impl Leaving {
    fn of(skeleton: &Skeleton, course: &Course, branch: u32, node: NodeId, way: Way) -> Self {
        let window = DIRECTION_WINDOW * skeleton.node(node).radius;
        let half = (0.5 * window).min(0.5 * course.length());
        let s = if way == Way::Onward { half } else { course.length() - half };
        let root_radius = course.radius(if way == Way::Onward { 0.0 } else { course.length() }, way);
        Self { branch, way, direction: course.leaving(way, window), radius: course.radius(s, way), root_radius }
    }

    /// Equation 12 relative to another branch.
    fn separation(&self, other: &Self) -> f64 {
        let sine = self.direction.cross(&other.direction).norm();
        separation_at(self.direction.dot(&other.direction), sine, [self.radius, other.radius])
    }
}

/// Finds the part of each branch of a skeleton that may be cut.
pub struct Cuttability<'a> {
    adjacency: &'a Adjacency,
    courses: Courses<'a>,
    rules: CutRules,
    /// Range of `leaving` of each node.
    first: Vec<u32>,
    leaving: Vec<Leaving>,
}

impl<'a> Cuttability<'a> {
    /// Creates it from all branches of the skeleton, `courses`.
    pub fn new(adjacency: &'a Adjacency, courses: Courses<'a>, rules: CutRules) -> Self {
        let skeleton = courses.skeleton;
        let mut first = vec![0_u32; skeleton.nodes.len() + 1];
        for branch in 0..courses.len() as u32 {
            for node in courses.chains.ends(branch) {
                first[node.index() + 1] += 1;
            }
        }
        for i in 1..first.len() {
            first[i] += first[i - 1];
        }
        let mut next = first.clone();
        let blank = Leaving { branch: 0, way: Way::Onward, direction: Vec3::zeros(), radius: 0.0, root_radius: 0.0 };
        let mut leaving = vec![blank; 2 * courses.len()];
        for (branch, course) in (0..).zip(courses.iter()) {
            for (node, way) in course.branch.ends().into_iter().zip([Way::Onward, Way::Back]) {
                let at = &mut next[node.index()];
                leaving[*at as usize] = Leaving::of(skeleton, &course, branch, node, way);
                *at += 1;
            }
        }
        Self { adjacency, courses, rules, first, leaving }
    }

    /// Returns the part of a branch that may be cut.
    ///
    /// # Errors
    /// [`Uncuttable`]: why the branch has no window.
    pub fn window(&self, branch: u32) -> Result<CutWindow, Uncuttable> {
        let course = &self.courses.get(branch);
        let [[near0, angle0], [near1, angle1]] = [Way::Onward, Way::Back].map(|way| self.distances(branch, way));
        let reach = [near0.max(angle0), course.length() - near1.max(angle1)];
        if !self.rules.fits(course, reach, 1.0) {
            let by_length = self.rules.fits(course, [near0, course.length() - near1], 1.0);
            return Err(if by_length { Uncuttable::Angle } else { Uncuttable::Length });
        }
        let straight = course.straight_parts(reach[0], reach[1], self.rules.max_turn);
        if straight.iter().any(|&part| self.rules.fits(course, part, 1.0)) {
            Ok(CutWindow { reach, straight })
        } else {
            Err(Uncuttable::Bend)
        }
    }

    /// Minimum distances of a plane from the end of `branch` that leaves its node by `way`: by (11), and by (12).
    fn distances(&self, branch: u32, way: Way) -> [f64; 2] {
        let node = self.courses.chains.ends(branch)[way.side()];
        let radius = self.courses.skeleton.node(node).radius;
        if BranchEnd::of(self.adjacency, node) == BranchEnd::Terminal {
            let runs = self.courses.get(branch).clear_of_runs(way);
            return [runs.max(TERMINAL_KEEPS * radius), 0.0];
        }
        let around = &self.leaving[self.first[node.index()] as usize..self.first[node.index() + 1] as usize];
        let Some(own) = around.iter().find(|l| l.branch == branch && l.way == way) else {
            return [self.rules.node_distance * radius, 0.0];
        };
        let (mut angle, mut thickest) = (0.0_f64, 0.0_f64);
        for other in around.iter().filter(|l| !(l.branch == branch && l.way == way)) {
            angle = angle.max(own.separation(other));
            thickest = thickest.max(other.root_radius);
        }
        // The cut must pass the wall of the thickest neighbour; with equal radii that is equation 11.
        let is_thin = own.root_radius < THIN * thickest;
        let share = if is_thin { THIN_DISTANCE } else { self.rules.node_distance - OWN_SHARE };
        let wall = share * thickest + OWN_SHARE * own.root_radius;
        [wall.min(self.rules.node_distance * radius), self.rules.angle_margin * angle]
    }
}

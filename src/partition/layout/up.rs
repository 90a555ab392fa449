//! Frames of discs beside a bifurcation or a bend: their first vector is normal to its plane. Bifurcations of the same shape
//! thus have the same discs.

use super::{LEG, Layout, NONE, Placed};
use crate::partition::parts::{ClusterId, CutId, SHARP_BEND};
use anastomesh_mesh::geometry::Vec3;
use anastomesh_skeleton::NodeId;
use anastomesh_skeleton::course::{Course, Way};

/// Maximum number of pieces of a cluster whose bifurcations count. Clusters have few, and each cut visits them all.
const MOST_PIECES: usize = 32;

/// Vessel at a bifurcation.
struct Branch {
    direction: Vec3,
    /// Rank of its other end: a cut after it, a cut before it, or a terminal.
    rank: u8,
    /// Radius at its other end.
    radius: f64,
}

impl Layout {
    /// First frame vectors of the discs on both sides of a cut, up to their components along the vessel. A vessel that leads to
    /// no bifurcation or bend on one side has one frame. `None`: the frame depends on the axis alone.
    pub(super) fn ups(&self, cut: CutId) -> [Option<Vec3>; 2] {
        let cut = &self.cuts[cut.0 as usize];
        let course = self.course(cut.branch);
        let nodes = course.branch.ends();
        let [first, second] = [0, 1].map(|side| {
            let cluster = cut.sides[side].0;
            self.normal_at(nodes[side], cluster).or_else(|| self.normal_of_bend(&course, cluster))
        });
        [first.or(second), second.or(first)]
    }

    /// Normal of the plane through points at equal distances along three vessels that meet at a node of a cluster. `None` for
    /// another number of vessels, and if the node is in no cluster or in a large one.
    fn normal_at(&self, node: NodeId, cluster: ClusterId) -> Option<Vec3> {
        let pieces = self.pieces_of(cluster.0 as usize);
        if pieces.len() > MOST_PIECES {
            return None;
        }
        let mut branches: Vec<Branch> = pieces.iter().flat_map(|piece| self.branches_at(node, piece)).collect();
        branches.sort_by(|a, b| b.rank.cmp(&a.rank).then(b.radius.total_cmp(&a.radius)));
        let [a, b, c] = <[Branch; 3]>::try_from(branches).ok()?.map(|branch| branch.direction);
        (a - c).cross(&(b - c)).try_normalize(0.0)
    }

    /// Normal of the plane of a bend: a cluster of one piece of the course, which turns sharply at one node.
    fn normal_of_bend(&self, course: &Course, cluster: ClusterId) -> Option<Vec3> {
        let [piece] = self.pieces_of(cluster.0 as usize) else { return None };
        let [lo, hi] = self.arc_of(piece, course);
        let arc = &course.branch.arc;
        let (from, to) = (arc.partition_point(|&s| s <= lo), arc.partition_point(|&s| s < hi));
        if to != from + 1 {
            return None;
        }
        let node = course.points[from];
        let mut ways = [lo, hi].map(|s| course.point(s) - node);
        if ways[0].angle(&-ways[1]) <= SHARP_BEND {
            return None;
        }
        // Vessels are in the order of those at a bifurcation.
        if piece.terminals[1] {
            ways.reverse();
        }
        ways[0].cross(&ways[1]).try_normalize(0.0)
    }

    /// Ends of a piece at a node.
    fn branches_at(&self, node: NodeId, piece: &Placed) -> Vec<Branch> {
        let course = self.course(piece.branch);
        let is_there =
            |&end: &usize| piece.cuts[end] == NONE && !piece.terminals[end] && course.branch.ends()[end] == node;
        (0..2).filter(is_there).map(|end| self.branch(piece, &course, end)).collect()
    }

    fn branch(&self, piece: &Placed, course: &Course, end: usize) -> Branch {
        let window = LEG * self.skeleton.node(course.branch.ends()[end]).radius;
        let other = 1 - end;
        let at = self.arc_of(piece, course)[other];
        Branch {
            // Directions out of a node are named in reverse.
            direction: course.leaving([Way::Onward, Way::Back][end], window),
            rank: if piece.terminals[other] { 2 } else { end as u8 },
            radius: course.radius(at, Way::BOTH[other]),
        }
    }
}

//! Frames of discs beside a bifurcation: their first vector is normal to the plane of the bifurcation. Bifurcations of the
//! same shape thus have the same discs.

use super::{Layout, NONE};
use crate::partition::parts::{ClusterId, CutId};
use anastomesh_mesh::geometry::Vec3;

impl Layout {
    /// First frame vectors of the discs on both sides of a cut, up to their components along the vessel. A vessel that leads to
    /// no bifurcation on one side has one frame. `None`: the frame depends on the axis alone.
    pub(super) fn ups(&self, cut: CutId) -> [Option<Vec3>; 2] {
        let [first, second] = self.cuts[cut.0 as usize].sides.map(|(cluster, _)| self.normal_of_fork(cluster));
        [first.or(second), second.or(first)]
    }

    /// Normal of the plane through the three vessels of a cluster, at equal distances from their node; `None` for other
    /// clusters. A vessel ends at a cut or at a terminal.
    fn normal_of_fork(&self, cluster: ClusterId) -> Option<Vec3> {
        let [a, b, c] = self.pieces_of(cluster.0 as usize) else { return None };
        let mut node = None;
        let mut ways = [Vec3::zeros(); 3];
        for (piece, way) in [a, b, c].into_iter().zip(&mut ways) {
            let is_inner = |end: &usize| piece.cuts[*end] == NONE && !piece.terminals[*end];
            let end = Some(0).filter(is_inner).or(Some(1).filter(is_inner)).filter(|end| !is_inner(&(1 - end)))?;
            let course = self.course(piece.branch);
            if *node.get_or_insert(course.branch.ends()[end]) != course.branch.ends()[end] {
                return None;
            }
            let [from, to] = [end, 1 - end].map(|end| self.arc_of(piece, &course)[end]);
            *way = (course.point(to) - course.point(from)).try_normalize(0.0)?;
        }
        (ways[0] - ways[2]).cross(&(ways[1] - ways[2])).try_normalize(0.0)
    }
}

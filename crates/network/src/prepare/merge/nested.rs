//! Lines within wider lines, such as concentric vessels.
//!
//! The lumen of both is that of the wider line. It must therefore be kept, even if the inner line is longer.

use super::line::SampledLine;
use super::runs::SAME_WAY;
use anastomesh_mesh::geometry::{Aabb, Bvh, Vec3, point_segment};
use anastomesh_skeleton::{EdgeId, Skeleton};
use rayon::prelude::*;

/// Factor on the radius of a line that must lie within another line. Radii of duplicate lines of one vessel differ by less.
pub(super) const WIDER: f64 = 1.1;
/// Share of a line's length that must lie within wider lines.
const SHARE: f64 = 0.5;
/// Maximum number of edges tested at a node. Only networks with all lines in one place exceed it.
const MOST_LOOKS: usize = 10_000;

/// True for each line that lies within wider lines of similar direction over most of its length.
pub(super) fn nested(skeleton: &Skeleton, lines: &[SampledLine]) -> Vec<bool> {
    let edges = skeleton.edges.len();
    let (mut of_line, mut tangents) = (vec![usize::MAX; edges], vec![Vec3::zeros(); edges]);
    for (i, line) in lines.iter().enumerate() {
        for (edge, tangent) in line.edges.iter().zip(&line.tangents) {
            (of_line[edge.index()], tangents[edge.index()]) = (i, *tangent);
        }
    }
    let boxes = skeleton.edge_ids().map(|e| {
        let tube = skeleton.tube(e);
        Aabb::of_points([&tube.a, &tube.b]).grown(tube.max_radius())
    });
    let tree = Bvh::new(&boxes.collect::<Vec<_>>());
    let is_inside = |own: usize, i: usize| {
        let line = &lines[own];
        let (point, radius) = (skeleton.node(line.nodes[i]).position, WIDER * line.radii[i]);
        let (mut inside, mut looks) = (false, 0);
        tree.query(&Aabb::of_points([&point]), |id| {
            looks += 1;
            let way = tangents[id as usize].dot(&line.tangents[i]).abs();
            if inside || looks > MOST_LOOKS || of_line[id as usize] == own || way < SAME_WAY {
                return;
            }
            let tube = skeleton.tube(EdgeId(id));
            let (t, distance) = point_segment(&point, &tube.a, &tube.b);
            inside = distance + radius <= tube.radius(t);
        });
        inside
    };
    let is_nested = |own: usize| {
        let line = &lines[own];
        let inside: Vec<bool> = (0..line.nodes.len()).map(|i| is_inside(own, i)).collect();
        let pieces = line.arc.windows(2).zip(inside.windows(2)).filter(|(_, inside)| inside[0] && inside[1]);
        pieces.map(|(arc, _)| arc[1] - arc[0]).sum::<f64>() > SHARE * line.length()
    };
    (0..lines.len()).into_par_iter().map(is_nested).collect()
}

//! Lines: branches, split where they reverse their direction.

use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_skeleton::{Branch, EdgeId, NodeId, Skeleton};

/// Minimum cosine between the directions out of a node, at a distance of one radius, for a reversal (60°). Two lines
/// that meet in their common inlet form one branch with a reversal.
pub(super) const TURNS_BACK: f64 = 0.5;

/// Line with properties of its nodes.
pub(super) struct SampledLine {
    pub nodes: Vec<NodeId>,
    pub edges: Vec<EdgeId>,
    /// Arc length from the start.
    pub arc: Vec<f64>,
    pub radii: Vec<f64>,
    /// Unit tangents over a radius of the line; zero if undefined.
    pub tangents: Vec<Vec3>,
}

impl SampledLine {
    pub(super) fn length(&self) -> f64 {
        self.arc[self.arc.len() - 1]
    }

    pub(super) fn last(&self) -> usize {
        self.nodes.len() - 1
    }
}

/// Splits a branch into lines.
pub(super) fn lines_of(skeleton: &Skeleton, branch: &Branch) -> Vec<SampledLine> {
    let radii = node_radii(skeleton, branch);
    let points: Vec<Point3> = branch.nodes.iter().map(|&n| skeleton.node(n).position).collect();
    let mut breaks = vec![0];
    breaks.extend(turns(&points, &branch.arc, &radii));
    breaks.push(points.len() - 1);
    let piece = |ends: &[usize]| {
        let [from, to] = [ends[0], ends[1]];
        let arc: Vec<f64> = branch.arc[from..=to].iter().map(|s| s - branch.arc[from]).collect();
        let radii = radii[from..=to].to_vec();
        let tangents = tangents(&points[from..=to], &arc, &radii);
        SampledLine {
            nodes: branch.nodes[from..=to].to_vec(),
            edges: branch.edges[from..to].to_vec(),
            arc,
            radii,
            tangents,
        }
    };
    breaks.windows(2).map(piece).collect()
}

/// Radii along a branch, from its own edges: at a branch point each vessel has its own radius.
fn node_radii(skeleton: &Skeleton, branch: &Branch) -> Vec<f64> {
    let tubes: Vec<_> = branch.tubes(skeleton).collect();
    let mut radii: Vec<f64> = tubes.iter().map(|t| t.ra).collect();
    radii.push(tubes[tubes.len() - 1].rb);
    radii
}

/// Nodes at which a polyline reverses, one per reversal: the sharpest.
fn turns(points: &[Point3], arc: &[f64], radii: &[f64]) -> Vec<usize> {
    let (mut found, mut best): (Vec<usize>, Option<(f64, usize)>) = (Vec::new(), None);
    for i in 1..points.len().saturating_sub(1) {
        let [before, after] = window(arc, i, radii[i]);
        let (u, v) = (points[before] - points[i], points[after] - points[i]);
        let cosine = u.dot(&v) / (u.norm() * v.norm());
        if cosine > TURNS_BACK {
            best = Some(best.filter(|b| b.0 >= cosine).unwrap_or((cosine, i)));
        } else if let Some((_, at)) = best.take() {
            found.push(at);
        }
    }
    found.extend(best.map(|b| b.1));
    found
}

fn tangents(points: &[Point3], arc: &[f64], radii: &[f64]) -> Vec<Vec3> {
    let tangent = |i: usize| {
        let [before, after] = window(arc, i, 0.5 * radii[i]);
        (points[after] - points[before]).try_normalize(0.0).unwrap_or_else(Vec3::zeros)
    };
    (0..points.len()).map(tangent).collect()
}

/// Last node at least `reach` before node `i` and first node as far behind it, or the ends.
fn window(arc: &[f64], i: usize, reach: f64) -> [usize; 2] {
    let before = arc[..i].partition_point(|&s| s <= arc[i] - reach).saturating_sub(1);
    let after = i + arc[i..].partition_point(|&s| s < arc[i] + reach);
    [before, after.min(arc.len() - 1)]
}

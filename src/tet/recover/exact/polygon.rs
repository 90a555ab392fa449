//! The Delaunay triangulation of a facet: a triangle with vertices on its sides.

use super::segments::Segments;
use super::space::Space;
use crate::geometry::implicit::{self, Site};
use crate::geometry::{Point3, Vec3};
use crate::tet::error::{Obstacle, Stuck, TetError};

/// The corners of a facet and the vertices on its sides, counter-clockwise.
pub(super) fn outline(segments: &Segments, [a, b, c]: [u32; 3], out: &mut Vec<u32>) {
    out.clear();
    for (p, q) in [(a, b), (b, c), (c, a)] {
        let Some(i) = segments.between(p, q) else { continue };
        let segment = &segments.list[i as usize];
        if segment.ends[0] == p {
            out.extend(&segment.chain[..segment.chain.len() - 1]);
        } else {
            out.extend(segment.chain[1..].iter().rev());
        }
    }
}

/// A point off the plane of a triangle, from which it runs counter-clockwise.
pub(super) fn point_above(s: &Space, triangle: [u32; 3]) -> Result<Point3, TetError> {
    let [a, b, c] = triangle.map(|v| *s.point(v));
    let size = (b - a).norm().max((c - a).norm());
    let normal = (b - a).cross(&(c - a));
    let unit = normal.try_normalize(0.0).unwrap_or(Vec3::zeros());
    let mut directions = vec![unit];
    for axis in [Vec3::x(), Vec3::y(), Vec3::z()] {
        directions.extend([axis, -axis]);
    }
    let above = directions.iter().map(|d| a + d * size).find(|p| s.orient_to(triangle, p) > 0);
    above.ok_or(TetError::Stuck { part: Obstacle::Triangle(triangle), reason: Stuck::Precision })
}

/// Triangulates a polygon in the plane below `above`, counter-clockwise seen from there, whose Delaunay triangles
/// (perturbed) are known not to cross its border: a convex one, or the hole that a vertex leaves when it is deleted.
pub(super) fn triangulate(s: &Space, polygon: &[u32], above: &Point3, out: &mut Vec<[u32; 3]>) -> bool {
    out.clear();
    let n = polygon.len();
    let mut stack = vec![(0, n - 1)];
    let site = Site { at: above, on: None };
    while let Some((low, high)) = stack.pop() {
        if high - low < 2 {
            continue;
        }
        let (p, q) = (polygon[low], polygon[high]);
        let mut best: Option<usize> = None;
        for k in low + 1..high {
            let v = polygon[k];
            if implicit::orient3d([s.site(p), s.site(v), s.site(q), site]) > 0
                && best.is_none_or(|b| s.in_circle([p, polygon[b], q], above, v))
            {
                best = Some(k);
            }
        }
        let Some(k) = best else { return false };
        out.push([p, polygon[k], q]);
        stack.push((k, high));
        stack.push((low, k));
    }
    out.len() == n - 2
}

//! Polygons in the plane of a facet.

use super::space::Space;
use crate::geometry::implicit::{self, Site};
use crate::geometry::{Point3, Vec3};
use crate::tet::error::{Obstacle, Stuck, TetError};

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

/// Triangulates a simple polygon in the plane below `above`, counter-clockwise seen from there, some of whose corners
/// may be flat: ears are cut off, the best-shaped first. False when it is not simple.
pub(super) fn triangulate(s: &Space, polygon: &[u32], above: &Point3, out: &mut Vec<[u32; 3]>) -> bool {
    out.clear();
    let site = Site { at: above, on: None };
    let turn = |[p, q, r]: [u32; 3]| implicit::orient3d([s.site(p), s.site(q), s.site(r), site]);
    let mut rest = polygon.to_vec();
    while rest.len() > 3 {
        let n = rest.len();
        let corner = |k: usize| [rest[(k + n - 1) % n], rest[k], rest[(k + 1) % n]];
        let is_ear = |k: usize| {
            let [p, q, r] = corner(k);
            let outside = |w: u32| turn([p, q, w]) < 0 || turn([q, r, w]) < 0 || turn([r, p, w]) < 0;
            turn([p, q, r]) > 0 && rest.iter().all(|&w| [p, q, r].contains(&w) || outside(w))
        };
        let mut order: Vec<(f64, usize)> = (0..n).map(|k| (shape(s, corner(k)), k)).collect();
        order.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let Some(&(_, k)) = order.iter().find(|&&(_, k)| is_ear(k)) else { return false };
        out.push(corner(k));
        rest.remove(k);
    }
    let &[p, q, r] = rest.as_slice() else { return false };
    out.push([p, q, r]);
    turn([p, q, r]) > 0
}

/// Area over the square of the longest side; a heuristic.
fn shape(s: &Space, corners: [u32; 3]) -> f64 {
    let [p, q, r] = corners.map(|v| s.point(v));
    let longest = (q - p).norm_squared().max((r - q).norm_squared()).max((p - r).norm_squared());
    (q - p).cross(&(r - p)).norm() / longest
}

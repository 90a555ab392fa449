//! Normals of triangles that may be needles.

use super::Vec3;

/// Unit normal of a triangle, towards the side that sees it counter-clockwise; zero for a degenerate one. Uses the two
/// shorter sides, which reduces roundoff for needles.
#[inline]
pub fn unit_normal(a: Vec3, b: Vec3, c: Vec3) -> Vec3 {
    let (ab, bc, ca) = (b - a, c - b, a - c);
    let [x, y, z] = [ab, bc, ca].map(|v| v.norm_squared());
    let n = if x >= y && x >= z {
        bc.cross(&ca)
    } else if y >= z {
        ca.cross(&ab)
    } else {
        ab.cross(&bc)
    };
    n.try_normalize(0.0).unwrap_or(Vec3::zeros())
}

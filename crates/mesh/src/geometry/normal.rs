//! Normals of triangles that may be needles.

use super::Vec3;

/// The unit normal of a triangle, towards the side from which it runs counter-clockwise; zero where it has no area. Of
/// the two shorter sides: less roundoff where the triangle is a needle.
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

//! Shape measures used while blocks are built.

use crate::geometry::Point3;

/// Radius ratio of a triangle, 2·r_in/R_circ, in [0, 1]; 1 for the equilateral one.
pub(super) fn triangle_ratio(p: &[Point3; 3]) -> f64 {
    let (a, b, c) = ((p[1] - p[2]).norm(), (p[2] - p[0]).norm(), (p[0] - p[1]).norm());
    // 2 r / R = 16 A² / (s · abc · …) written without the area: (b+c−a)(c+a−b)(a+b−c) / abc.
    let abc = a * b * c;
    if abc > 0.0 { ((b + c - a) * (c + a - b) * (a + b - c) / abc).max(0.0) } else { 0.0 }
}

/// Radius ratio of a tetrahedron, 3·r_in/R_circ, in [−1, 1]; negative for an inverted one.
pub(super) fn tet_ratio(p: &[Point3; 4]) -> f64 {
    let (a, b, c) = (p[1] - p[0], p[2] - p[0], p[3] - p[0]);
    let (bc, ca, ab) = (b.cross(&c), c.cross(&a), a.cross(&b));
    let volume6 = a.dot(&bc);
    let outer = (b - a).cross(&(c - a)).norm();
    let areas2 = bc.norm() + ca.norm() + ab.norm() + outer;
    let circum = (bc * a.norm_squared() + ca * b.norm_squared() + ab * c.norm_squared()).norm();
    // r = V6 / areas2 (twice the areas), R = circum / (2 |V6|).
    if circum * areas2 > 0.0 { 6.0 * volume6 * volume6.abs() / (areas2 * circum) } else { 0.0 }
}

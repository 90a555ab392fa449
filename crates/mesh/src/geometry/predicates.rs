//! Exact geometric predicates: an inline error filter first, then integers if the numbers fit, else Shewchuk's adaptive
//! expansions (`robust`). The only user of `robust`.
//!
//! Signs are exact for coordinates accepted by [`in_exact_range`]: expansions must neither overflow nor underflow.

use super::{Point3, integer};
use robust::{Coord, Coord3D};

/// Smallest magnitude of a non-zero coordinate. Fifth powers of differences and their roundoff do not underflow.
pub const MIN_MAGNITUDE: f64 = 1e-42;

/// Largest magnitude of a coordinate. Fifth powers of differences do not overflow.
pub const MAX_MAGNITUDE: f64 = 1e58;

/// Roundoff bound of the `orient3d` determinant, relative to the product of the largest differences.
///
/// It is Shewchuk's (7 + 56ε)ε times the six products of the permanent, rounded up.
pub const ORIENT3D_BOUND: f64 = 5e-15;

/// Roundoff bound of the `insphere` determinant: (16 + 224ε)ε times 24 products times the largest lift, rounded up.
pub const INSPHERE_BOUND: f64 = 4.5e-14;

/// True if the predicates are exact on points with this coordinate.
#[inline]
pub fn in_exact_range(x: f64) -> bool {
    let m = x.abs();
    m == 0.0 || (MIN_MAGNITUDE..=MAX_MAGNITUDE).contains(&m)
}

#[inline]
fn coord3(p: &Point3) -> Coord3D<f64> {
    Coord3D { x: p.x, y: p.y, z: p.z }
}

/// Orientation of a tetrahedron, with the sign of `det(b − a, c − a, d − a)`: positive if `a, b, c` are
/// counter-clockwise seen from `d`. The magnitude estimates the determinant.
#[inline]
pub fn orient3d(a: &Point3, b: &Point3, c: &Point3, d: &Point3) -> f64 {
    let (bx, by, bz) = (b.x - a.x, b.y - a.y, b.z - a.z);
    let (cx, cy, cz) = (c.x - a.x, c.y - a.y, c.z - a.z);
    let (dx, dy, dz) = (d.x - a.x, d.y - a.y, d.z - a.z);
    let det = bx * (cy * dz - cz * dy) + by * (cz * dx - cx * dz) + bz * (cx * dy - cy * dx);
    let mx = bx.abs().max(cx.abs()).max(dx.abs());
    let my = by.abs().max(cy.abs()).max(dy.abs());
    let mz = bz.abs().max(cz.abs()).max(dz.abs());
    if det.abs() > ORIENT3D_BOUND * mx * my * mz { det } else { orient3d_exact(a, b, c, d) }
}

/// Relative magnitude of a determinant below which [`orient3d_accurate`] does not use floating-point numbers.
const ACCURATE: f64 = 1e9 * ORIENT3D_BOUND;

/// As [`orient3d`], with a magnitude that is accurate to nine digits, except for coordinates of widely different magnitudes.
#[inline]
pub fn orient3d_accurate(a: &Point3, b: &Point3, c: &Point3, d: &Point3) -> f64 {
    let det = orient3d(a, b, c, d);
    let largest = |i: usize| (b[i] - a[i]).abs().max((c[i] - a[i]).abs()).max((d[i] - a[i]).abs());
    if det.abs() > ACCURATE * largest(0) * largest(1) * largest(2) { det } else { orient3d_exact(a, b, c, d) }
}

#[cold]
fn orient3d_exact(a: &Point3, b: &Point3, c: &Point3, d: &Point3) -> f64 {
    // `robust` is positive if d lies below abc: the opposite sign.
    let expanded = || -robust::orient3d(coord3(a), coord3(b), coord3(c), coord3(d));
    integer::orient3d([b, c, d], a).unwrap_or_else(expanded)
}

/// In-sphere test: positive if `e` lies inside the circumsphere of the positive tetrahedron `a, b, c, d`, negative
/// outside, zero on it. The sign flips for a negative tetrahedron.
#[inline]
pub fn insphere(a: &Point3, b: &Point3, c: &Point3, d: &Point3, e: &Point3) -> f64 {
    let (ax, ay, az) = (a.x - e.x, a.y - e.y, a.z - e.z);
    let (bx, by, bz) = (b.x - e.x, b.y - e.y, b.z - e.z);
    let (cx, cy, cz) = (c.x - e.x, c.y - e.y, c.z - e.z);
    let (dx, dy, dz) = (d.x - e.x, d.y - e.y, d.z - e.z);
    let (ab, bc, cd) = (ax * by - bx * ay, bx * cy - cx * by, cx * dy - dx * cy);
    let (da, ac, bd) = (dx * ay - ax * dy, ax * cy - cx * ay, bx * dy - dx * by);
    let abc = az * bc - bz * ac + cz * ab;
    let bcd = bz * cd - cz * bd + dz * bc;
    let cda = cz * da + dz * ac + az * cd;
    let dab = dz * ab + az * bd + bz * da;
    let al = ax * ax + ay * ay + az * az;
    let bl = bx * bx + by * by + bz * bz;
    let cl = cx * cx + cy * cy + cz * cz;
    let dl = dx * dx + dy * dy + dz * dz;
    let det = (cl * dab - dl * abc) + (al * bcd - bl * cda);
    let mx = ax.abs().max(bx.abs()).max(cx.abs().max(dx.abs()));
    let my = ay.abs().max(by.abs()).max(cy.abs().max(dy.abs()));
    let mz = az.abs().max(bz.abs()).max(cz.abs().max(dz.abs()));
    let ml = al.max(bl).max(cl.max(dl));
    if det.abs() > INSPHERE_BOUND * mx * my * mz * ml { det } else { insphere_exact(a, b, c, d, e) }
}

/// Roundoff bound of the floating-point determinant of [`insphere`] for these points.
#[inline]
pub fn insphere_bound(p: [&Point3; 4], e: &Point3) -> f64 {
    let [a, b, c, d] = p.map(|p| p - e);
    let largest = |i: usize| a[i].abs().max(b[i].abs()).max(c[i].abs().max(d[i].abs()));
    let lift = a.norm_squared().max(b.norm_squared()).max(c.norm_squared().max(d.norm_squared()));
    INSPHERE_BOUND * largest(0) * largest(1) * largest(2) * lift
}

/// As [`insphere`], without the filter.
#[cold]
pub fn insphere_exact(a: &Point3, b: &Point3, c: &Point3, d: &Point3, e: &Point3) -> f64 {
    let expanded = || -robust::insphere(coord3(a), coord3(b), coord3(c), coord3(d), coord3(e));
    integer::insphere([a, b, c, d], e).unwrap_or_else(expanded)
}

/// Orientation in the plane: positive if `a, b, c` are counter-clockwise, zero if collinear.
#[inline]
pub fn orient2d(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    let at = |p: [f64; 2]| Coord { x: p[0], y: p[1] };
    robust::orient2d(at(a), at(b), at(c))
}

/// True if three points in space are collinear: their projections on all three coordinate planes are.
#[inline]
pub fn collinear(a: &Point3, b: &Point3, c: &Point3) -> bool {
    [(0, 1), (1, 2), (2, 0)].iter().all(|&(i, j)| orient2d([a[i], a[j]], [b[i], b[j]], [c[i], c[j]]) == 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::exact_oracle::{det, exact, point, sign};
    use num_rational::BigRational;
    use proptest::prelude::*;

    type Row = Vec<BigRational>;

    fn sign_f(x: f64) -> i32 {
        i32::from(x > 0.0) - i32::from(x < 0.0)
    }

    fn differences(from: &Point3, to: &[&Point3]) -> Vec<Row> {
        to.iter().map(|p| (0..3).map(|i| exact(p[i]) - exact(from[i])).collect()).collect()
    }

    fn orient3d_oracle(p: &[Point3]) -> i32 {
        sign(&det(&differences(&p[0], &[&p[1], &p[2], &p[3]])))
    }

    fn insphere_oracle(p: &[Point3]) -> i32 {
        let mut rows = differences(&p[4], &[&p[0], &p[1], &p[2], &p[3]]);
        for r in &mut rows {
            let lift = r.iter().map(|x| x * x).fold(exact(0.0), |s, x| s + x);
            r.push(lift);
        }
        -sign(&det(&rows))
    }

    fn points(n: usize, scale: f64) -> impl Strategy<Value = Vec<Point3>> {
        prop::collection::vec(point(scale), n)
    }

    /// Asserts that an orientation differs from the exact one by a billionth at most.
    fn assert_accurate([a, b, c, d]: [&Point3; 4]) {
        let expected = det(&differences(a, &[b, c, d]));
        let error = exact(orient3d_accurate(a, b, c, d)) - &expected;
        let square = |x: &BigRational| x * x;
        assert!(square(&error) <= square(&expected) * exact(1e-18), "{a} {b} {c} {d}");
    }

    #[test]
    fn accurate_orientations_have_nine_digits() {
        let [a, b, c] = [[0.1, 0.2, 0.3], [1.3, 0.7, 0.9], [0.4, 1.1, -0.3]].map(Point3::from);
        for (step, unit) in (0..60).flat_map(|step| [-40, 0, 40].map(|power| (step, libm::exp2(f64::from(power))))) {
            // Nearer and nearer to the plane.
            let d = a + 0.3 * (b - a) + 0.4 * (c - a) + super::super::Vec3::z() * libm::exp2(f64::from(step)).recip();
            let [a, b, c, d] = [a, b, c, d].map(|p| p * unit);
            assert_accurate([&a, &b, &c, &d]);
        }
    }

    #[test]
    fn orientations_with_one_long_edge_are_accurate() {
        // The far point is opposite to the first one.
        let [a, near, other, far] =
            [[0.1, 0.2, 0.3], [0.11, 0.22, 0.31], [0.13, 0.19, 0.32], [-0.1, -0.2, -0.3]].map(Point3::from);
        for step in 20..50 {
            let off = super::super::Vec3::z() * libm::exp2(f64::from(step)).recip();
            let d = a + 0.5 * (near - a) + 0.01 * (far - a) + off;
            for [p, q, r] in [[&near, &far, &d], [&far, &near, &d], [&near, &d, &far]] {
                assert_accurate([&a, p, q, r]);
            }
            assert_accurate([&a, &near, &other, &d]);
        }
    }

    #[test]
    fn orientations_are_accurate_if_only_one_point_is_far_in_a_direction() {
        // The far point is opposite to the first one, or near to the origin.
        for [x, far] in [[-0.501_234_567_89, 0.501_234_567_89], [1.234_567_891_2, libm::exp2(-23.0)]] {
            let a = Point3::new(x, 0.1, 0.3);
            let b = Point3::new(far, 0.123_4, 0.356_7);
            for step in 20..40 {
                let off = libm::exp2(f64::from(step)).recip();
                let c = a + super::super::Vec3::new(1.1e-7, 0.912_3, 1.034_5);
                let d = a + super::super::Vec3::new(2.3e-7, 0.812_3, 1.034_5 * 0.812_3 / 0.912_3 + off);
                for [p, q, r] in [[&b, &c, &d], [&d, &b, &c], [&c, &d, &b]] {
                    assert_accurate([&a, p, q, r]);
                }
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn orient3d_has_the_exact_sign(p in points(4, 1.0)) {
            prop_assert_eq!(sign_f(orient3d(&p[0], &p[1], &p[2], &p[3])), orient3d_oracle(&p));
        }

        #[test]
        fn insphere_has_the_exact_sign(p in points(5, 1.0)) {
            prop_assert_eq!(sign_f(insphere(&p[0], &p[1], &p[2], &p[3], &p[4])), insphere_oracle(&p));
        }

        #[test]
        fn signs_are_exact_at_the_ends_of_the_range(p in points(5, 1e-26), q in points(5, 2e57)) {
            for p in [p, q] {
                prop_assume!(p.iter().all(|p| p.iter().all(|&x| in_exact_range(x))));
                prop_assert_eq!(sign_f(orient3d(&p[0], &p[1], &p[2], &p[3])), orient3d_oracle(&p));
                prop_assert_eq!(sign_f(insphere(&p[0], &p[1], &p[2], &p[3], &p[4])), insphere_oracle(&p));
            }
        }

        #[test]
        fn collinear_is_exact(p in points(3, 1.0)) {
            let rows = differences(&p[0], &[&p[1], &p[2]]);
            let zero = [(0, 1), (1, 2), (2, 0)].iter().all(|&(i, j)| {
                sign(&(&rows[0][i] * &rows[1][j] - &rows[0][j] * &rows[1][i])) == 0
            });
            prop_assert_eq!(collinear(&p[0], &p[1], &p[2]), zero);
        }
    }

    /// Units of length, and a factor near each.
    fn unit() -> impl Strategy<Value = f64> {
        let powers = prop::sample::select(vec![-70, -20, 0, 20, 70, 180]);
        (powers, 1.0..2.0_f64).prop_map(|(power, factor)| factor * libm::exp2(f64::from(power)))
    }

    fn anywhere() -> impl Strategy<Value = Point3> {
        prop::array::uniform3(-1.0..1.0_f64).prop_map(Point3::from)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1000))]

        #[test]
        fn orientations_of_nearly_coplanar_points_are_exact_in_any_unit(
            p in prop::array::uniform3(anywhere()), [u, v] in prop::array::uniform2(-1.0..2.0_f64), unit in unit(),
        ) {
            // The fourth point is off the plane by rounding alone.
            let d = p[0] + (p[1] - p[0]) * u + (p[2] - p[0]) * v;
            let p = [p[0], p[1], p[2], d].map(|p| p * unit);
            let expected = orient3d_oracle(&p);
            prop_assert_eq!(sign_f(orient3d(&p[0], &p[1], &p[2], &p[3])), expected);
            prop_assert_eq!(sign_f(orient3d_accurate(&p[0], &p[1], &p[2], &p[3])), expected);
        }

        #[test]
        fn nearly_cospherical_points_are_exact_in_any_unit(
            p in prop::array::uniform5(anywhere()), center in anywhere(), unit in unit(),
        ) {
            prop_assume!(p.iter().all(|p| p.coords.norm() > 0.1));
            let p = p.map(|p| (center + p.coords.normalize()) * unit);
            let found = insphere(&p[0], &p[1], &p[2], &p[3], &p[4]);
            prop_assert_eq!(sign_f(found), insphere_oracle(&p));
            prop_assert_eq!(sign_f(insphere_exact(&p[0], &p[1], &p[2], &p[3], &p[4])), insphere_oracle(&p));
        }
    }

    proptest! {
        #[test]
        fn points_of_a_line_are_collinear(
            a in prop::array::uniform3(-9i32..9), way in prop::array::uniform3(-9i32..9), steps in [-5i32..5, -5i32..5],
        ) {
            let at = |step: i32| Point3::from([0, 1, 2].map(|i| 0.25 * f64::from(a[i] + step * way[i])));
            let [a, b, c] = [at(0), at(steps[0]), at(steps[1])];
            prop_assert!(collinear(&a, &b, &c));
            let length = (b - a).norm();
            let aside = c + (b - a).yzx() * 1e-12 / length;
            prop_assert!(length == 0.0 || way.iter().all(|x| *x == way[0]) || !collinear(&a, &b, &aside));
        }
    }

    #[test]
    fn bounds_of_spheres_grow_with_the_fifth_power_of_lengths() {
        let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]].map(Point3::from);
        for power in [-20, 0, 7] {
            let unit = libm::exp2(f64::from(power));
            let [a, b, c, d] = corners.map(|p| p * unit);
            let expected = 3.0 * INSPHERE_BOUND * unit.powi(5);
            assert_eq!(insphere_bound([&a, &b, &c, &d], &Point3::origin()).to_bits(), expected.to_bits());
        }
    }

    #[test]
    fn signs_follow_the_house_convention() {
        let p = |x: f64, y: f64, z: f64| Point3::new(x, y, z);
        let (o, x, y, z) = (p(0., 0., 0.), p(1., 0., 0.), p(0., 1., 0.), p(0., 0., 1.));
        assert!(orient3d(&o, &x, &y, &z) > 0.0);
        assert!(insphere(&o, &x, &y, &z, &p(0.2, 0.2, 0.2)) > 0.0);
        assert!(insphere(&o, &x, &y, &z, &p(2.0, 2.0, 2.0)) < 0.0);
        assert!(insphere(&o, &x, &y, &z, &p(1.0, 1.0, 1.0)) == 0.0);
        assert!(orient2d([0., 0.], [1., 0.], [0., 1.]) > 0.0);
    }
}

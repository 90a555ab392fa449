//! Exact signs of volumes and areas: a floating-point filter, then integers of any size.

use crate::space::{Point, minus};
use num_bigint::BigInt;
use num_traits::float::FloatCore as _;

/// Relative error bound for each determinant of three differences: 9 roundings of 2⁻⁵³, rounded up.
const BOUND: f64 = 1e-15;
/// Bound on the absolute error of underflows, per unit of the largest factor.
const UNDERFLOW: f64 = 1e-315;

/// Returns the sign of the signed volume of a tetrahedron: positive if `a`, `b`, `c` are counterclockwise seen from `d`.
pub fn orient_3d(a: &Point, b: &Point, c: &Point, d: &Point) -> i32 {
    volume_sign(a, &[[*b, *c, *d]])
}

/// Returns the sign of the signed area of a triangle in the plane: positive if it is counterclockwise.
pub fn orient_2d(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> i32 {
    let [[x, y], b, c] = [a, b, c];
    orient_3d(&[x, y, 0.0], &[b[0], b[1], 0.0], &[c[0], c[1], 0.0], &[x, y, 1.0])
}

/// Returns the sign of the volume between a point and triangles: positive if they face away from it. For a closed surface,
/// every point gives the same sign.
pub fn volume_sign(origin: &Point, triangles: &[[Point; 3]]) -> i32 {
    filter(origin, triangles).unwrap_or_else(|| exact(origin, triangles))
}

fn filter(origin: &Point, triangles: &[[Point; 3]]) -> Option<i32> {
    let (mut volume, mut sum, mut largest) = (0.0, 0.0, 0.0_f64);
    for t in triangles {
        let [u, v, w] = t.map(|p| minus(p, *origin));
        for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            let (plus, minus) = (v[j] * w[k], v[k] * w[j]);
            volume += u[i] * (plus - minus);
            sum += u[i].abs() * (plus.abs() + minus.abs());
            largest = largest.max(u[i].abs()).max(v[i].abs()).max(w[i].abs());
        }
    }
    clear_sign(volume, (BOUND * sum + UNDERFLOW * (1.0 + largest)) * triangles.len() as f64, sum)
}

/// Sign of a sum that exceeds its error bound; `None` if it does not, or if the sum of the absolute terms overflows.
fn clear_sign(value: f64, bound: f64, sum: f64) -> Option<i32> {
    // A comparison with NaN or infinity is false.
    (value.abs() > bound && sum < f64::MAX).then(|| value.signum() as i32)
}

fn exact(origin: &Point, triangles: &[[Point; 3]]) -> i32 {
    // A common power of two makes integers of all numbers.
    let numbers = triangles.as_flattened().as_flattened().iter().chain(origin);
    let least = numbers.filter(|&&x| x != 0.0).map(|x| x.integer_decode().1).min().unwrap_or(0);
    let integer = |x: f64| {
        let (mantissa, exponent, sign) = x.integer_decode();
        (BigInt::from(mantissa) * sign) << (exponent - least).max(0)
    };
    let from = origin.map(integer);
    let volume = triangles.iter().map(|t| {
        let [u, v, w] = t.map(|[x, y, z]| [integer(x) - &from[0], integer(y) - &from[1], integer(z) - &from[2]]);
        let minor = |j: usize, k: usize| &v[j] * &w[k] - &v[k] * &w[j];
        &u[0] * minor(1, 2) + &u[1] * minor(2, 0) + &u[2] * minor(0, 1)
    });
    volume.sum::<BigInt>().cmp(&BigInt::ZERO) as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_are_exact_where_the_filter_fails() {
        let (a, b, c): (_, [f64; 3], [f64; 3]) = ([0.1_f64, 0.1, 0.1], [0.7, 0.2, 0.3], [0.3, 0.9, 0.4]);
        // The sum of three times a tenth is rounded: the sign of the remainder decides.
        let on = [a[0] + (b[0] - a[0]) * 0.5, a[1] + (b[1] - a[1]) * 0.5, a[2] + (b[2] - a[2]) * 0.5];
        let up = [on[0], on[1], f64::from_bits(on[2].to_bits() + 4)];
        let down = [on[0], on[1], f64::from_bits(on[2].to_bits() - 4)];
        assert_eq!((orient_3d(&a, &b, &c, &up), orient_3d(&a, &b, &c, &down)), (1, -1));
        assert_eq!(orient_3d(&a, &b, &c, &a), 0);
        assert_eq!(orient_3d(&a, &b, &c, &[0.0, 0.0, 1.0]), 1);
        assert_eq!(orient_3d(&b, &a, &c, &[0.0, 0.0, 1.0]), -1);
    }

    /// Triangles of a tetrahedron.
    fn sides(a: [f64; 3], b: [f64; 3], c: [f64; 3], d: [f64; 3]) -> [[[f64; 3]; 3]; 4] {
        [[a, c, b], [a, b, d], [b, c, d], [c, a, d]]
    }

    /// Sign of an area from integers.
    fn exact_2d([a, b, c]: [[f64; 2]; 3]) -> i32 {
        let [a, b, c] = [a, b, c].map(|[x, y]| [x, y, 0.0]);
        exact(&a, &[[b, c, [a[0], a[1], 1.0]]])
    }

    /// Points in a plane, moved by some units in the last place, at all scales.
    #[test]
    fn the_filter_never_differs_from_integers() {
        let mut state = 7_u64;
        let mut random = |below: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % below
        };
        let mut zeros = 0;
        for round in 0..20_000 {
            let scale = 2.0_f64.powi(random(2000) as i32 - 1000);
            let mut number = || random(1 << 30) as f64 / f64::from(1 << 30) * scale;
            let (a, b, c) =
                ([number(), number(), number()], [number(), number(), number()], [number(), number(), number()]);
            let (u, v) = (number() / scale, number() / scale);
            let mut d = [0, 1, 2].map(|k| a[k] + u * (b[k] - a[k]) + v * (c[k] - a[k]));
            for x in &mut d {
                *x = f64::from_bits(x.to_bits().wrapping_add(random(5) * u64::from(x.is_normal())));
            }
            assert_eq!(orient_3d(&a, &b, &c, &d), exact(&a, &[[b, c, d]]), "{round}: {a:?} {b:?} {c:?} {d:?}");
            let sides = sides(a, b, c, d);
            assert_eq!(volume_sign(&a, &sides), exact(&[0.0; 3], &sides), "{round}: {a:?} {b:?} {c:?} {d:?}");
            let e = [0, 1].map(|k| a[k] + u * (b[k] - a[k]));
            let (a, b) = ([a[0], a[1]], [b[0], b[1]]);
            assert_eq!(orient_2d(a, b, e), exact_2d([a, b, e]), "{round}: {a:?} {b:?} {e:?}");
            zeros += usize::from(exact_2d([a, b, e]) == 0);
            let beside = e.map(|x| x * (1.0 + 3.0 * f64::EPSILON));
            let thirds = [a, b, beside].map(|p| p.map(|x| x / 3.0));
            assert_eq!(orient_2d(thirds[0], thirds[1], thirds[2]), exact_2d(thirds), "{round}: {thirds:?}");
        }
        assert!((10..19_000).contains(&zeros), "{zeros}");
    }

    #[test]
    fn extreme_numbers_have_signs() {
        for scale in [1e-320, 1e-200, 1e-100, 1.0, 1e100, 1e200, 1e307] {
            let p = |x: f64, y: f64, z: f64| [x * scale, y * scale, z * scale];
            let (a, b, c, d) = (p(0., 0., 0.), p(1., 0., 0.), p(0., 1., 0.), p(0., 0., 1.));
            assert_eq!(orient_3d(&a, &b, &c, &d), 1, "{scale}");
            assert_eq!(orient_3d(&a, &c, &b, &d), -1, "{scale}");
            assert_eq!(orient_2d([0.0, 0.0], [scale, 0.0], [0.0, scale]), 1, "{scale}");
            assert_eq!(orient_2d([0.0, 0.0], [scale, scale], [3.0 * scale, 3.0 * scale]), 0, "{scale}");
        }
    }

    /// Clear cases need no integers, which are slow.
    #[test]
    fn the_filter_decides_clear_cases() {
        for (scale, shift) in [(1e-60, 0.0), (1e-3, 0.0), (1.0, 1e7), (1e60, 0.0)] {
            let p = |x: f64, y: f64, z: f64| [x, y, z].map(|x| x * scale + shift);
            let (a, b, c, d) = (p(-1., -2., -1.), p(3., 1., 2.), p(1., 2., 1.), p(0., 1., 4.));
            assert_eq!((filter(&a, &[[b, c, d]]), filter(&a, &[[c, b, d]])), (Some(1), Some(-1)), "{scale}");
            let [e, f, g] = [a, b, d].map(|p| [p[0], p[2], 0.0]);
            let up = [e[0], e[1], 1.0];
            assert_eq!((filter(&e, &[[f, g, up]]), filter(&e, &[[g, f, up]])), (Some(1), Some(-1)), "{scale}");
            assert_eq!(filter(&a, &sides(a, b, c, d)), Some(1), "{scale}");
            assert_eq!(filter(&a, &sides(a, c, b, d)), Some(-1), "{scale}");
        }
        assert_eq!((clear_sign(-2.0, 1.0, 2.0), clear_sign(1.0, 1.0, 2.0)), (Some(-1), None));
        assert_eq!((clear_sign(2.0, 1.0, f64::MAX), clear_sign(f64::NAN, 1.0, 2.0)), (None, None));
    }

    /// Products below the smallest number are rounded to multiples of it, here by 3 quarters at most.
    #[test]
    fn the_filter_knows_underflow() {
        let mut state = 11_u64;
        let mut small = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as i32 % 8 * 2 - 7
        };
        let power = |exponent: i32| f64::from_bits(((exponent + 1023) as u64) << 52);
        for (large, tiny) in [(900, -538), (0, -538), (-40, -518)] {
            for round in 0..2000 {
                let mut point = |exponent: i32| [0; 3].map(|_| f64::from(small()) * power(exponent));
                let (b, c, d) = (point(large), point(tiny), point(tiny));
                let expected = exact(&[0.0; 3], &[[b, c, d]]);
                assert_eq!(orient_3d(&[0.0; 3], &b, &c, &d), expected, "{round}: {b:?} {c:?} {d:?}");
            }
        }
    }

    #[test]
    fn volumes_have_signs_even_if_flat() {
        let thin = |h: f64| {
            let p = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.1, 0.1, h]];
            [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(|t: [usize; 3]| t.map(|i| p[i]))
        };
        for h in [1.0, 1e-12, 1e-300] {
            assert_eq!((volume_sign(&[0.0; 3], &thin(h)), volume_sign(&[0.0; 3], &thin(-h))), (1, -1), "{h}");
        }
        assert_eq!((volume_sign(&[0.0; 3], &thin(0.0)), volume_sign(&[0.0; 3], &[])), (0, 0));
    }
}

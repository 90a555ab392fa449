//! Exact signs of determinants: a floating-point filter, then integers of any size.

use num_bigint::{BigInt, Sign};

/// Relative error bound of a determinant of three differences: 7 roundings of 2⁻⁵³, rounded up.
const BOUND_3: f64 = 1e-15;
/// Relative error bound of a determinant of two differences.
const BOUND_2: f64 = 5e-16;
/// Bound on the absolute error of underflows, per unit of the largest factor.
const UNDERFLOW: f64 = 1e-315;

/// Returns the sign of the signed volume of a tetrahedron: positive if `a`, `b`, `c` are counterclockwise seen from `d`.
pub fn orient_3d(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3], d: &[f64; 3]) -> i32 {
    filter_3d(a, b, c, d).unwrap_or_else(|| exact_3d(a, b, c, d))
}

fn filter_3d(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3], d: &[f64; 3]) -> Option<i32> {
    let [u, v, w] = [b, c, d].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
    let (mut det, mut sum, mut largest) = (0.0, 0.0, 0.0_f64);
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let (plus, minus) = (v[j] * w[k], v[k] * w[j]);
        det += u[i] * (plus - minus);
        sum += u[i].abs() * (plus.abs() + minus.abs());
        largest = largest.max(u[i].abs()).max(v[i].abs()).max(w[i].abs());
    }
    clear_sign(det, BOUND_3 * sum + UNDERFLOW * (1.0 + largest), sum)
}

/// Sign of a sum that exceeds its error bound; `None` if it does not, or if the sum of the absolute terms overflows.
fn clear_sign(value: f64, bound: f64, sum: f64) -> Option<i32> {
    // A comparison with NaN or infinity is false.
    (value.abs() > bound && sum < f64::MAX).then(|| value.signum() as i32)
}

fn exact_3d(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3], d: &[f64; 3]) -> i32 {
    let numbers = Scaled::new(a.iter().chain(b).chain(c).chain(d).copied());
    let [p, q, r, s] = [a, b, c, d].map(|p| p.map(|x| numbers.integer(x)));
    sign(&determinant(&minus(&q, &p), &minus(&r, &p), &minus(&s, &p)))
}

/// Returns the sign of the signed area of a triangle in the plane: positive if it is counterclockwise.
pub fn orient_2d(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> i32 {
    filter_2d(a, b, c).unwrap_or_else(|| exact_2d(a, b, c))
}

fn filter_2d(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> Option<i32> {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
    let (plus, minus) = (u[0] * v[1], u[1] * v[0]);
    let sum = plus.abs() + minus.abs();
    clear_sign(plus - minus, BOUND_2 * sum + UNDERFLOW, sum)
}

fn exact_2d(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> i32 {
    let numbers = Scaled::new(a.into_iter().chain(b).chain(c));
    let [a, b, c] = [a, b, c].map(|p| p.map(|x| numbers.integer(x)));
    sign(&((&b[0] - &a[0]) * (&c[1] - &a[1]) - (&b[1] - &a[1]) * (&c[0] - &a[0])))
}

/// Returns the sign of the volume enclosed by triangles: positive if they face outwards.
pub fn volume_sign(triangles: &[[[f64; 3]; 3]]) -> i32 {
    filter_volume(triangles).unwrap_or_else(|| exact_volume(triangles))
}

fn filter_volume(triangles: &[[[f64; 3]; 3]]) -> Option<i32> {
    let origin = triangles.first()?[0];
    let (mut volume, mut sum) = (0.0, 0.0);
    for t in triangles {
        let [u, v, w] = t.map(|p| [p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]]);
        for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            volume += u[i] * (v[j] * w[k] - v[k] * w[j]);
            sum += u[i].abs() * (v[j] * w[k]).abs().max((v[k] * w[j]).abs());
        }
    }
    // Far above the error of any sum of fewer than 2³² products.
    clear_sign(volume, (1e-5 * sum).max(1e-200), sum)
}

fn exact_volume(triangles: &[[[f64; 3]; 3]]) -> i32 {
    let numbers = Scaled::new(triangles.iter().flatten().flatten().copied());
    let exact = triangles.iter().map(|t| t.map(|p| p.map(|x| numbers.integer(x))));
    sign(&exact.map(|[u, v, w]| determinant(&u, &v, &w)).sum())
}

/// Common power of two that makes integers of floating-point numbers.
struct Scaled {
    exponent: i32,
}

impl Scaled {
    fn new(numbers: impl Iterator<Item = f64>) -> Self {
        Self { exponent: numbers.filter(|&x| x != 0.0).map(|x| parts(x).1).min().unwrap_or(0) }
    }

    fn integer(&self, x: f64) -> BigInt {
        let (mantissa, exponent) = parts(x);
        if mantissa == 0 { BigInt::ZERO } else { BigInt::from(mantissa) << (exponent - self.exponent) as usize }
    }
}

/// Integer and power of two whose product is 2¹⁰⁷⁵ times a finite number.
fn parts(x: f64) -> (i64, i32) {
    let bits = x.to_bits();
    let (raw, fraction) = (((bits >> 52) & 0x7ff) as i32, (bits & ((1 << 52) - 1)) as i64);
    let mantissa = if raw == 0 { fraction } else { fraction + (1 << 52) };
    (if x.is_sign_negative() { -mantissa } else { mantissa }, raw.max(1))
}

fn minus(a: &[BigInt; 3], b: &[BigInt; 3]) -> [BigInt; 3] {
    [&a[0] - &b[0], &a[1] - &b[1], &a[2] - &b[2]]
}

fn determinant(u: &[BigInt; 3], v: &[BigInt; 3], w: &[BigInt; 3]) -> BigInt {
    &u[0] * (&v[1] * &w[2] - &v[2] * &w[1])
        + &u[1] * (&v[2] * &w[0] - &v[0] * &w[2])
        + &u[2] * (&v[0] * &w[1] - &v[1] * &w[0])
}

fn sign(x: &BigInt) -> i32 {
    match x.sign() {
        Sign::Plus => 1,
        Sign::Minus => -1,
        Sign::NoSign => 0,
    }
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
            assert_eq!(orient_3d(&a, &b, &c, &d), exact_3d(&a, &b, &c, &d), "{round}: {a:?} {b:?} {c:?} {d:?}");
            let sides = sides(a, b, c, d);
            assert_eq!(volume_sign(&sides), exact_volume(&sides), "{round}: {a:?} {b:?} {c:?} {d:?}");
            let e = [0, 1].map(|k| a[k] + u * (b[k] - a[k]));
            let (a, b) = ([a[0], a[1]], [b[0], b[1]]);
            assert_eq!(orient_2d(a, b, e), exact_2d(a, b, e), "{round}: {a:?} {b:?} {e:?}");
            zeros += usize::from(exact_2d(a, b, e) == 0);
            let beside = e.map(|x| x * (1.0 + 3.0 * f64::EPSILON));
            let thirds = [a, b, beside].map(|p| p.map(|x| x / 3.0));
            assert_eq!(
                orient_2d(thirds[0], thirds[1], thirds[2]),
                exact_2d(thirds[0], thirds[1], thirds[2]),
                "{round}: {thirds:?}"
            );
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
            assert_eq!((filter_3d(&a, &b, &c, &d), filter_3d(&a, &c, &b, &d)), (Some(1), Some(-1)), "{scale}");
            let flat = |p: [f64; 3]| [p[0], p[2]];
            assert_eq!(filter_2d(flat(a), flat(b), flat(d)), Some(1), "{scale}");
            assert_eq!(filter_2d(flat(a), flat(d), flat(b)), Some(-1), "{scale}");
            assert_eq!(filter_volume(&sides(a, b, c, d)), Some(1), "{scale}");
            assert_eq!(filter_volume(&sides(a, c, b, d)), Some(-1), "{scale}");
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
                let expected = exact_3d(&[0.0; 3], &b, &c, &d);
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
            assert_eq!((volume_sign(&thin(h)), volume_sign(&thin(-h))), (1, -1), "{h}");
        }
        assert_eq!((volume_sign(&thin(0.0)), volume_sign(&[])), (0, 0));
    }
}

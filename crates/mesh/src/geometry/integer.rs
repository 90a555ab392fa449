//! Exact determinants in integers. The coordinates are multiples of one power of two. If their differences in that unit
//! are below 2⁶¹, orientation fits into 192 bits and the in-sphere determinant into 320. That holds for nearly all
//! points close to each other, and costs about 10 ns, compared to microseconds for expansions.

use super::Point3;

/// Maximum bits of a difference.
const BITS: u32 = 61;

/// Integer coordinates of points relative to the last one, and their unit.
struct Differences<const K: usize> {
    rows: [[i64; 3]; K],
    unit: f64,
}

/// Exponent of the lowest set bit of `x`; `i32::MAX` for zero.
#[inline]
fn lowest_bit(x: f64) -> i32 {
    let bits = x.to_bits();
    let exponent = ((bits >> 52) & 0x7ff) as i32;
    let mantissa = (bits & ((1 << 52) - 1)) | 1 << 52;
    if exponent == 0 { i32::MAX } else { exponent - 1075 + mantissa.trailing_zeros() as i32 }
}

/// Power of two; `None` outside the normal numbers.
fn power(exponent: i32) -> Option<f64> {
    (-1022..1024).contains(&exponent).then(|| f64::from_bits(((exponent + 1023) as u64) << 52))
}

impl<const K: usize> Differences<K> {
    /// Returns `None` if differences exceed the common unit of all coordinates too far. No coordinate is subnormal.
    fn new(p: [&Point3; K], origin: &Point3) -> Option<Self> {
        let coordinates = || p.iter().copied().chain([origin]).flat_map(|p| [p.x, p.y, p.z]);
        let exponent = coordinates().map(lowest_bit).min()?;
        if exponent == i32::MAX {
            return Some(Self { rows: [[0; 3]; K], unit: 1.0 });
        }
        let (unit, per_unit) = (power(exponent)?, power(-exponent)?);
        let largest = coordinates().fold(0.0, |m: f64, x| m.max(x.abs())) * per_unit;
        let rows = if largest < 4.6e18 {
            // Multiples of the unit below 2⁶²: both the product and the conversion are exact.
            let integer = |x: f64| (x * per_unit) as i64;
            let o = [integer(origin.x), integer(origin.y), integer(origin.z)];
            p.map(|p| [integer(p.x) - o[0], integer(p.y) - o[1], integer(p.z) - o[2]])
        } else if largest < 4e37 {
            let integer = |x: f64| (x * per_unit) as i128;
            let o = [integer(origin.x), integer(origin.y), integer(origin.z)];
            let wide = p.map(|p| [integer(p.x) - o[0], integer(p.y) - o[1], integer(p.z) - o[2]]);
            if wide.iter().flatten().any(|d| d.unsigned_abs() >> BITS != 0) {
                return None;
            }
            wide.map(|row| row.map(|d| d as i64))
        } else {
            return None;
        };
        let bits = rows.iter().flatten().fold(0, |bits, d| bits | d.unsigned_abs());
        (bits >> BITS == 0).then_some(Self { rows, unit })
    }
}

/// Integer of 192 bits.
#[derive(Clone, Copy)]
struct Triple {
    high: i128,
    low: u64,
}

impl Triple {
    #[inline]
    fn product(a: i64, b: i128) -> Self {
        // The lower half of `b` is unsigned.
        let low = i128::from(a) * i128::from(b as u64);
        let high = i128::from(a) * (b >> 64);
        Self { high: high + (low >> 64), low: low as u64 }
    }

    #[inline]
    fn plus(self, other: Self) -> Self {
        let (low, carry) = self.low.overflowing_add(other.low);
        Self { high: self.high + other.high + i128::from(carry), low }
    }

    /// Magnitude in limbs, least significant first, and true for a negative number.
    #[inline]
    fn magnitude(self) -> ([u64; 3], bool) {
        let (mut low, mut high) = (self.low, self.high.cast_unsigned());
        if self.high < 0 {
            low = low.wrapping_neg();
            high = (!high).wrapping_add(u128::from(low == 0));
        }
        ([low, high as u64, (high >> 64) as u64], self.high < 0)
    }

    /// Rounds limb by limb of the magnitude, so that the sign is exact.
    fn to_f64(self) -> f64 {
        let (limbs, negative) = self.magnitude();
        let value = limbs.iter().rev().fold(0.0, |sum, &limb| sum * 18_446_744_073_709_551_616.0 + limb as f64);
        if negative { -value } else { value }
    }
}

#[inline]
fn minor(p: [i64; 3], q: [i64; 3], i: usize, j: usize) -> i128 {
    i128::from(p[i]) * i128::from(q[j]) - i128::from(p[j]) * i128::from(q[i])
}

/// Minors of two rows, without the first, second and third column.
#[inline]
fn minors(p: [i64; 3], q: [i64; 3]) -> [i128; 3] {
    [minor(p, q, 1, 2), minor(p, q, 2, 0), minor(p, q, 0, 1)]
}

/// Determinant of a row and the minors of two others.
#[inline]
fn det(p: [i64; 3], m: [i128; 3]) -> Triple {
    Triple::product(p[0], m[0]).plus(Triple::product(p[1], m[1])).plus(Triple::product(p[2], m[2]))
}

/// Rounded determinant of `a − d, b − d, c − d` with exact sign; `None` if the numbers are too large.
pub(super) fn orient3d([a, b, c]: [&Point3; 3], d: &Point3) -> Option<f64> {
    let Differences { rows: [p, q, r], unit } = Differences::new([a, b, c], d)?;
    Some(det(p, minors(q, r)).to_f64() * unit * unit * unit)
}

/// Sign of the in-sphere determinant: 1 if `e` lies inside the circumsphere of the positive tetrahedron `a, b, c, d`.
/// `None` if the numbers are too large.
pub(super) fn insphere(p: [&Point3; 4], e: &Point3) -> Option<f64> {
    let [a, b, c, d] = Differences::new(p, e)?.rows;
    let (ab, cd) = (minors(a, b), minors(c, d));
    let weights = [det(b, cd), det(a, cd), det(d, ab), det(c, ab)];
    let lift = |p: [i64; 3]| p.iter().map(|&x| i128::from(x) * i128::from(x)).sum::<i128>();
    let mut sum = [0; 5];
    for (k, (w, row)) in weights.into_iter().zip([a, b, c, d]).enumerate() {
        accumulate(&mut sum, w, lift(row), k % 2 == 1);
    }
    let negative = sum[4] >> 63 == 1;
    let zero = sum == [0; 5];
    Some(if zero {
        0.0
    } else if negative {
        -1.0
    } else {
        1.0
    })
}

/// Adds `± w · lift`, modulo 2³²⁰.
#[inline]
fn accumulate(sum: &mut [u64; 5], w: Triple, lift: i128, negate: bool) {
    let (limbs, negative) = w.magnitude();
    let negative = negative != negate;
    let lift = [lift as u64, (lift >> 64) as u64];
    let mut product = [0u64; 5];
    for (i, &x) in lift.iter().enumerate() {
        let mut carry = 0u128;
        for (j, &y) in limbs.iter().enumerate() {
            let term = u128::from(x) * u128::from(y) + u128::from(product[i + j]) + carry;
            product[i + j] = term as u64;
            carry = term >> 64;
        }
        product[i + 3] = carry as u64;
    }
    // Subtraction adds the complement and one.
    let mut carry = u128::from(negative);
    for (limb, x) in sum.iter_mut().zip(product) {
        let term = u128::from(*limb) + u128::from(if negative { !x } else { x }) + carry;
        *limb = term as u64;
        carry = term >> 64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cospherical_points_at_any_place_and_scale() {
        let corner = |i: u32, o: f64, h: f64| {
            let bit = |k: u32| o + if i >> k & 1 == 1 { h } else { 0.0 };
            Point3::new(bit(0), bit(1), bit(2))
        };
        for (o, h) in [(0.0, 1.0), (1e6, 0.25), (-3.0, 1e-9), (0.1, 0.1), (0.0, 1e30), (0.0, 1e-40)] {
            let at = |i: u32| corner(i, o, h);
            let (a, b, c, d, e) = (at(0), at(1), at(2), at(4), at(7));
            assert!(orient3d([&b, &c, &d], &a).unwrap() > 0.0);
            let sphere = insphere([&a, &b, &c, &d], &e).unwrap();
            if o.fract() == 0.0 && h != 1e-9 {
                assert_eq!(sphere, 0.0);
            }
            let near = Point3::new(e.x, e.y, e.z.next_down());
            assert_eq!(insphere([&a, &b, &c, &d], &near), Some(1.0), "{o} {h}");
        }
    }

    #[test]
    fn a_small_negative_number_keeps_its_sign() {
        let p = |x: f64, y: f64, z: f64| Point3::new(x, y, z);
        let h = f64::EPSILON;
        let (a, b) = (p(1.0, 1.0, 1.0), p(1.0 - h, 1.0, 1.0));
        let (c, d) = (p(-2.0, 1.0 + h, -2.0), p(-2.0, 1.0, 1.0 + 2.0 * h));
        assert_eq!(orient3d([&b, &c, &d], &a), Some(-2.0 * h * h * h));
        assert_eq!(orient3d([&c, &b, &d], &a), Some(2.0 * h * h * h));
    }

    #[test]
    fn numbers_too_far_apart_are_left_to_others() {
        let p = |x: f64, y: f64, z: f64| Point3::new(x, y, z);
        let (a, b, c, d) = (p(0., 0., 0.), p(1e20, 0., 0.), p(0., 1., 1e-20), p(0., 0., 1.));
        assert_eq!(orient3d([&b, &c, &d], &a), None);
        assert_eq!(insphere([&a, &b, &c, &d], &p(1.0, 1.0, 1.0)), None);
    }
}

//! Implicit points on segments and triangles, and exact predicates on them.
//!
//! For floating-point `a`, `b`, `c` and dyadic `s`, `t`, the point `a + s · (b − a) + t · (c − a)` is dyadic. Among the
//! implicit points of Attene, 'Indirect predicates for geometric constructions', 2020, this is the kind without a
//! denominator. Predicates first use the rounded points, with an error bound that includes the rounding, and otherwise
//! evaluate integers.

use super::Point3;
use super::dyadic::{Int, decompose};
use super::predicates;
use std::cmp::Ordering;

/// The exact point `a + s · (b − a) + t · (c − a)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnTriangle {
    /// Corners `a, b, c`.
    pub corners: [Point3; 3],
    /// `s` and `t`, with sum at most 1, in units of 2⁻¹²⁰.
    pub weights: [u128; 2],
}

impl OnTriangle {
    /// Fractional bits of a weight.
    const BITS: u32 = 120;

    /// The weight 1.
    pub const ONE: u128 = 1 << Self::BITS;

    /// The point `a + t · (b − a)`.
    pub fn on_segment([a, b]: [Point3; 2], t: u128) -> Self {
        Self { corners: [a, b, a], weights: [t, 0] }
    }

    /// Rounded point, each coordinate to within `10 ε` times the largest of those of the corners.
    pub fn rounded(&self) -> Point3 {
        let ([a, b, c], [s, t]) = (&self.corners, self.weights.map(|w| w as f64 / Self::ONE as f64));
        let at = |i: usize| a[i] + s * (b[i] - a[i]) + t * (c[i] - a[i]);
        Point3::new(at(0), at(1), at(2))
    }

    /// Error bound of [`OnTriangle::rounded`] along one axis.
    #[inline]
    fn slack(&self, axis: usize) -> f64 {
        let [a, b, c] = &self.corners;
        10.0 * f64::EPSILON * a[axis].abs().max(b[axis].abs()).max(c[axis].abs())
    }
}

/// An explicit or implicit point.
#[derive(Clone, Copy, Debug)]
pub struct Site<'a> {
    /// Coordinates, rounded for an implicit point.
    pub at: &'a Point3,
    /// Definition of an implicit point.
    pub on: Option<&'a OnTriangle>,
}

/// Maximum error of coordinate differences along each axis.
#[inline]
fn slack(sites: &[Site]) -> [f64; 3] {
    let mut s = [0.0; 3];
    for on in sites.iter().filter_map(|p| p.on) {
        for (axis, x) in s.iter_mut().enumerate() {
            *x = on.slack(axis).max(*x);
        }
    }
    // A difference has twice the error.
    s.map(|x| 2.0 * x)
}

fn sign(x: f64) -> i32 {
    i32::from(x > 0.0) - i32::from(x < 0.0)
}

/// Exact sign of `det(p1 − p0, p2 − p0, p3 − p0)`, as [`predicates::orient3d`].
#[inline]
pub fn orient3d(p: [Site; 4]) -> i32 {
    if p.iter().all(|s| s.on.is_none()) {
        return sign(predicates::orient3d(p[0].at, p[1].at, p[2].at, p[3].at));
    }
    let [b, c, d] = [1, 2, 3].map(|i| p[i].at - p[0].at);
    let det = b.x * (c.y * d.z - c.z * d.y) + b.y * (c.z * d.x - c.x * d.z) + b.z * (c.x * d.y - c.y * d.x);
    let m = b.abs().sup(&c.abs()).sup(&d.abs());
    let e = slack(&p);
    let bound = 1e-14 * m.x * m.y * m.z
        + 7.0 * (e[0] * m.y * m.z + m.x * e[1] * m.z + m.x * m.y * e[2])
        + 14.0 * (e[0] * e[1] * m.z + e[0] * m.y * e[2] + m.x * e[1] * e[2] + e[0] * e[1] * e[2]);
    if det.abs() > bound {
        sign(det)
    } else if in_one_plane(&p) {
        0
    } else {
        orient3d_exact(&p)
    }
}

/// True if all points lie in the plane of three corners by definition.
fn in_one_plane(sites: &[Site; 4]) -> bool {
    let mut corners = [Point3::origin(); 3];
    let mut count = 0;
    for site in sites {
        let of_site = site.on.map_or(std::slice::from_ref(site.at), |on| &on.corners);
        for p in of_site {
            if !corners[..count].contains(p) {
                if count == 3 {
                    return false;
                }
                corners[count] = *p;
                count += 1;
            }
        }
    }
    true
}

/// Exact lexicographic comparison of the coordinates.
pub fn compare(p: Site, q: Site) -> Ordering {
    for axis in 0..3 {
        let (x, y) = (p.at[axis], q.at[axis]);
        let order = if p.on.is_none() && q.on.is_none() {
            x.total_cmp(&y)
        } else {
            let slack = slack(&[p, q])[axis];
            if (x - y).abs() > slack { x.total_cmp(&y) } else { compare_exact(&[p, q], axis) }
        };
        if order != Ordering::Equal {
            return order;
        }
    }
    Ordering::Equal
}

/// Limbs of a coordinate: `predicates::in_exact_range` allows 386 bits, weights add 122.
const WIDE: usize = 8;

/// Scale of a set of points. `2^exponent` divides the coordinates of their ends, which are less than `2^top`;
/// `2^-fraction` divides their weights.
struct Scale {
    exponent: i32,
    top: i32,
    fraction: u32,
}

impl Scale {
    fn of(sites: &[Site]) -> Self {
        let mut s = Self { exponent: i32::MAX, top: i32::MIN, fraction: 0 };
        let mut lower = |p: &Point3| {
            for x in p.iter() {
                let (m, e) = decompose(*x);
                s.exponent = s.exponent.min(e);
                if m != 0 {
                    s.top = s.top.max(e + (64 - m.unsigned_abs().leading_zeros()).cast_signed());
                }
            }
        };
        for site in sites {
            match site.on {
                None => lower(site.at),
                Some(on) => on.corners.iter().for_each(&mut lower),
            }
        }
        for weight in sites.iter().filter_map(|p| p.on).flat_map(|on| on.weights) {
            if weight != 0 {
                s.fraction = s.fraction.max(OnTriangle::BITS - weight.trailing_zeros());
            }
        }
        s
    }

    /// True if coordinates and their differences fit in two limbs.
    fn is_small(&self) -> bool {
        i64::from(self.top) - i64::from(self.exponent) + i64::from(self.fraction) < 124
    }

    fn integer<const N: usize>(&self, x: f64) -> Int<N> {
        let (m, e) = decompose(x);
        if m == 0 { Int::ZERO } else { Int::new(m).shl((e - self.exponent).unsigned_abs()) }
    }

    fn coordinate<const N: usize>(&self, site: &Site, axis: usize) -> Int<N> {
        let up = self.fraction;
        let Some(on) = site.on else { return self.integer(site.at[axis]).shl(up) };
        let [a, b, c] = on.corners.map(|p| self.integer(p[axis]));
        let mut x = a.shl(up);
        for (end, weight) in [b, c].iter().zip(on.weights) {
            // Multiple of the largest common unit of all weights.
            let multiple = weight >> (OnTriangle::BITS - up);
            if multiple != 0 {
                x = x.add(&end.sub(&a).mul(&Int::unsigned(multiple)));
            }
        }
        x
    }
}

#[cold]
fn compare_exact(sites: &[Site; 2], axis: usize) -> Ordering {
    let scale = Scale::of(sites);
    scale.coordinate::<WIDE>(&sites[0], axis).sub(&scale.coordinate(&sites[1], axis)).sign().cmp(&0)
}

type Row = [Int<WIDE>; 3];

#[cold]
fn orient3d_exact(p: &[Site; 4]) -> i32 {
    let ([_, b, c, d], bits) = rows(p);
    let rows = [b, c, d];
    // Six products of three factors.
    match 3 * bits + 4 {
        0..192 => det3::<3>(&rows).sign(),
        192..256 => det3::<4>(&rows).sign(),
        256..384 => det3::<6>(&rows).sign(),
        384..640 => det3::<10>(&rows).sign(),
        _ => det3::<28>(&rows).sign(),
    }
}

fn minor<const N: usize>(p: &[Int<N>; 3], q: &[Int<N>; 3]) -> Int<N> {
    p[0].mul(&q[1]).sub(&q[0].mul(&p[1]))
}

fn det3<const N: usize>(rows: &[Row; 3]) -> Int<N> {
    let [b, c, d] = rows.map(|r| r.map(|x| x.resize::<N>()));
    b[2].mul(&minor(&c, &d)).sub(&c[2].mul(&minor(&b, &d))).add(&d[2].mul(&minor(&b, &c)))
}

/// Rows of all sites relative to the first one, and the bits of the largest entry.
fn rows<const K: usize>(sites: &[Site; K]) -> ([Row; K], u32) {
    let scale = Scale::of(sites);
    if scale.is_small() { rows_in::<K, 2>(&scale, sites) } else { rows_in::<K, WIDE>(&scale, sites) }
}

/// Rows as in [`rows`], from coordinates with `N` limbs.
fn rows_in<const K: usize, const N: usize>(scale: &Scale, sites: &[Site; K]) -> ([Row; K], u32) {
    let at = sites.map(|s| -> [Int<N>; 3] { std::array::from_fn(|k| scale.coordinate(&s, k)) });
    let rows = at.map(|p| -> [Int<N>; 3] { std::array::from_fn(|k| p[k].sub(&at[0][k])) });
    let bits = rows.iter().flatten().map(Int::bits).max().unwrap_or(0);
    (rows.map(|row| row.map(|x| x.resize())), bits)
}

/// Determinant of [`orient3d`] for four rows.
fn volume<const N: usize>(rows: &[Row], [a, b, c, d]: [usize; 4]) -> Int<N> {
    let from = |i: usize| -> Row { std::array::from_fn(|k| rows[i][k].sub(&rows[a][k])) };
    det3(&[from(b), from(c), from(d)])
}

/// Weights, rounded down, of the point where the line through `p` and `q` crosses a triangle, if it does.
pub fn crossing([a, b, c]: [Site; 3], [p, q]: [Site; 2]) -> Option<[u128; 2]> {
    let (rows, bits) = rows(&[a, b, c, p, q]);
    // Three sums of six products of three differences.
    match 3 * bits + 9 {
        0..384 => weights::<6>(&rows),
        384..640 => weights::<10>(&rows),
        _ => weights::<28>(&rows),
    }
}

fn weights<const N: usize>(rows: &[Row; 5]) -> Option<[u128; 2]> {
    let [x, y, z] = [[3, 4, 1, 2], [3, 4, 2, 0], [3, 4, 0, 1]].map(|v| volume::<N>(rows, v));
    let sum = x.add(&y).add(&z);
    let inside = sum.sign() != 0 && [x, y, z].iter().all(|w| w.sign() == sum.sign());
    inside.then(|| [y, z].map(|w| w.abs().fraction(&sum.abs(), OnTriangle::BITS)))
}

/// Weight `t`, rounded down, for which `p + t · (q − p)` lies in the plane of a triangle. `p` and `q` must lie on
/// opposite sides, or one of them in the plane.
pub fn parameter([a, b, c]: [Site; 3], [p, q]: [Site; 2]) -> Option<u128> {
    let (rows, bits) = rows(&[a, b, c, p, q]);
    match 3 * bits + 9 {
        0..384 => part::<6>(&rows),
        384..640 => part::<10>(&rows),
        _ => part::<28>(&rows),
    }
}

fn part<const N: usize>(rows: &[Row; 5]) -> Option<u128> {
    let [x, y] = [[0, 1, 2, 3], [0, 1, 2, 4]].map(|v| volume::<N>(rows, v));
    let across = x.sign() * y.sign() <= 0 && x != y;
    across.then(|| x.abs().fraction(&x.sub(&y).abs(), OnTriangle::BITS))
}

#[cfg(test)]
#[path = "implicit_tests.rs"]
mod tests;

//! Points on segments that need not be representable, and exact predicates on them.
//!
//! The point `a + t · (b − a)` with floating-point `a`, `b` and `t` is a dyadic number in each coordinate: no division
//! is needed (of the implicit points of Attene, 'Indirect predicates for geometric constructions', 2020, this is the
//! kind without a denominator). Predicates try the rounded points first, with a bound of the error that counts the
//! rounding, and evaluate integers otherwise.

use super::Point3;
use super::dyadic::{Int, decompose};
use super::predicates;
use std::cmp::Ordering;

/// The point `a + t · (b − a)`, exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnSegment {
    /// Where `t` is zero.
    pub a: Point3,
    /// Where `t` is one.
    pub b: Point3,
    /// Between zero and one, a multiple of [`OnSegment::UNIT`].
    pub t: f64,
}

impl OnSegment {
    /// Parameters are multiples of 2⁻⁶².
    pub const UNIT: f64 = 1.0 / (1u64 << 62) as f64;

    /// The point rounded, each coordinate to within `4 ε` times the larger of those of the ends.
    pub fn rounded(&self) -> Point3 {
        let at = |i: usize| self.a[i] + self.t * (self.b[i] - self.a[i]);
        Point3::new(at(0), at(1), at(2))
    }

    /// Bound of the error of [`OnSegment::rounded`] along one axis.
    #[inline]
    fn slack(&self, axis: usize) -> f64 {
        4.0 * f64::EPSILON * self.a[axis].abs().max(self.b[axis].abs())
    }
}

/// A point of either kind.
#[derive(Clone, Copy, Debug)]
pub struct Site<'a> {
    /// The point, rounded if it is implicit.
    pub at: &'a Point3,
    /// What an implicit point is.
    pub on: Option<&'a OnSegment>,
}

/// The widest of the errors along each axis.
#[inline]
fn slack(sites: &[Site]) -> [f64; 3] {
    let mut s = [0.0; 3];
    for on in sites.iter().filter_map(|p| p.on) {
        for (axis, x) in s.iter_mut().enumerate() {
            *x = on.slack(axis).max(*x);
        }
    }
    // Differences of two.
    s.map(|x| 2.0 * x)
}

fn sign(x: f64) -> i32 {
    i32::from(x > 0.0) - i32::from(x < 0.0)
}

/// The sign of `det(p1 − p0, p2 − p0, p3 − p0)`, as [`predicates::orient3d`]. Exact.
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
    if det.abs() > bound { sign(det) } else { orient3d_exact(&p) }
}

/// Positive when `p4` lies inside the sphere through the positive tetrahedron of the others, as
/// [`predicates::insphere`]. Exact.
#[inline]
pub fn insphere(p: [Site; 5]) -> i32 {
    if p.iter().all(|s| s.on.is_none()) {
        return sign(predicates::insphere(p[0].at, p[1].at, p[2].at, p[3].at, p[4].at));
    }
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| p[i].at - p[4].at);
    let (ab, bc, cd) = (a.x * b.y - b.x * a.y, b.x * c.y - c.x * b.y, c.x * d.y - d.x * c.y);
    let (da, ac, bd) = (d.x * a.y - a.x * d.y, a.x * c.y - c.x * a.y, b.x * d.y - d.x * b.y);
    let abc = a.z * bc - b.z * ac + c.z * ab;
    let bcd = b.z * cd - c.z * bd + d.z * bc;
    let cda = c.z * da + d.z * ac + a.z * cd;
    let dab = d.z * ab + a.z * bd + b.z * da;
    let [al, bl, cl, dl] = [a, b, c, d].map(|v| v.norm_squared());
    let det = (cl * dab - dl * abc) + (al * bcd - bl * cda);
    let m = a.abs().sup(&b.abs()).sup(&c.abs().sup(&d.abs()));
    let ml = al.max(bl).max(cl.max(dl));
    let e = slack(&p);
    // Of the lift, and of the product of three differences, to first order; the factors leave room for the rest.
    let el = 2.5 * (m.x * e[0] + m.y * e[1] + m.z * e[2]);
    let em = e[0] * m.y * m.z + m.x * e[1] * m.z + m.x * m.y * e[2];
    let first_order = e[0] <= 1e-3 * m.x && e[1] <= 1e-3 * m.y && e[2] <= 1e-3 * m.z;
    let bound = 6e-14 * m.x * m.y * m.z * ml + 28.0 * (em * ml + m.x * m.y * m.z * el);
    if first_order && det.abs() > bound { sign(det) } else { insphere_exact(&p) }
}

/// Lexicographic order of the coordinates. Exact.
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

/// Whether `e` lies inside the sphere of the positive tetrahedron `p`, with the ties of cospherical points broken as
/// in the Delaunay kernel: the lift of each point is raised by an infinitesimal, larger by orders of magnitude the
/// later it comes in lexicographic order.
#[inline]
pub fn in_sphere_perturbed(p: [Site; 4], e: Site) -> bool {
    let s = insphere([p[0], p[1], p[2], p[3], e]);
    if s == 0 { tie(p, e) } else { s > 0 }
}

#[cold]
fn tie(p: [Site; 4], e: Site) -> bool {
    let mut all = [(p[0], 0), (p[1], 1), (p[2], 2), (p[3], 3), (e, 4)];
    all.sort_by(|a, b| compare(b.0, a.0));
    for (_, i) in all {
        if i == 4 {
            return false;
        }
        let mut q = p;
        q[i] = e;
        let o = orient3d(q);
        if o != 0 {
            return o > 0;
        }
    }
    false
}

/// Coordinates fit in this many limbs: `predicates::in_exact_range` allows 386 bits, a parameter adds 62.
const WIDE: usize = 8;

/// Scale of a set of points: `2^exponent` divides their ends' coordinates, `2^-fraction` their parameters.
struct Scale {
    exponent: i32,
    fraction: i32,
}

impl Scale {
    fn of(sites: &[Site]) -> Self {
        let mut s = Self { exponent: i32::MAX, fraction: 0 };
        let mut lower = |p: &Point3| {
            for x in p.iter() {
                s.exponent = s.exponent.min(decompose(*x).1);
            }
        };
        for site in sites {
            match site.on {
                None => lower(site.at),
                Some(on) => {
                    lower(&on.a);
                    lower(&on.b);
                }
            }
        }
        for on in sites.iter().filter_map(|p| p.on) {
            let (m, e) = decompose(on.t);
            if m != 0 {
                s.fraction = s.fraction.max(-e);
            }
        }
        s
    }

    fn integer(&self, x: f64) -> Int<WIDE> {
        let (m, e) = decompose(x);
        if m == 0 { Int::ZERO } else { Int::new(m).shl((e - self.exponent).unsigned_abs()) }
    }

    fn coordinate(&self, site: &Site, axis: usize) -> Int<WIDE> {
        let up = self.fraction.unsigned_abs();
        let Some(on) = site.on else { return self.integer(site.at[axis]).shl(up) };
        let (a, b) = (self.integer(on.a[axis]), self.integer(on.b[axis]));
        let (m, e) = decompose(on.t);
        if m == 0 {
            return a.shl(up);
        }
        a.shl(up).add(&b.sub(&a).mul(&Int::new(m)).shl((self.fraction + e).unsigned_abs()))
    }
}

#[cold]
fn compare_exact(sites: &[Site; 2], axis: usize) -> Ordering {
    let scale = Scale::of(sites);
    scale.coordinate(&sites[0], axis).sub(&scale.coordinate(&sites[1], axis)).sign().cmp(&0)
}

type Row = [Int<WIDE>; 3];

/// The differences of all points from the last, and the bits of the largest.
fn differences<const K: usize>(sites: &[Site], from: usize) -> ([Row; K], u32) {
    let scale = Scale::of(sites);
    let origin: Row = std::array::from_fn(|k| scale.coordinate(&sites[from], k));
    let mut rows = [[Int::ZERO; 3]; K];
    let others = sites.iter().enumerate().filter(|&(i, _)| i != from);
    let mut bits = 0;
    for (row, (_, site)) in rows.iter_mut().zip(others) {
        for k in 0..3 {
            row[k] = scale.coordinate(site, k).sub(&origin[k]);
            bits = bits.max(row[k].bits());
        }
    }
    (rows, bits)
}

#[cold]
fn orient3d_exact(p: &[Site; 4]) -> i32 {
    let (rows, bits) = differences::<3>(p, 0);
    // Six products of three.
    match 3 * bits + 4 {
        0..256 => det3::<4>(&rows),
        256..384 => det3::<6>(&rows),
        384..640 => det3::<10>(&rows),
        _ => det3::<28>(&rows),
    }
}

#[cold]
fn insphere_exact(p: &[Site; 5]) -> i32 {
    let (rows, bits) = differences::<4>(p, 4);
    // 24 products of three, times a sum of three squares.
    match 5 * bits + 8 {
        0..384 => lifted::<6>(&rows),
        384..576 => lifted::<9>(&rows),
        576..832 => lifted::<13>(&rows),
        832..1280 => lifted::<20>(&rows),
        _ => lifted::<42>(&rows),
    }
}

fn minor<const N: usize>(p: &[Int<N>; 3], q: &[Int<N>; 3]) -> Int<N> {
    p[0].mul(&q[1]).sub(&q[0].mul(&p[1]))
}

fn det3<const N: usize>(rows: &[Row; 3]) -> i32 {
    let [b, c, d] = rows.map(|r| r.map(|x| x.resize::<N>()));
    let sum = b[2].mul(&minor(&c, &d)).sub(&c[2].mul(&minor(&b, &d))).add(&d[2].mul(&minor(&b, &c)));
    sum.sign()
}

fn lifted<const N: usize>(rows: &[Row; 4]) -> i32 {
    let [a, b, c, d] = rows.map(|r| r.map(|x| x.resize::<N>()));
    let (ab, bc, cd) = (minor(&a, &b), minor(&b, &c), minor(&c, &d));
    let (da, ac, bd) = (minor(&d, &a), minor(&a, &c), minor(&b, &d));
    let lift = |v: &[Int<N>; 3]| v[0].mul(&v[0]).add(&v[1].mul(&v[1])).add(&v[2].mul(&v[2]));
    let abc = a[2].mul(&bc).sub(&b[2].mul(&ac)).add(&c[2].mul(&ab));
    let bcd = b[2].mul(&cd).sub(&c[2].mul(&bd)).add(&d[2].mul(&bc));
    let cda = c[2].mul(&da).add(&d[2].mul(&ac)).add(&a[2].mul(&cd));
    let dab = d[2].mul(&ab).add(&a[2].mul(&bd)).add(&b[2].mul(&da));
    let upper = lift(&c).mul(&dab).sub(&lift(&d).mul(&abc));
    let lower = lift(&a).mul(&bcd).sub(&lift(&b).mul(&cda));
    upper.add(&lower).sign()
}

#[cfg(test)]
#[path = "implicit_tests.rs"]
mod tests;

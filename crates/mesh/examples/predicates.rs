//! Comparison of the predicates with exact integer arithmetic:
//!
//! ```sh
//! cargo run --release -p anastomesh-mesh --example predicates -- 1000000 2
//! ```
//!
//! The arguments are the number of cases of each predicate and the number of threads (1 by default). The cases depend
//! only on their number. The exit code is 1 if a sign differs.
//!
//! Coordinates are integers times a power of two. Most points lie on a line, a plane or a sphere, or next to it. In a
//! lattice whose basis has determinant 1, large coordinates have determinants of a few units. Some cases mix small
//! integers with multiples of a large power of two, so that differences of coordinates are rounded.

use anastomesh_mesh::Point3;
use anastomesh_mesh::geometry::predicates::{MAX_MAGNITUDE, MIN_MAGNITUDE, collinear, insphere, orient2d, orient3d};
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};

/// Bits of the coordinates of `orient2d` and `collinear`. Differences are at most 2⁵³, minors at most 2¹⁰⁷.
const BITS_2D: u32 = 52;

/// Bits of the coordinates of `orient3d`. Differences are at most 2⁴¹, minors at most 2⁸³, and the three products of the
/// determinant at most 6 · 2¹²³ < 2¹²⁷ together.
const BITS_3D: u32 = 40;

/// Bits of the coordinates of `insphere`. Differences are at most 2²⁴, minors at most 2⁴⁹ (in `i64`), determinants of three
/// rows at most 6 · 2⁷², and lifts at most 3 · 2⁴⁸. The four products are at most 72 · 2¹²⁰ < 2¹²⁷ together.
const BITS_SPHERE: u32 = 23;

/// Bits of the two integers of a coordinate with two scales. See [`sign_at`].
const BITS_MIXED: u32 = 9;

/// Exponents of the smallest and the largest number in the range of the predicates.
const EXPONENTS: (i32, i32) = (-139, 192);

/// Cases of one seed.
const CHUNK: u64 = 1 << 16;

/// Integer coordinates of points.
type Lattice<const N: usize, const D: usize> = [[i64; D]; N];

/// Makes a case, and evaluates its predicate.
type MakeCase = fn(&mut Random) -> Case;

/// Signs of one case and its points, without the unused ones.
struct Case {
    exact: i64,
    found: i64,
    points: [Point3; 5],
    used: usize,
}

impl Case {
    fn new<const N: usize>(exact: i64, found: f64, p: [Point3; N]) -> Self {
        let points = std::array::from_fn(|i| p.get(i).copied().unwrap_or_default());
        Self { exact, found: i64::from(found > 0.0) - i64::from(found < 0.0), points, used: N }
    }
}

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1).map(|a| a.parse::<u64>());
    let (Some(Ok(count)), Ok(threads), None) = (arguments.next(), arguments.next().unwrap_or(Ok(1)), arguments.next())
    else {
        eprintln!("usage: predicates COUNT [THREADS]");
        return ExitCode::from(2);
    };
    let predicates: [(&str, MakeCase); 4] = [
        ("orient2d", orient2d_case),
        ("orient3d", orient3d_case),
        ("insphere", insphere_case),
        ("collinear", collinear_case),
    ];
    let mut differ = false;
    for (index, (name, case)) in predicates.into_iter().enumerate() {
        let total = compare(case, index as u64, count, threads.max(1));
        println!("{name}: {count} compared with exact integers, {} differ, {} zero", total.differ, total.zero);
        if let Some((_, text)) = total.first {
            println!("{text}");
            differ = true;
        }
    }
    ExitCode::from(u8::from(differ))
}

/// Numbers of cases, and the first one that differs.
#[derive(Default)]
struct Total {
    differ: u64,
    zero: u64,
    first: Option<(u64, String)>,
}

impl Total {
    fn add(&mut self, number: u64, case: &Case) {
        self.zero += u64::from(case.exact == 0);
        if case.exact != case.found {
            self.differ += 1;
            if self.first.as_ref().is_none_or(|(first, _)| number < *first) {
                let points: Vec<[f64; 3]> = case.points[..case.used].iter().map(|p| [p.x, p.y, p.z]).collect();
                let text = format!("case {number}: exact {}, found {}: {points:?}", case.exact, case.found);
                self.first = Some((number, text));
            }
        }
    }

    fn merge(&mut self, other: Self) {
        self.differ += other.differ;
        self.zero += other.zero;
        self.first = [self.first.take(), other.first].into_iter().flatten().min();
    }
}

/// Compares cases in chunks. Each chunk has a seed of its own, so the result does not depend on the number of threads.
fn compare(case: MakeCase, predicate: u64, count: u64, threads: u64) -> Total {
    let next = AtomicU64::new(0);
    let work = || {
        let mut total = Total::default();
        loop {
            let start = next.fetch_add(CHUNK, Ordering::Relaxed);
            if start >= count {
                return total;
            }
            let mut random = Random::new(predicate << 56 ^ start);
            for number in start..count.min(start + CHUNK) {
                total.add(number, &case(&mut random));
            }
        }
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        let mut total = Total::default();
        for worker in workers {
            total.merge(worker.join().expect("predicates do not panic"));
        }
        total
    })
}

/// Random numbers of a 64-bit seed (wyrand).
struct Random(u64);

impl Random {
    fn new(seed: u64) -> Self {
        let mut random = Self(seed);
        // Neighbouring seeds are far apart afterwards.
        random.0 = random.draw() ^ random.draw().rotate_left(32);
        random
    }

    fn draw(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0xa076_1d64_78bd_642f);
        let product = u128::from(self.0) * u128::from(self.0 ^ 0xe703_7ed1_a0b4_28db);
        (product >> 64) as u64 ^ product as u64
    }

    fn below(&mut self, n: u32) -> u32 {
        (((self.draw() >> 32) * u64::from(n)) >> 32) as u32
    }

    fn between(&mut self, low: i32, high: i32) -> i32 {
        low + self.below((high - low + 1) as u32) as i32
    }

    /// Integer of at least −2^`bits` and less than 2^`bits`.
    fn signed(&mut self, bits: u32) -> i64 {
        (self.draw() >> (63 - bits)) as i64 - (1 << bits)
    }

    /// Returns 1 or −1.
    fn unit(&mut self) -> i64 {
        self.signed(0) * 2 + 1
    }

    fn vector<const D: usize>(&mut self, bits: u32) -> [i64; D] {
        std::array::from_fn(|_| self.signed(bits))
    }
}

/// Basis with determinant 1 and entries of magnitude 2^`bits` at most, made of shears.
fn basis<const D: usize>(random: &mut Random, bits: u32) -> Lattice<D, D> {
    let mut rows: Lattice<D, D> = std::array::from_fn(|i| std::array::from_fn(|j| i64::from(i == j)));
    let mut largest = 1;
    let mut at = random.below(D as u32) as usize;
    // A shear multiplies the largest entry by at most 33.
    while largest * 33 <= 1 << bits {
        let (factor, other) = (random.signed(5) | 1, (at + 1) % D);
        for k in 0..D {
            rows[at][k] += factor * rows[other][k];
            largest = largest.max(rows[at][k].abs());
        }
        at = other;
    }
    rows
}

/// Points in the span of `dimension` vectors of a lattice. One of them may be moved by a vector of the lattice, and one by
/// one unit. Coordinates have magnitude 2^`bits` at most: 2^(bits − 1) of the origin, 2^(bits − 3) of each of three vectors,
/// 2^(bits − 6) and 1 of the moves.
fn near_span<const N: usize, const D: usize>(random: &mut Random, bits: u32, dimension: usize) -> Lattice<N, D> {
    let size = random.below(bits - 5);
    let (origin, basis) = (random.vector::<D>(bits - 1), basis::<D>(random, size));
    let mut points = [origin; N];
    for p in &mut points {
        for row in &basis[..dimension] {
            let factor = random.signed(3);
            (0..D).for_each(|k| p[k] += factor * row[k]);
        }
    }
    let choice = random.below(8);
    if choice & 1 != 0 {
        let (i, sign) = (random.below(N as u32) as usize, random.unit());
        (0..D).for_each(|k| points[i][k] += sign * basis[D - 1][k]);
    }
    if choice == 2 {
        let (i, k) = (random.below(N as u32) as usize, random.below(D as u32) as usize);
        points[i][k] += random.unit();
    }
    points
}

/// Points of a sphere around a lattice point, one of them perhaps moved by one unit. The sphere holds all signed
/// permutations of a vector, turned and enlarged by a quaternion.
fn near_sphere<const N: usize>(random: &mut Random) -> Lattice<N, 3> {
    let centre = random.vector::<3>(22);
    let [a, b, c, d] = random.vector::<4>(3);
    let turn = [
        [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
        [2 * (b * c + a * d), a * a - b * b + c * c - d * d, 2 * (c * d - a * b)],
        [2 * (b * d - a * c), 2 * (c * d + a * b), a * a - b * b - c * c + d * d],
    ];
    let bits = random.below(13);
    let v = random.vector::<3>(bits);
    let mut points = std::array::from_fn(|_| {
        const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
        let order = ORDERS[random.below(6) as usize];
        let p = order.map(|k| v[k] * random.unit());
        // Rows of the turn have the norm a² + b² + c² + d² ≤ 2⁸, and p has 2¹³ at most: 2²² + 2²¹ + 1 < 2²³.
        std::array::from_fn(|i| centre[i] + turn[i][0] * p[0] + turn[i][1] * p[1] + turn[i][2] * p[2])
    });
    if random.below(2) == 0 {
        points[random.below(N as u32) as usize][random.below(3) as usize] += random.unit();
    }
    points
}

/// Power of two.
fn power(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

/// Product of integer coordinates of at most `bits` bits and a power of two, within the range of the predicates.
fn scaled<const N: usize>(random: &mut Random, p: &Lattice<N, 3>, bits: u32) -> [Point3; N] {
    let scale = power(random.between(EXPONENTS.0, EXPONENTS.1 - bits as i32));
    p.map(|p| at(p.map(|x| x as f64 * scale)))
}

/// As [`scaled`], now and then with another power of two for each axis. That multiplies a determinant of coordinates by a
/// positive number.
fn stretched<const N: usize>(random: &mut Random, p: &Lattice<N, 3>, bits: u32) -> [Point3; N] {
    if random.below(64) > 0 {
        return scaled(random, p, bits);
    }
    let scale = [(); 3].map(|()| power(random.between(EXPONENTS.0, EXPONENTS.1 - bits as i32)));
    p.map(|p| at(std::array::from_fn(|k| p[k] as f64 * scale[k])))
}

fn at(x: [f64; 3]) -> Point3 {
    debug_assert!(x.iter().all(|x| *x == 0.0 || (MIN_MAGNITUDE..=MAX_MAGNITUDE).contains(&x.abs())));
    Point3::from(x)
}

fn difference<const D: usize>(p: [i64; D], q: [i64; D]) -> [i64; D] {
    std::array::from_fn(|k| p[k] - q[k])
}

fn minor(p: [i64; 3], q: [i64; 3], i: usize, j: usize) -> i128 {
    i128::from(p[i]) * i128::from(q[j]) - i128::from(p[j]) * i128::from(q[i])
}

fn sign(x: i128) -> i64 {
    x.signum() as i64
}

fn orient2d_case(random: &mut Random) -> Case {
    let kind = random.below(16);
    let p: Lattice<3, 2> = match kind {
        0 => [(); 3].map(|()| random.vector(BITS_2D)),
        1 => [(); 3].map(|()| random.vector(2)),
        // Integers of 20 bits and multiples of 2⁴⁰. Their differences have 61 bits, more than a double.
        2 => [(); 3].map(|()| random.vector(20).map(|x| x << (40 * random.below(2)))),
        _ => near_span(random, BITS_2D, 1),
    };
    let [a, b, c] = p;
    let (u, v) = (difference(b, a), difference(c, a));
    // Differences below 2⁶¹: products below 2¹²².
    let exact = sign(i128::from(u[0]) * i128::from(v[1]) - i128::from(u[1]) * i128::from(v[0]));
    let bits = if kind == 2 { 60 } else { BITS_2D };
    let q = stretched(random, &p.map(|[x, y]| [x, y, 0]), bits);
    let [a, b, c] = q.map(|p| [p.x, p.y]);
    Case::new(exact, orient2d(a, b, c), q)
}

fn collinear_case(random: &mut Random) -> Case {
    let p: Lattice<3, 3> = match random.below(16) {
        0 => [(); 3].map(|()| random.vector(BITS_2D)),
        1 => [(); 3].map(|()| random.vector(1)),
        _ => near_span(random, BITS_2D, 1),
    };
    let (u, v) = (difference(p[1], p[0]), difference(p[2], p[0]));
    let apart = [(0, 1), (1, 2), (2, 0)].iter().any(|&(i, j)| minor(u, v, i, j) != 0);
    let q = stretched(random, &p, BITS_2D);
    let found = !collinear(&q[0], &q[1], &q[2]);
    Case::new(i64::from(apart), f64::from(u8::from(found)), q)
}

fn orient3d_case(random: &mut Random) -> Case {
    let p: Lattice<4, 3> = match random.below(64) {
        0 => return mixed_orient3d(random),
        1..4 => [(); 4].map(|()| random.vector(BITS_3D)),
        4..8 => [(); 4].map(|()| random.vector(2)),
        8..12 => near_span(random, BITS_3D, 1),
        _ => near_span(random, BITS_3D, 2),
    };
    let [u, v, w] = [1, 2, 3].map(|i| difference(p[i], p[0]));
    let exact = i128::from(u[0]) * minor(v, w, 1, 2)
        + i128::from(u[1]) * minor(v, w, 2, 0)
        + i128::from(u[2]) * minor(v, w, 0, 1);
    let q = stretched(random, &p, BITS_3D);
    Case::new(sign(exact), orient3d(&q[0], &q[1], &q[2], &q[3]), q)
}

fn insphere_case(random: &mut Random) -> Case {
    let p: Lattice<5, 3> = match random.below(64) {
        0 => return mixed_insphere(random),
        1..4 => [(); 5].map(|()| random.vector(BITS_SPHERE)),
        4..8 => [(); 5].map(|()| random.vector(2)),
        8..12 => near_span(random, BITS_SPHERE, 2),
        12..32 => near_span(random, BITS_SPHERE, 3),
        _ => near_sphere(random),
    };
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| difference(p[i], p[4]));
    let lift = |p: [i64; 3]| i128::from(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    let det = |p: [i64; 3], q: [i64; 3], r: [i64; 3]| {
        i128::from(p[0]) * i128::from(q[1] * r[2] - q[2] * r[1])
            + i128::from(p[1]) * i128::from(q[2] * r[0] - q[0] * r[2])
            + i128::from(p[2]) * i128::from(q[0] * r[1] - q[1] * r[0])
    };
    let exact = lift(a) * det(b, c, d) - lift(b) * det(a, c, d) + lift(c) * det(a, b, d) - lift(d) * det(a, b, c);
    let q = scaled(random, &p, BITS_SPHERE);
    Case::new(sign(exact), insphere(&q[0], &q[1], &q[2], &q[3], &q[4]), q)
}

/// Polynomial in the second scale of a coordinate, of degree 5 at most.
#[derive(Clone, Copy, Default)]
struct Polynomial {
    terms: [i64; 6],
    degree: usize,
}

impl Polynomial {
    fn plus(self, other: Self, factor: i64) -> Self {
        let terms = std::array::from_fn(|k| self.terms[k] + factor * other.terms[k]);
        Self { terms, degree: self.degree.max(other.degree) }
    }

    fn times(self, other: Self) -> Self {
        let mut product = Self { degree: self.degree + other.degree, ..Self::default() };
        for i in 0..=self.degree {
            for j in 0..=other.degree {
                product.terms[i + j] += self.terms[i] * other.terms[j];
            }
        }
        product
    }

    fn det(p: [Self; 3], q: [Self; 3], r: [Self; 3]) -> Self {
        let minor = |i: usize, j: usize| q[i].times(r[j]).plus(q[j].times(r[i]), -1);
        p[0].times(minor(1, 2)).plus(p[1].times(minor(2, 0)), 1).plus(p[2].times(minor(0, 1)), 1)
    }
}

/// Points whose coordinates are small integers or small multiples of 2^`shift`: the polynomials, the points, and the shift.
fn mixed<const N: usize>(random: &mut Random) -> ([[Polynomial; 3]; N], [Point3; N], u32) {
    let shift = 1 + random.below(90);
    let bits = if random.below(2) == 0 { 1 } else { random.below(BITS_MIXED + 1) };
    let p = [(); N].map(|()| [(); 3].map(|()| (random.signed(bits), random.below(2) as usize)));
    let scale = random.between(EXPONENTS.0, EXPONENTS.1 - (BITS_MIXED + shift) as i32);
    let scales = [power(scale), power(scale + shift as i32)];
    let polynomials = p.map(|p| {
        p.map(|(x, second)| {
            let mut terms = [0; 6];
            terms[second] = x;
            Polynomial { terms, degree: 1 }
        })
    });
    (polynomials, p.map(|p| at(p.map(|(x, second)| x as f64 * scales[second]))), shift)
}

/// Sign of a polynomial at 2^`shift`.
///
/// The terms of a polynomial have magnitudes with a sum S below 2⁶². S is at most 2⁹ for a coordinate, and 2¹⁰ for a
/// difference. It is 3 · 2²⁰ for a lift, 6 · 2³⁰ for a determinant, and 72 · 2⁵⁰ for the in-sphere determinant. The terms
/// below k add up to less than 2⁶² · 2^(shift · (k − 1)). So the sum of the higher ones decides from 2⁶² / 2^shift on.
fn sign_at(polynomial: Polynomial, shift: u32) -> i64 {
    let mut sum: i128 = 0;
    for term in polynomial.terms.into_iter().rev() {
        if sum != 0 && (shift >= 63 || sum.unsigned_abs() >> 62 != 0) {
            break;
        }
        // The sum is zero or both numbers are small: below 2⁶² · 2⁶² + 2⁶².
        sum = if sum == 0 { 0 } else { sum << shift } + i128::from(term);
    }
    sign(sum)
}

fn mixed_orient3d(random: &mut Random) -> Case {
    let (p, q, shift) = mixed::<4>(random);
    let row = |i: usize| std::array::from_fn(|k| p[i][k].plus(p[0][k], -1));
    let exact = sign_at(Polynomial::det(row(1), row(2), row(3)), shift);
    Case::new(exact, orient3d(&q[0], &q[1], &q[2], &q[3]), q)
}

fn mixed_insphere(random: &mut Random) -> Case {
    let (p, q, shift) = mixed::<5>(random);
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| std::array::from_fn(|k| p[i][k].plus(p[4][k], -1)));
    let lift = |p: [Polynomial; 3]| p.iter().fold(Polynomial::default(), |sum, x| sum.plus(x.times(*x), 1));
    let term = |p, q, r, s| lift(p).times(Polynomial::det(q, r, s));
    let exact = term(a, b, c, d).plus(term(b, a, c, d), -1).plus(term(c, a, b, d), 1).plus(term(d, a, b, c), -1);
    Case::new(sign_at(exact, shift), insphere(&q[0], &q[1], &q[2], &q[3], &q[4]), q)
}

//! Delaunay kernel against rational arithmetic, on degenerate points: on grids, spheres, lines and planes, repeated,
//! and moved by single units in the last place.

use super::delaunay;
use crate::complex::{Complex, GHOST};
use crate::error::TetError;
use anastomesh_mesh::geometry::Point3;
use num_rational::BigRational;
use proptest::prelude::*;
use std::cmp::Ordering;

type Row = [BigRational; 3];

/// Exact coordinates, and predicates on them.
struct Exact(Vec<Row>);

impl Exact {
    fn new(points: &[Point3]) -> Self {
        let exact = |x: f64| BigRational::from_float(x).expect("finite");
        Self(points.iter().map(|p| [exact(p.x), exact(p.y), exact(p.z)]).collect())
    }

    fn from(&self, origin: u32, v: u32) -> Row {
        std::array::from_fn(|i| &self.0[v as usize][i] - &self.0[origin as usize][i])
    }

    /// Sign of the volume of a tetrahedron.
    fn orient(&self, [a, b, c, d]: [u32; 4]) -> Ordering {
        det(&self.from(a, b), &self.from(a, c), &self.from(a, d)).cmp(&zero())
    }

    /// Side of the circumsphere of the positive tetrahedron `t` on which point `e` lies: `Greater` inside.
    fn sphere(&self, t: [u32; 4], e: u32) -> Ordering {
        let [a, b, c, d] = t.map(|v| self.from(e, v));
        let lift = |p: &Row| p.iter().map(|x| x * x).fold(zero(), |s, x| s + x);
        let terms = [(&a, det(&b, &c, &d)), (&c, det(&a, &b, &d))].map(|(p, w)| lift(p) * w);
        let others = [(&b, det(&a, &c, &d)), (&d, det(&a, &b, &c))].map(|(p, w)| lift(p) * w);
        let [p, q] = terms;
        let [r, s] = others;
        (p + q).cmp(&(r + s))
    }

    /// As [`Exact::sphere`], with ties broken by perturbation. The squared length of each point, by which the
    /// paraboloid lifts it, grows by an ε that is larger for later points in lexicographic order.
    fn perturbed_sphere(&self, t: [u32; 4], e: u32) -> Ordering {
        let plain = self.sphere(t, e);
        if plain != Ordering::Equal {
            return plain;
        }
        let mut all = [t[0], t[1], t[2], t[3], e];
        all.sort_by(|&v, &w| self.0[w as usize].cmp(&self.0[v as usize]));
        let coefficient = |v: u32| {
            if v == e { Ordering::Less } else { self.orient(t.map(|w| if w == v { e } else { w })) }
        };
        all.into_iter().map(coefficient).find(|&o| o != Ordering::Equal).expect("that of the point itself")
    }

    /// Dimension of the affine hull of the points; −1 for none.
    fn rank(&self) -> i32 {
        let ids = || 0..self.0.len() as u32;
        let Some(b) = ids().find(|&v| self.0[v as usize] != self.0[0]) else {
            return i32::from(!self.0.is_empty()) - 1;
        };
        let flat = |v: u32| {
            let (p, q) = (self.from(0, b), self.from(0, v));
            (0..3).all(|i| &p[i] * &q[(i + 1) % 3] == &p[(i + 1) % 3] * &q[i])
        };
        let Some(c) = ids().find(|&v| !flat(v)) else { return 1 };
        if ids().any(|v| self.orient([0, b, c, v]) != Ordering::Equal) { 3 } else { 2 }
    }
}

fn zero() -> BigRational {
    BigRational::from_float(0.0).expect("finite")
}

fn det(p: &Row, q: &Row, r: &Row) -> BigRational {
    let minor = |i: usize, j: usize| &q[i] * &r[j] - &q[j] * &r[i];
    &p[0] * minor(1, 2) + &p[1] * minor(2, 0) + &p[2] * minor(0, 1)
}

/// Asserts that the complex is the Delaunay tetrahedralization of the perturbed points. By Delaunay's lemma, three
/// conditions suffice: each tetrahedron is positive, the hull is convex, and each face is locally Delaunay.
fn check(points: &[Point3], c: &Complex) {
    c.sanity_check().expect("a sound complex");
    let exact = Exact::new(points);
    let mut used = vec![false; points.len()];
    for t in (0..c.slots() as u32).filter(|&t| c.is_alive(t)) {
        let v = c.verts(t);
        if c.is_ghost(t) {
            for i in 0..3 {
                // The neighbouring hull face does not reach across the plane of this one.
                let other = c.apex(c.mate(4 * t + i));
                assert!(
                    other != GHOST && exact.orient([v[0], v[1], v[2], other]) != Ordering::Greater,
                    "hull at {v:?}"
                );
            }
            continue;
        }
        for x in v {
            used[x as usize] = true;
        }
        assert_eq!(exact.orient(v), Ordering::Greater, "{v:?}");
        for i in 0..4 {
            let mate = c.mate(4 * t + i);
            if !c.is_ghost(mate >> 2) {
                assert_eq!(exact.perturbed_sphere(v, c.apex(mate)), Ordering::Less, "{v:?} and {}", c.apex(mate));
            }
        }
    }
    assert!(used.iter().all(|&u| u), "each point is a vertex");
}

fn sorted_tets(c: &Complex, name: impl Fn(u32) -> u32) -> Vec<[u32; 4]> {
    let mut tets: Vec<[u32; 4]> = c.real_tets().map(|t| c.verts(t).map(&name)).collect();
    for t in &mut tets {
        t.sort_unstable();
    }
    tets.sort_unstable();
    tets
}

/// Asserts that the kernel returns the right result or error, for any order of the points.
fn holds(points: &[Point3], turn: usize) {
    let repeated = (0..points.len()).filter(|&i| points[..i].contains(&points[i])).count();
    let rank = Exact::new(points).rank();
    let c = match delaunay(points) {
        Ok(c) => c,
        Err(TetError::DuplicatePoints { count, pairs, .. }) => {
            assert_eq!((count, rank), (repeated, 3));
            assert!(!pairs.is_empty() && pairs.iter().all(|&[a, b]| a < b && points[a as usize] == points[b as usize]));
            return;
        }
        Err(TetError::Flat) => return assert!(rank < 3),
        Err(error) => panic!("{error}"),
    };
    assert_eq!((rank, repeated), (3, 0));
    check(points, &c);
    let n = points.len();
    // Reversed and rotated order.
    let name = |i: usize| (2 * n - 1 - i + turn) % n;
    let other: Vec<Point3> = (0..n).map(|i| points[name(i)]).collect();
    let again = delaunay(&other).expect("the same points");
    assert_eq!(sorted_tets(&c, |v| v), sorted_tets(&again, |v| name(v as usize) as u32));
}

fn nudged(x: f64, ulps: i32) -> f64 {
    (0..ulps.abs()).fold(x, |x, _| if ulps > 0 { x.next_up() } else { x.next_down() })
}

/// A point of a coarse grid with an exact or inexact step, moved by a few units in the last place.
fn grid_point(step: f64, ulps: i32) -> impl Strategy<Value = Point3> {
    let axis = move || (0i32..4, -ulps..=ulps).prop_map(move |(i, u)| nudged(f64::from(i + 1) * step, u));
    (axis(), axis(), axis()).prop_map(|(x, y, z)| Point3::new(x, y, z))
}

/// Integer points at distance √(5² · 3²) from the origin, exactly cospherical.
fn sphere_points() -> Vec<Point3> {
    let mut points = Vec::new();
    for x in -15i32..=15 {
        for y in -15i32..=15 {
            for z in -15i32..=15 {
                if x * x + y * y + z * z == 225 {
                    points.push(Point3::new(f64::from(x), f64::from(y), f64::from(z)));
                }
            }
        }
    }
    points
}

fn without_repetition(points: Vec<Point3>) -> Vec<Point3> {
    let mut distinct: Vec<Point3> = Vec::new();
    for p in points {
        if !distinct.contains(&p) {
            distinct.push(p);
        }
    }
    distinct
}

/// Bounds of rounding errors grow with the size of the points.
#[test]
fn large_points_nearly_of_a_sphere() {
    let points: Vec<Point3> = sphere_points().iter().step_by(4).map(|p| p * 0.7e9).collect();
    assert!(points.len() > 30);
    holds(&points, 1);
}

fn many<S: Strategy<Value = Point3>>(point: S, count: std::ops::Range<usize>) -> impl Strategy<Value = Vec<Point3>> {
    prop::collection::vec(point, count)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn points_of_a_grid(p in many(grid_point(1.0, 0), 4..50), q in many(grid_point(0.1, 0), 4..50), turn in 0usize..9) {
        holds(&p, turn);
        holds(&without_repetition(p), turn);
        holds(&without_repetition(q), turn);
    }

    #[test]
    fn points_nearly_of_a_grid(p in many(grid_point(1.0, 2), 4..50), q in many(grid_point(0.3, 1), 4..50), turn in 0usize..9) {
        holds(&without_repetition(p), turn);
        holds(&without_repetition(q), turn);
    }

    #[test]
    fn points_of_a_sphere(pick in prop::collection::vec(any::<prop::sample::Index>(), 4..40), inside in any::<bool>(),
                          scale in 0.01..100.0f64, turn in 0usize..9) {
        let all = sphere_points();
        let mut points = without_repetition(pick.iter().map(|i| all[i.index(all.len())]).collect());
        if inside {
            points.push(Point3::new(0.0, 0.0, 0.0));
        }
        holds(&points, turn);
        // Scaled points are nearly cospherical.
        holds(&points.iter().map(|p| p * scale).collect::<Vec<_>>(), turn);
    }

    #[test]
    fn points_of_lines_and_planes(line in prop::collection::vec(-20i32..20, 2..12), plane in prop::collection::vec((-3i32..4, -3i32..4), 0..14),
                                  apart in many(grid_point(1.0, 0), 0..3), turn in 0usize..9) {
        let on_line = line.iter().map(|&t| Point3::new(1.0, 2.0, 1.0) + nalgebra::Vector3::new(0.25, -0.5, 1.0) * f64::from(t));
        let in_plane = plane.iter().map(|&(s, t)| Point3::new(f64::from(s), f64::from(t), f64::from(s - 2 * t)));
        let points = without_repetition(on_line.chain(in_plane).chain(apart).collect());
        holds(&points, turn);
    }

    #[test]
    fn points_in_one_plane_are_flat(plane in prop::collection::vec((-9i32..9, -9i32..9), 1..30)) {
        let points: Vec<Point3> = plane.iter().map(|&(s, t)| Point3::new(f64::from(s) * 0.5, f64::from(t), f64::from(3 * s - t))).collect();
        prop_assert_eq!(delaunay(&points).unwrap_err(), TetError::Flat);
    }
}

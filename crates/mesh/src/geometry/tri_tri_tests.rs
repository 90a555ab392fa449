//! Tests against a rational oracle that clips one triangle by the other.

use super::*;
use num_rational::Ratio;
use proptest::prelude::*;

type Q = Ratio<i128>;
type V = [Q; 3];

fn rational(p: &Point3) -> V {
    std::array::from_fn(|i| Q::from_integer(p[i] as i128))
}

fn sub(a: &V, b: &V) -> V {
    std::array::from_fn(|i| a[i] - b[i])
}

fn dot(a: &V, b: &V) -> Q {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: &V, b: &V) -> V {
    std::array::from_fn(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}

fn is_zero(a: &V) -> bool {
    a.iter().all(|x| *x == Q::from_integer(0))
}

/// Part of a convex polygon (or segment, or point) with `height` ≥ 0.
fn clip(polygon: &[V], height: impl Fn(&V) -> Q) -> Vec<V> {
    let zero = Q::from_integer(0);
    let mut kept = Vec::new();
    for (i, a) in polygon.iter().enumerate() {
        let b = &polygon[(i + 1) % polygon.len()];
        let (ha, hb) = (height(a), height(b));
        if ha >= zero {
            kept.push(*a);
        }
        if (ha > zero && hb < zero) || (ha < zero && hb > zero) {
            let t = ha / (ha - hb);
            kept.push(std::array::from_fn(|k| a[k] + (b[k] - a[k]) * t));
        }
    }
    kept
}

/// Position of a point of the triangle: 0 at a vertex, 1 on an edge, 2 inside.
fn depth(t: &[V; 3], p: &V) -> usize {
    let on = (0..3).filter(|&j| is_zero(&cross(&sub(&t[(j + 1) % 3], &t[j]), &sub(p, &t[j])))).count();
    2 - on
}

/// Expected result of `classify`, from the intersection itself.
fn oracle(points: &[Point3], a: [u32; 3], b: [u32; 3]) -> Contact {
    let (p, q) = (a.map(|v| rational(&points[v as usize])), b.map(|v| rational(&points[v as usize])));
    let n = cross(&sub(&q[1], &q[0]), &sub(&q[2], &q[0]));
    let mut common = p.to_vec();
    common = clip(&common, |x| dot(&n, &sub(x, &q[0])));
    common = clip(&common, |x| -dot(&n, &sub(x, &q[0])));
    for j in 0..3 {
        let inward = cross(&n, &sub(&q[(j + 1) % 3], &q[j]));
        common = clip(&common, |x| dot(&inward, &sub(x, &q[j])));
    }
    common.sort();
    common.dedup();
    let flat = common.len() < 3
        || common[2..].iter().all(|c| is_zero(&cross(&sub(&common[1], &common[0]), &sub(c, &common[0]))));
    let dimension = if flat { common.len().min(2) } else { 3 };
    let shared = a.iter().filter(|v| b.contains(v)).count();
    let improper = match (shared, dimension) {
        (3, _) => Improper::SameVertices,
        (0, 0) => return Contact::Apart,
        (1, 1) | (2, 2) => return Contact::Neighbours,
        (0, 1) => match (depth(&p, &common[0]), depth(&q, &common[0])) {
            (0, 0) => Improper::CoincidentPoint,
            (0, 1) | (1, 0) => Improper::VertexOnEdge,
            (1, 1) => Improper::EdgeOnEdge,
            _ => Improper::VertexOnFace,
        },
        (0, 2) => Improper::Crossing,
        (1, 2) => Improper::BeyondSharedVertex,
        (2, 3) => Improper::Folded,
        (0 | 1, 3) => Improper::CoplanarOverlap,
        _ => panic!("{shared} shared vertices and dimension {dimension}"),
    };
    Contact::Improper(improper)
}

fn grid_points(n: usize, flat: bool) -> impl Strategy<Value = Vec<Point3>> {
    let depth = if flat { 0..1_i32 } else { -2..3_i32 };
    prop::collection::vec((-3..4_i32, -3..4_i32, depth), n)
        .prop_map(|v| v.into_iter().map(|(x, y, z)| Point3::new(x.into(), y.into(), z.into())).collect())
}

fn degenerate(points: &[Point3], t: [u32; 3]) -> bool {
    collinear(&points[t[0] as usize], &points[t[1] as usize], &points[t[2] as usize])
}

/// A second triangle that shares 0, 1, 2 or 3 ids with `[0, 1, 2]`.
fn second() -> impl Strategy<Value = [u32; 3]> {
    prop::sample::select(vec![[3, 4, 5], [0, 3, 4], [3, 1, 4], [3, 4, 2], [1, 0, 3], [2, 1, 3], [0, 3, 2], [2, 0, 1]])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6000))]
    #[test]
    fn agrees_with_clipping(
        points in prop_oneof![grid_points(6, false), grid_points(6, true)],
        second in second(),
        turn in 0..3_usize,
        scale in -20..20_i32,
    ) {
        let mut first = [0, 1, 2];
        prop_assume!(!degenerate(&points, first) && !degenerate(&points, second));
        let expected = oracle(&points, first, second);
        // Scaling by a power of two and rotating the first triangle change nothing.
        let points: Vec<Point3> = points.iter().map(|p| p * 2.0_f64.powi(scale)).collect();
        first.rotate_left(turn);
        prop_assert_eq!(classify(&points, first, second), expected);
        prop_assert_eq!(classify(&points, second, first), expected);
        first.swap(0, 1);
        prop_assert_eq!(classify(&points, second, first), expected);
    }

    #[test]
    fn finds_what_testing_all_pairs_finds(
        points in grid_points(14, false),
        picks in prop::collection::vec(prop::sample::subsequence((0..14_u32).collect::<Vec<_>>(), 3), 0..14),
    ) {
        let triangles: Vec<[u32; 3]> = picks.iter().map(|t| [t[0], t[1], t[2]]).collect();
        let flat: Vec<bool> = triangles.iter().map(|&t| degenerate(&points, t)).collect();
        let mut expected = Vec::new();
        for i in 0..triangles.len() {
            if flat[i] {
                expected.push((i as u32, i as u32));
            }
            for j in i + 1..triangles.len() {
                let improper = || matches!(oracle(&points, triangles[i], triangles[j]), Contact::Improper(_));
                if !flat[i] && !flat[j] && improper() {
                    expected.push((i as u32, j as u32));
                }
            }
        }
        prop_assert_eq!(self_intersections(&points, &triangles), expected);
    }
}

fn points(coordinates: &[[f64; 3]]) -> Vec<Point3> {
    coordinates.iter().map(|&c| Point3::from(c)).collect()
}

/// One example of each kind: the first triangle is (0,0,0), (4,0,0), (0,4,0).
#[test]
fn each_kind_is_named() {
    let kind = |second: [u32; 3], extra: [[f64; 3]; 3]| {
        let mut all = points(&[[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]]);
        all.extend(points(&extra));
        classify(&all, [0, 1, 2], second)
    };
    let improper = |second, extra| match kind(second, extra) {
        Contact::Improper(kind) => kind,
        other => panic!("{other:?}"),
    };
    let (a, b, c) = ([5.0, 5.0, 1.0], [5.0, 4.0, 1.0], [4.0, 5.0, 2.0]);
    assert_eq!(kind([3, 4, 5], [a, b, c]), Contact::Apart);
    assert_eq!(kind([0, 4, 5], [a, b, c]), Contact::Neighbours);
    assert_eq!(kind([1, 2, 5], [a, b, [4.0, 4.0, 0.0]]), Contact::Neighbours);
    assert_eq!(improper([3, 4, 5], [[0.0; 3], b, c]), Improper::CoincidentPoint);
    assert_eq!(improper([3, 4, 5], [[1.0, 0.0, 0.0], b, c]), Improper::VertexOnEdge);
    assert_eq!(improper([3, 4, 5], [[1.0, 1.0, 0.0], b, c]), Improper::VertexOnFace);
    assert_eq!(improper([3, 4, 5], [[2.0, 0.0, -1.0], [2.0, 0.0, 1.0], [2.0, -3.0, 0.0]]), Improper::EdgeOnEdge);
    assert_eq!(improper([3, 4, 5], [[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [9.0, 9.0, 0.5]]), Improper::Crossing);
    assert_eq!(improper([3, 4, 5], [[1.0, 1.0, 0.0], [9.0, 1.0, 0.0], [1.0, 9.0, 0.0]]), Improper::CoplanarOverlap);
    assert_eq!(improper([0, 4, 5], [a, [3.0, 3.0, 1.0], [1.0, 1.0, -1.0]]), Improper::BeyondSharedVertex);
    assert_eq!(improper([1, 0, 5], [a, b, [1.0, 1.0, 0.0]]), Improper::Folded);
    assert_eq!(improper([1, 0, 2], [a, b, c]), Improper::SameVertices);
    assert_eq!(improper([3, 4, 5], [[-1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [3.0, 1.0, 0.0]]), Improper::Degenerate);
}

/// The last bit decides: the vertex lies on the plane, or one unit in the last place above it.
#[test]
fn nothing_is_rounded() {
    let touch = |z: f64| {
        let all = points(&[
            [0.1, 0.1, 0.3],
            [4.1, 0.1, 0.3],
            [0.1, 4.1, 0.3],
            [1.3, 1.7, z],
            [1.0, 1.0, 2.0],
            [2.0, 1.0, 2.0],
        ]);
        classify(&all, [0, 1, 2], [3, 4, 5])
    };
    assert_eq!(touch(0.3), Contact::Improper(Improper::VertexOnFace));
    assert_eq!(touch(0.3_f64.next_up()), Contact::Apart);
    assert_eq!(touch(0.3_f64.next_down()), Contact::Improper(Improper::Crossing));
}

//! Exact intersections of triangles, and winding numbers of points.

use crate::exact::{orient_2d, orient_3d};
use crate::space::{Bounds, Point, boxes};
use itertools::Itertools as _;

/// Returns the pairs of triangles that intersect outside their common vertices and edges. Degenerate triangles are
/// ignored.
pub fn crossings(points: &[Point], faces: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let tree = boxes(faces.iter().map(|face| Bounds::from_points(&face.map(|v| points[v as usize]))));
    let pairs = tree.intersection_candidates_with_other_tree(&tree).map(|(a, b)| [a.data, b.data]);
    let is_crossing = |&[i, j]: &[u32; 2]| i < j && intersect(points, faces[i as usize], faces[j as usize]);
    pairs.filter(is_crossing).sorted_unstable().collect()
}

fn intersect(points: &[Point], s: [u32; 3], t: [u32; 3]) -> bool {
    let at = |v: u32| &points[v as usize];
    let have_area = || [s, t].iter().all(|face| axes(face.map(at)).is_some());
    let is_common = |v: &u32| s.contains(v) && t.contains(v);
    let common: Vec<u32> = s.into_iter().filter(is_common).collect();
    match common[..] {
        // Beyond a common vertex, the first exit is through the opposite side of one triangle.
        [] | [_] => {
            let any_meets = |from: [u32; 3], to: [u32; 3]| {
                let sides = [[0, 1], [1, 2], [2, 0]].map(|side| side.map(|i| from[i]));
                let mut free = sides.into_iter().filter(|side| !side.iter().any(is_common));
                free.any(|side| meets(side.map(at), to.map(at)))
            };
            (any_meets(s, t) || any_meets(t, s)) && have_area()
        }
        // Beyond a common edge, only triangles folded onto each other intersect.
        [u, v] => {
            let apex = |face: [u32; 3]| at(face.into_iter().find(|w| !is_common(w)).unwrap_or(u));
            let (p, q) = (apex(s), apex(t));
            let is_folded = |axes| {
                let turn = |r: &Point| orient_2d(flat(at(u), axes), flat(at(v), axes), flat(r, axes));
                turn(p) == turn(q)
            };
            orient_3d(at(u), at(v), p, q) == 0 && have_area() && axes(s.map(at)).is_some_and(is_folded)
        }
        _ => have_area(),
    }
}

/// Axes of a projection in which the triangle has an area; `None` if it is degenerate.
fn axes(t: [&Point; 3]) -> Option<[usize; 2]> {
    let has_area = |axes: &[usize; 2]| {
        let [a, b, c] = t.map(|p| flat(p, *axes));
        orient_2d(a, b, c) != 0
    };
    [[0, 1], [1, 2], [2, 0]].into_iter().find(has_area)
}

fn flat(p: &Point, axes: [usize; 2]) -> [f64; 2] {
    axes.map(|k| p[k])
}

/// True if a segment and a triangle have a common point.
fn meets([p, q]: [&Point; 2], t: [&Point; 3]) -> bool {
    let [a, b, c] = t;
    let (above, below) = (orient_3d(a, b, c, p), orient_3d(a, b, c, q));
    if above * below > 0 {
        return false;
    }
    if above == 0 && below == 0 {
        let in_plane = |axes| meets_in_plane([p, q].map(|p| flat(p, axes)), t.map(|p| flat(p, axes)));
        return axes(t).is_some_and(in_plane);
    }
    let turns = [orient_3d(p, q, a, b), orient_3d(p, q, b, c), orient_3d(p, q, c, a)];
    turns.iter().all(|&turn| turn >= 0) || turns.iter().all(|&turn| turn <= 0)
}

fn meets_in_plane([p, q]: [[f64; 2]; 2], t: [[f64; 2]; 3]) -> bool {
    let turn = orient_2d(t[0], t[1], t[2]);
    let contains = |p| (0..3).all(|i| orient_2d(t[i], t[(i + 1) % 3], p) != -turn);
    let cross = |i: usize| {
        let (a, b) = (t[i], t[(i + 1) % 3]);
        // Collinear sides are left to other sides and to the ends.
        orient_2d(p, q, a) != orient_2d(p, q, b) && orient_2d(a, b, p) != orient_2d(a, b, q)
    };
    // With an end outside, a segment that meets the triangle meets a side.
    contains(p) || (0..3).any(cross)
}

/// Returns how often a closed surface winds around a point that is not on it.
pub fn winding(p: &Point, triangles: &[[Point; 3]]) -> i32 {
    triangles.iter().map(|t| passed(p, t)).sum()
}

/// Signed passages of a ray in direction +x through a triangle: 1 outwards, -1 inwards. The ray starts at a point moved
/// by an infinitesimal in y, and by a smaller one in z.
fn passed(p: &Point, t: &[Point; 3]) -> i32 {
    if !may_pass(p, t) {
        return 0;
    }
    let [a, b, c, start] = [&t[0], &t[1], &t[2], p].map(|q| flat(q, [1, 2]));
    let turns = [turn(a, b, start), turn(b, c, start), turn(c, a, start)];
    // The outward normal has the sign of the turn along x. The ray passes if the point lies on the inner side.
    let is_passed = turns == [turns[0]; 3] && orient_3d(&t[0], &t[1], &t[2], p) == -turns[0];
    if is_passed { turns[0] } else { 0 }
}

/// False if all vertices of a triangle are behind a point, or on one side of it.
fn may_pass(p: &Point, t: &[Point; 3]) -> bool {
    let any = |k: usize, compare: fn(&f64, &f64) -> bool| t.iter().any(|q| compare(&q[k], &p[k]));
    any(0, f64::ge) && [1, 2].iter().all(|&k| any(k, f64::le) && any(k, f64::ge))
}

/// Side of a line on which the moved point lies: of its infinitesimals, the first that matters decides.
fn turn(a: [f64; 2], b: [f64; 2], p: [f64; 2]) -> i32 {
    match orient_2d(a, b, p) {
        // The derivative of the area in y is a.z - b.z, in z it is b.y - a.y.
        0 if a[1] != b[1] => a[1].total_cmp(&b[1]) as i32,
        0 => b[0].total_cmp(&a[0]) as i32,
        sign => sign,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: [Point; 3] = [[0., 0., 0.], [2., 0., 0.], [0., 2., 0.]];

    /// Result for a segment, the same for all orders of the triangle's vertices.
    fn segment(p: [f64; 2], q: [f64; 2]) -> bool {
        let [a, b, c] = A.map(|p| flat(&p, [0, 1]));
        let found = meets_in_plane([p, q], [a, b, c]);
        for t in [[b, c, a], [c, a, b], [a, c, b], [c, b, a], [b, a, c]] {
            assert_eq!([meets_in_plane([p, q], t), meets_in_plane([q, p], t)], [found; 2], "{p:?} {q:?} {t:?}");
        }
        found
    }

    #[test]
    fn segments_and_a_triangle_in_a_plane() {
        // Through each side, through a vertex, along a side, and inside.
        for outside in [[0.5, -1.], [-1., 0.5], [2., 2.], [-1., -1.]] {
            assert!(segment(outside, [0.5, 0.5]), "{outside:?}");
        }
        assert!(segment([-1., 0.], [3., 0.]) && segment([0.5, 0.5], [0.6, 0.5]) && segment([-1., 1.], [1., -1.]));
        assert!(!segment([-1., 0.9], [0.9, -1.]) && !segment([3., 0.], [4., 0.]) && !segment([-1., -1.], [-1., 3.]));
    }

    /// Result for two triangles, the same for all orders of their vertices.
    fn pair(other: [Point; 3]) -> bool {
        let points: Vec<Point> = A.into_iter().chain(other).collect();
        let number = |p: &Point| points.iter().position(|q| q == p).expect("a point") as u32;
        let faces = [A, other].map(|t| t.each_ref().map(number));
        let turned = |[a, b, c]: [u32; 3]| [[a, b, c], [b, c, a], [c, a, b], [a, c, b], [c, b, a], [b, a, c]];
        let found = !crossings(&points, &faces).is_empty();
        for s in turned(faces[0]) {
            for t in turned(faces[1]) {
                assert_eq!([intersect(&points, s, t), intersect(&points, t, s)], [found; 2], "{s:?} {t:?} {other:?}");
            }
        }
        found
    }

    #[test]
    fn pairs_of_triangles() {
        let [a, b, c] = A;
        // Without a common vertex: piercing, touching, coplanar, apart.
        assert!(pair([[0.5, 0.5, -1.], [0.5, 0.5, 1.], [3., 3., 1.]]));
        assert!(pair([[0.5, 0.5, 0.], [0.5, 0.5, 1.], [3., 3., 1.]]));
        assert!(pair([[0.1, 0.1, 0.], [0.2, 0.1, 0.], [0.1, 0.2, 0.]]));
        assert!(pair([[-1., -1., 0.], [9., -1., 0.], [-1., 9., 0.]]));
        assert!(pair([[-1., 0.5, 0.], [3., 0.5, 0.], [1., 0.6, 0.]]));
        assert!(pair([[1., 0., 0.], [1., -1., 0.], [1., -1., 1.]]));
        assert!(!pair([[0.5, 0.5, 1e-300], [0.5, 0.5, 1.], [3., 3., 1.]]));
        assert!(!pair([[2., 2., 0.], [3., 2., 0.], [2., 3., 0.]]));
        // With a common vertex.
        assert!(!pair([a, [-1., 0., 0.], [0., -1., 0.]]));
        assert!(!pair([a, [1., 0., 1.], [0., 1., 1.]]));
        assert!(pair([a, [1., 1., -1.], [1., 1., 1.]]));
        assert!(pair([a, [1., 0.5, 0.], [0.5, 1., 1.]]));
        assert!(pair([a, [3., 0., 0.], [0., 0., 1.]]));
        // With a common edge.
        assert!(!pair([b, a, [0., 0., 1.]]));
        assert!(!pair([b, a, [0., -1., 0.]]));
        assert!(pair([b, a, [0.3, 0.3, 0.]]));
        assert!(!pair([b, a, [0.3, 0.3, 1e-300]]));
        assert!(pair([c, b, a]));
    }

    #[test]
    fn rays_pass_no_triangle_beside_or_behind_their_start() {
        let moved = |by: Point| [[5., 0., 0.], [5., 2., 0.], [5., 0., 2.]].map(|q| [0, 1, 2].map(|k| q[k] + by[k]));
        for by in [[0.; 3], [-5., 0., 0.], [0., -2., 0.], [0., 0., -2.], [9., -1., -1.]] {
            assert!(may_pass(&[0.; 3], &moved(by)), "{by:?}");
        }
        for by in [[-6., -1., -1.], [0., 1., 0.], [0., -3., 0.], [0., 0., 1.], [0., 0., -3.]] {
            assert!(!may_pass(&[0.; 3], &moved(by)), "{by:?}");
        }
    }

    #[test]
    fn winding_numbers_of_an_octahedron() {
        let p = [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [-1., 0., 0.], [0., -1., 0.], [0., 0., -1.]];
        let faces = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
        let outer: Vec<[Point; 3]> = faces.map(|f: [usize; 3]| f.map(|i| p[i])).to_vec();
        let inner: Vec<[Point; 3]> = outer.iter().map(|&[a, b, c]| [a, c, b]).collect();
        // The rays of these points pass through vertices and edges.
        for inside in [[0., 0., 0.], [-0.5, 0., 0.], [0.2, 0.2, 0.], [-0.2, 0., 0.3]] {
            assert_eq!((winding(&inside, &outer), winding(&inside, &inner)), (1, -1), "{inside:?}");
        }
        for outside in [[-2., 0., 0.], [2., 0., 0.], [-2., 0.5, 0.], [-1., 1., 0.], [-0.9, 0., 0.2], [-1., 0., 1.]] {
            assert_eq!((winding(&outside, &outer), winding(&outside, &inner)), (0, 0), "{outside:?}");
        }
    }
}

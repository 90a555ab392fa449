//! Winding numbers by ray crossing.

use super::Point3;
use super::predicates::{orient2d, orient3d};

/// Contribution of a triangle to the winding number of a closed surface around `p`.
///
/// The ray starts at `p` along x. The contribution is 1 if the ray leaves through the triangle (counter-clockwise seen
/// from ahead), −1 if it enters, and 0 if it misses. It is `None` if `p` lies on the triangle. The sum over a closed
/// surface is its winding number.
///
/// Exact for coordinates in the range of the predicates. The ray is perturbed symbolically by (ε, ε²) in y and z, so
/// that it never meets an edge.
pub fn crossing(p: &Point3, [a, b, c]: [&Point3; 3]) -> Option<i32> {
    let turns = [passes(a, b, p), passes(b, c, p), passes(c, a, p)];
    let turn = turns[0];
    if turn == 0 || turns != [turn; 3] {
        return Some(0);
    }
    let side = orient3d(a, b, c, p);
    if side == 0.0 {
        return None;
    }
    let ahead = (side < 0.0) == (turn > 0);
    Some(if ahead { turn } else { 0 })
}

/// Side of the edge from `a` to `b` on which the perturbed ray passes, seen against x: 1 to the left, 0 if parallel.
fn passes(a: &Point3, b: &Point3, p: &Point3) -> i32 {
    let flat = |p: &Point3| [p.y, p.z];
    let turn = orient2d(flat(a), flat(b), flat(p));
    let sign = |less: bool, greater: bool| i32::from(greater) - i32::from(less);
    if turn != 0.0 {
        return sign(turn < 0.0, turn > 0.0);
    }
    match sign(b.z > a.z, b.z < a.z) {
        0 => sign(b.y < a.y, b.y > a.y),
        by_y => by_y,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner(i: usize) -> Point3 {
        Point3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2) as f64)
    }

    /// Unit cube with outward faces.
    const CUBE: [[usize; 3]; 12] = [
        [0, 2, 1],
        [1, 2, 3],
        [4, 5, 6],
        [5, 7, 6],
        [0, 1, 4],
        [1, 5, 4],
        [2, 6, 3],
        [3, 6, 7],
        [0, 4, 2],
        [2, 4, 6],
        [1, 3, 5],
        [3, 7, 5],
    ];

    fn winding(p: &Point3) -> Option<i32> {
        CUBE.iter().map(|t| crossing(p, [&corner(t[0]), &corner(t[1]), &corner(t[2])])).sum()
    }

    #[test]
    fn points_on_a_grid_through_edges_and_vertices_are_told_apart() {
        // Quarters: rays run along edges, diagonals and through vertices.
        for i in 0..9 * 9 * 9 {
            let at = |k: i32| f64::from(k - 2) / 4.0;
            let p = Point3::new(at(i % 9), at(i / 9 % 9), at(i / 81));
            let inside = p.iter().all(|&x| 0.0 < x && x < 1.0);
            let outside = p.iter().any(|&x| !(0.0..=1.0).contains(&x));
            if inside || outside {
                assert_eq!(winding(&p), Some(i32::from(inside)), "{p}");
            } else {
                // On the surface, one of the triangles may report it.
                assert!(matches!(winding(&p), None | Some(0 | 1)));
            }
        }
    }
}

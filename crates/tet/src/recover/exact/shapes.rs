//! Surfaces that need exact recovery.

use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::Point3;

/// Twisted prism over a regular polygon, with diagonals that make its sides concave.
pub(crate) fn twisted_prism(n: u32, turn: f64, height: f64) -> TriMesh {
    let mut s = TriMesh::default();
    for (z, turn) in [(0.0, 0.0), (height, turn)] {
        for i in 0..n {
            let w = f64::from(i) / f64::from(n) * std::f64::consts::TAU + turn;
            s.points.push(Point3::new(libm::cos(w), libm::sin(w), z));
        }
    }
    for i in 0..n {
        let j = (i + 1) % n;
        s.triangles.push([i, j, n + i]);
        s.triangles.push([j, n + j, n + i]);
    }
    for i in 1..n - 1 {
        s.triangles.push([0, i + 1, i]);
        s.triangles.push([n, n + i, n + i + 1]);
    }
    s
}

/// Point of a box over a grid of `n × n` squares, at the bottom or top.
fn corner(n: u32, i: u32, j: u32, top: u32) -> u32 {
    (i * (n + 1) + j) * 2 + top
}

/// All squares of such a box, counter-clockwise seen from outside.
fn box_of_squares(n: u32, mut square: impl FnMut(u32, u32, u32, u32)) {
    let at = |i, j, top| corner(n, i, j, top);
    for i in 0..n {
        for j in 0..n {
            square(at(i, j, 1), at(i + 1, j, 1), at(i + 1, j + 1, 1), at(i, j + 1, 1));
            square(at(i, j, 0), at(i, j + 1, 0), at(i + 1, j + 1, 0), at(i + 1, j, 0));
        }
        square(at(i, 0, 0), at(i + 1, 0, 0), at(i + 1, 0, 1), at(i, 0, 1));
        square(at(i + 1, n, 0), at(i, n, 0), at(i, n, 1), at(i + 1, n, 1));
        square(at(0, i + 1, 0), at(0, i, 0), at(0, i, 1), at(0, i + 1, 1));
        square(at(n, i, 0), at(n, i + 1, 0), at(n, i + 1, 1), at(n, i, 1));
    }
}

/// Thin box with `n × n` squares at bottom and top, and random diagonals.
pub(crate) fn sheet(n: u32, thickness: f64, origin: f64, salt: u64) -> TriMesh {
    let mut s = TriMesh::default();
    for i in 0..=n {
        for j in 0..=n {
            for z in [0.0, thickness] {
                s.points.push(Point3::new(f64::from(i) + origin, f64::from(j) - origin, z));
            }
        }
    }
    let square = |a: u32, b: u32, c: u32, d: u32| {
        let coin = crate::delaunay::hash(u64::from(a) ^ (u64::from(c) << 20) ^ salt) & 1 == 0;
        s.triangles.extend(if coin { [[a, b, c], [a, c, d]] } else { [[b, c, d], [b, d, a]] });
    };
    box_of_squares(n, square);
    s
}

/// Chazelle's polyhedron: a box with wedge-shaped notches from above and below that nearly meet in a saddle.
pub(crate) fn chazelle(notches: u32, gap: f64) -> TriMesh {
    // Ridges of the bottom notches run along x on z = x y, those of the top notches along y on z = x y + gap. One
    // zigzag sheet over a grid approximates each.
    let n = 2 * notches;
    let mut s = TriMesh::default();
    let half = f64::from(n) / 2.0;
    for i in 0..=n {
        for j in 0..=n {
            let (x, y) = (f64::from(i) - half, f64::from(j) - half);
            let low = if j % 2 == 1 && i > 0 && i < n { x * y } else { -half * half - 1.0 };
            let high = if i % 2 == 1 && j > 0 && j < n { x * y + gap } else { half * half + 1.0 };
            s.points.push(Point3::new(x, y, low));
            s.points.push(Point3::new(x, y, high));
        }
    }
    let square = |a: u32, b: u32, c: u32, d: u32| s.triangles.extend([[a, b, c], [a, c, d]]);
    box_of_squares(n, square);
    s
}

/// Fan of long thin triangles from one point, closed by another fan below, with a zigzag rim.
pub(crate) fn fan(n: u32, length: f64) -> TriMesh {
    let mut s =
        TriMesh { points: vec![Point3::new(0.0, 0.0, 0.0), Point3::new(0.1, 0.0, -0.05)], ..TriMesh::default() };
    for i in 0..=n {
        let x = f64::from(i) / f64::from(n) - 0.5;
        s.points.push(Point3::new(length, x, if i % 2 == 0 { 0.0 } else { 1e-3 }));
    }
    for i in 0..n {
        s.triangles.push([0, i + 2, i + 3]);
        s.triangles.push([1, i + 3, i + 2]);
    }
    s.triangles.push([0, 1, 2]);
    s.triangles.push([1, 0, n + 2]);
    s
}

/// Random points in a box.
pub(crate) fn scatter(n: u64) -> Vec<Point3> {
    let coin = |k: u64| (crate::delaunay::hash(k) >> 11) as f64 / (1u64 << 53) as f64;
    (0..n).map(|k| Point3::new(coin(3 * k), coin(3 * k + 1), coin(3 * k + 2))).collect()
}

/// Segments and facets on several levels, among scattered points. They are no closed surface.
pub(crate) fn dangling(scattered: u64, levels: u32, step: f64) -> (TriMesh, Vec<[u32; 2]>) {
    let mut points = scatter(scattered);
    let mut place = |x: f64, y: f64, z: f64| {
        points.push(Point3::new(x, y, z));
        points.len() as u32 - 1
    };
    let (mut segments, mut triangles) = (Vec::new(), Vec::new());
    for k in 0..levels {
        let z = 0.1 + step * f64::from(k);
        segments.push([place(-0.2, 0.51, z), place(1.2, 0.503, z + 0.01)]);
        triangles.push([(-0.1, -0.1), (1.1, -0.1), (0.4, 0.46)].map(|(x, y)| place(x, y, z + 0.003)));
    }
    (TriMesh { points, triangles }, segments)
}

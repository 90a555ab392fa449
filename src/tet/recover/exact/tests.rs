use super::*;
use crate::geometry::Vec3;
use crate::mesh::TriMesh;
use crate::tet::plc::InputKind;
use crate::tet::{carve, certify, fill};
use proptest::prelude::*;

/// Recovers all of a closed surface by this tier alone, carves, certifies.
fn fills(surface: &TriMesh) -> Result<ExactSummary, TetError> {
    let mut points = surface.points.clone();
    points.extend(fill::box_corners(&surface.points));
    let (c, summary) = recover_exact(&points, &surface.triangles, &[])?;
    let carved = carve::carve(&c, surface, InputKind::Closed, &[])?;
    let mesh = carved.into_compact_mesh(surface.points.len());
    certify::certify(&mesh, surface)?;
    Ok(summary)
}

fn fills_all(surface: &TriMesh) -> ExactSummary {
    fills(surface).unwrap_or_else(|e| panic!("{e}"))
}

/// A prism over a regular polygon, its top turned, with the diagonals that make its sides bend inwards.
fn twisted_prism(n: u32, turn: f64, height: f64) -> TriMesh {
    let mut s = TriMesh::default();
    for (z, turn) in [(0.0, 0.0), (height, turn)] {
        for i in 0..n {
            let w = f64::from(i) / f64::from(n) * std::f64::consts::TAU + turn;
            s.points.push(Point3::new(w.cos(), w.sin(), z));
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

/// A thin box with `n × n` squares above and below, the diagonals turned by a coin.
fn sheet(n: u32, thickness: f64, origin: f64, salt: u64) -> TriMesh {
    let mut s = TriMesh::default();
    let at = |i: u32, j: u32, top: u32| (i * (n + 1) + j) * 2 + top;
    for i in 0..=n {
        for j in 0..=n {
            for z in [0.0, thickness] {
                s.points.push(Point3::new(f64::from(i) + origin, f64::from(j) - origin, z));
            }
        }
    }
    let mut square = |a: u32, b: u32, c: u32, d: u32| {
        let coin = crate::tet::delaunay::hash(u64::from(a) ^ (u64::from(c) << 20) ^ salt) & 1 == 0;
        s.triangles.extend(if coin { [[a, b, c], [a, c, d]] } else { [[b, c, d], [b, d, a]] });
    };
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
    s
}

/// The polyhedron of Chazelle: a box with wedge-shaped notches from above and below that nearly meet in a saddle.
fn chazelle(notches: u32, gap: f64) -> TriMesh {
    // Ridges of the bottom notches run along x on z = x y, those of the top notches along y on z = x y + gap; both are
    // approximated by one zigzag sheet each over a grid.
    let n = 2 * notches;
    let mut s = TriMesh::default();
    let half = f64::from(n) / 2.0;
    let at = |i: u32, j: u32, top: u32| (i * (n + 1) + j) * 2 + top;
    for i in 0..=n {
        for j in 0..=n {
            let (x, y) = (f64::from(i) - half, f64::from(j) - half);
            let low = if j % 2 == 1 && i > 0 && i < n { x * y } else { -half * half - 1.0 };
            let high = if i % 2 == 1 && j > 0 && j < n { x * y + gap } else { half * half + 1.0 };
            s.points.push(Point3::new(x, y, low));
            s.points.push(Point3::new(x, y, high));
        }
    }
    let mut square = |a: u32, b: u32, c: u32, d: u32| s.triangles.extend([[a, b, c], [a, c, d]]);
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
    s
}

#[test]
fn twisted_prisms_are_filled() {
    // Schönhardt's is the one with three sides; those with more have only triangles that bend inwards as well.
    for n in 3..9 {
        for turn in [-0.5, -0.1, 0.3] {
            for height in [0.3, 1.0, 20.0] {
                fills_all(&twisted_prism(n, turn * 6.0 / f64::from(n), height));
            }
        }
    }
    assert!(fills_all(&twisted_prism(3, -0.5, 1.0)).on_segments > 0);
}

#[test]
fn thin_sheets_with_unlike_sides_are_filled() {
    for (n, thickness) in [(1, 0.1), (4, 0.1), (4, 1e-3), (6, 1e-6), (3, 1e-9)] {
        for salt in 0..3 {
            fills_all(&sheet(n, thickness, 0.0, salt));
        }
    }
    fills_all(&sheet(4, 1e-3, 1e6, 1));
}

#[test]
fn notched_boxes_are_filled() {
    for (n, gap) in [(1, 0.5), (2, 0.1), (3, 0.01)] {
        fills_all(&chazelle(n, gap));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn spheres_of_random_points_are_filled(
        raw in prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64, 0.2..1.0f64), 12..60), flat in 0.01..1.0f64
    ) {
        // The hull of random points on a sphere, then moved along their rays: star-shaped, with long thin triangles.
        let points: Vec<Point3> = raw
            .iter()
            .map(|&(x, y, z, _)| Point3::from(Vec3::new(x, y, z).normalize()))
            .collect();
        prop_assume!(points.iter().all(|p| p.x.is_finite()));
        let c = delaunay(&points).unwrap();
        let ghosts = (0..c.slots() as u32).filter(|&t| c.is_alive(t) && c.is_ghost(t));
        let triangles: Vec<[u32; 3]> = ghosts.map(|t| c.face(c.mate(4 * t + 3))).collect();
        let inside = triangles.iter().all(|t| {
            let [p, q, r] = t.map(|v| points[v as usize]);
            crate::geometry::predicates::orient3d(&Point3::origin(), &p, &q, &r) > 0.0
        });
        prop_assume!(inside);
        let moved = points.iter().zip(&raw).map(|(p, r)| {
            let p = p.coords * r.3;
            Point3::new(p.x, p.y, p.z * flat)
        });
        let used: Vec<Point3> = moved.collect();
        fills_all(&TriMesh { points: used, triangles });
    }
}

fn read_off(path: &std::path::Path) -> TriMesh {
    let text = std::fs::read_to_string(path).unwrap();
    let mut words = text.split_whitespace().skip(1);
    let mut next = || words.next().unwrap();
    let (n, m): (usize, usize) = (next().parse().unwrap(), next().parse().unwrap());
    next();
    let mut s = TriMesh::default();
    for _ in 0..n {
        let mut x = || next().parse::<f64>().unwrap();
        s.points.push(Point3::new(x(), x(), x()));
    }
    for _ in 0..m {
        next();
        let mut v = || next().parse::<u32>().unwrap();
        s.triangles.push([v(), v(), v()]);
    }
    s
}

/// All surfaces of a folder that have `ONLY` in their name, with times. By hand.
#[test]
#[ignore = "a survey of real surfaces; names in ONLY, folder in SURFACES"]
fn survey() {
    let dir = std::env::var("SURFACES").unwrap();
    let only = std::env::var("ONLY").unwrap_or_default();
    let mut files: Vec<_> = std::fs::read_dir(dir).unwrap().map(|f| f.unwrap().path()).collect();
    files.sort();
    for path in files {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        if path.extension().is_some_and(|e| e == "off") && only.split(',').any(|o| name.contains(o)) {
            let surface = read_off(&path);
            let cpu = || {
                let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
                text.split(' ').next().and_then(|x| x.parse::<f64>().ok()).unwrap_or(0.0) * 1e-9
            };
            let start = cpu();
            let result = fills(&surface);
            println!("{name:40} {:7} tris {:8.3} CPU s {result:?}", surface.triangles.len(), cpu() - start);
        }
    }
}

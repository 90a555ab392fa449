use super::perturb::in_sphere_perturbed;
use super::*;
use crate::complex::{Cell, NONE};
use anastomesh_mesh::budget::Budget;
use anastomesh_mesh::geometry::predicates::{insphere, orient3d};
use anastomesh_mesh::progress::StopsAfter;
use proptest::prelude::*;

fn check_delaunay(points: &[Point3], c: &Complex) {
    c.sanity_check().unwrap();
    for t in c.real_tets() {
        let q = c.verts(t).map(|v| &points[v as usize]);
        for (i, p) in points.iter().enumerate() {
            if c.verts(t).contains(&(i as u32)) {
                continue;
            }
            assert!(insphere(q[0], q[1], q[2], q[3], p) <= 0.0, "point {i} lies in the sphere of {t}");
            assert!(!in_sphere_perturbed(q, p), "point {i} lies in the perturbed sphere of {t}");
        }
    }
    // Euler: one ball bounded by one sphere.
    let used: std::collections::BTreeSet<u32> = c.real_tets().flat_map(|t| c.verts(t)).collect();
    assert_eq!(used.len(), points.len());
}

fn canonical(c: &Complex) -> Vec<[u32; 4]> {
    let mut tets: Vec<[u32; 4]> = c
        .real_tets()
        .map(|t| {
            let mut v = c.verts(t);
            v.sort_unstable();
            v
        })
        .collect();
    tets.sort_unstable();
    tets
}

fn hull_volume(c: &Complex) -> f64 {
    c.real_tets().map(|t| c.orient(&c.verts(t)) / 6.0).sum()
}

#[test]
fn a_cube_grid_is_filled_without_flat_tetrahedra() {
    let mut points = Vec::new();
    for i in 0..6 {
        for j in 0..6 {
            for k in 0..6 {
                points.push(Point3::new(f64::from(i), f64::from(j), f64::from(k)));
            }
        }
    }
    let c = delaunay(&points).unwrap();
    check_delaunay(&points, &c);
    assert!((hull_volume(&c) - 125.0).abs() < 1e-10);
}

#[test]
fn the_answer_does_not_depend_on_the_order_of_the_points() {
    let mut points = Vec::new();
    for i in 0..5 {
        for j in 0..4 {
            for k in 0..4 {
                points.push(Point3::new(f64::from(i), f64::from(j), f64::from(k)));
            }
        }
    }
    let n = points.len();
    let a = canonical(&delaunay(&points).unwrap());
    let reversed: Vec<Point3> = points.iter().rev().copied().collect();
    let mut b: Vec<[u32; 4]> = canonical(&delaunay(&reversed).unwrap());
    for t in &mut b {
        *t = t.map(|v| n as u32 - 1 - v);
        t.sort_unstable();
    }
    b.sort_unstable();
    assert_eq!(a, b);
}

#[test]
fn degenerate_inputs_are_typed_errors() {
    let p = |x: f64, y: f64, z: f64| Point3::new(x, y, z);
    assert!(matches!(delaunay(&[]), Err(TetError::Empty { .. })));
    let line: Vec<_> = (0..9).map(|i| p(f64::from(i), 0.0, 0.0)).collect();
    assert_eq!(delaunay(&line).unwrap_err(), TetError::Flat);
    let plane: Vec<_> = (0..9).map(|i| p(f64::from(i % 3), f64::from(i / 3), 0.0)).collect();
    assert_eq!(delaunay(&plane).unwrap_err(), TetError::Flat);
    assert_eq!(delaunay(&[p(1.0, 1.0, 1.0); 5]).unwrap_err(), TetError::Flat);
    let nan = [p(0., 0., 0.), p(1., 0., 0.), p(0., f64::NAN, 0.), p(0., 0., 1.)];
    assert!(matches!(delaunay(&nan), Err(TetError::OutOfRange { count: 1, .. })));
    let twice = [p(0., 0., 0.), p(1., 0., 0.), p(0., 1., 0.), p(0., 0., 1.), p(1., 0., 0.)];
    assert!(matches!(delaunay(&twice), Err(TetError::DuplicatePoints { pairs, count: 1, .. }) if pairs == [[1, 4]]));
}

#[test]
fn points_on_a_sphere_with_one_far_vertex() {
    // A cavity with hundreds of faces: the centre of a sphere, inserted among its points.
    let mut points = vec![Point3::new(0.0, 0.0, 0.0)];
    for i in 0..400 {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 400.0;
        let w = f64::from(i) * 2.399_963;
        let r = (1.0 - z * z).sqrt();
        points.push(Point3::new(r * libm::cos(w), r * libm::sin(w), z));
    }
    let c = delaunay(&points).unwrap();
    check_delaunay(&points, &c);
}

/// True if all points are exactly coplanar: no three vectors from the first span a volume.
fn are_coplanar(points: &[Point3]) -> bool {
    let Some((o, rest)) = points.split_first() else { return true };
    let flat = |i: usize, j: usize, k: usize| orient3d(o, &rest[i], &rest[j], &rest[k]) == 0.0;
    (0..rest.len()).all(|i| (0..i).all(|j| (0..j).all(|k| flat(i, j, k))))
}

fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![(-2i32..3).prop_map(f64::from), (-2i32..3).prop_map(|i| f64::from(i) * 0.1), -2.0..2.0f64]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn random_and_degenerate_points(raw in prop::collection::vec((coordinate(), coordinate(), coordinate()), 4..60)) {
        let points: Vec<Point3> = raw.iter().map(|&(x, y, z)| Point3::new(x, y, z)).collect();
        let repeated = (0..points.len()).filter(|&i| points[..i].contains(&points[i])).count();
        match delaunay(&points) {
            Ok(c) => {
                prop_assert_eq!(repeated, 0);
                check_delaunay(&points, &c);
            }
            Err(TetError::DuplicatePoints { count, .. }) => prop_assert_eq!(count, repeated),
            Err(TetError::Flat) => prop_assert!(are_coplanar(&points)),
            Err(e) => prop_assert!(false, "{e}"),
        }
    }

    #[test]
    fn points_on_a_line_and_one_sphere(on_line in 0usize..8, raw in prop::collection::vec((-4i32..5, -4i32..5, 0i32..2), 4..30)) {
        // Stereographic images of grid points with one denominator: many exactly cospherical points.
        let mut points: Vec<Point3> = (0..on_line).map(|i| Point3::new(i as f64 * 0.25, 0.0, 0.0)).collect();
        for (x, y, z) in raw {
            let s = if z == 0 { 1.0 } else { -1.0 };
            let p = Point3::new(f64::from(x), f64::from(y), s * f64::from(25 - x * x - y * y).max(0.0).sqrt().floor());
            if !points.contains(&p) {
                points.push(p);
            }
        }
        match delaunay(&points) {
            Ok(c) => check_delaunay(&points, &c),
            Err(e) => {
                prop_assert_eq!(e, TetError::Flat);
                prop_assert!(are_coplanar(&points));
            }
        }
    }
}

fn random_points(count: usize) -> Vec<Point3> {
    let unit = |i: u64| (hash(i) >> 11) as f64 / (1u64 << 53) as f64;
    (0..count as u64).map(|i| Point3::new(unit(3 * i), unit(3 * i + 1), unit(3 * i + 2))).collect()
}

/// Merged parts equal the tetrahedralization in one piece, in the same order for any number of threads.
#[test]
fn parts_merge_to_the_whole() {
    let grid =
        (0..8000).map(|i| Point3::new(f64::from(i % 20) * 0.1, f64::from(i / 20 % 20) * 0.1, f64::from(i / 400)));
    let shell = random_points(30_000).into_iter().map(|p| p * 2.0 - nalgebra::Vector3::repeat(1.0));
    let ball: Vec<Point3> = shell.filter(|p| p.coords.norm() < 1.0).collect();
    for (points, parts) in [(random_points(20_000), 4), (grid.collect(), 2), (ball, 3)] {
        let whole = delaunay(&points).unwrap();
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let made = pool.install(|| parallel::in_parts(&points, points.len() / parts, &Watch::NOBODY));
            made.expect("worth while").into_complex(&points)
        };
        let merged = run(1);
        merged.sanity_check().unwrap();
        assert_eq!(canonical(&whole), canonical(&merged));
        let tets = |c: &Complex| c.real_tets().map(|t| c.verts(t)).collect::<Vec<_>>();
        let first = tets(&merged);
        for threads in [2, 7] {
            assert_eq!(first, tets(&run(threads)));
        }
    }
}

/// As [`parts_merge_to_the_whole`], for few points.
#[test]
fn few_points_are_merged_from_parts() {
    let points: Vec<Point3> = random_points(3000).iter().map(|p| Point3::new(10.0 * p.x, p.y, p.z)).collect();
    let whole = delaunay(&points).unwrap();
    let merged = parallel::in_parts(&points, 1000, &Watch::NOBODY).expect("worth while").into_complex(&points);
    merged.sanity_check().unwrap();
    assert_eq!(canonical(&whole), canonical(&merged));
    assert!((0..points.len() as u32).all(|v| merged.verts(merged.vertex_tet(v)).contains(&v)));
}

#[test]
fn empty_slots_receive_the_last_tetrahedra() {
    let points = random_points(50);
    let order: Vec<u32> = (0..50).collect();
    let (cells, free) = insert_all(&points, &order, &Watch::NOBODY).unwrap().into_cells(&order);
    assert!(free.is_empty());
    let total = cells.len() as u32 + 6;
    let empty = [8, 0, total - 1, 7, 20, total - 3];
    let names: Vec<u32> = (0..total).filter(|t| !empty.contains(t)).collect();
    let mut spread = vec![Cell::EMPTY; total as usize];
    for (cell, &t) in cells.iter().zip(&names) {
        let mates = cell.mates.map(|mate| 4 * names[(mate >> 2) as usize] + (mate & 3));
        spread[t as usize] = Cell { verts: cell.verts, mates };
    }
    let compact = merge::compact(spread, empty.to_vec());
    assert_eq!(compact.len(), cells.len());
    let c = Complex::from_cells(points.clone(), compact, Vec::new(), vec![NONE; points.len()]);
    c.sanity_check().unwrap();
    assert_eq!(canonical(&c), canonical(&delaunay(&points).unwrap()));
}

#[test]
fn each_point_counts_as_20_operations() {
    let budget = Budget::new(u64::MAX);
    delaunay_watched(&random_points(2000), &Watch::NOBODY.within(&budget)).unwrap();
    // Points are counted 1024 at a time.
    assert_eq!(budget.spent(), 2 * 1024 * 20);
}

/// No split if nearly all tetrahedra cross the cut.
#[test]
fn points_on_a_sphere_stay_in_one_piece() {
    let points: Vec<Point3> = random_points(3000).iter().map(|p| p * 2.0 - nalgebra::Vector3::repeat(1.0)).collect();
    let on_sphere: Vec<Point3> = points.iter().map(|p| Point3::from(p.coords.normalize())).collect();
    assert!(parallel::in_parts(&on_sphere, 1000, &Watch::NOBODY).is_none());
}

/// Cancellation stops insertion early, in one piece and in parts.
#[test]
fn whoever_stops_it_is_heard() {
    let points = random_points(30_000);
    for times in [0, 1, 5] {
        let stops = StopsAfter::new(times);
        assert_eq!(delaunay_watched(&points, &Watch::of(&stops)).err(), Some(TetError::Cancelled));
        assert_eq!(stops.asked(), times + 1);
        let stops = StopsAfter::new(times);
        assert!(parallel::in_parts(&points, 10_000, &Watch::of(&stops)).is_none());
        assert!(stops.asked() <= times + 4, "asked {} times", stops.asked());
    }
}

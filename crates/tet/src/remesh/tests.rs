//! Tests with generated shapes.

use crate::contacts::no_contacts;
use crate::error::TetError;
use crate::input::validate;
use crate::options::{Boundary, Sizing};
use crate::plc::{InputKind, Plc};
use crate::progress::{Progress, Stage, Watch};
use crate::remesh::{Remeshed, Wanted, remesh};
use crate::{Layers, TetQuality, Tetrahedralizer};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::shapes::{banded_sphere, sphere_surface};
use std::sync::atomic::{AtomicBool, Ordering};

const DEFAULT: Wanted<'static> = Wanted { tolerance: None, size: None, longest: f64::INFINITY, most: 1_000_000 };

/// Remeshes, and checks validity, topology, tolerance and lists.
fn remeshed(plc: &Plc, kind: InputKind, wanted: &Wanted) -> Remeshed {
    let made = remesh(plc.into(), wanted, &Watch::NOBODY).expect("remeshed");
    validate(&made.plc.surface, &made.plc.segments, kind).expect("valid");
    no_contacts(&made.plc.surface, &Watch::NOBODY).expect("without self-intersections");
    assert!(made.summary.distance <= made.summary.tolerance, "{:?}", made.summary);
    assert_eq!(euler(&made.plc.surface), euler(&plc.surface));
    assert_eq!(made.origins.len(), made.plc.surface.triangles.len());
    let marker = |&t: &u32| plc.markers.get(t as usize).copied();
    assert_eq!(made.plc.markers, made.origins.iter().filter_map(marker).collect::<Vec<_>>());
    made
}

fn euler(surface: &TriMesh) -> i64 {
    let mut edges: Vec<[u32; 2]> = surface
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    let mut used: Vec<u32> = surface.triangles.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    used.len() as i64 - edges.len() as i64 + surface.triangles.len() as i64
}

fn volume(surface: &TriMesh) -> f64 {
    let corners = |t: &[u32; 3]| t.map(|v| surface.points[v as usize].coords);
    surface.triangles.iter().map(corners).map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0).sum()
}

/// Grid of quadrilaterals, each as two triangles, around an axis: closed in direction `i` and, if `is_torus`, in `j`.
fn swept(n: u32, m: u32, is_torus: bool, at: impl Fn(f64, f64) -> Point3) -> TriMesh {
    let rows = if is_torus { m } else { m + 1 };
    let mut surface = TriMesh::default();
    for j in 0..rows {
        surface.points.extend((0..n).map(|i| at(f64::from(i) / f64::from(n), f64::from(j) / f64::from(m))));
    }
    let id = |i: u32, j: u32| (j % rows) * n + i % n;
    for (i, j) in (0..m).flat_map(|j| (0..n).map(move |i| (i, j))) {
        let [a, b, c, d] = [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)];
        surface.triangles.extend([[a, b, c], [a, c, d]]);
    }
    surface
}

fn torus() -> TriMesh {
    swept(60, 10, true, |u, v| {
        let ([s, c], [t, d]) = ([u, u].map(|u| u * std::f64::consts::TAU), [v, v].map(|v| v * std::f64::consts::TAU));
        let r = 2.0 + 0.5 * libm::cos(d);
        Point3::new(r * libm::cos(c), r * libm::sin(s), 0.5 * libm::sin(t))
    })
}

/// Cylinder with long needles on its side, and fans as ends. Sides and ends have different markers.
fn cylinder() -> Plc {
    let n = 40;
    let mut surface = swept(n, 1, false, |u, v| {
        let (s, c) = libm::sincos(u * std::f64::consts::TAU);
        Point3::new(c, s, 5.0 * v)
    });
    let sides = surface.triangles.len();
    surface.points.extend([Point3::new(0.0, 0.0, 0.0), Point3::new(0.0, 0.0, 5.0)]);
    for i in 0..n {
        let j = (i + 1) % n;
        surface.triangles.extend([[2 * n, j, i], [2 * n + 1, n + i, n + j]]);
    }
    let ends = surface.triangles.len() - sides;
    let markers = std::iter::repeat_n(1, sides).chain((0..ends).map(|i| 2 + (i % 2) as i32)).collect();
    Plc::from(surface).markers(markers)
}

/// Box with one marker per side, from `min` with these lengths. One side has a fan around a point close to its edge.
fn marked_box(min: [f64; 3], lengths: [f64; 3]) -> Plc {
    let corner = |i: u32| Point3::from([0, 1, 2].map(|k| min[k] + lengths[k] * f64::from(i >> k & 1)));
    let mut points: Vec<Point3> = (0..8).map(corner).collect();
    points.push(Point3::new(min[0] + 0.6 * lengths[0], min[1] + 0.001 * lengths[1], min[2] + lengths[2]));
    let quads = [[0, 2, 3, 1], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut triangles: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    triangles.extend([[4, 5, 8], [5, 7, 8], [7, 6, 8], [6, 4, 8]]);
    let markers = (0..triangles.len() as i32).map(|i| (i / 2).min(5)).collect();
    Plc::new(points, triangles).markers(markers)
}

#[test]
fn needles_of_a_sphere_disappear() {
    let surface = banded_sphere(30);
    let plc = Plc::from(&surface);
    let made = remeshed(&plc, InputKind::Closed, &DEFAULT);
    let summary = &made.summary;
    assert!(summary.smallest_angle[0] < 6.0 && summary.smallest_angle[1] > 20.0, "{summary:?}");
    assert_eq!(summary.frozen, 0);
    let change = volume(&made.plc.surface) / volume(&surface);
    assert!((change - 1.0).abs() < 0.01, "{change}");
}

#[test]
fn a_good_surface_stays_good() {
    let plc = Plc::from(sphere_surface(4));
    let summary = remeshed(&plc, InputKind::Closed, &DEFAULT).summary;
    let [before, after] = summary.triangles.map(|n| n as f64);
    assert!(after < 1.5 * before && after > 0.5 * before, "{summary:?}");
    assert!(summary.smallest_angle[1] > 30.0, "{summary:?}");
}

#[test]
fn corners_edges_and_markers_of_a_box_stay() {
    let plc = marked_box([0.0; 3], [1.0; 3]);
    let size = |_: &Point3| 0.2;
    let wanted = Wanted { size: Some(&size), ..DEFAULT };
    let made = remeshed(&plc, InputKind::Closed, &wanted);
    assert!(made.summary.smallest_angle[0] < 0.2 && made.summary.smallest_angle[1] > 20.0, "{:?}", made.summary);
    assert!((volume(&made.plc.surface) - 1.0).abs() < 1e-9);
    for corner in &plc.surface.points[..8] {
        assert!(made.plc.surface.points.contains(corner));
    }
    for marker in 0..6 {
        let of = made.plc.surface.triangles.iter().zip(&made.plc.markers).filter(|(_, m)| **m == marker);
        let corners = |t: &[u32; 3]| t.map(|v| &made.plc.surface.points[v as usize]);
        let area: f64 = of.map(|(t, _)| super::features::area(corners(t))).sum();
        assert!((area - 1.0).abs() < 1e-9, "{marker}: {area}");
    }
}

#[test]
fn rims_of_a_cylinder_stay_sharp() {
    let plc = cylinder();
    let made = remeshed(&plc, InputKind::Closed, &Wanted { tolerance: Some(0.01), ..DEFAULT });
    assert!(made.summary.smallest_angle[1] > 15.0, "{:?}", made.summary);
    let change = volume(&made.plc.surface) / volume(&plc.surface);
    assert!((change - 1.0).abs() < 0.01, "{change}");
}

#[test]
fn a_torus_keeps_its_hole() {
    let made = remeshed(&Plc::from(torus()), InputKind::Closed, &DEFAULT);
    assert_eq!(euler(&made.plc.surface), 0);
    assert!(made.summary.smallest_angle[1] > 20.0, "{:?}", made.summary);
}

/// Boxes at x < 1 and x > 1, with a common square.
fn two_boxes() -> Plc {
    let mut points: Vec<Point3> = Vec::new();
    for x in [0.0, 1.0, 2.0] {
        points.extend([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(y, z)| Point3::new(x, y, z)));
    }
    let mut quads = vec![([0, 3, 2, 1], 1), ([4, 5, 6, 7], 2), ([8, 9, 10, 11], 3)];
    for (i, j) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
        quads.extend([([i, j, j + 4, i + 4], 4), ([i + 4, j + 4, j + 8, i + 8], 4)]);
    }
    let triangles = quads.iter().flat_map(|&([a, b, c, d], _)| [[a, b, c], [a, c, d]]).collect();
    Plc::new(points, triangles).markers(quads.iter().flat_map(|&(_, marker)| [marker; 2]).collect())
}

#[test]
fn boxes_with_a_common_face_stay_joined() {
    let plc = two_boxes();
    let size = |p: &Point3| if p.x < 1.0 { 0.2 } else { 0.3 };
    let made = remeshed(&plc, InputKind::Plc, &Wanted { size: Some(&size), ..DEFAULT });
    assert!(made.summary.smallest_angle[1] > 20.0, "{:?}", made.summary);
    let filled = Tetrahedralizer::new().kind(InputKind::Plc).run(&made.plc).expect("filled");
    assert_eq!(filled.summary.regions, 2);
}

#[test]
fn sides_closer_than_the_tolerance_stay_apart() {
    let plc = marked_box([0.0; 3], [1.0, 1.0, 0.004]);
    let size = |_: &Point3| 0.1;
    let made = remeshed(&plc, InputKind::Closed, &Wanted { tolerance: Some(0.02), size: Some(&size), ..DEFAULT });
    assert!((volume(&made.plc.surface) - 0.004).abs() < 1e-9);
    // Two concentric spheres, as one surface.
    let mut shell = banded_sphere(20);
    let inner = banded_sphere(17);
    let n = shell.points.len() as u32;
    shell.points.extend(inner.points.iter().map(|p| p * 0.97));
    shell.triangles.extend(inner.triangles.iter().map(|&[a, b, c]| [a + n, c + n, b + n]));
    let made = remeshed(&Plc::from(shell), InputKind::Closed, &Wanted { tolerance: Some(0.1), ..DEFAULT });
    assert_eq!(euler(&made.plc.surface), 4);
}

#[test]
fn results_do_not_depend_on_threads() {
    let plc = Plc::from(torus());
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| remeshed(&plc, InputKind::Closed, &DEFAULT))
    };
    let (one, three) = (run(1), run(3));
    assert_eq!(one.plc, three.plc);
    assert_eq!((one.origins, one.summary), (three.origins, three.summary));
}

#[test]
fn remeshing_stops_on_request() {
    #[derive(Default)]
    struct Stopped(AtomicBool);
    impl Progress for Stopped {
        fn at(&self, stage: Stage, _: u64, _: u64) {
            self.0.fetch_or(stage == Stage::Remesh, Ordering::Relaxed);
        }
        fn is_cancelled(&self) -> bool {
            self.0.load(Ordering::Relaxed)
        }
    }
    let run = Tetrahedralizer::new().boundary(Boundary::Remesh { tolerance: None }).progress(Stopped::default());
    assert_eq!(run.run(&banded_sphere(20)), Err(TetError::Cancelled));
}

#[test]
fn meshes_have_better_tetrahedra_and_name_their_origins() {
    let plc = cylinder();
    let run = |boundary: Boundary| Tetrahedralizer::new().boundary(boundary).run(&plc).expect("certified");
    let (kept, made) = (run(Boundary::Keep), run(Boundary::Remesh { tolerance: Some(0.01) }));
    let [before, after] = [&kept, &made].map(|made| TetQuality::of(&made.mesh));
    assert!(after.mean > before.mean + 0.1 && after.dihedral_min > before.dihedral_min, "{before:?} {after:?}");
    let change = made.summary.remesh.expect("remeshed");
    assert_eq!((made.faces.len(), made.origins.len()), (change.triangles[1], change.triangles[1]));
    assert!(made.origins.iter().zip(&made.face_markers).all(|(&t, &m)| plc.markers[t as usize] == m));
}

#[test]
fn layers_and_lengths_apply_to_the_new_surface() {
    let plc = cylinder();
    let run = Tetrahedralizer::new().boundary(Boundary::Remesh { tolerance: Some(0.01) });
    let layered = run.clone().layers(Layers::default()).run(&plc).expect("certified");
    assert!(layered.summary.layers.is_some() && layered.summary.remesh.is_some());
    let lengths = vec![0.4; plc.surface.points.len()];
    let sized = run.clone().sizing(Sizing::PerVertex(lengths)).run(&plc).expect("certified");
    assert!(sized.summary.remesh.expect("remeshed").triangles[1] > 400);
    let refused = run.boundary(Boundary::Remesh { tolerance: Some(-1.0) }).run(&plc);
    assert_eq!(refused, Err(TetError::BadSize { value: -1.0 }));
}

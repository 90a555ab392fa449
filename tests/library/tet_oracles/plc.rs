//! Piecewise linear complexes: volume, faces and regions equal TetGen's, which keeps the facets with -Y.

use super::tetgen::{points_section, volume};
use super::{recorded, tetgen};
use anastomesh::mesh::shapes::torus_surface;
use anastomesh::tet::{InputKind, Interior, Plc, Tetrahedralizer};
use anastomesh::{Point3, TriMesh, Vec3};
use std::fmt::Write as _;

const FILE: &str = "plc.txt";

/// Compared values, without tetrahedra, as a complex can be filled in many ways.
#[derive(Debug)]
struct Filled {
    /// Number of faces in facets.
    faces: usize,
    regions: usize,
    volume: f64,
}

fn ours(plc: &Plc) -> Filled {
    let run = Tetrahedralizer::new().kind(InputKind::Plc).interior(Interior::None).optimize(false).run(plc);
    let out = run.unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(out.mesh.points[..plc.surface.points.len()], plc.surface.points);
    Filled { faces: out.faces.len(), regions: out.summary.regions, volume: volume(&out.mesh) }
}

fn theirs(plc: &Plc) -> Option<Filled> {
    let mut poly = points_section(&plc.surface.points);
    let _ = writeln!(poly, "{} 0", plc.surface.triangles.len());
    for [a, b, c] in &plc.surface.triangles {
        let _ = writeln!(poly, "1\n3 {a} {b} {c}");
    }
    let _ = writeln!(poly, "{}", plc.holes.len());
    for (i, p) in plc.holes.iter().enumerate() {
        let _ = writeln!(poly, "{i} {} {} {}", p.x, p.y, p.z);
    }
    poly.push_str("0\n");
    let theirs = tetgen::run("-pYQA", "poly", poly)?;
    Some(Filled { faces: theirs.faces, regions: theirs.regions, volume: volume(&theirs.mesh) })
}

fn compare(case: &str, plc: &Plc) {
    let ours = ours(plc);
    let agree = |theirs: &Filled| {
        let same = (ours.faces, ours.regions) == (theirs.faces, theirs.regions);
        assert!(same && (ours.volume - theirs.volume).abs() < 1e-9 * theirs.volume, "{case}: {ours:?} {theirs:?}");
    };
    if let Some(theirs) = theirs(plc) {
        if recorded::recording() {
            recorded::record(FILE, case, &format!("{} {} {}", theirs.faces, theirs.regions, theirs.volume));
        }
        agree(&theirs);
    }
    let line = recorded::line(FILE, case);
    let mut words = line.split(' ');
    let mut number = || words.next().and_then(|w| w.parse::<f64>().ok()).expect("a number");
    agree(&Filled { faces: number() as usize, regions: number() as usize, volume: number() });
}

fn add(plc: &mut Plc, points: &[Point3], triangles: &[[u32; 3]]) {
    let first = plc.surface.points.len() as u32;
    plc.surface.points.extend(points);
    plc.surface.triangles.extend(triangles.iter().map(|t| t.map(|v| v + first)));
}

/// Box of twelve triangles.
fn add_box(plc: &mut Plc, low: Point3, size: Vec3) {
    let corner =
        |i: u32| low + Vec3::new(size.x * f64::from(i & 1), size.y * f64::from(i >> 1 & 1), size.z * f64::from(i >> 2));
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let halves: Vec<[u32; 3]> = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    add(plc, &(0..8).map(corner).collect::<Vec<_>>(), &halves);
}

/// Torus of `n` × `m` quadrilaterals around an axis, its tube along a unit circle.
fn add_torus(plc: &mut Plc, [n, m]: [u32; 2], tube: f64, place: impl Fn(Point3) -> Point3) {
    let TriMesh { points, triangles } = torus_surface(n, m, tube);
    add(plc, &points.into_iter().map(place).collect::<Vec<_>>(), &triangles);
}

/// Row of boxes with shared walls.
fn partitioned(cells: u32) -> Plc {
    let mut plc = Plc::default();
    for i in 0..=cells {
        let x = f64::from(i) * 1.3;
        plc.surface.points.extend([(0.0, 0.0), (1.0, 0.0), (1.0, 1.1), (0.0, 1.1)].map(|(y, z)| Point3::new(x, y, z)));
        let f = 4 * i;
        plc.surface.triangles.extend([[f, f + 1, f + 2], [f, f + 2, f + 3]]);
        for (j, k) in [(0, 1), (1, 2), (2, 3), (3, 0)] {
            if i < cells {
                plc.surface.triangles.extend([[f + j, f + k, f + k + 4], [f + j, f + k + 4, f + j + 4]]);
            }
        }
    }
    plc
}

#[test]
fn boxes() {
    let mut nested = Plc::default();
    add_box(&mut nested, Point3::origin(), Vec3::new(3.0, 3.0, 3.0));
    add_box(&mut nested, Point3::new(0.9, 1.1, 0.8), Vec3::new(1.0, 1.2, 0.7));
    compare("box-in-box", &nested);
    nested.holes.push(Point3::new(1.3, 1.5, 1.2));
    compare("box-in-box-hollow", &nested);
    compare("box-in-three", &partitioned(3));
    let mut dangling = Plc::default();
    add_box(&mut dangling, Point3::origin(), Vec3::new(2.0, 2.0, 2.0));
    let flap = [Point3::new(0.5, 0.5, 0.4), Point3::new(1.5, 0.6, 0.9), Point3::new(0.7, 1.4, 1.5)];
    add(&mut dangling, &flap, &[[0, 1, 2]]);
    compare("box-with-flap", &dangling);
}

#[test]
fn tori() {
    let mut single = Plc::default();
    add_torus(&mut single, [24, 12], 0.4, |p| p);
    compare("torus", &single);
    add_torus(&mut single, [30, 10], 0.2, |p| p);
    compare("torus-in-torus", &single);
    let mut linked = Plc::default();
    add_torus(&mut linked, [24, 10], 0.3, |p| p);
    add_torus(&mut linked, [22, 10], 0.28, |p| Point3::new(p.x + 1.0, p.z, p.y));
    compare("linked-tori", &linked);
}

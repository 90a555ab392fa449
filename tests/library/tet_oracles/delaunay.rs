//! Delaunay tetrahedralizations: the set of tetrahedra equals CGAL's, even for cospherical points, as CGAL uses the
//! same perturbation. The convex hull has the volume of CGAL's and TetGen's, and TetGen's face count.

use super::{recorded, tetgen};
use crate::common::oracle::{self, Random};
use anastomesh::Point3;
use anastomesh::testing::delaunay;
use anastomesh::tet::Tetrahedralizer;
use std::fmt::Write as _;

const FILE: &str = "delaunay.txt";
const HULLS: &str = "hull.txt";

/// Tetrahedra with ascending vertices, in ascending order, and their total volume.
#[derive(Debug, PartialEq)]
struct Answer {
    volume: f64,
    tets: Vec<[u32; 4]>,
}

impl Answer {
    fn of_ours(points: &[Point3]) -> Self {
        let complex = delaunay(points).expect("points in general position");
        complex.sanity_check().expect("a sound complex");
        let volume = complex.real_tets().map(|t| complex.orient(&complex.verts(t)) / 6.0).sum();
        let mut tets: Vec<[u32; 4]> = complex.real_tets().map(|t| complex.verts(t)).collect();
        for t in &mut tets {
            t.sort_unstable();
        }
        tets.sort_unstable();
        Self { volume, tets }
    }

    fn of_cgal(points: &[Point3]) -> Option<Self> {
        let program = oracle::cgal("delaunay")?;
        let mut input = format!("{}\n", points.len());
        for p in points {
            let _ = writeln!(input, "{} {} {}", p.x, p.y, p.z);
        }
        let text = oracle::answer(&program, input);
        let mut lines = text.lines();
        let volume = lines.next().and_then(|l| l.split(' ').nth(1)).and_then(|w| w.parse().ok()).expect("a volume");
        let tet = |line: &str| {
            let mut words = line.split(' ').map(|w| w.parse().expect("a vertex"));
            std::array::from_fn(|_| words.next().expect("four vertices"))
        };
        Some(Self { volume, tets: lines.map(tet).collect() })
    }

    /// Number of tetrahedra and an FNV-1a hash of their vertices.
    fn digest(&self) -> String {
        let step =
            |h: u64, v: u32| v.to_le_bytes().iter().fold(h, |h, &b| (h ^ u64::from(b)).wrapping_mul(0x100_0000_01b3));
        let hash = self.tets.iter().flatten().fold(0xcbf2_9ce4_8422_2325, |h, &v| step(h, v));
        format!("{} {hash:016x}", self.tets.len())
    }
}

fn compare(case: &str, points: &[Point3]) {
    let ours = Answer::of_ours(points);
    let theirs = Answer::of_cgal(points);
    if let Some(theirs) = &theirs {
        if recorded::recording() {
            recorded::record(FILE, case, &format!("{} {}", theirs.digest(), theirs.volume));
        }
        assert_eq!(ours.tets, theirs.tets, "{case}");
    }
    let line = recorded::line(FILE, case);
    let (digest, volume) = line.rsplit_once(' ').expect("a volume behind");
    assert_eq!(ours.digest(), digest, "{case}");
    let volume: f64 = volume.parse().expect("a number");
    assert!((ours.volume - volume).abs() <= 1e-12 * volume, "{case}: {} {volume}", ours.volume);
}

/// Number of triangles and volume of the convex hull, from its tetrahedra.
type Hull = (usize, f64);

fn our_hull(points: &[Point3]) -> Hull {
    let made = Tetrahedralizer::new().delaunay(points).expect("points in general position");
    (made.faces.len(), tetgen::volume(&made.mesh))
}

fn their_hull(points: &[Point3]) -> Option<Hull> {
    let theirs = tetgen::run("-Q", "node", tetgen::points_section(points))?;
    let mut faces = std::collections::HashMap::new();
    for &[a, b, c, d] in &theirs.mesh.tets {
        for mut face in [[a, b, c], [a, b, d], [a, c, d], [b, c, d]] {
            face.sort_unstable();
            *faces.entry(face).or_insert(0) += 1;
        }
    }
    Some((faces.values().filter(|&&tets| tets == 1).count(), tetgen::volume(&theirs.mesh)))
}

fn compare_hulls(case: &str, points: &[Point3]) {
    let ours = our_hull(points);
    let agree = |(faces, volume): Hull| {
        let near = (ours.1 - volume).abs() <= 1e-9 * volume;
        assert!(ours.0 == faces && near, "{case}: {ours:?}, TetGen: {faces} {volume}");
    };
    if let Some(theirs) = their_hull(points) {
        if recorded::recording() {
            recorded::record(HULLS, case, &format!("{} {}", theirs.0, theirs.1));
        }
        agree(theirs);
    }
    let line = recorded::line(HULLS, case);
    let (faces, volume) = line.split_once(' ').expect("two numbers");
    agree((faces.parse().expect("a number"), volume.parse().expect("a number")));
}

fn random(count: usize, seed: u64, place: impl Fn(&mut Random) -> Point3) -> Vec<Point3> {
    let mut random = Random(seed);
    (0..count).map(|_| place(&mut random)).collect()
}

fn in_cube(r: &mut Random) -> Point3 {
    Point3::new(r.unit(), r.unit(), r.unit())
}

fn on_sphere(r: &mut Random) -> Point3 {
    let (z, w) = (2.0 * r.unit() - 1.0, std::f64::consts::TAU * r.unit());
    let s = (1.0 - z * z).sqrt();
    Point3::new(s * w.cos(), s * w.sin(), z)
}

fn grid(n: i32, step: f64) -> Vec<Point3> {
    let places = (0..n).flat_map(|i| (0..n).flat_map(move |j| (0..n).map(move |k| [i, j, k])));
    places.map(|p| Point3::from(p.map(|x| f64::from(x) * step))).collect()
}

#[test]
fn random_points() {
    compare("cube-30", &random(30, 1, in_cube));
    compare("cube-3000", &random(3000, 2, in_cube));
    // Flattened by a factor of ten thousand, and concentrated by that factor around one corner.
    compare("slab-1000", &random(1000, 3, |r| Point3::new(r.unit(), r.unit(), 1e-4 * r.unit())));
    compare("corner-1000", &random(1000, 4, |r| in_cube(r).map(|x| x.powi(8))));
    compare("far-1000", &random(1000, 5, |r| in_cube(r).map(|x| 1e7 + x)));
}

#[test]
fn cospherical_points() {
    compare("grid-8", &grid(8, 1.0));
    compare("tenths-8", &grid(8, 0.1));
    compare("sphere-1000", &random(1000, 6, on_sphere));
    let lattice = random(400, 7, |r| in_cube(r).map(|x| (x * 30.0).floor()));
    let mut distinct: Vec<Point3> = Vec::new();
    for p in lattice {
        if !distinct.contains(&p) {
            distinct.push(p);
        }
    }
    compare("lattice-400", &distinct);
    let cylinder =
        (0..40).flat_map(|z| (0..24).map(move |a| (f64::from(a) / 24.0 * std::f64::consts::TAU, f64::from(z))));
    compare("cylinder-960", &cylinder.map(|(a, z)| Point3::new(a.cos(), a.sin(), 0.26 * z)).collect::<Vec<_>>());
}

#[test]
fn convex_hulls() {
    compare_hulls("cube-3000", &random(3000, 2, in_cube));
    compare_hulls("slab-1000", &random(1000, 3, |r| Point3::new(r.unit(), r.unit(), 1e-4 * r.unit())));
    compare_hulls("sphere-1000", &random(1000, 6, on_sphere));
    compare_hulls("grid-8", &grid(8, 1.0));
}

/// A complete recorded set, of the smallest case.
#[test]
fn the_set_of_tetrahedra() {
    let points = random(30, 1, in_cube);
    let text = |answer: &Answer| {
        answer.tets.iter().map(|[a, b, c, d]| format!("{a},{b},{c},{d}")).collect::<Vec<_>>().join(" ")
    };
    if recorded::recording()
        && let Some(theirs) = Answer::of_cgal(&points)
    {
        recorded::record(FILE, "cube-30-tets", &text(&theirs));
    }
    assert_eq!(text(&Answer::of_ours(&points)), recorded::line(FILE, "cube-30-tets"));
}

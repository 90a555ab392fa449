//! Rotated surfaces with flat parts, which are then flat up to rounding.

use super::delaunay::hash;
use super::*;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Point3, Vec3};
use nalgebra::{Quaternion, UnitQuaternion};

/// Random number generator.
pub(super) struct Rng(pub u64);

impl Rng {
    fn next(&mut self) -> u64 {
        self.0 = hash(self.0.wrapping_add(0x9e37_79b9_7f4a_7c15));
        self.0
    }

    /// Uniform in 0 to 1.
    fn share(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    fn rotation(&mut self) -> UnitQuaternion<f64> {
        let mut side = || 2.0 * self.share() - 1.0;
        UnitQuaternion::from_quaternion(Quaternion::new(side(), side(), side(), side()))
    }
}

pub(super) fn turned(mut s: TriMesh, rng: &mut Rng) -> TriMesh {
    let rotation = rng.rotation();
    for p in &mut s.points {
        *p = rotation * *p;
    }
    s
}

/// Random triangulation of a convex polygon.
fn triangulated(corners: &[u32], rng: &mut Rng, out: &mut Vec<[u32; 3]>) {
    let n = corners.len();
    if n >= 3 {
        let k = 1 + rng.below(n - 2);
        out.push([corners[0], corners[k], corners[n - 1]]);
        triangulated(&corners[..=k], rng, out);
        triangulated(&corners[k..], rng, out);
    }
}

/// A plate over a convex polygon, with independent random triangulations at top and bottom.
pub(super) fn plate(n: u32, height: f64, rng: &mut Rng) -> TriMesh {
    let mut s = TriMesh::default();
    let mut angles: Vec<f64> = (0..n).map(|i| f64::from(i) + 0.9 * rng.share()).collect();
    for a in &mut angles {
        *a *= std::f64::consts::TAU / f64::from(n);
    }
    for z in [0.0, height] {
        s.points.extend(angles.iter().map(|&a| Point3::new(libm::cos(a), libm::sin(a), z)));
    }
    let rim: Vec<u32> = (0..n).collect();
    triangulated(&rim.iter().rev().copied().collect::<Vec<_>>(), rng, &mut s.triangles);
    triangulated(&rim.iter().map(|v| v + n).collect::<Vec<_>>(), rng, &mut s.triangles);
    for i in 0..n {
        let j = (i + 1) % n;
        s.triangles.extend([[i, j, n + i], [j, n + j, n + i]]);
    }
    s
}

/// A box with each face split in two, then `times` times each triangle in four: rows of points on straight lines.
pub(super) fn rows(sides: [f64; 3], times: u32) -> TriMesh {
    let mut s = TriMesh::default();
    for k in 0..8_u32 {
        let at = |axis: usize| if k >> axis & 1 == 1 { sides[axis] } else { 0.0 };
        s.points.push(Point3::new(at(0), at(1), at(2)));
    }
    for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        s.triangles.extend([[a, b, c], [a, c, d]]);
    }
    for _ in 0..times {
        s = split(&s);
    }
    s
}

/// Splits every triangle in four.
pub(super) fn split(s: &TriMesh) -> TriMesh {
    let mut out = TriMesh { points: s.points.clone(), triangles: Vec::new() };
    let mut middles = std::collections::BTreeMap::new();
    for t in &s.triangles {
        let m: [u32; 3] = std::array::from_fn(|i| {
            let (a, b) = (t[i].min(t[(i + 1) % 3]), t[i].max(t[(i + 1) % 3]));
            *middles.entry((a, b)).or_insert_with(|| {
                out.points.push(nalgebra::center(&s.points[a as usize], &s.points[b as usize]));
                out.points.len() as u32 - 1
            })
        });
        out.triangles.extend([[t[0], m[0], m[2]], [t[1], m[1], m[0]], [t[2], m[2], m[1]], m]);
    }
    out
}

/// Fills a surface, or asserts that its self-intersection is reported. Returns true if it was filled.
fn fills(s: &TriMesh, what: &str) -> bool {
    let plc = Plc::from(s);
    let tetrahedralizer = Tetrahedralizer::new().interior(Interior::None).optimize(false);
    match tetrahedralizer.run(&plc) {
        Ok(made) => {
            assert_eq!(made.faces, s.triangles, "{what}");
            true
        }
        Err(error) => {
            assert!(tetrahedralizer.check(&plc).is_err(), "{what}: {error}");
            false
        }
    }
}

/// Number of cases of each kind; set by `TURNED_CASES=2000`.
fn cases() -> u64 {
    std::env::var("TURNED_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(40)
}

#[test]
fn turned_plates_are_filled() {
    let mut filled = 0;
    for seed in 0..cases() {
        for height in [1.0, 1e-2] {
            let mut rng = Rng(seed);
            let n = 4 + rng.below(40) as u32;
            let plate = plate(n, height, &mut rng);
            filled += u64::from(fills(&turned(plate, &mut rng), &format!("plate {seed} {n} {height}")));
        }
    }
    assert!(filled > 3 * cases() / 2, "{filled}");
}

#[test]
fn turned_plates_of_needles_are_filled() {
    for seed in 0..cases() / 10 {
        let mut rng = Rng(seed);
        let n = 300 + rng.below(300) as u32;
        let plate = plate(n, 0.2, &mut rng);
        assert!(fills(&turned(plate, &mut rng), &format!("needles {seed} {n}")));
    }
}

#[test]
fn turned_rows_of_points_are_filled() {
    for seed in 0..cases() / 4 {
        let mut rng = Rng(seed);
        let sides = [0; 3].map(|_| 0.1 + rng.share());
        let rows = rows(sides, 1 + rng.below(3) as u32);
        assert!(fills(&turned(rows, &mut rng), &format!("rows {seed}")));
    }
}

#[test]
fn turned_boxes_within_boxes_are_filled() {
    for seed in 0..cases() {
        let mut rng = Rng(seed);
        let mut all = rows([1.0, 1.2, 1.4], rng.below(3) as u32);
        let mut inner = rows([0.3, 0.4, 0.5], rng.below(2) as u32);
        let n = all.points.len() as u32;
        let aside = Vec3::new(rng.share(), rng.share(), rng.share()) * 0.6 + Vec3::repeat(0.05);
        for p in &mut inner.points {
            *p += aside;
        }
        all.points.append(&mut inner.points);
        all.triangles.extend(inner.triangles.iter().map(|&[a, b, c]| [n + a, n + c, n + b]));
        assert!(fills(&turned(all, &mut rng), &format!("boxes {seed}")));
    }
}

#[test]
fn turned_plates_as_thin_as_can_be_are_filled() {
    for seed in 0..cases() {
        let mut rng = Rng(seed);
        // From thick ones to one unit in the last place.
        let height = libm::pow(10.0_f64, -16.0 * rng.share()).max(f64::EPSILON);
        let n = 4 + rng.below(20) as u32;
        let plate = plate(n, height, &mut rng);
        fills(&turned(plate, &mut rng), &format!("thin {seed} {n} {height}"));
    }
}

#[test]
fn turned_plates_of_needles_in_single_precision_are_filled() {
    for seed in 0..cases() / 10 {
        let mut rng = Rng(seed);
        let n = 100 + rng.below(400) as u32;
        let mut plate = turned(plate(n, 0.2, &mut rng), &mut rng);
        for x in plate.points.iter_mut().flat_map(|p| p.iter_mut()) {
            *x = f64::from(*x as f32);
        }
        fills(&plate, &format!("single {seed} {n}"));
    }
}

#[test]
fn plates_of_needles_with_points_amid_their_edges_are_filled() {
    for seed in 0..cases() / 10 {
        let mut rng = Rng(seed);
        let n = 100 + rng.below(200) as u32;
        let plate = split(&plate(n, 0.2, &mut rng));
        fills(&plate, &format!("split {seed} {n}"));
        fills(&turned(plate, &mut rng), &format!("split, turned {seed} {n}"));
    }
}

/// A plate with inner points and a top that is flat up to noise.
#[test]
fn nearly_flat_discs_are_filled() {
    for seed in 0..cases() {
        let mut rng = Rng(seed);
        let n = 5 + rng.below(60) as u32;
        let noise = libm::pow(10.0_f64, -16.0 + 8.0 * rng.share());
        let mut plate = split(&plate(n, 0.3, &mut rng));
        for p in &mut plate.points {
            p.z += noise * (rng.share() - 0.5);
        }
        fills(&turned(plate, &mut rng), &format!("noise {seed} {n} {noise}"));
    }
}

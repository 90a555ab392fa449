//! Tests of trimming on tubes filled with a lattice.

use super::fixtures::{lattice_tube, lattice_tubes};
use super::trim::{TrimOptions, Trimmed, trim};
use crate::block::fixtures::{assert_mesh, boundary, closed_euler, direction, jitter, neighbours, section};
use crate::block::{CutEnd, FlattenFailure};
use crate::partition::CutId;
use anastomesh_mesh::geometry::{Point3, Tube, Vec3};
use anastomesh_mesh::quality::{tet_ratio, triangle_ratio};

fn cut_end(cut: u32, side: u8, origin: Point3, axis: Vec3, radius: f64) -> CutEnd {
    CutEnd { cut: CutId(cut), side, section: section(origin, axis, radius) }
}

fn options(edge: f64, relax: bool) -> TrimOptions {
    TrimOptions { edge, relax, depth: 2.0 }
}

/// Trims a tube. Also returns true if the wall was a manifold before (a staircase need not be).
fn trim_tube(seed: u64, rho: f64, noise: f64, relax: bool) -> (bool, Result<Trimmed, (usize, FlattenFailure)>) {
    let axis = direction(seed);
    let r = 1.0;
    let h = 2.0 * r / rho;
    let a = Point3::new(jitter(seed, 21), jitter(seed, 22), jitter(seed, 23));
    let b = a + axis * 9.0;
    let mesh = lattice_tube(&Tube { a, b, ra: r, rb: r }, h, noise, seed);
    let ends = [cut_end(0, 0, a + axis * 2.0, -axis, r), cut_end(1, 1, a + axis * 7.0, axis, r)];
    (closed_euler(&boundary(&mesh)) == Some(2), trim(&mesh, &neighbours(&mesh), &ends, &[], &options(h, relax)))
}

#[test]
fn ends_of_tubes_at_all_angles_become_flat_discs() {
    let (mut failures, mut manifolds) = (0, 0);
    for seed in 0..60 {
        let rho = 3.0 + (seed % 3) as f64;
        let (manifold, result) = trim_tube(seed, rho, 0.3, seed % 2 == 0);
        let Ok(trimmed) = result else {
            failures += 1;
            continue;
        };
        for end in &trimmed.ends {
            assert_eq!(end.check(&trimmed.mesh.points), Ok(()));
            // The surface stays near its plane.
            for &v in &end.rim {
                assert!(end.section.height(&trimmed.mesh.points[v as usize]).abs() < 1.6);
            }
        }
        if manifold {
            manifolds += 1;
            assert_mesh(&trimmed.mesh, 2);
        }
    }
    assert!(manifolds > 10, "{manifolds}");
    // A staircase of cubes is much rougher than a contoured wall.
    assert!(failures <= 3, "{failures} of 60 failed");
}

#[test]
fn relaxing_evens_the_rim_and_keeps_shapes() {
    let spread = |t: &Trimmed| -> f64 {
        let heights = |e: &crate::block::EndSurface| {
            let h = e.rim.iter().map(|&v| e.section.height(&t.mesh.points[v as usize]));
            let (l, u) = h.fold((f64::MAX, f64::MIN), |(l, u), x| (l.min(x), u.max(x)));
            u - l
        };
        t.ends.iter().map(heights).sum()
    };
    let (mut rough, mut smooth) = (0.0, 0.0);
    for seed in 0..20 {
        let (a, b) = (trim_tube(seed, 4.0, 0.2, false).1, trim_tube(seed, 4.0, 0.2, true).1);
        let (Ok(a), Ok(b)) = (a, b) else { continue };
        rough += spread(&a);
        smooth += spread(&b);
        let worst = |t: &Trimmed| {
            t.mesh.tets.iter().map(|x| tet_ratio(&x.map(|v| t.mesh.points[v as usize]))).fold(1.0, f64::min)
        };
        assert!(worst(&b) >= worst(&a).min(0.35) - 1e-12);
    }
    assert!(smooth < 0.8 * rough, "{smooth} {rough}");
}

#[test]
fn a_plane_trims_only_the_tip_of_its_own_vessel() {
    // Two parallel vessels joined at the bottom; the plane of the first intersects the second, too.
    let p = |x: f64, z: f64| Point3::new(x, 0.1, z);
    let tube = |a, b| Tube { a, b, ra: 1.0, rb: 1.0 };
    let tubes = [tube(p(0.0, 0.0), p(0.0, 9.0)), tube(p(0.0, 0.0), p(4.0, 0.0)), tube(p(4.0, 0.0), p(4.0, 9.0))];
    let h = 0.5;
    let mesh = lattice_tubes(&tubes, h, 0.2, 5);
    let ends = [cut_end(0, 0, p(0.0, 5.0), Vec3::z(), 1.0)];
    let trimmed = trim(&mesh, &neighbours(&mesh), &ends, &[], &options(h, true)).expect("flat");
    let top = |x: f64| {
        let near = trimmed.mesh.points.iter().filter(|q| (q.x - x).abs() < 1.6);
        near.map(|q| q.z).fold(f64::MIN, f64::max)
    };
    assert!(top(0.0) < 6.0, "{}", top(0.0));
    assert!(top(4.0) > 9.0);
    assert_mesh(&trimmed.mesh, 2);
}

#[test]
fn a_tip_fused_with_a_neighbour_is_told() {
    let p = |x: f64, z: f64| Point3::new(x, 0.1, z);
    let tube = |a, b| Tube { a, b, ra: 1.0, rb: 1.0 };
    let tubes = [
        tube(p(0.0, 0.0), p(0.0, 9.0)),
        tube(p(0.0, 0.0), p(6.0, 0.0)),
        tube(p(6.0, 0.0), p(6.0, 8.0)),
        tube(p(0.0, 8.0), p(6.0, 8.0)),
    ];
    let mesh = lattice_tubes(&tubes, 0.5, 0.1, 5);
    let ends = [cut_end(0, 0, p(0.0, 5.0), Vec3::z(), 1.0)];
    let result = trim(&mesh, &neighbours(&mesh), &ends, &[], &options(0.5, true));
    assert_eq!(result.err(), Some((0, FlattenFailure::LeavesVessel)));
}

#[test]
fn the_plane_that_takes_a_cap_is_blamed() {
    let axis = Vec3::z();
    let tube = Tube { a: Point3::origin(), b: Point3::new(0.0, 0.0, 9.0), ra: 1.0, rb: 1.0 };
    let mesh = lattice_tube(&tube, 0.5, 0.1, 5);
    let at = |z: f64| Point3::new(0.0, 0.0, z);
    let ends = [cut_end(4, 0, at(2.0), -axis, 1.0), cut_end(7, 1, at(7.0), axis, 1.0)];
    let farthest = |sign: f64| {
        let heights = mesh.points.iter().map(|p| sign * p.z).enumerate();
        heights.max_by(|a, b| a.1.total_cmp(&b.1)).expect("a vertex").0 as u32
    };
    let lost = |vertex: u32| trim(&mesh, &neighbours(&mesh), &ends, &[vertex], &options(0.5, true)).err();
    assert_eq!(lost(farthest(-1.0)), Some((0, FlattenFailure::LeavesVessel)));
    assert_eq!(lost(farthest(1.0)), Some((1, FlattenFailure::LeavesVessel)));
}

#[test]
fn a_plane_beyond_the_mesh_is_told() {
    let tube = Tube { a: Point3::origin(), b: Point3::new(0.0, 0.0, 6.0), ra: 1.0, rb: 1.0 };
    let mesh = lattice_tube(&tube, 0.5, 0.1, 5);
    let ends = [cut_end(0, 0, Point3::new(0.0, 0.0, 12.0), Vec3::z(), 1.0)];
    let result = trim(&mesh, &neighbours(&mesh), &ends, &[], &options(0.5, true));
    assert_eq!(result.err(), Some((0, FlattenFailure::NothingBeyond)));
}

#[test]
fn shapes_of_regular_simplices_are_one() {
    let s = 3f64.sqrt();
    let p = [
        Point3::origin(),
        Point3::new(1.0, 0.0, 0.0),
        Point3::new(0.5, s / 2.0, 0.0),
        Point3::new(0.5, s / 6.0, (2.0f64 / 3.0).sqrt()),
    ];
    assert!((tet_ratio(&p) - 1.0).abs() < 1e-12);
    assert!((tet_ratio(&[p[1], p[0], p[2], p[3]]) + 1.0).abs() < 1e-12);
    assert!((triangle_ratio(&[p[0], p[1], p[2]]) - 1.0).abs() < 1e-12);
}

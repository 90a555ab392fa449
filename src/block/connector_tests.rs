//! Connector surfaces between synthetic end surfaces.

use super::connector_surface::{ConnectorEnd, ConnectorSurface, Division, connector_surface};
use super::end_surface::EndSurface;
use super::fixtures::{assert_taken_over, flipped, jitter, section, straight, volume, wall_angle};
use super::rings::chord_factor;
use super::strip::best_strip;
use crate::partition::CutId;
use anastomesh_mesh::geometry::{Point3, Section, Vec3};

/// Fan-shaped end surface: `n` rim vertices of a circle, with radial, axial and angular noise of up to `noise` steps.
fn fan(at: &Section, side: u8, n: usize, noise: f64, seed: u64) -> (EndSurface, Vec<Point3>) {
    let (u, w) = at.frame();
    let step = std::f64::consts::TAU / n as f64;
    let mut points = vec![at.origin + at.axis * (0.1 * at.radius)];
    for i in 0..n {
        let id = i as u64;
        let a = step * (i as f64 + noise * jitter(seed, 4 * id));
        let r = at.radius * (1.0 + 0.1 * noise * jitter(seed, 4 * id + 1));
        let z = at.radius * step * noise * jitter(seed, 4 * id + 2);
        points.push(at.origin + (u * libm::cos(a) + w * libm::sin(a)) * r + at.axis * z);
    }
    let triangles = (0..n as u32).map(|i| [0, 1 + i, 1 + (i + 1) % n as u32]).collect();
    let surface = EndSurface { cut: CutId(0), side, section: *at, triangles, rim: (1..=n as u32).collect() };
    (surface, points)
}

fn join(path: &[Section], counts: [usize; 2], noise: f64, seed: u64) -> ConnectorSurface {
    let a = fan(&path[0], 0, counts[0], noise, seed);
    let b = fan(&flipped(&path[path.len() - 1]), 1, counts[1], noise, seed + 1);
    let ends = [ConnectorEnd { surface: &a.0, points: &a.1 }, ConnectorEnd { surface: &b.0, points: &b.1 }];
    let out = connector_surface(path, ends, Division::Rings(1.0)).expect("connector");
    assert_taken_over(&out, ends);
    out
}

#[test]
fn clean_rims_of_equal_count_give_good_walls() {
    for seed in 0..20 {
        let out = join(&straight(seed, 3.0, [1.0, 1.0]), [14, 14], 0.0, seed);
        assert!(wall_angle(&out) > 35.0, "{}", wall_angle(&out));
    }
}

#[test]
fn ragged_rims_and_different_counts_are_joined() {
    let mut worst = 180.0f64;
    for seed in 0..60 {
        let counts = [[10, 12], [8, 14], [20, 12], [9, 9]][seed as usize % 4];
        let out = join(&straight(seed, 2.0 + (seed % 5) as f64 * 0.7, [1.0, 0.8]), counts, 0.5, seed);
        worst = worst.min(wall_angle(&out));
    }
    assert!(worst > 15.0, "{worst}");
}

#[test]
fn the_volume_of_a_long_connector_is_that_of_its_vessel() {
    for n in [9, 12, 18] {
        let out = join(&straight(3, 40.0, [1.0, 1.0]), [n, n], 0.0, 3);
        let wanted = std::f64::consts::PI * 40.0;
        let radius_error = (volume(&out.surface) / wanted).sqrt() - 1.0;
        assert!(radius_error.abs() < 0.005, "{n}: {radius_error}");
    }
    assert!(chord_factor(6) > 1.06);
}

#[test]
fn bent_and_tapered_paths_are_followed() {
    for turn in [0.3f64, 0.8, 1.5] {
        let bend = 3.0;
        let path: Vec<Section> = (0..=8)
            .map(|i| {
                let a = turn * f64::from(i) / 8.0;
                let o = Point3::new(bend * (1.0 - libm::cos(a)), 0.0, bend * libm::sin(a));
                section(o, Vec3::new(libm::sin(a), 0.0, libm::cos(a)), 1.0 - 0.03 * f64::from(i))
            })
            .collect();
        let out = join(&path, [12, 10], 0.4, 7);
        assert!(wall_angle(&out) > 15.0, "{turn}: {}", wall_angle(&out));
    }
}

#[test]
fn a_window_too_short_for_rings_has_one_strip() {
    let out = join(&straight(5, 0.4, [1.0, 1.0]), [12, 12], 0.2, 5);
    assert_eq!(out.rings, 0);
}

#[test]
fn strips_need_two_loops() {
    let points = vec![Point3::origin(); 3];
    assert!(best_strip(&points, &[0, 1], &[0, 1, 2], Point3::origin(), Vec3::z()).is_none());
    assert!(best_strip(&points, &[0, 1, 2], &[0, 1, 2], Point3::origin(), Vec3::z()).is_none());
}

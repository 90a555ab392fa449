//! Shapes and terminals of caps.

use super::*;
use crate::check::tests::{HEIGHT, failing, tube};

/// The tube with all lengths multiplied.
fn scaled(factor: f64) -> (VolumeMesh, Expectation) {
    let (mut volume, expectation) = tube();
    volume.mesh.points.iter_mut().for_each(|p| *p *= factor);
    for cap in volume.patches.iter_mut().filter_map(|patch| patch.cap.as_mut()) {
        cap.center *= factor;
        cap.radius *= factor;
    }
    (volume, expectation)
}

#[test]
fn deviations_of_caps_are_measured_in_radii() {
    for factor in [0.125, 1.0, 8.0] {
        let (sound, expectation) = scaled(factor);
        let off_centre = |radii: f64| {
            let mut volume = sound.clone();
            volume.patches[2].cap.as_mut().unwrap().center.x = radii * factor;
            failing(&volume, &expectation)
        };
        assert_eq!((off_centre(0.09), off_centre(0.11)), (vec![], vec![Line::CapCentred]), "{factor}");
        let top = sound.mesh.points.iter().position(|p| p.z > 0.999 * HEIGHT * factor).unwrap();
        let off_plane = |radii: f64| {
            let mut volume = sound.clone();
            volume.mesh.points[top].z += 2.0 * radii * factor;
            failing(&volume, &expectation)
        };
        assert_eq!((off_plane(0.9e-9), off_plane(1.1e-9)), (vec![], vec![Line::CapFlat]), "{factor}");
    }
}

/// Triangles around a vertex, between it and consecutive vertices of a ring.
fn fan(apex: u32, ring: &[u32]) -> Vec<[u32; 3]> {
    ring.iter().zip(ring.iter().cycle().skip(1)).map(|(&a, &b)| [apex, a, b]).collect()
}

/// Band between two rings of three vertices.
fn band(low: u32, high: u32) -> Vec<[u32; 3]> {
    let sides = [[0, 1], [1, 2], [2, 0]];
    sides.iter().flat_map(|[i, j]| [[low + i, low + j, high + j], [low + i, high + j, high + i]]).collect()
}

#[test]
fn discs_are_connected_with_one_boundary_and_no_handle() {
    let tetrahedron = [[10, 11, 12], [10, 13, 11], [11, 13, 12], [12, 13, 10]];
    let discs = [vec![[0, 1, 2]], vec![[0, 1, 2], [1, 0, 3]], fan(0, &[1, 2, 3, 4, 5])];
    for disc in &discs {
        assert!(is_disc(disc), "{disc:?}");
        let with_sphere = [disc, &tetrahedron[..]].concat();
        assert!(!is_disc(&with_sphere), "{disc:?}");
    }
    // A square torus of 9 vertices.
    let id = |x: u32, y: u32| x % 3 + 3 * (y % 3);
    let cells = (0..9).map(|i| (i % 3, i / 3));
    let torus: Vec<[u32; 3]> = cells
        .flat_map(|(x, y)| {
            let [a, b, c, d] = [id(x, y), id(x + 1, y), id(x + 1, y + 1), id(x, y + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect();
    let ball_touching_itself = [fan(0, &[3, 2, 1]), band(1, 4), fan(0, &[4, 5, 6])].concat();
    let others = [
        ("nothing", vec![]),
        ("two discs", [fan(0, &[1, 2, 3]), fan(4, &[5, 6, 7])].concat()),
        ("discs with a common vertex", vec![[0, 1, 2], [0, 3, 4]]),
        ("a band", band(0, 3)),
        ("a closed surface", tetrahedron.to_vec()),
        ("a torus", torus.clone()),
        ("a torus with a hole", torus[1..].to_vec()),
        ("a closed surface that touches itself at a vertex", ball_touching_itself),
        ("different turns", vec![[0, 1, 2], [0, 1, 3]]),
        ("a copy", vec![[0, 1, 2], [1, 0, 3], [1, 0, 3]]),
        ("a sphere at an inner edge", vec![[0, 1, 2], [1, 0, 3], [0, 1, 4], [1, 0, 5], [0, 4, 5], [1, 5, 4]]),
        ("a triangle without area", vec![[0, 0, 1]]),
    ];
    for (what, triangles) in others {
        assert!(!is_disc(&triangles), "{what}");
    }
}

#[test]
fn terminals_without_cap_and_other_caps_are_listed_by_node() {
    let cap = |node| Cap { node, center: Point3::origin(), normal: Vec3::z(), radius: 1.0 };
    let wrong = |terminals: &[u32], caps: &[u32]| {
        let patch = |(id, &node): (i32, &u32)| Patch { id, name: format!("outlet_{id}"), cap: Some(cap(node)) };
        let patches: Vec<Patch> = (2..).zip(caps).map(patch).collect();
        let line = cap_per_terminal(&patches, &Expectation { loops: vec![0], terminals: terminals.to_vec() });
        assert_eq!(line.fails(), line.count > 0);
        line.offenders.iter().map(|offender| offender.ids[0]).collect::<Vec<i64>>()
    };
    assert!(wrong(&[7, 3], &[3, 7]).is_empty());
    assert_eq!(wrong(&[3, 7], &[]), [3, 7]);
    assert_eq!(wrong(&[], &[5, 4]), [4, 5]);
    assert_eq!(wrong(&[3, 7], &[7, 7, 9]), [3, 7, 9]);
    assert_eq!(wrong(&[9, 3, 5], &[5, 4]), [3, 4, 9]);
}

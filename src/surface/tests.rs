//! Tests of the whole surface stage.

use super::halfedge::HalfEdges;
use super::*;
use crate::geometry::Tube;
use proptest::prelude::*;

fn tube(a: [f64; 3], b: [f64; 3], ra: f64, rb: f64) -> Tube {
    Tube { a: Point3::from(a), b: Point3::from(b), ra, rb }
}

/// Contours a sign field on an n³ grid with an outside border.
fn contour_signs(n: usize, inside: &[bool]) -> Option<TriMesh> {
    let value = |x: contour::Node| {
        let at = x.map(|c| c - 1);
        let within = at.iter().all(|&c| c >= 0 && (c as usize) < n);
        let index = || at[0] as usize + n * (at[1] as usize + n * at[2] as usize);
        if within && inside[index()] { -1.0 } else { 1.0 }
    };
    let mut seeds = Vec::new();
    let m = n as i32 + 1;
    for x in 0..m {
        for y in 0..m {
            for z in 0..m {
                let c: Vec<bool> =
                    (0..8).map(|c| value([x + (c & 1), y + (c >> 1 & 1), z + (c >> 2 & 1)]) < 0.0).collect();
                if c.iter().any(|&s| s) && !c.iter().all(|&s| s) {
                    seeds.push([x, y, z]);
                }
            }
        }
    }
    (!seeds.is_empty()).then(|| contour::contour(&seeds, usize::MAX, value).unwrap().0)
}

fn volume(mesh: &TriMesh) -> f64 {
    mesh.triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| mesh.points[v as usize].coords);
            a.dot(&b.cross(&c)) / 6.0
        })
        .sum()
}

#[test]
fn all_256_cases_close_to_an_outward_manifold() {
    for mask in 1..256usize {
        let inside: Vec<bool> = (0..8).map(|c| mask >> c & 1 == 1).collect();
        let mesh = contour_signs(2, &inside).unwrap();
        HalfEdges::new(&mesh).unwrap_or_else(|e| panic!("case {mask}: {e:?}"));
        assert!(volume(&mesh) > 0.0, "case {mask}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn every_sign_field_gives_a_closed_manifold(inside in prop::collection::vec(prop::bool::weighted(0.5), 125)) {
        if let Some(mesh) = contour_signs(5, &inside) {
            prop_assert!(HalfEdges::new(&mesh).is_ok());
        }
    }
}

#[test]
fn straight_tube() {
    let t = [tube([0.1, 0.2, 0.3], [8.0, 3.0, 2.0], 1.0, 1.0)];
    for rho in [3.0, 4.0, 5.0] {
        let mesh = vessel_surface(&t, &SurfaceParams::with_voxel(2.0 / rho)).unwrap();
        assert!(HalfEdges::new(&mesh).is_ok());
        assert_eq!(euler_characteristic(&mesh), 2);
        assert!(volume(&mesh) > 0.0);
    }
}

//! Strip between the reduced rings of a straight tube, computed without search.

use anastomesh_mesh::geometry::{Point3, Vec3};

/// Maximum distance of a straight tube's wall from its axis, in radii.
const STRAIGHT: f64 = 1.25;

/// Triangle strip between two rings, each ordered like its surface's edges, if a straight tube connects them.
pub fn straight(points: &[Point3], rings: [&[u32]; 2]) -> Option<Vec<[u32; 3]>> {
    let [a, b] = rings.map(|ring| middle(points, ring));
    let axis = b - a;
    let length = axis.norm();
    let radius =
        |ring: &[u32], centre: &Point3| ring.iter().map(|&v| (points[v as usize] - centre).norm()).fold(0.0, f64::max);
    let radii = [radius(rings[0], &a), radius(rings[1], &b)];
    let is_near = |p: &Point3| {
        let t = ((p - a).dot(&axis) / (length * length)).clamp(0.0, 1.0);
        (p - (a + axis * t)).norm() <= STRAIGHT * (radii[0] + t * (radii[1] - radii[0]))
    };
    (length > 0.0 && points.iter().all(is_near)).then(|| strip(points, rings, [a, b]))
}

fn middle(points: &[Point3], ring: &[u32]) -> Point3 {
    let sum: Vec3 = ring.iter().map(|&v| points[v as usize].coords).sum();
    Point3::from(sum / ring.len() as f64)
}

/// Both rings follow the surface orientation, so they run in opposite directions around the axis.
fn strip(points: &[Point3], [first, second]: [&[u32]; 2], [a, b]: [Point3; 2]) -> Vec<[u32; 3]> {
    let other: Vec<u32> = second.iter().rev().copied().collect();
    let start = points[first[0] as usize] - a;
    let off = |&i: &usize| ((points[other[i] as usize] - b) - start).norm_squared();
    let shift = (0..other.len()).min_by(|i, j| off(i).total_cmp(&off(j))).unwrap_or(0);
    let [n, m] = [first.len(), other.len()];
    let at = |i: usize| first[i % n];
    let beside = |j: usize| other[(j + shift) % m];
    let (mut i, mut j) = (0, 0);
    let mut triangles = Vec::with_capacity(n + m);
    while i < n || j < m {
        // The ring that is behind advances.
        if j == m || (i < n && (i + 1) * m <= (j + 1) * n) {
            triangles.push([at(i), at(i + 1), beside(j)]);
            i += 1;
        } else {
            triangles.push([beside(j + 1), beside(j), at(i)]);
            j += 1;
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::rings::rings;
    use std::f64::consts::TAU;

    /// Two rings of opposite direction with these corner counts, and the surface between them.
    fn ends(corners: [u32; 2], bend: f64) -> (Vec<Point3>, [Vec<u32>; 2]) {
        let ring = |count: u32, z: f64, x: f64| {
            (0..count).map(move |i| {
                let (sin, cos) = libm::sincos(TAU * f64::from(i) / f64::from(count));
                Point3::new(x + cos, sin, z)
            })
        };
        let points = ring(corners[0], 0.0, 0.0).chain(ring(corners[1], 9.0, 0.0)).chain(ring(5, 4.5, bend)).collect();
        let second = (corners[0]..corners[0] + corners[1]).rev().collect();
        (points, [(0..corners[0]).collect(), second])
    }

    #[test]
    fn a_strip_has_both_rings_and_faces_outwards() {
        for corners in [[3, 3], [5, 8], [24, 3]] {
            let (points, [a, b]) = ends(corners, 0.0);
            let triangles = straight(&points, [&a, &b]).unwrap();
            assert_eq!(triangles.len() as u32, corners[0] + corners[1]);
            let mut found: Vec<usize> = rings(&triangles).iter().map(Vec::len).collect();
            found.sort_unstable();
            let mut expected = corners.map(|n| n as usize);
            expected.sort_unstable();
            assert_eq!(found, expected);
            for t in triangles {
                let [p, q, r] = t.map(|v| points[v as usize]);
                let outwards = (p.coords + q.coords + r.coords).component_mul(&Vec3::new(1.0, 1.0, 0.0));
                assert!((q - p).cross(&(r - p)).dot(&outwards) > 0.0, "{t:?}");
            }
        }
    }

    #[test]
    fn what_is_bent_is_no_straight_tube() {
        let (points, [a, b]) = ends([6, 6], 0.6);
        assert_eq!(straight(&points, [&a, &b]), None);
    }
}

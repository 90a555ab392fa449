//! Clearance inside a general surface: half of the width across, from each vertex.

use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Aabb, Bvh, Point3, Vec3};

/// Length of the first step of a ray, in mean edge lengths of the surface, and growth factor of the steps.
const STEP: f64 = 2.0;
const LONGER: f64 = 1.5;

/// Half the distance from each vertex to the opposite surface, along unit vectors `ways`; zero where the vector is.
pub(super) fn half_widths(surface: &TriMesh, ways: &[Vec3]) -> Vec<f64> {
    let corners = |t: &[u32; 3]| t.map(|v| &surface.points[v as usize]);
    let boxes: Vec<Aabb> = surface.triangles.iter().map(|t| Aabb::of_points(corners(t))).collect();
    let tree = Bvh::new(&boxes);
    let whole = boxes.iter().fold(Aabb::EMPTY, |sum, aabb| sum.union(aabb));
    let (first, furthest) = (STEP * surface.mean_edge(), (whole.max - whole.min).norm());
    let across = |v: u32, from: &Point3, way: &Vec3| {
        let (mut begin, mut step) = (0.0, first);
        while begin < furthest {
            let end = begin + step;
            let mut nearest = f64::INFINITY;
            tree.query(&Aabb::of_points([&(from + way * begin), &(from + way * end)]), |t| {
                let triangle = &surface.triangles[t as usize];
                if !triangle.contains(&v) {
                    nearest = hit(from, way, corners(triangle)).map_or(nearest, |at| nearest.min(at));
                }
            });
            if nearest <= end {
                return nearest;
            }
            (begin, step) = (end, step * LONGER);
        }
        furthest
    };
    let half = |(v, (from, way)): (u32, (&Point3, &Vec3))| {
        if *way == Vec3::zeros() { 0.0 } else { 0.5 * across(v, from, way) }
    };
    (0..).zip(surface.points.iter().zip(ways)).map(half).collect()
}

/// Distance along a ray to a triangle, edges included (Möller, Trumbore 1997). Rounding is acceptable here.
fn hit(from: &Point3, way: &Vec3, [a, b, c]: [&Point3; 3]) -> Option<f64> {
    let (u, v) = (b - a, c - a);
    let p = way.cross(&v);
    let det = u.dot(&p);
    if det == 0.0 {
        return None;
    }
    let from_a = from - a;
    let x = from_a.dot(&p) / det;
    let q = from_a.cross(&u);
    let y = way.dot(&q) / det;
    let at = v.dot(&q) / det;
    (x >= 0.0 && y >= 0.0 && x + y <= 1.0 && at > 0.0).then_some(at)
}

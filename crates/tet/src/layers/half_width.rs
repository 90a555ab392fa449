//! Clearance inside a general surface: half of the width across, from each vertex.

use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Aabb, Bvh, Point3, Vec3};
use rayon::prelude::*;

/// Length of the first step of a ray, in mean edge lengths of the surface, and growth factor of the steps.
const STEP: f64 = 2.0;
const LONGER: f64 = 1.5;

/// Half the distance from each vertex to the opposite surface, along unit vectors `ways`; zero where the vector is.
pub(super) fn half_widths(surface: &TriMesh, ways: &[Vec3]) -> Vec<f64> {
    let furthest = extent(&surface.points);
    clear_widths(surface, ways, |_| furthest).into_iter().map(|width| 0.5 * width).collect()
}

/// Distance from each vertex to the opposite surface along unit vectors `ways`, up to a maximum. Zero where the vector
/// is. `ways` may end before the vertices.
pub fn clear_widths(surface: &TriMesh, ways: &[Vec3], most: impl Fn(usize) -> f64 + Sync) -> Vec<f64> {
    let corners = |t: &[u32; 3]| t.map(|v| &surface.points[v as usize]);
    let boxes: Vec<Aabb> = surface.triangles.par_iter().map(|t| Aabb::of_points(corners(t))).collect();
    let tree = Bvh::of(boxes);
    let first = STEP * surface.mean_edge();
    let across = |v: u32, from: &Point3, way: &Vec3, furthest: f64| {
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
                return nearest.min(furthest);
            }
            (begin, step) = (end, step * LONGER);
        }
        furthest
    };
    let width = |v: usize| {
        let way = &ways[v];
        if *way == Vec3::zeros() { 0.0 } else { across(v as u32, &surface.points[v], way, most(v)) }
    };
    (0..ways.len()).into_par_iter().map(width).collect()
}

/// Diagonal of the bounding box.
fn extent(points: &[Point3]) -> f64 {
    let all = Aabb::of_points(points);
    (all.max - all.min).norm()
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

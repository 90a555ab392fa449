//! Outward directions at the vertices of a wall. At rims they lie in the plane of the cap.

use super::shell::of_caps;
use crate::layers::Directions;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Point3, Vec3};

/// Minimum cosine between a direction in the plane of a cap and the normals of the wall. The wall behind a cap may rise
/// above its plane, where a tip ends inside a fork; the ring is not flat there.
const STEEP: f64 = 0.25;
/// Shares of the wall's own direction that are added to one that is not steep enough.
const TURNED: [f64; 3] = [0.5, 1.0, 2.0];

/// Unit vectors that lead away from a wall, whose triangles are seen from inside. At the rim of a cap they lie in its plane.
/// Also returns the normals of these planes, zero for other vertices.
pub(super) fn directions(surface: &TriMesh, wall: &[[u32; 3]], caps: &[Option<u32>]) -> [Vec<Vec3>; 2] {
    let mut ways = Directions::new(&surface.points, wall);
    let mut is_held = vec![false; surface.points.len()];
    let mut planes = vec![Vec3::zeros(); surface.points.len()];
    for (_, triangles) in of_caps(surface, caps) {
        let (centre, normal) = plane(&surface.points, &triangles);
        for v in triangles.into_iter().flatten().map(|v| v as usize) {
            is_held[v] = true;
            // Vertices inside the cap have no triangle of the wall.
            if ways.ways[v] == Vec3::zeros() {
                continue;
            }
            let way = surface.points[v] - centre;
            let flat = (way - normal * way.dot(&normal)).try_normalize(0.0).unwrap_or_default();
            let is_steep = |way: &Vec3| ways.steepness(v, way) >= STEEP;
            if is_steep(&flat) {
                planes[v] = normal;
                ways.ways[v] = flat;
            } else {
                let own = ways.ways[v];
                let between = TURNED.into_iter().filter_map(|share| (flat + own * share).try_normalize(0.0));
                ways.ways[v] = between.into_iter().find(is_steep).unwrap_or(own);
            }
        }
    }
    ways.smooth(wall, &is_held);
    [ways.ways, planes]
}

/// Centre of area and unit normal of a cap.
fn plane(points: &[Point3], triangles: &[[u32; 3]]) -> (Point3, Vec3) {
    let (mut area, mut moment, mut total) = (Vec3::zeros(), Vec3::zeros(), 0.0);
    for triangle in triangles {
        let [a, b, c] = triangle.map(|v| points[v as usize]);
        let normal = (b - a).cross(&(c - a));
        area += normal;
        total += normal.norm();
        moment += (a.coords + b.coords + c.coords) * (normal.norm() / 3.0);
    }
    let centre = if total > 0.0 { moment / total } else { Vec3::zeros() };
    (Point3::from(centre), area.try_normalize(0.0).unwrap_or_default())
}

//! Outward directions at the vertices of a wall, in the plane of the cap at its rims.

use super::of_caps;
use crate::layers::Directions;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Point3, Vec3};

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
            planes[v] = normal;
            let way = surface.points[v] - centre;
            // Vertices inside the cap have no triangle of the wall.
            if ways.ways[v] != Vec3::zeros() {
                ways.ways[v] = (way - normal * way.dot(&normal)).try_normalize(0.0).unwrap_or_default();
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

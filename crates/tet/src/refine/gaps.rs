//! Local feature size: distance between opposite walls, measured along the normals of a surface.

use super::wall::Wall;
use crate::plc::InputKind;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Aabb, Bvh, Point3, Vec3};

/// Edge lengths wanted across a gap between two walls.
const ACROSS: f64 = 3.0;

/// Minimum size in a gap, relative to the edge length of its walls. The given triangles leave no better shapes there.
const LEAST: f64 = 0.6;

/// Margin of a triangle, in barycentric coordinates.
const MARGIN: f64 = 1e-9;

/// Limits the edge lengths at the vertices of a wall to a share of the distance to the opposite wall.
pub fn limit_by_gaps(wall: &mut Wall) {
    let Wall { surface, kind, baffles, bvh, sizes, .. } = wall;
    for ((v, normal), h) in (0..).zip(normals(surface)).zip(sizes) {
        let Some(normal) = normal.try_normalize(0.0).filter(|_| *h > 0.0) else { continue };
        let both = [-normal, normal];
        let directions = if *kind == InputKind::Closed && *baffles == 0 { &both[..1] } else { &both };
        let reach = ACROSS * *h;
        let gap = directions.iter().map(|d| gap(surface, bvh, v, d * reach)).fold(1.0, f64::min);
        *h *= gap.max(LEAST);
    }
}

/// Part of a segment that begins at a vertex, up to the first triangle that does not have the vertex; at most 1.
fn gap(surface: &TriMesh, bvh: &Bvh, v: u32, reach: Vec3) -> f64 {
    let p = surface.points[v as usize];
    let end = p + reach;
    let mut first = 1.0;
    bvh.query(&Aabb { min: p.inf(&end), max: p.sup(&end) }, |t| {
        let t = surface.triangles[t as usize];
        if !t.contains(&v) {
            let part = crossing(&p, &reach, t.map(|w| &surface.points[w as usize]));
            first = part.filter(|&x| x > 0.0).map_or(first, |x| x.min(first));
        }
    });
    first
}

/// Parameter at which a segment crosses a triangle.
/// (Möller, Trumbore, 'Fast, minimum storage ray-triangle intersection', 1997.)
fn crossing(p: &Point3, reach: &Vec3, [a, b, c]: [&Point3; 3]) -> Option<f64> {
    let (e, f, s) = (b - a, c - a, p - a);
    let h = reach.cross(&f);
    let determinant = e.dot(&h);
    if determinant == 0.0 {
        return None;
    }
    let u = s.dot(&h) / determinant;
    let q = s.cross(&e);
    let w = reach.dot(&q) / determinant;
    // The margin catches rays along an edge.
    let inside = u >= -MARGIN && w >= -MARGIN && u + w <= 1.0 + MARGIN;
    inside.then(|| f.dot(&q) / determinant)
}

/// Sum of the normals of the triangles at each vertex, weighted by area.
fn normals(surface: &TriMesh) -> Vec<Vec3> {
    let mut normals = vec![Vec3::zeros(); surface.points.len()];
    for t in &surface.triangles {
        let [a, b, c] = t.map(|v| surface.points[v as usize]);
        let normal = (b - a).cross(&(c - a));
        for v in t {
            normals[*v as usize] += normal;
        }
    }
    normals
}

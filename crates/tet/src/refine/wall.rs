//! Position of points relative to a surface: inside or outside, and far enough from it.

use super::sizes::vertex_sizes;
use crate::plc::InputKind;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Aabb, Bvh, Point3, Vec3, point_triangle};

/// Surface with a bounding volume hierarchy of its triangles.
#[derive(Debug)]
pub struct Wall<'a> {
    pub surface: &'a TriMesh,
    pub kind: InputKind,
    /// Number of last triangles of a closed surface that lie inside and separate nothing.
    pub baffles: usize,
    /// Height wanted for the first tetrahedra at each vertex; may be empty.
    pub heights: &'a [f64],
    pub bvh: Bvh,
    /// Edge length at each vertex.
    pub sizes: Vec<f64>,
    /// Minimum distance of points, in edge lengths.
    pub clearance: f64,
}

impl<'a> Wall<'a> {
    /// Wall whose sizes are the edge lengths of the surface.
    pub fn new(surface: &'a TriMesh, kind: InputKind, clearance: f64) -> Self {
        let boxes = surface.triangles.iter().map(|t| Aabb::of_points(t.map(|v| &surface.points[v as usize]))).collect();
        Self { surface, kind, baffles: 0, heights: &[], bvh: Bvh::of(boxes), sizes: vertex_sizes(surface), clearance }
    }

    /// True if a point lies inside, or may do so in a complex of facets.
    pub fn holds(&self, p: &Point3) -> bool {
        match self.kind {
            InputKind::Closed => self.is_odd(p),
            InputKind::Plc => self.is_enclosed(p),
        }
    }

    /// True if rays along all axes meet a facet.
    fn is_enclosed(&self, p: &Point3) -> bool {
        (0..6).all(|i| {
            let axis = i / 2;
            let mut end = *p;
            end[axis] = if i % 2 == 0 { f64::NEG_INFINITY } else { f64::INFINITY };
            self.bvh.any(&Aabb { min: p.inf(&end), max: p.sup(&end) }, |t| {
                let [a, b, c] = self.surface.triangles[t as usize].map(|v| self.surface.points[v as usize] - p);
                let (x, y) = ((axis + 1) % 3, (axis + 2) % 3);
                let side = |u: &Vec3, v: &Vec3| u[x] * v[y] - u[y] * v[x];
                let (w, u, v) = (side(&a, &b), side(&b, &c), side(&c, &a));
                (w >= 0.0 && u >= 0.0 && v >= 0.0) || (w <= 0.0 && u <= 0.0 && v <= 0.0)
            })
        })
    }

    /// True if a vertical ray meets an odd number of triangles. A ray that grazes an edge may give a wrong result; carving
    /// drops such points.
    fn is_odd(&self, p: &Point3) -> bool {
        let mut top = *p;
        top.z = f64::INFINITY;
        let mut odd = false;
        let boundary = self.surface.triangles.len().saturating_sub(self.baffles);
        self.bvh.query(&Aabb { min: *p, max: top }, |t| {
            if t as usize >= boundary {
                return;
            }
            let [a, b, c] = self.surface.triangles[t as usize].map(|v| self.surface.points[v as usize] - p);
            let side = |u: &Vec3, v: &Vec3| u.x * v.y - u.y * v.x;
            let (w, u, v) = (side(&a, &b), side(&b, &c), side(&c, &a));
            let hit = (w > 0.0 && u > 0.0 && v > 0.0) || (w < 0.0 && u < 0.0 && v < 0.0);
            odd ^= hit && (u * a.z + v * b.z + w * c.z) / (u + v + w) > 0.0;
        });
        odd
    }

    /// True if a point is far enough from the wall. `side` is that of its smallest cube.
    pub fn is_clear(&self, p: &Point3, side: f64) -> bool {
        let reach = self.clearance * 2.0 * side;
        !self.bvh.any(&Aabb { min: *p, max: *p }.grown(reach), |t| {
            let t = self.surface.triangles[t as usize];
            let corners = t.map(|v| self.surface.points[v as usize]);
            let (foot, distance) = point_triangle(p, corners.each_ref());
            distance < self.clearance * self.size_on(&t, &corners, &foot).min(2.0 * side)
        })
    }

    /// Edge length at a point of a triangle, interpolated from its corners.
    fn size_on(&self, t: &[u32; 3], corners: &[Point3; 3], foot: &Point3) -> f64 {
        let [h0, h1, h2] = t.map(|v| self.sizes.get(v as usize).copied().unwrap_or(0.0));
        let [a, b, c] = corners.map(|p| p - foot);
        let normal = (b - a).cross(&(c - a));
        let total = normal.norm_squared();
        if total == 0.0 {
            return h0.min(h1).min(h2);
        }
        let part = |u: &Vec3, v: &Vec3| (u.cross(v).dot(&normal) / total).clamp(0.0, 1.0);
        part(&b, &c) * h0 + part(&c, &a) * h1 + part(&a, &b) * h2
    }
}

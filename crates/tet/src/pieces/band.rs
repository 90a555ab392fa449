//! The part of a surface near a plane, in a box.

use super::plane::Plane;
use crate::refine::vertex_sizes;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Aabb, Point3};
use rustc_hash::{FxHashMap, FxHashSet};

/// Distance from the plane up to which a triangle belongs to the band, in its longest edges.
const REACH: f64 = 3.0;

/// Margin of the box, relative to its size.
const MARGIN: f64 = 0.05;

/// Triangles near a plane, in a box.
pub(super) struct Band {
    /// Triangles of the surface in the band, with the sides of a box around them at the end.
    pub boxed: TriMesh,
    /// Triangle of the surface that each one is.
    pub triangles: Vec<u32>,
    /// Point of the surface that each point is.
    pub points: Vec<u32>,
    /// Edge lengths on the plane that are due to the rest of the surface.
    pub sources: Vec<(Point3, f64)>,
    bounds: Aabb,
}

/// Edge lengths on a plane that grow from the points of a surface. Of points with about the same length and place, one is
/// kept.
fn sources(surface: &TriMesh, plane: Plane, slope: f64) -> Vec<(Point3, f64)> {
    let mut seen: FxHashSet<(i32, [i32; 3])> = FxHashSet::default();
    let mut kept = Vec::new();
    for (p, h) in surface.points.iter().zip(vertex_sizes(surface)).filter(|(_, h)| *h > 0.0) {
        let length = h + slope * plane.distance(p).abs();
        let on = plane.project(p);
        let level = libm::log2(0.5 * length).ceil() as i32;
        let side = libm::exp2(f64::from(level));
        if seen.insert((level, [on.x, on.y, on.z].map(|x| (x / side).floor() as i32))) {
            kept.push((on, length));
        }
    }
    kept
}

impl Band {
    pub fn of(surface: &TriMesh, plane: Plane, slope: f64) -> Self {
        let is_near = |t: &[u32; 3]| {
            let corners = t.map(|v| surface.points[v as usize]);
            let [x, y, z] = corners.map(|p| plane.distance(&p));
            let (low, high) = (x.min(y).min(z), x.max(y).max(z));
            let [a, b, c] = corners;
            let longest = (a - b).norm().max((b - c).norm()).max((c - a).norm());
            low <= REACH * longest && high >= -REACH * longest
        };
        let near = |(i, t): (u32, &[u32; 3])| is_near(t).then_some(i);
        let triangles: Vec<u32> = (0..).zip(&surface.triangles).filter_map(near).collect();
        let mut points: Vec<u32> = triangles.iter().flat_map(|&t| surface.triangles[t as usize]).collect();
        points.sort_unstable();
        points.dedup();
        let number: FxHashMap<u32, u32> = points.iter().copied().zip(0..).collect();
        let local = |t: &u32| surface.triangles[*t as usize].map(|v| number[&v]);
        let mut boxed = TriMesh {
            points: points.iter().map(|&v| surface.points[v as usize]).collect(),
            triangles: triangles.iter().map(local).collect(),
        };
        let tight = Aabb::of_points(&boxed.points);
        let bounds = tight.grown(MARGIN * (tight.max - tight.min).norm());
        add_box(&mut boxed, &bounds);
        Self { boxed, triangles, points, sources: sources(surface, plane, slope), bounds }
    }

    /// True if a point lies in the box, with some distance to its sides.
    pub fn contains(&self, p: &Point3) -> bool {
        let inner = self.bounds.grown(-0.2 * MARGIN * (self.bounds.max - self.bounds.min).norm());
        (0..3).all(|i| inner.min[i] < p[i] && p[i] < inner.max[i])
    }
}

/// Adds the sides of a box.
fn add_box(surface: &mut TriMesh, bounds: &Aabb) {
    let first = surface.points.len() as u32;
    let ends = [bounds.min, bounds.max];
    surface.points.extend((0..8).map(|i: usize| Point3::new(ends[i & 1].x, ends[(i >> 1) & 1].y, ends[i >> 2].z)));
    let sides: [[u32; 4]; 6] = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    for [a, b, c, d] in sides.map(|side| side.map(|v| first + v)) {
        surface.triangles.extend([[a, b, c], [a, c, d]]);
    }
}

//! Input surface of the remeshing: its smooth patches, their normals, and closest points on them.

use super::features::{self, Features};
use crate::plc::PlcRef;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Aabb, Bvh, Point3, Vec3, point_triangle};

/// Minimum cosine between the normals of a triangle and of the input there: 45°, a little more than the angle of features.
const COMPATIBLE: f64 = 0.7;

/// Doublings of the radius of a search for the closest point.
const WIDER: usize = 5;

/// Maximum length of pieces of triangles in the search tree, as a share of the diagonal, and maximum bisections of a
/// triangle. More pieces cost more than they save on the shared surfaces.
const PIECES: f64 = 64.0;
const DEPTH: u32 = 8;

/// Input surface, with the tolerance of each triangle.
pub(super) struct Reference<'a> {
    pub plc: PlcRef<'a>,
    pub features: Features,
    /// Unit normal of each triangle; that of its neighbours for a triangle flatter than the tolerance.
    pub normals: Vec<Vec3>,
    /// Allowed distance from each triangle, and of each point.
    pub allowed: Vec<f64>,
    pub allowed_points: Vec<f64>,
    tree: Bvh,
    /// Triangle of each box of the tree. Long triangles have several.
    owners: Vec<u32>,
    tolerance: f64,
}

impl<'a> Reference<'a> {
    pub fn new(plc: PlcRef<'a>, tolerance: f64) -> Self {
        let surface = plc.surface;
        let (boxes, owners) = boxes(surface);
        let (features, normals) = features::find(plc, tolerance);
        let allowed = vec![tolerance; surface.triangles.len()];
        let allowed_points = vec![tolerance; surface.points.len()];
        Self { plc, features, normals, allowed, allowed_points, tree: Bvh::of(boxes), owners, tolerance }
    }

    /// Sets the allowed distances: the tolerance, but at most `most` at each point, times the factor of each triangle.
    pub fn allow(&mut self, most: &[f64], factors: &[f64]) {
        self.allowed_points.iter_mut().zip(most).for_each(|(allowed, most)| *allowed = most.min(self.tolerance));
        for ((t, factor), allowed) in self.plc.surface.triangles.iter().zip(factors).zip(&mut self.allowed) {
            // Needles may have one corner in a fine part.
            let coarsest = t.iter().map(|&v| most[v as usize]).fold(0.0, f64::max);
            *allowed = factor * coarsest.min(self.tolerance);
            for &v in t {
                let least = &mut self.allowed_points[v as usize];
                *least = least.min(factor * self.tolerance);
            }
        }
    }

    pub fn corners(&self, t: u32) -> [&Point3; 3] {
        self.plc.surface.triangles[t as usize].map(|v| &self.plc.surface.points[v as usize])
    }

    /// Input triangles with boxes that overlap a box; some several times.
    pub fn query(&self, aabb: &Aabb, mut found: impl FnMut(u32)) {
        self.tree.query(aabb, |i| found(self.owners[i as usize]));
    }

    /// True if a triangle has the given patch and about the given normal.
    fn is_compatible(&self, t: u32, normal: &Vec3, patch: u32) -> bool {
        self.features.patches[t as usize] == patch && normal.dot(&self.normals[t as usize]) > COMPATIBLE
    }

    /// Input triangle of a patch, with a compatible normal, within its tolerance of a point. Triangles of `hints` are tried first.
    pub fn within(&self, p: &Point3, normal: &Vec3, patch: u32, hints: &[u32]) -> Option<u32> {
        let fits = |t: u32| {
            self.is_compatible(t, normal, patch) && point_triangle(p, self.corners(t)).1 <= self.allowed[t as usize]
        };
        if let Some(&t) = hints.iter().find(|&&t| fits(t)) {
            return Some(t);
        }
        let radius = hints.iter().map(|&t| 2.0 * self.allowed[t as usize]).fold(0.0, f64::max).min(self.tolerance);
        let mut found: Option<u32> = None;
        self.query(&Aabb::of_points([p]).grown(radius), |t| {
            if found.is_none_or(|best| t < best) && fits(t) {
                found = Some(t);
            }
        });
        found
    }

    /// Closest point of a patch with compatible normals, and its triangle.
    pub fn project(&self, p: &Point3, normal: &Vec3, patch: u32, hints: &[u32]) -> Option<(Point3, u32)> {
        let mut best: Option<(f64, u32, Point3)> = None;
        let mut consider = |t: u32| {
            if self.is_compatible(t, normal, patch) {
                let (q, distance) = point_triangle(p, self.corners(t));
                if best.is_none_or(|(least, id, _)| (distance, t) < (least, id)) {
                    best = Some((distance, t, q));
                }
            }
            best.map(|(distance, ..)| distance)
        };
        let mut near = None;
        for &t in hints {
            near = consider(t).or(near);
        }
        if let Some(radius) = near {
            self.query(&Aabb::of_points([p]).grown(radius), |t| {
                consider(t);
            });
        } else {
            let mut radius = self.tolerance;
            for _ in 0..WIDER {
                let mut found = None;
                self.query(&Aabb::of_points([p]).grown(radius), |t| found = consider(t));
                if found.is_some_and(|distance| distance <= radius) {
                    break;
                }
                radius *= 2.0;
            }
        }
        best.map(|(_, t, q)| (q, t))
    }

    /// Distance of a point from the surface, which is at most that from the triangle `hint`.
    pub fn distance(&self, p: &Point3, hint: u32) -> f64 {
        let mut least = point_triangle(p, self.corners(hint)).1;
        self.query(&Aabb::of_points([p]).grown(least), |t| least = least.min(point_triangle(p, self.corners(t)).1));
        least
    }
}

/// Boxes of pieces of the triangles, each with its triangle. Boxes of whole needles would overlap most others.
fn boxes(surface: &TriMesh) -> (Vec<Aabb>, Vec<u32>) {
    let all = Aabb::of_points(&surface.points);
    let longest = all.diagonal() / PIECES;
    let (mut boxes, mut owners) = (Vec::new(), Vec::new());
    for (t, corners) in (0..).zip(&surface.triangles) {
        let mut pieces = vec![(corners.map(|v| surface.points[v as usize]), 0)];
        while let Some(([a, b, c], depth)) = pieces.pop() {
            let sides = [(b - c).norm(), (c - a).norm(), (a - b).norm()];
            let k = (0..3).max_by(|&i, &j| sides[i].total_cmp(&sides[j])).unwrap_or(0);
            if sides[k] <= longest || depth == DEPTH {
                boxes.push(Aabb::of_points([&a, &b, &c]));
                owners.push(t);
                continue;
            }
            let [p, q, r] = [[a, b, c], [b, c, a], [c, a, b]][k];
            let middle = nalgebra::center(&q, &r);
            // A rounded middle lies in the box of both ends, so the boxes leave no gap beyond roundoff.
            pieces.extend([([p, q, middle], depth + 1), ([p, middle, r], depth + 1)]);
        }
    }
    (boxes, owners)
}

/// Distance of a point from the closest triangle of a tree; it is at most that of `hint`.
pub(super) fn nearest<'a>(tree: &Bvh, p: &Point3, hint: u32, corners: impl Fn(u32) -> [&'a Point3; 3]) -> f64 {
    let mut least = point_triangle(p, corners(hint)).1;
    tree.query(&Aabb::of_points([p]).grown(least), |t| least = least.min(point_triangle(p, corners(t)).1));
    least
}

//! Relaxation of an end surface before a connector is built on it.
//!
//! Greedy removal leaves a ragged rim. Rim vertices slide along the wall towards their mean height and towards even
//! angles, and inner vertices of the disc follow. Moves must not degrade tetrahedra and triangles beyond limits. This
//! avoids needles in the seam.

use super::region::{OUTSIDE, Region, WALL};
use anastomesh_mesh::TET_FACES;
use anastomesh_mesh::geometry::turn;
use anastomesh_mesh::geometry::{Point3, Section, Vec3};
use anastomesh_mesh::quality::{tet_ratio, triangle_ratio};

/// Passes over the vertices of the end surface.
const PASSES: usize = 8;
/// Limits down to which a move may lower the worst radius ratio at a vertex.
const TET_FLOOR: f64 = 0.35;
const TRIANGLE_FLOOR: f64 = 0.6;
/// Minimum cosine between triangles of the end surface and the plane, unless they start lower.
const COSINE_FLOOR: f64 = 0.5;

pub(super) struct EndRelaxation<'a> {
    pub region: &'a Region,
    pub removed: &'a [bool],
    pub section: &'a Section,
    /// Fixed vertices (local numbers).
    pub frozen: &'a dyn Fn(u32) -> bool,
}

struct Worst {
    tet: f64,
    triangle: f64,
    cosine: f64,
}

impl EndRelaxation<'_> {
    /// Moves `points` (global) of the end surface. `triangles` and `rim` use local vertices.
    pub(super) fn run(&self, points: &mut [Point3], triangles: &[[u32; 3]], rim: &[u32]) {
        let inner = inner_vertices(triangles, rim);
        let around: Vec<Vec<u32>> = inner.iter().map(|&v| ring_of(v, triangles)).collect();
        for _ in 0..PASSES {
            self.slide_rim(points, rim);
            for (&v, ring) in inner.iter().zip(&around) {
                let mean = ring.iter().map(|&w| self.at(points, w).coords).sum::<Vec3>() / ring.len() as f64;
                self.step(points, v, Point3::from(mean));
            }
        }
    }

    fn at(&self, points: &[Point3], v: u32) -> Point3 {
        points[self.region.vertices[v as usize] as usize]
    }

    fn slide_rim(&self, points: &mut [Point3], rim: &[u32]) {
        let (u, w) = self.section.frame();
        let polar = |p: Point3| {
            let d = p - self.section.origin;
            let (x, y) = (d.dot(&u), d.dot(&w));
            (libm::atan2(y, x), libm::hypot(x, y), d.dot(&self.section.axis))
        };
        let n = rim.len();
        let level = rim.iter().map(|&v| polar(self.at(points, v)).2).sum::<f64>() / n as f64;
        for i in 0..n {
            let (theta, radius, height) = polar(self.at(points, rim[i]));
            let (before, radius_before, _) = polar(self.at(points, rim[(i + n - 1) % n]));
            let (after, radius_after, _) = polar(self.at(points, rim[(i + 1) % n]));
            let (back, ahead) = (turn(before - theta), turn(after - theta));
            let shift = 0.25 * (back + ahead);
            // Along the wall, the radius changes towards that of the neighbour in the direction of the move.
            let (gap, toward) = if shift > 0.0 { (ahead, radius_after) } else { (back, radius_before) };
            let share = if gap.abs() > 1e-9 { (shift / gap).clamp(0.0, 0.5) } else { 0.0 };
            let r = radius + share * (toward - radius);
            let a = theta + share * gap;
            let h = height + 0.5 * (level - height);
            let target = self.section.origin + (u * libm::cos(a) + w * libm::sin(a)) * r + self.section.axis * h;
            self.step(points, rim[i], target);
        }
    }

    /// Moves `v` towards `target` as far as quality permits.
    fn step(&self, points: &mut [Point3], v: u32, target: Point3) {
        if (self.frozen)(v) {
            return;
        }
        let global = self.region.vertices[v as usize] as usize;
        let from = points[global];
        let before = self.worst(points, v);
        for share in [1.0, 0.5, 0.25] {
            points[global] = from + (target - from) * share;
            let after = self.worst(points, v);
            if after.tet >= before.tet.min(TET_FLOOR)
                && after.triangle >= before.triangle.min(TRIANGLE_FLOOR)
                && after.cosine >= before.cosine.min(COSINE_FLOOR)
            {
                return;
            }
        }
        points[global] = from;
    }

    /// Worst quality among the remaining elements at a vertex.
    fn worst(&self, points: &[Point3], v: u32) -> Worst {
        let mut worst = Worst { tet: 1.0, triangle: 1.0, cosine: 1.0 };
        for &t in self.region.star(v) {
            if self.removed[t as usize] {
                continue;
            }
            let corners = self.region.corners[t as usize];
            let p = corners.map(|c| self.at(points, c));
            worst.tet = worst.tet.min(tet_ratio(&p));
            for (i, &n) in self.region.neighbours[t as usize].iter().enumerate() {
                let end = n < OUTSIDE && self.removed[n as usize];
                if corners[i] == v || !(end || n == WALL) {
                    continue;
                }
                let f = TET_FACES[i].map(|k| p[k]);
                worst.triangle = worst.triangle.min(triangle_ratio(&f));
                if end {
                    let n = (f[1] - f[0]).cross(&(f[2] - f[0]));
                    worst.cosine = worst.cosine.min(n.dot(&self.section.axis) / n.norm().max(f64::MIN_POSITIVE));
                }
            }
        }
        worst
    }
}

fn inner_vertices(triangles: &[[u32; 3]], rim: &[u32]) -> Vec<u32> {
    let mut on_rim = rim.to_vec();
    on_rim.sort_unstable();
    let mut inner: Vec<u32> =
        triangles.iter().flatten().copied().filter(|v| on_rim.binary_search(v).is_err()).collect();
    inner.sort_unstable();
    inner.dedup();
    inner
}

fn ring_of(v: u32, triangles: &[[u32; 3]]) -> Vec<u32> {
    let mut ring: Vec<u32> =
        triangles.iter().filter(|t| t.contains(&v)).flatten().copied().filter(|&w| w != v).collect();
    ring.sort_unstable();
    ring.dedup();
    ring
}

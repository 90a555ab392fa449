//! Improvement of a connector's wall: edge flips and sliding of ring vertices until triangle quality converges.

use super::path::AxisPath;
use super::rings::RingVertex;
use super::shape::facing_ratio;
use anastomesh_mesh::geometry::{Point3, Vec3};
use rustc_hash::FxHashMap;

/// Radius ratio above which triangles are not changed.
const GOOD: f64 = 0.9;

/// Maximum rounds of flips and slides.
const MAX_WALL_PASSES: usize = 3;

/// Minimum gain in the worst radius ratio. Smaller gains are rounding, and changes could alternate forever.
const GAIN: f64 = 1e-3;

/// Wall triangles between two rims. Vertices from `first_free` on are ring vertices, whose path coordinates are in
/// `rings`.
pub(super) struct TubeWall<'a> {
    pub path: &'a AxisPath,
    pub points: Vec<Point3>,
    pub triangles: Vec<[u32; 3]>,
    pub first_free: u32,
    pub rings: Vec<RingVertex>,
    /// Direction from the axis to each vertex.
    outward: Vec<Vec3>,
    /// Quality of each triangle.
    shapes: Vec<f64>,
}

impl<'a> TubeWall<'a> {
    /// Creates a wall from strips.
    pub(super) fn new(
        path: &'a AxisPath,
        points: Vec<Point3>,
        triangles: Vec<[u32; 3]>,
        first_free: u32,
        rings: Vec<RingVertex>,
    ) -> Self {
        let mut wall = Self { path, points, triangles, first_free, rings, outward: Vec::new(), shapes: Vec::new() };
        wall.outward = (0..wall.points.len() as u32).map(|v| wall.radial(v)).collect();
        wall.shapes = wall.triangles.iter().map(|&t| wall.shape(t)).collect();
        wall
    }

    /// Improves the wall. Edges and vertices of the rims are fixed.
    pub(super) fn improve(&mut self) {
        for _ in 0..MAX_WALL_PASSES {
            let flips = self.flip();
            let slides = self.slide();
            if flips + slides == 0 {
                break;
            }
        }
    }

    fn at(&self, v: u32) -> Point3 {
        self.points[v as usize]
    }

    /// Radius ratio, negative if the triangle faces the axis.
    fn shape(&self, t: [u32; 3]) -> f64 {
        let p = t.map(|v| self.at(v));
        let radial: Vec3 = t.iter().map(|&v| self.outward[v as usize]).sum();
        facing_ratio(&p, &radial)
    }

    /// Approximate direction from the axis to a vertex.
    fn radial(&self, v: u32) -> Vec3 {
        let s = if v >= self.first_free {
            self.rings[(v - self.first_free) as usize].s
        } else {
            let from_start = self.at(v) - self.path.at(0.0).origin;
            let from_end = self.at(v) - self.path.at(self.path.length()).origin;
            if from_start.norm_squared() <= from_end.norm_squared() {
                from_start.dot(&self.path.at(0.0).axis)
            } else {
                self.path.length() + from_end.dot(&self.path.at(self.path.length()).axis)
            }
        };
        (self.at(v) - self.path.at(s).origin).normalize()
    }

    /// Flips edges of poor triangles if this improves the worse of the two triangles.
    fn flip(&mut self) -> usize {
        if self.shapes.iter().all(|&s| s > GOOD) {
            return 0;
        }
        let mut owner: FxHashMap<(u32, u32), u32> = FxHashMap::default();
        owner.reserve(3 * self.triangles.len());
        for (i, t) in self.triangles.iter().enumerate() {
            for k in 0..3 {
                owner.insert((t[k], t[(k + 1) % 3]), i as u32);
            }
        }
        let mut flips = 0;
        for i in 0..self.triangles.len() {
            for k in 0..3 {
                if self.shapes[i] > GOOD {
                    break;
                }
                let t = self.triangles[i];
                let (a, b, c) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
                let Some(&j) = owner.get(&(b, a)) else { continue };
                let u = self.triangles[j as usize];
                let Some(d) = u.iter().copied().find(|&v| v != a && v != b) else { continue };
                if c == d || owner.contains_key(&(c, d)) || owner.contains_key(&(d, c)) {
                    continue;
                }
                let new = [[a, d, c], [d, b, c]];
                let before = self.shapes[i].min(self.shapes[j as usize]);
                let shapes = new.map(|t| self.shape(t));
                if shapes[0].min(shapes[1]) <= before + GAIN {
                    continue;
                }
                owner.remove(&(a, b));
                owner.remove(&(b, a));
                for (n, at) in [i as u32, j].into_iter().enumerate() {
                    (self.triangles[at as usize], self.shapes[at as usize]) = (new[n], shapes[n]);
                    for k in 0..3 {
                        owner.insert((new[n][k], new[n][(k + 1) % 3]), at);
                    }
                }
                flips += 1;
            }
        }
        flips
    }

    /// Slides ring vertices along the tube towards the mean of their neighbours if this improves the worst adjacent
    /// triangle.
    fn slide(&mut self) -> usize {
        if self.shapes.iter().all(|&s| s > GOOD) {
            return 0;
        }
        let n = self.rings.len();
        let mut stars: Vec<Vec<u32>> = vec![Vec::new(); n];
        for (i, t) in self.triangles.iter().enumerate() {
            for &v in t.iter().filter(|&&v| v >= self.first_free) {
                stars[(v - self.first_free) as usize].push(i as u32);
            }
        }
        let mut slides = 0;
        for _ in 0..3 {
            for (k, star) in stars.iter().enumerate() {
                slides += usize::from(self.slide_vertex(k, star));
            }
        }
        slides
    }

    fn slide_vertex(&mut self, k: usize, star: &[u32]) -> bool {
        if star.is_empty() {
            return false;
        }
        let before = star.iter().map(|&t| self.shapes[t as usize]).fold(1.0, f64::min);
        if before > GOOD {
            return false;
        }
        let v = self.first_free + k as u32;
        let (from, place, outward) = (self.at(v), self.rings[k], self.outward[v as usize]);
        let mut mean = Vec3::zeros();
        for &t in star {
            for &w in self.triangles[t as usize].iter().filter(|&&w| w != v) {
                mean += self.at(w) - from;
            }
        }
        mean /= 2.0 * star.len() as f64;
        let frame = self.path.at(place.s);
        let (sine, cosine) = libm::sincos(place.theta);
        let tangent = frame.w * cosine - frame.u * sine;
        for share in [1.0, 0.5] {
            let next = RingVertex {
                s: place.s + share * mean.dot(&frame.axis),
                theta: place.theta + share * mean.dot(&tangent) / place.distance,
                distance: place.distance,
            };
            let there = self.path.at(next.s);
            let moved = there.point(next.theta, next.distance);
            self.points[v as usize] = moved;
            self.outward[v as usize] = (moved - there.origin) / next.distance;
            self.rings[k] = next;
            if self.worst(star) > before + GAIN {
                for &t in star {
                    self.shapes[t as usize] = self.shape(self.triangles[t as usize]);
                }
                return true;
            }
        }
        self.points[v as usize] = from;
        self.outward[v as usize] = outward;
        self.rings[k] = place;
        false
    }

    fn worst(&self, star: &[u32]) -> f64 {
        star.iter().map(|&t| self.shape(self.triangles[t as usize])).fold(1.0, f64::min)
    }
}

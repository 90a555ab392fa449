//! Plane parts without layers that are not star-shaped, such as a face of tissue around a vessel.
//!
//! They cannot shrink as a whole. Their vertices at the wall slide in the plane instead, and layers end in a strip along
//! the wall. All other vertices stay.

use super::caps::{Cap, FLAT, rim};
use super::direction::Directions;
use super::inset::lower;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Point3, Vec3};

/// Minimum cosine between a sliding direction and the reversed normals of the wall.
const STEEP: f64 = 0.2;
/// Minimum area of a triangle whose vertices slide, relative to its area before.
const KEPT_AREA: f64 = 0.3;
/// Factor of the offsets at a triangle that becomes too small, and passes until they vanish.
const FACTOR: f64 = 0.7;
const MAX_PASSES: usize = 40;
/// Slope of the rays that measure the width along a plane, away from the plane.
const PROBE: f64 = 0.2;

/// Vertices that slide.
#[derive(Default)]
pub(super) struct Slides {
    /// Outward normal of the plane in which each vertex slides.
    pub normals: Vec<Option<Vec3>>,
    /// Triangles with such vertices.
    triangles: Vec<[u32; 3]>,
    /// Edges of the wall with such vertices, in the direction of the plane part.
    edges: Vec<[u32; 2]>,
}

impl Slides {
    /// Finds the vertices of `caps` that may slide, and sets their directions. `is_free` tells if a vertex or a triangle may
    /// change.
    pub(super) fn find(
        (surface, is_rim): (&TriMesh, &[bool]),
        caps: &[&Cap],
        is_free: &(impl Fn(u32) -> bool, impl Fn(u32) -> bool),
        directions: &mut Directions,
    ) -> Self {
        let mut normals = vec![None; surface.points.len()];
        let (mut triangles, mut edges) = (Vec::new(), Vec::new());
        for cap in caps {
            let mut around: Vec<(u32, u32)> =
                cap.triangles.iter().flat_map(|&t| surface.triangles[t as usize].map(|v| (v, t))).collect();
            around.sort_unstable();
            for star in around.chunk_by(|x, y| x.0 == y.0).filter(|star| is_rim[star[0].0 as usize]) {
                let v = star[0].0;
                if !is_free.0(v) || !star.iter().all(|&(_, t)| is_free.1(t)) {
                    continue;
                }
                let of_star: Vec<[u32; 3]> = star.iter().map(|&(_, t)| surface.triangles[t as usize]).collect();
                let Some(normal) = plane_normal(surface, v, &of_star) else { continue };
                let way = directions.ways[v as usize];
                let Some(way) = (way - normal * way.dot(&normal)).try_normalize(1e-3) else { continue };
                if directions.steepness(v as usize, &way) >= STEEP {
                    directions.ways[v as usize] = way;
                    normals[v as usize] = Some(normal);
                }
            }
            let slides = |v: &u32| normals[*v as usize].is_some();
            triangles
                .extend(cap.triangles.iter().map(|&t| surface.triangles[t as usize]).filter(|t| t.iter().any(slides)));
            edges.extend(rim(&surface.triangles, cap).into_iter().filter(|edge| edge.iter().any(slides)));
        }
        Self { normals, triangles, edges }
    }

    /// True if no vertex slides.
    pub(super) fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// True if a vertex slides.
    pub(super) fn has(&self, v: usize) -> bool {
        self.normals.get(v).is_some_and(Option::is_some)
    }

    /// Directions to measure widths along. Those in a plane of the surface are inclined to it.
    pub(super) fn probes(&self, ways: &[Vec3]) -> Vec<Vec3> {
        let probe = |(way, normal): (&Vec3, &Option<Vec3>)| normal.map_or(*way, |n| (way - n * PROBE).normalize());
        ways.iter().zip(&self.normals).map(probe).collect()
    }

    /// Lowers offsets until no triangle becomes too small, and neighbours differ by at most `grade` times their distance.
    pub(super) fn fit(&self, heights: &mut [f64], ways: &[Vec3], (points, wall): (&[Point3], &[[u32; 3]]), grade: f64) {
        for pass in 0..MAX_PASSES {
            let at = |v: u32| {
                points[v as usize] + ways[v as usize] * if self.has(v as usize) { heights[v as usize] } else { 0.0 }
            };
            let small = self.small(points, at, KEPT_AREA);
            if small.is_empty() {
                return;
            }
            let factor = if pass + 1 < MAX_PASSES { FACTOR } else { 0.0 };
            let mut vertices: Vec<u32> = small.into_flattened();
            vertices.sort_unstable();
            vertices.dedup();
            vertices.into_iter().filter(|&v| self.has(v as usize)).for_each(|v| heights[v as usize] *= factor);
            lower(heights, points, wall, grade);
        }
    }

    /// Triangles that become smaller than a share of their area, and edges of the wall whose strip overlaps itself.
    pub(super) fn small(&self, points: &[Point3], at: impl Fn(u32) -> Point3, share: f64) -> Vec<[u32; 3]> {
        let before = |v: u32| points[v as usize];
        let normal = |[a, b, c]: [Point3; 3]| (b - a).cross(&(c - a));
        let is_small = |t: &[u32; 3]| {
            let old = normal(t.map(before));
            normal(t.map(&at)).dot(&old) <= share * old.norm_squared()
        };
        let overlaps = |&[a, b]: &[u32; 2]| {
            let Some(up) = self.normals[a as usize].or(self.normals[b as usize]) else { return false };
            let ([a, b], [c, d]) = ([before(a), before(b)], [at(a), at(b)]);
            let is_turned = |t: [Point3; 3]| normal(t).dot(&up) <= 0.0;
            (b != d && (is_turned([a, b, d]) || is_turned([b, d, c])))
                || (a != c && (is_turned([a, b, c]) || is_turned([a, d, c])))
        };
        let strips = self.edges.iter().filter(|edge| overlaps(edge)).map(|&[a, b]| [a, b, b]);
        self.triangles.iter().copied().filter(is_small).chain(strips).collect()
    }
}

/// Unit normal of the triangles at a vertex, if they lie in one plane.
fn plane_normal(surface: &TriMesh, v: u32, star: &[[u32; 3]]) -> Option<Vec3> {
    let point = |v: u32| surface.points[v as usize];
    let sum: Vec3 = star.iter().map(|t| t.map(point)).map(|[a, b, c]| (b - a).cross(&(c - a))).sum();
    let normal = sum.try_normalize(0.0)?;
    let offsets = || star.as_flattened().iter().map(|&w| point(w) - point(v));
    let size = offsets().map(|d| d.norm()).fold(0.0, f64::max);
    let is_flat = offsets().all(|d| d.dot(&normal).abs() <= FLAT * size);
    let faces = |t: &[u32; 3]| {
        let [a, b, c] = t.map(point);
        (b - a).cross(&(c - a)).dot(&normal) > 0.0
    };
    (is_flat && star.iter().all(faces)).then_some(normal)
}

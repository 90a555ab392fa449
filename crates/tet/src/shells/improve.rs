//! Local search for outer positions where prisms are inverted or much flatter than their thickness requires.

use super::directions::{Side, Sides};
use super::shell::{Shell, depths};
use crate::layers::{Directions, Numbers, toward};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Point3, Vec3};
use rayon::prelude::*;

/// Fraction of the quality of a right prism below which a prism is improved.
const POOR: f64 = 0.4;
/// Passes over the poor prisms and those around moved vertices.
const PASSES: usize = 4;
/// Steps of a vertex, relative to its thickness, in each pass.
const STEPS: [f64; 3] = [0.3, 0.1, 0.03];
/// Minimum steepness of an offset, relative to the direction of its vertex. Where all offsets are steep, thin prisms are
/// positive. Offsets that are not may improve inverted prisms, but these stay inverted at any thickness.
const KEEPS: f64 = 0.5;
/// Directions of a step beside the outer position.
const TURNS: u32 = 8;

/// Wall with the triangles at each vertex.
pub(super) struct Improver<'a> {
    surface: &'a TriMesh,
    wall: &'a [[u32; 3]],
    numbers: &'a Numbers,
    /// Fractions of the offset at which the copies of each vertex lie.
    depths: Vec<f64>,
    /// Outward direction of each vertex, and the triangles there.
    directions: &'a Directions,
    /// Region in which the outer position of each vertex may lie.
    sides: &'a Sides,
    /// Quality of a right prism with the thickness wanted, at each triangle.
    ideal: Vec<f64>,
}

impl<'a> Improver<'a> {
    /// Improver of shells with the thickness `heights`.
    pub fn new(
        (surface, wall): (&'a TriMesh, &'a [[u32; 3]]),
        numbers: &'a Numbers,
        shells: &[Shell],
        (directions, sides): (&'a Directions, &'a Sides),
        heights: &[f64],
    ) -> Self {
        let depths = (0..surface.points.len()).flat_map(|v| depths(shells, v)).collect();
        let mut made = Self { surface, wall, numbers, depths, directions, sides, ideal: Vec::new() };
        made.ideal = wall.par_iter().map(|t| made.right_prism(*t, heights)).collect();
        made
    }

    /// Fractions of the offset at which the copies of a vertex lie.
    pub fn depths_at(&self, v: usize) -> &[f64] {
        let layers = self.numbers.layers() as usize;
        &self.depths[v * layers..][..layers]
    }

    /// Moves outer positions where prisms at some triangles are poor. Each move raises the least quality at its vertex.
    pub fn improve(&self, triangles: &[u32], outer: &mut [Point3]) {
        let mut watched = triangles.to_vec();
        for _ in 0..PASSES {
            let is_poor = |t: &u32| self.relative(*t, outer) < POOR;
            let poor: Vec<u32> = watched.par_iter().copied().filter(is_poor).collect();
            let mut vertices: Vec<u32> = poor.iter().flat_map(|&t| self.wall[t as usize]).collect();
            vertices.sort_unstable();
            vertices.dedup();
            vertices.retain(|&v| self.move_vertex(v as usize, outer));
            watched = self.around_vertices(vertices);
            if watched.is_empty() {
                return;
            }
        }
    }

    /// Triangles at some vertices.
    pub fn around_vertices(&self, vertices: impl IntoIterator<Item = u32>) -> Vec<u32> {
        let mut triangles: Vec<u32> =
            vertices.into_iter().flat_map(|v| self.directions.at_vertex.get(v)).copied().collect();
        triangles.sort_unstable();
        triangles.dedup();
        triangles
    }

    /// Tries positions around that of a vertex. Returns true if one is better.
    fn move_vertex(&self, v: usize, outer: &mut [Point3]) -> bool {
        let own = outer[v];
        let offset = own - self.surface.points[v];
        let mut best = (self.around(v, outer), own);
        for step in STEPS {
            for candidate in self.candidates(v, &best.1, step * offset.norm()) {
                outer[v] = candidate;
                let quality = self.around(v, outer);
                if quality > best.0 {
                    best = (quality, candidate);
                }
            }
        }
        outer[v] = best.1;
        best.1 != own
    }

    /// Positions nearer to the surface, and beside.
    fn candidates(&self, v: usize, from: &Point3, step: f64) -> Vec<Point3> {
        let offset = from - self.surface.points[v];
        let Some(way) = offset.try_normalize(0.0) else { return Vec::new() };
        let nearer = from - way * step;
        let least = KEEPS * self.directions.steepness(v, &self.directions.ways[v]);
        let is_steep = |place: &Point3| self.is_steep(v, place, least);
        let side = match self.sides.at(v) {
            Side::Flat(normal) => {
                let side = way.cross(&normal);
                let all = [nearer, from + side * step, from - side * step];
                return all.into_iter().filter(is_steep).collect();
            }
            Side::Free | Side::Front(_) => any_normal(&way),
        };
        let other = way.cross(&side);
        let beside = |i: u32| {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(TURNS);
            (side * libm::cos(angle) + other * libm::sin(angle)) * step
        };
        let shifts: Vec<Vec3> = (0..TURNS).map(beside).collect();
        let may_be_at = |place: &Point3| match self.sides.at(v) {
            Side::Front(normal) => (place - self.surface.points[v]).dot(&normal) >= 0.0,
            Side::Free | Side::Flat(_) => true,
        };
        std::iter::once(nearer)
            .chain(shifts.iter().map(|s| from + s))
            .chain(shifts.iter().map(|s| nearer + s))
            .filter(|place| may_be_at(place) && is_steep(place))
            .collect()
    }

    /// True if an outer position leads away from all triangles of its vertex, with at least this steepness.
    fn is_steep(&self, v: usize, place: &Point3, least: f64) -> bool {
        let way = (place - self.surface.points[v]).try_normalize(0.0);
        way.is_some_and(|way| self.directions.steepness(v, &way) >= least)
    }

    /// Least relative quality of the prisms at a vertex.
    fn around(&self, v: usize, outer: &[Point3]) -> f64 {
        self.directions.at_vertex.get(v as u32).iter().map(|&t| self.relative(t, outer)).fold(f64::INFINITY, f64::min)
    }

    /// Quality at a triangle, relative to that of a right prism.
    fn relative(&self, t: u32, outer: &[Point3]) -> f64 {
        let triangle = self.wall[t as usize];
        self.quality(triangle, triangle.map(|v| outer[v as usize])) / self.ideal[t as usize]
    }

    /// Quality of the prism at right angles to a triangle.
    fn right_prism(&self, triangle: [u32; 3], heights: &[f64]) -> f64 {
        let [a, b, c] = triangle.map(|v| self.surface.points[v as usize]);
        let outward = -(b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
        let height = triangle.map(|v| heights[v as usize]).into_iter().fold(0.0, f64::max);
        self.quality(triangle, [a, b, c].map(|p| p + outward * height)).max(f64::MIN_POSITIVE)
    }

    /// Least quality of the tetrahedra at a wall triangle: minimum height over longest edge, negative if inverted.
    fn quality(&self, triangle: [u32; 3], outer: [Point3; 3]) -> f64 {
        let place = |copy: u32| {
            let origin = self.numbers.origin(copy);
            let base = &self.surface.points[origin as usize];
            if copy == origin {
                return *base;
            }
            let i = triangle.iter().position(|&v| v == origin).unwrap_or_default();
            let layer = (copy - self.numbers.copy(origin, 1)) as usize;
            toward(base, &outer[i], self.depths_at(origin as usize)[layer])
        };
        self.numbers.tets_at(triangle).map(|tet| flatness(tet.map(place))).fold(f64::INFINITY, f64::min)
    }
}

/// Minimum height of a tetrahedron over its longest edge; negative if it is inverted.
fn flatness([a, b, c, d]: [Point3; 4]) -> f64 {
    let area = |p: &Point3, q: &Point3, r: &Point3| (q - p).cross(&(r - p)).norm();
    let largest = area(&a, &b, &c).max(area(&a, &b, &d)).max(area(&a, &c, &d)).max(area(&b, &c, &d));
    let edges = [b - a, c - a, d - a, c - b, d - b, d - c];
    let longest = edges.iter().map(Vec3::norm).fold(0.0, f64::max);
    let volume = (b - a).cross(&(c - a)).dot(&(d - a));
    if largest > 0.0 { volume / (largest * longest) } else { 0.0 }
}

/// A unit vector at right angles to another.
fn any_normal(way: &Vec3) -> Vec3 {
    let axis = if way.x.abs() < 0.6 { Vec3::x() } else { Vec3::y() };
    way.cross(&axis).normalize()
}

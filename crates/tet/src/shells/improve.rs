//! Local search for outer positions where prisms are inverted or much flatter than their thickness requires.

use super::{Shell, depths};
use crate::layers::{Numbers, toward};
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::adjacency::Incidence;
use anastomesh_mesh::geometry::{Point3, Vec3};
use rayon::prelude::*;

/// Fraction of the quality of a right prism below which a prism is improved.
const POOR: f64 = 0.4;
/// Passes over the poor prisms.
const PASSES: usize = 6;
/// Steps of a vertex, relative to its thickness, in each pass.
const STEPS: [f64; 3] = [0.3, 0.1, 0.03];
/// Directions of a step beside the outer position.
const TURNS: u32 = 8;

/// Wall with the triangles at each vertex.
pub(super) struct Improver<'a> {
    surface: &'a TriMesh,
    wall: &'a [[u32; 3]],
    numbers: &'a Numbers,
    shells: &'a [Shell],
    /// Plane that a vertex at a rim stays in, by its normal; zero elsewhere.
    planes: &'a [Vec3],
    /// Quality of a right prism with the thickness wanted, at each triangle.
    ideal: Vec<f64>,
    /// Triangles at each vertex.
    at_vertex: Incidence,
}

impl<'a> Improver<'a> {
    /// Improver of shells with the thickness `heights`.
    pub fn new(
        (surface, wall): (&'a TriMesh, &'a [[u32; 3]]),
        numbers: &'a Numbers,
        shells: &'a [Shell],
        planes: &'a [Vec3],
        heights: &[f64],
    ) -> Self {
        let at_vertex = Incidence::of_cells(wall, surface.points.len());
        let ideal = wall.iter().map(|t| ideal(surface, *t, shells, heights)).collect();
        Self { surface, wall, numbers, shells, planes, ideal, at_vertex }
    }

    /// Moves outer positions where prisms are poor. Each move raises the least quality at its vertex.
    pub fn improve(&self, outer: &mut [Point3]) {
        for _ in 0..PASSES {
            let is_poor = |t: &u32| self.quality(self.wall[*t as usize], outer) < POOR * self.ideal[*t as usize];
            let poor: Vec<u32> = (0..self.wall.len() as u32).into_par_iter().filter(is_poor).collect();
            let mut vertices: Vec<u32> = poor.iter().flat_map(|&t| self.wall[t as usize]).collect();
            vertices.sort_unstable();
            vertices.dedup();
            let moved = vertices.into_iter().filter(|&v| self.move_vertex(v as usize, outer)).count();
            if moved == 0 {
                return;
            }
        }
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
        let plane = self.planes[v];
        let nearer = from - way * step;
        let side = if plane == Vec3::zeros() { any_normal(&way) } else { way.cross(&plane) };
        if plane != Vec3::zeros() {
            return vec![nearer, from + side * step, from - side * step];
        }
        let other = way.cross(&side);
        let beside = |i: u32| {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(TURNS);
            (side * angle.cos() + other * angle.sin()) * step
        };
        let shifts: Vec<Vec3> = (0..TURNS).map(beside).collect();
        std::iter::once(nearer)
            .chain(shifts.iter().map(|s| from + s))
            .chain(shifts.iter().map(|s| nearer + s))
            .collect()
    }

    /// Least quality of the prisms at a vertex.
    fn around(&self, v: usize, outer: &[Point3]) -> f64 {
        self.at_vertex
            .get(v as u32)
            .iter()
            .map(|&t| self.quality(self.wall[t as usize], outer) / self.ideal[t as usize])
            .fold(f64::INFINITY, f64::min)
    }

    /// Least quality of the tetrahedra at a wall triangle: minimum height over longest edge, negative if inverted.
    fn quality(&self, triangle: [u32; 3], outer: &[Point3]) -> f64 {
        let base = triangle.map(|v| self.surface.points[v as usize]);
        let copies = triangle.map(|v| depths(self.shells, v as usize));
        let place = |copy: u32| {
            let origin = self.numbers.origin(copy);
            let i = triangle.iter().position(|&v| v == origin).unwrap_or_default();
            if copy == origin {
                return base[i];
            }
            let layer = (copy - self.numbers.copy(origin, 1)) as usize;
            toward(&base[i], &outer[origin as usize], copies[i][layer])
        };
        self.numbers.tets_at(triangle).map(|tet| flatness(tet.map(place))).fold(f64::INFINITY, f64::min)
    }
}

/// Quality of a right prism with the thinnest layer and the longest edge at a triangle.
fn ideal(surface: &TriMesh, triangle: [u32; 3], shells: &[Shell], heights: &[f64]) -> f64 {
    let thinnest = |v: u32| {
        let depths = depths(shells, v as usize);
        let steps = depths.iter().scan(0.0, |before, &depth| Some(depth - std::mem::replace(before, depth)));
        steps.fold(1.0, f64::min) * heights[v as usize]
    };
    let height = triangle.map(thinnest).into_iter().fold(0.0, f64::max);
    let [a, b, c] = triangle.map(|v| surface.points[v as usize]);
    let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
    (height / longest.hypot(height)).max(f64::MIN_POSITIVE)
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

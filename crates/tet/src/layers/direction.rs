//! Inward direction at each vertex of a wall.

use anastomesh_mesh::adjacency::Incidence;
use anastomesh_mesh::geometry::{Point3, Vec3, unit_normal};
use rayon::prelude::*;

/// Steps towards the centre of the smallest cap that contains all normals at a vertex.
const STEPS: u32 = 40;
/// Steps where the direction is not clear after the first. The error is about the reciprocal of their number.
const MANY_STEPS: u32 = 4000;
/// Steepness of a clear direction.
const CLEAR: f64 = 0.1;
/// Smoothing passes over the inward directions.
const PASSES: usize = 3;
/// Minimum steepness of a smoothed direction, relative to that before.
const KEEPS: f64 = 0.6;

/// Inward directions at the vertices of a wall.
pub struct Directions {
    /// Unit vectors into the volume; zero off the wall, and if no direction leads away from all triangles.
    pub ways: Vec<Vec3>,
    /// Outward normal of each triangle of the wall.
    normals: Vec<Vec3>,
    /// Triangles at each vertex.
    pub at_vertex: Incidence,
}

impl Directions {
    /// Computes directions from the triangles of a wall, counter-clockwise seen from outside. Each direction sees all
    /// triangles of its vertex from behind as steeply as possible. It is the reversed centre of the smallest spherical
    /// cap that contains their normals.
    pub fn new(points: &[Point3], wall: &[[u32; 3]]) -> Self {
        let normal = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|v| points[v as usize].coords);
            unit_normal(a, b, c)
        };
        let normals = wall.par_iter().map(normal).collect();
        let mut made = Self { ways: Vec::new(), normals, at_vertex: Incidence::of_cells(wall, points.len()) };
        made.ways = (0..points.len()).into_par_iter().map(|v| inward_direction(&made.normals_at(v))).collect();
        made
    }

    fn normals_at(&self, v: usize) -> Vec<Vec3> {
        self.at_vertex.get(v as u32).iter().map(|&t| self.normals[t as usize]).collect()
    }

    /// Minimum cosine between an inward direction at a vertex and the reversed normals around it.
    pub fn steepness(&self, v: usize, way: &Vec3) -> f64 {
        steepness(way, self.at_vertex.get(v as u32).iter().map(|&t| &self.normals[t as usize]))
    }

    /// Direction that also sees a further triangle from behind, with an outward normal; zero if there is none.
    pub fn way_with(&self, v: usize, normal: Vec3) -> Vec3 {
        let mut normals = self.normals_at(v);
        normals.push(normal);
        inward_direction(&normals)
    }

    /// Averages directions with those of neighbours, within the minimum steepness, except at held vertices.
    pub fn smooth(&mut self, wall: &[[u32; 3]], is_held: &[bool]) {
        for _ in 0..PASSES {
            let smoother = |v: usize| {
                let own = self.ways[v];
                let others = |&t: &u32| wall[t as usize].into_iter().filter(|&w| w as usize != v);
                let of_triangle = |t| others(t).map(|w| self.ways[w as usize]).sum::<Vec3>();
                let sum: Vec3 = self.at_vertex.get(v as u32).iter().map(of_triangle).sum();
                let way = sum.try_normalize(0.0).and_then(|sum| (sum + own).try_normalize(0.0));
                let is_steep = |way: &Vec3| self.steepness(v, way) >= KEEPS * self.steepness(v, &own);
                way.filter(|way| !is_held[v] && is_steep(way)).unwrap_or(own)
            };
            self.ways = (0..self.ways.len()).into_par_iter().map(smoother).collect();
        }
    }
}

/// Greatest minimum cosine between a direction and the reversed normals at a vertex. Not above 0 if no direction leads away
/// from all triangles.
pub fn openness(normals: &[Vec3]) -> f64 {
    steepest(normals).map_or(-1.0, |(seen, _)| seen)
}

/// True if the openness is at least `least`. Faster than the value.
pub fn is_open(normals: &[Vec3], least: f64) -> bool {
    let mean = -normals.iter().sum::<Vec3>();
    mean.try_normalize(0.0).is_some_and(|way| steepness(&way, normals) >= least) || openness(normals) >= least
}

/// Minimum cosine between an inward direction and the reversed normals.
fn steepness<'a>(way: &Vec3, normals: impl IntoIterator<Item = &'a Vec3>) -> f64 {
    normals.into_iter().map(|normal| -way.dot(normal)).fold(1.0, f64::min)
}

/// Inward direction at a vertex; zero if there is none.
fn inward_direction(normals: &[Vec3]) -> Vec3 {
    steepest(normals).filter(|(seen, _)| *seen > 0.0).map_or(Vec3::zeros(), |(_, way)| way)
}

/// Steepest direction and its steepness. Decreasing steps towards the furthest normal converge to the centre of the smallest
/// enclosing ball (Bădoiu, Clarkson 2003).
fn steepest(normals: &[Vec3]) -> Option<(f64, Vec3)> {
    let mut middle: Vec3 = -normals.iter().sum::<Vec3>() / normals.len().max(1) as f64;
    let mut best: Option<(f64, Vec3)> = None;
    for step in 1..=MANY_STEPS {
        if step > STEPS && best.is_some_and(|(seen, _)| seen >= CLEAR) {
            break;
        }
        let Some(way) = middle.try_normalize(0.0) else { break };
        // The furthest of unit vectors has the least cosine.
        let cosines = normals.iter().map(|normal| (-way.dot(normal), normal));
        let Some((seen, furthest)) = cosines.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        if best.is_none_or(|(most, _)| seen > most) {
            best = Some((seen, way));
        }
        middle += (-furthest - middle) / f64::from(step + 1);
    }
    best
}

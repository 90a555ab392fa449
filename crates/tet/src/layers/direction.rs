//! Inward direction at each vertex of a wall.

use anastomesh_mesh::geometry::unit_normal;
use anastomesh_mesh::geometry::{Point3, Vec3};

/// Steps towards the centre of the smallest cap that contains all normals at a vertex.
const STEPS: u32 = 40;
/// Smoothing passes over the inward directions.
const PASSES: usize = 3;
/// Minimum steepness of a smoothed direction, relative to that before.
const KEEPS: f64 = 0.6;

/// Inward directions at the vertices of a wall, and the triangle normals around each.
pub struct Directions {
    /// Unit vectors into the volume; zero off the wall, and if no direction leads away from all triangles.
    pub ways: Vec<Vec3>,
    /// Outward normals of the triangles at each vertex of the wall.
    normals: Vec<Vec<Vec3>>,
}

impl Directions {
    /// Computes directions from the triangles of a wall, counter-clockwise seen from outside. Each direction sees all
    /// triangles of its vertex from behind as steeply as possible. It is the reversed centre of the smallest spherical
    /// cap that contains their normals.
    pub fn new(points: &[Point3], wall: &[[u32; 3]]) -> Self {
        let mut normals: Vec<Vec<Vec3>> = vec![Vec::new(); points.len()];
        for triangle in wall {
            let [a, b, c] = triangle.map(|v| points[v as usize].coords);
            let normal = unit_normal(a, b, c);
            for &v in triangle {
                normals[v as usize].push(normal);
            }
        }
        let ways = normals.iter().map(|of_vertex| inward_direction(of_vertex)).collect();
        Self { ways, normals }
    }

    /// Minimum cosine between an inward direction at a vertex and the reversed normals around it.
    pub fn steepness(&self, v: usize, way: &Vec3) -> f64 {
        steepness(way, &self.normals[v])
    }

    /// Direction that also sees a further triangle from behind, with an outward normal; zero if there is none.
    pub fn way_with(&self, v: usize, normal: Vec3) -> Vec3 {
        let normals: Vec<Vec3> = self.normals[v].iter().copied().chain([normal]).collect();
        inward_direction(&normals)
    }

    /// Averages directions with those of neighbours, within the minimum steepness, except at held vertices.
    pub fn smooth(&mut self, wall: &[[u32; 3]], is_held: &[bool]) {
        for _ in 0..PASSES {
            let mut sums = vec![Vec3::zeros(); self.ways.len()];
            for &[a, b, c] in wall {
                for (v, [x, y]) in [(a, [b, c]), (b, [c, a]), (c, [a, b])] {
                    sums[v as usize] += self.ways[x as usize] + self.ways[y as usize];
                }
            }
            for (v, sum) in sums.into_iter().enumerate().filter(|(v, _)| !is_held[*v]) {
                let own = self.ways[v];
                let Some(way) = sum.try_normalize(0.0).and_then(|sum| (sum + own).try_normalize(0.0)) else { continue };
                if steepness(&way, &self.normals[v]) >= KEEPS * steepness(&own, &self.normals[v]) {
                    self.ways[v] = way;
                }
            }
        }
    }
}

/// Greatest minimum cosine between a direction and the reversed normals at a vertex. Not above 0 if no direction leads away
/// from all triangles.
pub fn openness(normals: &[Vec3]) -> f64 {
    steepest(normals).map_or(-1.0, |(seen, _)| seen)
}

/// Minimum cosine between an inward direction and the reversed normals.
fn steepness(way: &Vec3, normals: &[Vec3]) -> f64 {
    normals.iter().map(|normal| -way.dot(normal)).fold(1.0, f64::min)
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
    for step in 1..=STEPS {
        let Some(way) = middle.try_normalize(0.0) else { break };
        let seen = steepness(&way, normals);
        if best.is_none_or(|(most, _)| seen > most) {
            best = Some((seen, way));
        }
        let far = |a: &Vec3| (middle + *a).norm_squared();
        let Some(furthest) = normals.iter().max_by(|a, b| far(a).total_cmp(&far(b))) else { break };
        middle += (-furthest - middle) / f64::from(step + 1);
    }
    best
}

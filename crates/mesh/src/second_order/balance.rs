//! Vertices for curved surfaces that enclose the volume of a mesh with flat faces.
//!
//! A mesh whose flat faces enclose the right volume has its vertices outside of a convex surface. A curved surface through these
//! vertices would enclose too much.

use super::edges::{Edges, FACE_EDGES};
use super::midpoints::SecondOrder;
use super::surface;
use crate::VolumeMesh;
use crate::geometry::predicates::orient3d;
use crate::geometry::{Point3, Vec3, unit_normal};
use rayon::prelude::*;

/// Height of a curved face over the flat one, relative to its size, below which it is flat: rounding errors.
const FLAT: f64 = 1e-9;

/// Least length of the part of a plane's normal that other planes do not contain. Below, both planes are the same.
const SAME_PLANE: f64 = 1e-3;

/// Least length of the mean of unit normals around a vertex that moves.
const LEAST_NORMAL: f64 = 0.5;

/// Least volume of a tetrahedron with moved vertices, relative to the given one.
const LEAST_VOLUME: f64 = 0.25;

/// Number of times the displacement of a vertex is halved before the vertex stays.
const HALVINGS: u8 = 4;

/// Maximum number of rounds. Afterwards, all vertices stay.
const ROUNDS: usize = 100;

impl SecondOrder {
    /// Positions of the vertices of a mesh, moved so that curved surfaces enclose the volume of the flat faces, to first order. The
    /// vertices of caps and other planes move within these. Tetrahedra stay positive. The caller checks the boundary.
    ///
    /// A curved face is higher than the flat one by a third of the sum of the offsets of its midpoints, on average. A vertex moves inwards by
    /// the mean of this height over its faces, weighted by area, along their mean normal. Around a tube of 12 points, the curved
    /// volume then differs by 0.02 %.
    pub fn balanced_points(volume: &VolumeMesh) -> Vec<Point3> {
        let points = &volume.mesh.points;
        let mut shifts = shifts(volume);
        let mut halvings = vec![0_u8; points.len()];
        for _ in 0..ROUNDS {
            let moved: Vec<Point3> = points.par_iter().zip(&shifts).map(|(p, shift)| p + shift).collect();
            let bad = squeezed(volume, &moved, &shifts);
            if bad.is_empty() {
                return moved;
            }
            for v in bad {
                let v = v as usize;
                halvings[v] += 1;
                shifts[v] *= if halvings[v] > HALVINGS { 0.0 } else { 0.5 };
            }
        }
        points.clone()
    }
}

/// Vertices that move, of tetrahedra that lose most of their volume; ascending.
fn squeezed(volume: &VolumeMesh, moved: &[Point3], shifts: &[Vec3]) -> Vec<u32> {
    let volume6 = |[a, b, c, d]: [Point3; 4]| (b - a).cross(&(c - a)).dot(&(d - a));
    let examine = |tet: &[u32; 4]| -> Vec<u32> {
        let moving: Vec<u32> = tet.iter().copied().filter(|&v| shifts[v as usize] != Vec3::zeros()).collect();
        let [given, now] = [&volume.mesh.points[..], moved].map(|points| tet.map(|v| points[v as usize]));
        let keeps = moving.is_empty()
            || volume6(now) >= LEAST_VOLUME * volume6(given) && orient3d(&now[0], &now[1], &now[2], &now[3]) > 0.0;
        if keeps { Vec::new() } else { moving }
    };
    let mut bad: Vec<u32> = volume.mesh.tets.par_iter().flat_map_iter(examine).collect();
    bad.par_sort_unstable();
    bad.dedup();
    bad
}

/// Faces at a vertex.
#[derive(Clone, Default)]
struct Around {
    /// Sums over the curved faces: area, area times height, area times normal.
    area: f64,
    height: f64,
    normal: Vec3,
    /// Orthonormal directions in which the vertex stays: normals of flat faces.
    fixed: Vec<Vec3>,
}

impl Around {
    /// Adds the normal of a flat face.
    fn fix(&mut self, normal: Vec3) {
        let new = self.fixed.iter().fold(normal, |rest, fixed| rest - fixed * fixed.dot(&rest));
        self.fixed.extend(new.try_normalize(SAME_PLANE));
    }

    /// Displacement of the vertex.
    fn shift(&self) -> Vec3 {
        let mean = self.normal / self.area;
        let length = mean.norm();
        // Not a number for a vertex without curved faces.
        if length.is_nan() || length < LEAST_NORMAL {
            return Vec3::zeros();
        }
        let shift = mean * (-self.height / self.area / length);
        self.fixed.iter().fold(shift, |rest, fixed| rest - fixed * fixed.dot(&rest))
    }
}

/// Displacement of each vertex.
fn shifts(volume: &VolumeMesh) -> Vec<Vec3> {
    let points = &volume.mesh.points;
    let edges = Edges::of_cells(&volume.mesh.tets, &volume.boundary, points.len());
    let offsets = surface::offsets(volume, &edges);
    let offset = |a: u32, b: u32| edges.find(a, b).map_or(Vec3::zeros(), |edge| offsets[edge as usize]);
    let mut around = vec![Around::default(); points.len()];
    for face in &volume.boundary {
        let [a, b, c] = face.map(|v| points[v as usize]);
        let (normal, area) = (unit_normal(a.coords, b.coords, c.coords), 0.5 * (b - a).cross(&(c - a)).norm());
        let height = FACE_EDGES.map(|[i, j]| offset(face[i], face[j]).dot(&normal)).iter().sum::<f64>() / 3.0;
        for v in face {
            let around = &mut around[*v as usize];
            if height.abs() > FLAT * area.sqrt() {
                around.area += area;
                around.height += area * height;
                around.normal += normal * area;
            } else {
                around.fix(normal);
            }
        }
    }
    around.par_iter().map(Around::shift).collect()
}

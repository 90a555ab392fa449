//! Vertices for curved surfaces that enclose the volume of a mesh with flat faces.
//!
//! A mesh whose flat faces enclose the right volume has its vertices outside of a convex surface. A curved surface through these
//! vertices would enclose too much.

use super::edges::Edges;
use super::extend::{Carried, Planes, Vertices, extend};
use super::midpoints::SecondOrder;
use super::surface::{self, Flat};
use crate::VolumeMesh;
use crate::geometry::predicates::orient3d;
use crate::geometry::{Point3, Vec3};
use rayon::prelude::*;

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
    /// volume then differs by 0.02 %. Vertices near the surface, as those of thin layers, move with it.
    ///
    /// `rest` is what is then left from a position to the right one: zero if it is not known.
    pub fn balanced_points(volume: &VolumeMesh, rest: &(impl Fn(&Point3) -> Vec3 + Sync)) -> Vec<Point3> {
        let points = &volume.mesh.points;
        let mut shifts = shifts(volume, rest);
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
    /// Number of these faces.
    faces: u32,
    /// Planes of the flat faces.
    planes: Planes,
}

impl Around {
    /// Edge of an equilateral triangle with the mean area of the curved faces.
    fn edge(&self) -> f64 {
        (4.0 / 3.0_f64.sqrt() * self.area / f64::from(self.faces)).sqrt()
    }

    /// Displacement of a vertex of curved faces.
    fn shift(&self) -> Vec3 {
        let mean = self.normal / self.area;
        let length = mean.norm();
        if length < LEAST_NORMAL { Vec3::zeros() } else { mean * (-self.height / self.area / length) }
    }
}

/// Displacement of each vertex.
fn shifts(volume: &VolumeMesh, rest: &(impl Fn(&Point3) -> Vec3 + Sync)) -> Vec<Vec3> {
    let points = &volume.mesh.points;
    let edges = Edges::of_cells(&volume.mesh.tets, &volume.boundary, points.len());
    let offsets = surface::offsets(volume, &edges);
    let mut around = vec![Around::default(); points.len()];
    for (face, Flat { normal, area, height }) in volume.boundary.iter().zip(Flat::faces(volume, &edges, &offsets)) {
        for v in face {
            let around = &mut around[*v as usize];
            if height == 0.0 {
                around.planes.add(normal);
            } else {
                around.area += area;
                around.height += area * height;
                around.normal += normal * area;
                around.faces += 1;
            }
        }
    }
    let on_curved = |(v, own): (u32, &Around)| {
        (own.area > 0.0).then(|| {
            let shift = own.shift();
            let shift = own.planes.within(shift + rest(&(points[v as usize] + shift)));
            (v, Carried::on_surface(shift, own.edge()))
        })
    };
    let given: Vec<_> = (0..points.len() as u32).into_par_iter().zip(&around).filter_map(on_curved).collect();
    let allowed = |v: u32, shift| around[v as usize].planes.within(shift);
    extend(&Vertices::new(points, &edges, allowed), points.len(), given.into_iter())
}

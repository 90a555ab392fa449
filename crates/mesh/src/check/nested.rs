//! Boundary surfaces that lie where the mesh already is: a piece of the mesh within another that it does not touch.
//!
//! The number of positive tetrahedra over a place is the sum of the winding numbers of the boundary surfaces round it, so
//! it must be 0 or 1. Crossing a surface changes it by one; round a point of a surface the others must therefore wind
//! 0 times when the surface faces outwards, and once when it faces into a cavity.

use super::surfaces::Surfaces;
use crate::geometry::{Aabb, Bvh, Point3, crossing};

/// Relative roundoff of a term of [`Enclosed`], with a wide margin.
const ROUNDOFF: f64 = 1e-14;

/// The volume that a closed surface encloses, with its sign and what rounding may have done to it.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Enclosed {
    volume: f64,
    doubt: f64,
}

impl Enclosed {
    pub(super) fn exactly(volume: f64) -> Self {
        Self { volume, doubt: 0.0 }
    }

    pub(super) fn volume(&self) -> f64 {
        self.volume
    }

    /// Adds a triangle, seen from a point of its surface.
    fn add_triangle(&mut self, from: &Point3, [a, b, c]: [&Point3; 3]) {
        let (d, u, v) = (a - from, b - a, c - a);
        let size = d.abs().sum() * u.abs().sum() * v.abs().sum();
        self.add(Self { volume: u.cross(&v).dot(&d) / 6.0, doubt: ROUNDOFF * size });
    }

    pub(super) fn add(&mut self, other: Self) {
        self.volume += other.volume;
        self.doubt += other.doubt + ROUNDOFF * self.volume.abs();
    }

    /// Whether the surface surely faces into what it encloses.
    pub(super) fn is_cavity(&self) -> bool {
        self.volume < -self.doubt
    }
}

/// Whether a surface round a point of which the others wind `others` times lies where the mesh already is.
pub(super) fn is_within(others: i64, enclosed: &Enclosed) -> bool {
    match others {
        ..=0 => false,
        1 => !enclosed.is_cavity(),
        _ => true,
    }
}

/// The surfaces of a closed boundary that does not touch itself which lie within the mesh, ascending.
pub(super) fn nested_surfaces(points: &[Point3], faces: &[[u32; 3]], surfaces: &Surfaces) -> Vec<u32> {
    if surfaces.all.len() < 2 {
        return Vec::new();
    }
    let corners = |f: u32| faces[f as usize].map(|v| &points[v as usize]);
    let boxes: Vec<Aabb> = (0..faces.len() as u32).map(|f| Aabb::of_points(corners(f))).collect();
    let tree = Bvh::new(&boxes);
    let enclosed = enclosed(points, faces, surfaces);
    let within = |&i: &u32| {
        let p = &points[surfaces.all[i as usize].vertex as usize];
        let ray = Aabb { min: *p, max: Point3::new(f64::INFINITY, p.y, p.z) };
        let mut others = 0;
        tree.query(&ray, |f| {
            if surfaces.of[faces[f as usize][0] as usize] != i {
                others += i64::from(crossing(p, corners(f)).unwrap_or_default());
            }
        });
        is_within(others, &enclosed[i as usize])
    };
    (0..surfaces.all.len() as u32).filter(within).collect()
}

/// What each surface encloses.
pub(super) fn enclosed(points: &[Point3], faces: &[[u32; 3]], surfaces: &Surfaces) -> Vec<Enclosed> {
    let mut enclosed = vec![Enclosed::default(); surfaces.all.len()];
    for face in faces {
        let surface = surfaces.of[face[0] as usize] as usize;
        let from = &points[surfaces.all[surface].vertex as usize];
        enclosed[surface].add_triangle(from, face.map(|v| &points[v as usize]));
    }
    enclosed
}

//! Nested boundary surfaces: a piece of the mesh inside another without contact.
//!
//! The number of positive tetrahedra over a point is the sum of the winding numbers of all boundary surfaces. It must
//! be 0 or 1, and crossing a surface changes it by one. Around a point of an outward surface, the others must therefore
//! wind 0 times, and around a point of a cavity's surface once.

use super::surfaces::Surfaces;
use crate::geometry::{Aabb, Bvh, Point3, crossing};

/// Relative roundoff of a term of [`Enclosed`], with a wide margin.
const ROUNDOFF: f64 = 1e-14;

/// Signed volume enclosed by a closed surface, with a bound on its rounding error.
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

    /// True if the surface certainly bounds a cavity.
    pub(super) fn is_cavity(&self) -> bool {
        self.volume < -self.doubt
    }
}

/// True if a surface lies inside the mesh, given the winding number `others` of all others around it.
pub(super) fn is_within(others: i64, enclosed: &Enclosed) -> bool {
    match others {
        ..=0 => false,
        1 => !enclosed.is_cavity(),
        _ => true,
    }
}

/// Nested surfaces, ascending, of a closed boundary without self-contact.
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

/// Signed volume enclosed by each surface.
pub(super) fn enclosed(points: &[Point3], faces: &[[u32; 3]], surfaces: &Surfaces) -> Vec<Enclosed> {
    let mut enclosed = vec![Enclosed::default(); surfaces.all.len()];
    for face in faces {
        let surface = surfaces.of[face[0] as usize] as usize;
        let from = &points[surfaces.all[surface].vertex as usize];
        enclosed[surface].add_triangle(from, face.map(|v| &points[v as usize]));
    }
    enclosed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::surfaces::surfaces;

    #[test]
    fn the_volume_within_a_surface_and_its_doubt_grow_with_the_cube_of_lengths() {
        let cube = crate::shapes::cube_lattice(3);
        let faces = crate::adjacency::boundary_faces(&cube);
        let of_cube = |length: f64| {
            let points: Vec<Point3> = cube.points.iter().map(|p| p * length).collect();
            enclosed(&points, &faces, &surfaces(points.len(), &faces))[0]
        };
        let unit = of_cube(1.0);
        assert!(unit.doubt > (unit.volume() - 1.0).abs() && unit.doubt < 1e-11, "{unit:?}");
        for length in [2.0_f64.powi(-20), 8.0] {
            let (volume, found) = (length.powi(3), of_cube(length));
            assert_eq!(found, Enclosed { volume: volume * unit.volume, doubt: volume * unit.doubt });
            assert!((found.volume() / volume - 1.0).abs() < 1e-11, "{found:?}");
        }
    }

    #[test]
    fn the_doubt_of_a_sum_is_that_of_its_terms_and_of_the_sum() {
        let mut sum = Enclosed { volume: 1.0, doubt: 0.25 };
        sum.add(Enclosed { volume: -9.0, doubt: 0.5 });
        assert_eq!(sum, Enclosed { volume: -8.0, doubt: 0.25 + (0.5 + ROUNDOFF * 8.0) });
    }

    #[test]
    fn a_cavity_has_a_volume_that_is_certainly_negative() {
        let enclosed = |volume, doubt| Enclosed { volume, doubt };
        assert!(Enclosed::exactly(-1.0).is_cavity() && enclosed(-2e-9, 1e-9).is_cavity());
        assert!(!Enclosed::exactly(0.0).is_cavity() && !Enclosed::exactly(1.0).is_cavity());
        assert!(!enclosed(-1e-9, 2e-9).is_cavity() && !enclosed(1e-9, 2e-9).is_cavity());
        // Within one other surface, only a cavity is not inside the mesh.
        let within = |others, volume| is_within(others, &Enclosed::exactly(volume));
        assert!(!within(0, 1.0) && !within(-1, 1.0) && within(1, 1.0) && !within(1, -1.0) && within(2, -1.0));
    }
}

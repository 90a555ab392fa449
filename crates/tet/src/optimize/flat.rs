//! The last resort for flat tetrahedra, which hurt every solver: whatever the purse of the thorough improvement says, each
//! is taken out as long as that is possible. Recovery leaves them within patches that are plane but for the last bits.
//! Those that are merely thin, and thinner than the triangles that stay call for, get a purse of their own.

use super::Improver;
use super::allowance::Allowance;

/// Radius ratio below which a tetrahedron counts as flat.
pub(super) const FLAT: f64 = 1e-9;
/// Radius ratio below which it counts as thin, and the part of what its triangles allow below which they are not to blame.
const THIN: f64 = 1e-3;
const TO_BLAME: f64 = 0.1;
/// Thin ones are tried once for so many tetrahedra of the mesh, or this many times where it is small.
const MOST: (usize, usize) = (50, 50);
/// Maximum passes over the flat tetrahedra that are left. Their neighbours may have changed since the last pass.
const MAX_FLAT_PASSES: usize = 12;
/// Size of the cavities that are reconnected, and steps of the search.
const CAVITY: (usize, usize) = (20, 5000);
/// Layers of tetrahedra around a flat one in which a vertex is tried.
const LAYERS: usize = 3;

impl Improver<'_> {
    /// Takes flat and thin tetrahedra out, but for those of which the surface has all faces. Returns how many flat ones
    /// are left.
    pub(super) fn dissolve_flat(&mut self) -> usize {
        let list = self.worst_first(THIN);
        let none = list.is_empty();
        self.keep_list(list);
        if none {
            return 0;
        }
        let allowance = Allowance::of(&self.c);
        let mut purse = (self.c.real_tets().count() / MOST.0).max(MOST.1);
        for _ in 0..MAX_FLAT_PASSES {
            let list = self.worst_first(THIN);
            let mut changes = 0;
            for &(q, t) in &list {
                let wanted = q < FLAT || (purse > 0 && q < TO_BLAME * allowance.of_tet(&self.c.verts(t)));
                if wanted && self.is_loose((q, t)) {
                    purse = purse.saturating_sub(usize::from(q >= FLAT));
                    changes += usize::from(self.dissolve(t));
                }
            }
            self.keep_list(list);
            if changes == 0 {
                break;
            }
        }
        let list = self.worst_first(FLAT);
        let left = list.iter().filter(|&&entry| self.is_loose(entry)).count();
        self.keep_list(list);
        left
    }

    /// Whether an entry of a list still describes a tetrahedron, and that has a face that may go.
    fn is_loose(&self, (q, t): (f64, u32)) -> bool {
        let stays = |half: u32| self.c.is_frozen(half) || self.c.is_ghost(self.c.mate(half) >> 2);
        self.is_current((q, t)) && !(4 * t..4 * t + 4).all(stays)
    }

    fn dissolve(&mut self, t: u32) -> bool {
        // What was searched in vain for less is searched for longer.
        self.reconnection.forget();
        if self.treat_with_all(t) {
            // A corner may have been moved alone.
            return true;
        }
        self.reconnection.forget();
        if self.reconnect(t, CAVITY.0, CAVITY.1) {
            self.report.flips += 1;
            return true;
        }
        let inserted = self.insert_beside(t, FLAT, LAYERS);
        self.report.inserted += usize::from(inserted);
        inserted
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::delaunay::delaunay;
    use crate::optimize::OptimizeOptions;
    use anastomesh_mesh::geometry::Point3;
    use nalgebra::{Rotation3, Vector3};

    /// The Delaunay tetrahedralization of a turned lattice, the eight corners of each cube of which lie on a sphere but for
    /// rounding, and of points around it.
    fn turned_lattice(n: u32) -> Improver<'static> {
        let turn = Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(Vector3::new(1.0, 2.0, 3.0)), 0.7);
        let all = (0..n).flat_map(|i| (0..n).flat_map(move |j| (0..n).map(move |k| [i, j, k])));
        let middle = Vector3::repeat(0.5 * f64::from(n - 1));
        let mut points: Vec<Point3> = all.map(|x| turn * (Point3::from(x.map(f64::from)) - middle)).collect();
        for i in 0..80 {
            let z: f64 = (f64::from(i) + 0.5) / 40.0 - 1.0;
            let (sin, cos) = (f64::from(i) * 2.399_963).sin_cos();
            let flat = (1.0 - z * z).sqrt();
            points.push(Point3::new(flat * cos, flat * sin, z) * (1.2 * f64::from(n)));
        }
        let c = delaunay(&points).unwrap();
        Improver::new(c, &OptimizeOptions { fixed_points: points.len(), ..OptimizeOptions::full() })
    }

    fn flat(improver: &Improver) -> usize {
        improver.c.real_tets().filter(|&t| improver.quality[t as usize] < FLAT).count()
    }

    #[test]
    fn flat_ones_between_points_that_stay_go() {
        let mut improver = turned_lattice(4);
        let before = flat(&improver);
        assert!(before > 10, "{before}");
        assert_eq!(improver.dissolve_flat(), 0, "of {before}");
        improver.c.sanity_check().unwrap();
        assert_eq!(flat(&improver), 0);
    }

    #[test]
    fn flat_ones_under_a_face_that_stays_go() {
        // A square whose corners are plane but for rounding, and a triangle with a point in it; both under what is given.
        let p = |x: f64, y: f64, z: f64| Point3::new(x, y, z);
        let square = vec![p(0., 0., 0.), p(1., 0., 1e-15), p(1., 1., 0.), p(0., 1., 1e-15), p(0.5, 0.5, -1.)];
        let triangle = vec![p(0., 0., 0.), p(3., 0., 0.), p(0., 3., 0.), p(1., 1., 1e-15), p(1., 1., -2.)];
        let cases =
            [(square, vec![[0, 1, 2, 3], [0, 2, 1, 4], [0, 3, 2, 4]]), (triangle, vec![[0, 2, 1, 3], [0, 1, 2, 4]])];
        for (points, mut tets) in cases {
            for t in &mut tets {
                let [a, b, c, d] = t.map(|v: u32| &points[v as usize]);
                if anastomesh_mesh::geometry::predicates::orient3d(a, b, c, d) < 0.0 {
                    t.swap(0, 1);
                }
            }
            let c = crate::complex::Complex::from_mesh(points, &tets).unwrap();
            let mut improver = Improver::new(c, &OptimizeOptions { fixed_points: 5, ..OptimizeOptions::full() });
            assert_eq!((flat(&improver), improver.dissolve_flat(), flat(&improver)), (1, 0, 0));
            improver.c.sanity_check().unwrap();
        }
    }
}

//! Removal of flat tetrahedra, which harm every solver. Each one is removed if possible, whatever the budget of the
//! thorough improvement. Boundary recovery leaves them in patches that are flat up to rounding. Thin tetrahedra,
//! thinner than their fixed triangles require, have a budget of their own.

use super::Improver;
use super::allowance::Allowance;

/// Radius ratio below which a tetrahedron counts as flat.
pub(super) const FLAT: f64 = 1e-9;
/// Radius ratio below which it counts as thin, and its maximum fraction of the attainable ratio.
const THIN: f64 = 1e-3;
const MAX_THIN_SHARE: f64 = 0.1;
/// Maximum attempts on thin tetrahedra: one per 50 tetrahedra of the mesh, but at least 50.
const MOST: (usize, usize) = (50, 50);
/// Maximum rounds over the remaining ones, since their surroundings may have changed.
const MAX_FLAT_PASSES: usize = 12;
/// Size of the cavities to reconnect, and steps of the search.
const CAVITY: (usize, usize) = (20, 5000);
/// Layers of tetrahedra around a flat one in which a vertex is tried.
const LAYERS: usize = 3;

impl Improver<'_> {
    /// Removes flat and thin tetrahedra, unless all faces are on the surface. Returns the number of flat ones left.
    pub(super) fn dissolve_flat(&mut self) -> usize {
        let list = self.worst_first(THIN);
        let none = list.is_empty();
        self.keep_list(list);
        if none {
            return 0;
        }
        let allowance = Allowance::of(&self.c);
        let mut budget = (self.c.real_tets().count() / MOST.0).max(MOST.1);
        for _ in 0..MAX_FLAT_PASSES {
            let list = self.worst_first(THIN);
            let mut changes = 0;
            for &(q, t) in &list {
                let wanted = q < FLAT || (budget > 0 && q < MAX_THIN_SHARE * allowance.of_tet(&self.c.verts(t)));
                if wanted && self.is_loose((q, t)) {
                    budget = budget.saturating_sub(usize::from(q >= FLAT));
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

    /// True if a list entry still describes its tetrahedron and one of its faces may be removed.
    fn is_loose(&self, (q, t): (f64, u32)) -> bool {
        let stays = |half: u32| self.c.is_frozen(half) || self.c.is_ghost(self.c.mate(half) >> 2);
        self.is_current((q, t)) && !(4 * t..4 * t + 4).all(stays)
    }

    fn dissolve(&mut self, t: u32) -> bool {
        // Searches repeat with more steps than before.
        self.reconnection.forget();
        if self.treat_with_all(t) {
            // Only a corner may have moved.
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

    /// Delaunay tetrahedralization of a rotated lattice in a sphere of points. The eight corners of each cube are
    /// cospherical up to rounding.
    fn turned_lattice(n: u32) -> Improver<'static> {
        let turn = Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(Vector3::new(1.0, 2.0, 3.0)), 0.7);
        let all = (0..n).flat_map(|i| (0..n).flat_map(move |j| (0..n).map(move |k| [i, j, k])));
        let middle = Vector3::repeat(0.5 * f64::from(n - 1));
        let mut points: Vec<Point3> = all.map(|x| turn * (Point3::from(x.map(f64::from)) - middle)).collect();
        for i in 0..80 {
            let z: f64 = (f64::from(i) + 0.5) / 40.0 - 1.0;
            let (sin, cos) = libm::sincos(f64::from(i) * 2.399_963);
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
        // A square with corners coplanar up to rounding, and a triangle with a point in it; both under a given face.
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

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
/// Rounds over those that are left; what is around them may have changed.
const ROUNDS: usize = 4;
/// Size of the cavities that are reconnected, and steps of the search.
const CAVITY: (usize, usize) = (20, 5000);
/// Layers of tetrahedra around a flat one in which a vertex is tried.
const LAYERS: usize = 3;

impl Improver {
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
        for _ in 0..ROUNDS {
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
        let inserted = self.insert_beside(t, LAYERS);
        self.report.inserted += usize::from(inserted);
        inserted
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point3;
    use crate::tet::delaunay::delaunay;
    use crate::tet::optimize::OptimizeOptions;
    use nalgebra::{Rotation3, Vector3};

    /// The Delaunay tetrahedralization of a turned lattice: its sides are plane but for rounding, and the eight corners of
    /// each cube lie on a sphere.
    fn turned_lattice(n: u32, keep: impl Fn([u32; 3]) -> bool) -> Improver {
        let turn = Rotation3::from_axis_angle(&nalgebra::Unit::new_normalize(Vector3::new(1.0, 2.0, 3.0)), 0.7);
        let all = (0..=n).flat_map(|i| (0..=n).flat_map(move |j| (0..=n).map(move |k| [i, j, k])));
        let points: Vec<Point3> = all.filter(|&x| keep(x)).map(|x| turn * Point3::from(x.map(f64::from))).collect();
        let c = delaunay(&points).unwrap();
        Improver::new(c, &OptimizeOptions { fixed_points: points.len(), ..OptimizeOptions::full() })
    }

    fn flat(improver: &Improver) -> usize {
        improver.c.real_tets().filter(|&t| improver.quality[t as usize] < FLAT).count()
    }

    #[test]
    fn flat_ones_within_sides_that_are_all_but_plane_go() {
        for hollow in [false, true] {
            let mut improver = turned_lattice(5, |x| !hollow || x.iter().any(|&i| i == 0 || i == 5));
            let hull = |c: &crate::tet::complex::Complex| {
                let mut faces: Vec<[u32; 3]> = c
                    .real_tets()
                    .flat_map(|t| 4 * t..4 * t + 4)
                    .filter(|&h| c.is_ghost(c.mate(h) >> 2))
                    .map(|h| crate::tet::complex::face_key(c.face(h)))
                    .collect();
                faces.sort_unstable();
                faces
            };
            let (before, faces) = (flat(&improver), hull(&improver.c));
            assert!(before > 10, "{before}");
            assert_eq!(improver.dissolve_flat(), 0, "of {before}");
            improver.c.sanity_check().unwrap();
            assert_eq!(hull(&improver.c), faces);
            let all_given = improver.c.real_tets().filter(|&t| {
                improver.quality[t as usize] < FLAT && (0..4).all(|i| improver.c.is_ghost(improver.c.neighbor(t, i)))
            });
            assert_eq!(flat(&improver), all_given.count());
        }
    }
}

//! Removal of flat tetrahedra. The Delaunay tetrahedralization has them where points are coplanar up to rounding.

use super::Recovery;
use super::rule::Rule;
use crate::complex::Complex;
use crate::input::SurfaceEdges;
use crate::progress::Watch;
use anastomesh_mesh::TriMesh;

/// Maximum depth of nested flips for a flat tetrahedron.
const DEPTH: u32 = 2;

/// Maximum flips for one flat tetrahedron.
const BUDGET: u32 = 100;

/// Flips away tetrahedra no thicker than `height`, if possible without loss of recovered surface parts.
pub(super) fn dissolve_flat(c: &mut Complex, surface: &TriMesh, edges: &SurfaceEdges, height: f64) {
    Recovery::new(c, surface, (edges, Rule::Thick(height)), &Watch::NOBODY).dissolve();
}

impl Recovery<'_> {
    /// Flips away tetrahedra that the rule forbids, if possible.
    pub(super) fn dissolve(&mut self) {
        if self.rule == Rule::Positive {
            return;
        }
        let flat: Vec<[u32; 4]> =
            self.c.real_tets().map(|t| self.c.verts(t)).filter(|v| !self.rule.allows(self.c, v)).collect();
        for v in flat {
            self.budget = BUDGET;
            self.journal.clear();
            self.failed.clear();
            self.dissolve_one(v);
        }
    }

    fn dissolve_one(&mut self, v: [u32; 4]) -> bool {
        let Some(t) = self.find_tet(v) else { return true };
        if (4 * t..4 * t + 4).any(|half| self.flip_face(half).is_ok()) {
            return true;
        }
        for i in 0..4 {
            for j in 0..i {
                let Some(t) = self.find_tet(v) else { return true };
                if self.clear_edge(t, v[i], v[j], DEPTH) {
                    return true;
                }
            }
        }
        self.find_tet(v).is_none()
    }

    fn find_tet(&mut self, v: [u32; 4]) -> Option<u32> {
        self.star.around(self.c, v[0]).iter().copied().find(|&t| v.iter().all(|&x| self.c.slot_of(t, x).is_some()))
    }
}

//! Certificate of a tetrahedralization of points: its tetrahedra fill the convex hull of the points exactly once.
//!
//! The stored neighbours of a [`Complex`] serve as a witness: the pass verifies each of them and searches for none. Positive
//! tetrahedra whose faces are glued in pairs cover a point as often as the hull's faces wind around it. All hull faces have
//! one common tetrahedron on their inner side. They wind around its interior as often as a ray from there crosses them. If
//! the ray crosses once, the hull bounds a star-shaped solid that is covered once. If no dihedral angle exceeds π, the solid
//! is convex.
//! (Mehlhorn et al., 'Checking geometric programs or verification of geometric structures', 1999.) No two tetrahedra
//! overlap then. This excludes repeated tetrahedra, repeated points and faces of three tetrahedra.

use super::certify::CertifyError;
use super::complex::{Cell, Complex, face_of, opposed};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::predicates::{orient2d, orient3d};

/// Proves that the tetrahedra of a complex fill the convex hull of its points, and returns the outward faces of the hull.
///
/// One pass over the tetrahedra and one over the ghosts, without copies, verify these conditions:
///
/// - Every tetrahedron is positive by the exact predicate.
/// - Every face is glued mutually to one face with the same vertices on the other side.
/// - Every point has a tetrahedron.
/// - The faces of the hull, each under a ghost, form a convex surface by exact predicates.
/// - That surface winds once around the tetrahedra.
///
/// # Errors
/// The first violated condition.
pub fn certify_hull(c: &Complex) -> Result<Vec<[u32; 3]>, CertifyError> {
    let hull = check_gluing(c)?;
    check_convexity(c, &hull)?;
    check_winding(c, &hull)?;
    Ok(hull.iter().map(|&half| c.face(half)).collect())
}

/// Number of cells whose points and neighbours are fetched before the first one is checked, so that memory latencies
/// overlap. A block of 16 KiB stays in the first-level cache.
const BLOCK: usize = 64;

/// Checks tetrahedra, ghosts and their neighbours; returns the half-faces under the ghosts in ascending order.
fn check_gluing(c: &Complex) -> Result<Vec<u32>, CertifyError> {
    let mut pass = Pass::new(c);
    for first in (0..c.slots() as u32).step_by(BLOCK) {
        pass.check_orientation(first)?;
        pass.check_neighbors(first)?;
    }
    pass.finish()
}

/// The pass over all cells.
struct Pass<'a> {
    c: &'a Complex,
    used: Vec<bool>,
    hull: Vec<u32>,
    /// Half-faces of tetrahedra and ghosts.
    halves: usize,
    /// Half-faces whose mates point back at them.
    glued: usize,
    corners: [[Point3; 4]; BLOCK],
    /// Upper half-face of each glued pair, its mate, and the cell of the mate.
    pairs: Vec<(u32, u32)>,
    others: Vec<Cell>,
}

impl<'a> Pass<'a> {
    fn new(c: &'a Complex) -> Self {
        Self {
            c,
            used: vec![false; c.points.len()],
            hull: Vec::new(),
            halves: 0,
            glued: 0,
            corners: [[Point3::origin(); 4]; BLOCK],
            pairs: vec![(0, 0); 4 * BLOCK],
            others: vec![Cell::EMPTY; 4 * BLOCK],
        }
    }

    fn check_orientation(&mut self, first: u32) -> Result<(), CertifyError> {
        let cells = self.c.block(first, BLOCK);
        if let Some(last) = self.c.points.len().checked_sub(1) {
            for (corners, cell) in self.corners.iter_mut().zip(cells) {
                for (corner, &v) in corners.iter_mut().zip(&cell.verts) {
                    *corner = self.c.points[last.min(v as usize)];
                }
            }
        }
        for ((tet, cell), [p, q, r, s]) in (first..).zip(cells).zip(&self.corners) {
            if !self.c.is_real(tet) {
                continue;
            }
            let known = cell.verts.iter().all(|&v| (v as usize) < self.used.len());
            let is_positive = known && orient3d(p, q, r, s) > 0.0;
            if !is_positive {
                return Err(CertifyError::NotPositive { tet, vertices: cell.verts });
            }
            for v in cell.verts {
                self.used[v as usize] = true;
            }
        }
        Ok(())
    }

    /// Checks the upper half-face of each glued pair: the cell of the lower one may still be in the cache.
    fn check_neighbors(&mut self, first: u32) -> Result<(), CertifyError> {
        let cells = self.c.block(first, BLOCK);
        let mut count = 0;
        for (t, cell) in (first..).zip(cells).filter(|&(t, _)| self.c.is_alive(t)) {
            self.halves += 4;
            if self.c.is_ghost(t) {
                self.hull.push(cell.mates[3]);
            }
            for (half, &mate) in (4 * t..).zip(&cell.mates) {
                self.pairs[count] = (half, mate);
                count += usize::from(mate < half);
            }
        }
        let pairs = &self.pairs[..count];
        for (other, &(_, mate)) in self.others.iter_mut().zip(pairs) {
            *other = *self.c.cell(mate >> 2);
        }
        for (&(half, mate), other) in pairs.iter().zip(&self.others) {
            let face = face_of(&cells[((half >> 2) - first) as usize].verts, (half & 3) as usize);
            let i = (mate & 3) as usize;
            if other.mates[i] != half || !opposed(face, face_of(&other.verts, i)) {
                return Err(CertifyError::NotConforming { face });
            }
        }
        self.glued += 2 * count;
        Ok(())
    }

    fn finish(mut self) -> Result<Vec<u32>, CertifyError> {
        let c = self.c;
        if self.glued != self.halves {
            return Err(CertifyError::NotConforming { face: one_sided(c).map_or([0; 3], |half| c.face(half)) });
        }
        if let Some(&half) = self.hull.iter().find(|&&half| !c.is_real(half >> 2)) {
            return Err(CertifyError::NotConforming { face: c.face(half) });
        }
        if let Some(point) = self.used.iter().position(|used| !used) {
            return Err(CertifyError::PointUnused { point: point as u32 });
        }
        self.hull.sort_unstable();
        Ok(self.hull)
    }
}

/// First half-face whose mate does not refer back to it. Mates below their half-faces have been checked.
fn one_sided(c: &Complex) -> Option<u32> {
    let alive = (0..c.slots() as u32).filter(|&t| c.is_alive(t));
    let points_back = |half: u32, mate: u32| (mate >> 2) < c.slots() as u32 && c.mate(mate) == half && mate != half;
    alive.flat_map(|t| 4 * t..4 * t + 4).find(|&half| !points_back(half, c.mate(half)))
}

/// Checks that no two neighbouring faces of the hull form a dihedral angle above π.
fn check_convexity(c: &Complex, hull: &[u32]) -> Result<(), CertifyError> {
    for &half in hull {
        let ghost = c.mate(half) & !3;
        let beside = (ghost..ghost + 3).map(|edge| (edge, c.mate(edge))).filter(|(edge, mate)| edge < mate);
        for (_, mate) in beside {
            if side_of(c, half, c.apex(mate)) > 0.0 {
                return Err(CertifyError::NotConvex { face: c.face(half) });
            }
        }
    }
    Ok(())
}

/// Positive when a vertex lies outside of the plane of a hull face, negative when inside.
fn side_of(c: &Complex, half: u32, v: u32) -> f64 {
    let [p, q, r] = c.face(half).map(|v| &c.points[v as usize]);
    orient3d(p, q, r, &c.points[v as usize])
}

/// Checks that the hull winds once around the first tetrahedron.
fn check_winding(c: &Complex, hull: &[u32]) -> Result<(), CertifyError> {
    let Some(tet) = c.real_tets().next() else { return Ok(()) };
    let vertices = c.verts(tet);
    let corners = vertices.map(|v| shadow(&c.points[v as usize]));
    let mut crossed = 0;
    for &half in hull {
        if vertices.iter().any(|&v| side_of(c, half, v) > 0.0) {
            return Err(CertifyError::NotConvex { face: c.face(half) });
        }
        crossed += usize::from(is_above(corners, c.face(half).map(|v| shadow(&c.points[v as usize]))));
    }
    if crossed == 1 { Ok(()) } else { Err(CertifyError::Winding { tet, crossed }) }
}

/// The projection of a point along the z-axis.
fn shadow(p: &Point3) -> [f64; 2] {
    [p.x, p.y]
}

/// True if a face, oriented outwards, is crossed by the ray in direction z from inside the tetrahedron with these corners. The
/// ray begins at the first corner, moved by ε, ε² and ε³ of the way to each of the others: it misses all edges.
fn is_above(corners: [[f64; 2]; 4], [p, q, r]: [[f64; 2]; 3]) -> bool {
    let left_of = |from, to| corners.iter().map(|&o| orient2d(from, to, o)).find(|&side| side != 0.0);
    orient2d(p, q, r) > 0.0 && [(p, q), (q, r), (r, p)].iter().all(|&(from, to)| left_of(from, to) > Some(0.0))
}

#[cfg(test)]
mod tests;

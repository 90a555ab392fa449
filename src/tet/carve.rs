//! Carving: what lies outside the recovered surface goes.

use super::complex::{Complex, NONE};
use super::error::TetError;
use super::star::Star;
use crate::mesh::TriMesh;

const UNSEEN: u8 = 2;

/// Keeps the tetrahedra inside the surface, whose triangles are the frozen faces of `c`, and drops the points that are
/// neither the surface's nor in use. Crossing a frozen face changes sides, so shells may be nested.
///
/// # Errors
/// [`TetError::NotSeparating`] when a triangle has the same side on both sides, or faces inwards.
pub(super) fn carve(c: &Complex, surface: &TriMesh) -> Result<Complex, TetError> {
    let side = sides(c);
    check_sides(c, surface, &side)?;
    let n = surface.points.len();
    let mut id = vec![NONE; c.points.len()];
    for (v, slot) in id.iter_mut().enumerate().take(n) {
        *slot = v as u32;
    }
    for t in c.real_tets().filter(|&t| side[t as usize] == 1) {
        for v in c.verts(t) {
            if v as usize >= n {
                id[v as usize] = 0;
            }
        }
    }
    let mut points = surface.points.clone();
    for (slot, p) in id.iter_mut().zip(&c.points).skip(n) {
        if *slot == 0 {
            *slot = points.len() as u32;
            points.push(*p);
        }
    }
    Ok(c.part(points, &id, |t| side[t as usize] == 1))
}

/// For every tetrahedron 0 outside, 1 inside: the parity of frozen faces on the way from infinity.
fn sides(c: &Complex) -> Vec<u8> {
    let mut side = vec![UNSEEN; c.slots()];
    let mut stack = Vec::new();
    if let Some(ghost) = (0..c.slots() as u32).find(|&t| c.is_alive(t) && c.is_ghost(t)) {
        side[ghost as usize] = 0;
        stack.push(ghost);
    }
    while let Some(t) = stack.pop() {
        for i in 0..4 {
            let half = 4 * t + i;
            let n = c.mate(half) >> 2;
            if side[n as usize] == UNSEEN {
                side[n as usize] = side[t as usize] ^ u8::from(c.is_frozen(half));
                stack.push(n);
            }
        }
    }
    side
}

/// Each triangle must have the inside behind it and the outside before it.
fn check_sides(c: &Complex, surface: &TriMesh, side: &[u8]) -> Result<(), TetError> {
    let mut star = Star::default();
    for t in c.real_tets() {
        for i in 0..4 {
            let half = 4 * t + i;
            if !c.is_frozen(half) || side[t as usize] != side[(c.mate(half) >> 2) as usize] {
                continue;
            }
            let f = c.face(half);
            let triangle = surface.triangles.iter().position(|tri| tri.iter().all(|v| f.contains(v)));
            return Err(TetError::NotSeparating { triangle: triangle.unwrap_or(0) as u32 });
        }
    }
    // One triangle of each shell tells how the whole shell is turned; the certificate checks the rest.
    if let Some(tri) = surface.triangles.first()
        && let Some(half) = star.find_face(c, *tri)
    {
        let f = c.face(half);
        let turn = f.iter().position(|&v| v == tri[0]).unwrap_or(0);
        let same = f[(turn + 1) % 3] == tri[1];
        let behind = if same { half >> 2 } else { c.mate(half) >> 2 };
        if side[behind as usize] != 1 {
            return Err(TetError::NotSeparating { triangle: 0 });
        }
    }
    Ok(())
}

//! Carving: what lies outside of the recovered surface goes.

use super::complex::{Complex, NONE};
use super::error::TetError;
use super::input::Offenders;
use super::plc::InputKind;
use super::regions::tets_of_seeds;
use super::star::Star;
use crate::geometry::Point3;
use crate::mesh::TriMesh;

const UNSEEN: u8 = 2;
const OUTSIDE: u8 = 0;
const INSIDE: u8 = 1;

/// Keeps the tetrahedra inside the surface, whose triangles are the frozen faces of `c`, and drops the points that are
/// neither the surface's nor in use.
///
/// # Errors
/// [`TetError::NotSeparating`] when a triangle of a closed surface has the same side on both sides;
/// [`TetError::NothingEnclosed`], [`TetError::Outside`] and [`TetError::BadSeed`] for other complexes.
pub(super) fn carve(c: &Complex, surface: &TriMesh, kind: InputKind, holes: &[Point3]) -> Result<Complex, TetError> {
    let side = match kind {
        InputKind::Closed => sides_by_parity(c, surface)?,
        InputKind::Plc => sides_by_reach(c, surface, holes)?,
    };
    let n = surface.points.len();
    let mut id = vec![NONE; c.points.len()];
    for (v, slot) in id.iter_mut().enumerate().take(n) {
        *slot = v as u32;
    }
    for t in c.real_tets().filter(|&t| side[t as usize] == INSIDE) {
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
    Ok(c.part(points, &id, |t| side[t as usize] == INSIDE))
}

/// Some ghost: it is outside.
fn infinity(c: &Complex) -> Option<u32> {
    (0..c.slots() as u32).find(|&t| c.is_alive(t) && c.is_ghost(t))
}

/// For every tetrahedron the parity of frozen faces on the way from infinity: crossing one changes sides, so shells may
/// be nested, and it does not matter which way they are turned.
fn sides_by_parity(c: &Complex, surface: &TriMesh) -> Result<Vec<u8>, TetError> {
    let mut side = vec![UNSEEN; c.slots()];
    let mut stack = Vec::new();
    if let Some(ghost) = infinity(c) {
        side[ghost as usize] = OUTSIDE;
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
    let halves = c.real_tets().flat_map(|t| (0..4).map(move |i| 4 * t + i));
    let mut lost = halves
        .filter(|&h| (side[(h >> 2) as usize] == side[(c.mate(h) >> 2) as usize]) == c.is_frozen(h))
        .map(|h| triangle_at(c, surface, h));
    match lost.next() {
        Some(triangle) => Err(TetError::NotSeparating { triangle }),
        None => Ok(side),
    }
}

/// The triangle with the vertices of a half-face.
fn triangle_at(c: &Complex, surface: &TriMesh, half: u32) -> u32 {
    let f = c.face(half);
    surface.triangles.iter().position(|t| t.iter().all(|v| f.contains(v))).unwrap_or(0) as u32
}

/// For every tetrahedron whether it can be reached from infinity or from a hole without crossing a frozen face.
fn sides_by_reach(c: &Complex, surface: &TriMesh, holes: &[Point3]) -> Result<Vec<u8>, TetError> {
    let mut side = vec![INSIDE; c.slots()];
    let mut stack: Vec<u32> = infinity(c).into_iter().collect();
    for (index, (t, &position)) in tets_of_seeds(c, holes).into_iter().zip(holes).enumerate() {
        stack.push(t.ok_or(TetError::BadSeed { what: "holes", index: index as u32, position })?);
    }
    for &t in &stack {
        side[t as usize] = OUTSIDE;
    }
    while let Some(t) = stack.pop() {
        for i in 0..4 {
            let half = 4 * t + i;
            let n = c.mate(half) >> 2;
            if side[n as usize] == INSIDE && !c.is_frozen(half) {
                side[n as usize] = OUTSIDE;
                stack.push(n);
            }
        }
    }
    if !c.real_tets().any(|t| side[t as usize] == INSIDE) {
        return Err(TetError::NothingEnclosed);
    }
    let mut halves = c.real_tets().flat_map(|t| (0..4).map(move |i| 4 * t + i));
    let lost = |h: u32| c.is_frozen(h) && side[(h >> 2) as usize] + side[(c.mate(h) >> 2) as usize] == 2 * OUTSIDE;
    if halves.any(lost) {
        let (mut star, mut found) = (Star::default(), Offenders::default());
        for (&triangle, i) in surface.triangles.iter().zip(0..) {
            if star.find_face(c, triangle).is_none_or(lost) {
                found.add(i);
            }
        }
        return Err(TetError::Outside { what: "triangles", ids: found.named, count: found.count });
    }
    Ok(side)
}

/// Checks that the segments of a complex are edges of what is left after carving.
pub(super) fn check_segments(carved: &Complex, segments: &[[u32; 2]]) -> Result<(), TetError> {
    let mut star = Star::default();
    let mut found = Offenders::default();
    for (&[a, b], i) in segments.iter().zip(0..) {
        if star.find_edge(carved, a, b).is_none() {
            found.add(i);
        }
    }
    let Offenders { named: ids, count } = found;
    if count == 0 { Ok(()) } else { Err(TetError::Outside { what: "segments", ids, count }) }
}

/// Freezes the faces around the segments of a complex that are no edges of triangles, so that no improvement of the
/// mesh removes them. Returns the faces, to be thawed by [`release_segments`].
pub(super) fn hold_segments(c: &mut Complex, segments: &[[u32; 2]]) -> Vec<[u32; 3]> {
    let mut star = Star::default();
    let mut ring = super::star::EdgeRing::default();
    let mut held = Vec::new();
    for &[a, b] in segments {
        let Some(t) = star.find_edge(c, a, b) else { continue };
        if !ring.collect(c, t, a, b, usize::MAX) || ring.touches_ghost() {
            continue;
        }
        for i in 0..ring.len() {
            if let Some(half) = ring.spoke(c, i)
                && !c.is_frozen(half)
            {
                c.freeze(half);
                held.push(c.face(half));
            }
        }
    }
    held
}

/// Thaws faces.
pub(super) fn release_segments(c: &mut Complex, held: &[[u32; 3]]) {
    let mut star = Star::default();
    for &f in held {
        if let Some(half) = star.find_face(c, f) {
            c.thaw(half);
        }
    }
}

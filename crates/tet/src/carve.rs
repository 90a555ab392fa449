//! Carving: removal of the tetrahedra outside the recovered surface.

use super::complex::{Complex, NONE, face_key};
use super::error::{SeedKind, TetError};
use super::plc::InputKind;
use super::regions::tets_of_seeds;
use super::star::Star;
use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::Point3;
use rustc_hash::FxHashSet;

const UNSEEN: u8 = 2;
const OUTSIDE: u8 = 0;
const INSIDE: u8 = 1;

/// Side of each tetrahedron of a complex.
pub(super) struct Sides(Vec<u8>);

impl Sides {
    /// Finds the sides for a surface whose triangles are the frozen faces of `c`.
    ///
    /// # Errors
    /// [`TetError::NotSeparating`] if a triangle of a closed surface has the same side on both sides;
    /// [`TetError::NothingEnclosed`] and [`TetError::BadSeed`] for other complexes.
    pub(super) fn find(c: &Complex, surface: &TriMesh, kind: InputKind, holes: &[Point3]) -> Result<Self, TetError> {
        match kind {
            InputKind::Closed => sides_by_parity(c, surface, 0),
            InputKind::Plc => sides_by_reach(c, holes),
        }
        .map(Self)
    }

    /// Finds the sides for a closed surface whose last triangles, `baffles` in number, separate nothing.
    ///
    /// # Errors
    /// [`TetError::NotSeparating`] if another triangle has the same side on both sides.
    pub(super) fn find_around(c: &Complex, surface: &TriMesh, baffles: usize) -> Result<Self, TetError> {
        sides_by_parity(c, surface, baffles).map(Self)
    }

    /// True if a tetrahedron is kept.
    pub(super) fn is_inside(&self, t: u32) -> bool {
        self.0[t as usize] == INSIDE
    }

    /// True if neither tetrahedron at a half-face is kept.
    pub(super) fn outside_of_both(&self, c: &Complex, half: u32) -> bool {
        !self.is_inside(half >> 2) && !self.is_inside(c.mate(half) >> 2)
    }

    /// True if a triangle of the surface lies between two tetrahedra that are not kept.
    pub(super) fn has_faces_outside(&self, c: &Complex) -> bool {
        let mut halves = c.real_tets().flat_map(|t| (0..4).map(move |i| 4 * t + i));
        halves.any(|h| c.is_frozen(h) && self.outside_of_both(c, h))
    }
}

/// Keeps the tetrahedra inside the surface and drops points that are neither the surface's nor used.
pub(super) fn carve(c: &Complex, surface: &TriMesh, sides: &Sides) -> Complex {
    let n = surface.points.len();
    let mut id = vec![NONE; c.points.len()];
    for (v, slot) in id.iter_mut().enumerate().take(n) {
        *slot = v as u32;
    }
    for t in c.real_tets().filter(|&t| sides.is_inside(t)) {
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
    c.part(points, &id, |t| sides.is_inside(t))
}

/// Any ghost, which is outside.
fn infinity(c: &Complex) -> Option<u32> {
    (0..c.slots() as u32).find(|&t| c.is_alive(t) && c.is_ghost(t))
}

/// Parity of the frozen faces between each tetrahedron and infinity. Crossing one changes sides, so shells may be
/// nested and have any orientation.
fn sides_by_parity(c: &Complex, surface: &TriMesh, baffles: usize) -> Result<Vec<u8>, TetError> {
    let boundary = surface.triangles.len().saturating_sub(baffles);
    let inside: FxHashSet<[u32; 3]> = surface.triangles[boundary..].iter().map(|&t| face_key(t)).collect();
    let separates = |half: u32| c.is_frozen(half) && !inside.contains(&face_key(c.face(half)));
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
                side[n as usize] = side[t as usize] ^ u8::from(separates(half));
                stack.push(n);
            }
        }
    }
    let halves = c.real_tets().flat_map(|t| (0..4).map(move |i| 4 * t + i));
    let mut lost = halves
        .filter(|&h| (side[(h >> 2) as usize] == side[(c.mate(h) >> 2) as usize]) == separates(h))
        .map(|h| triangle_at(c, surface, h));
    match lost.next() {
        Some(triangle) => Err(TetError::NotSeparating { triangle }),
        None => Ok(side),
    }
}

/// Triangle with the vertices of a half-face.
fn triangle_at(c: &Complex, surface: &TriMesh, half: u32) -> u32 {
    let f = c.face(half);
    surface.triangles.iter().position(|t| t.iter().all(|v| f.contains(v))).unwrap_or(0) as u32
}

/// Marks as outside each tetrahedron that is reachable from infinity or a hole without crossing a frozen face.
fn sides_by_reach(c: &Complex, holes: &[Point3]) -> Result<Vec<u8>, TetError> {
    let mut side = vec![INSIDE; c.slots()];
    let mut stack: Vec<u32> = infinity(c).into_iter().collect();
    for (index, (t, &position)) in tets_of_seeds(c, holes).into_iter().zip(holes).enumerate() {
        stack.push(t.ok_or(TetError::BadSeed { seed: SeedKind::Hole, index: index as u32, position })?);
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
    Ok(side)
}

/// Freezes the faces around segments that are no edges of triangles, so that mesh improvement keeps them. Returns the
/// faces, to be thawed by [`release_segments`].
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

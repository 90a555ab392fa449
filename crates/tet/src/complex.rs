//! Tetrahedral complex: an array of tetrahedra, with neighbours connected face to face.
//!
//! A *half-face* `4 * tet + face` is face `face` of tetrahedron `tet` (opposite its vertex `face`); mates are paired
//! half-faces. *Ghost* tetrahedra, whose last vertex is [`GHOST`], lie on the outer side of every boundary face, so
//! that each half-face has a mate. Around a hull or a carved domain, ghosts are connected across the boundary's edges.

mod cell;
mod changes;
mod undo;

use anastomesh_mesh::adjacency::tet_adjacency;
pub(crate) use anastomesh_mesh::face_key;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::predicates::orient3d;
use anastomesh_mesh::{TET_FACES, TetMesh};
pub(crate) use cell::Cell;
use undo::UndoLog;

/// Vertex at infinity, last vertex of every ghost tetrahedron.
pub const GHOST: u32 = u32::MAX;

/// First vertex of a deleted tetrahedron.
const DEAD: u32 = u32::MAX - 1;

/// Maximum tetrahedra to replace that are searched without sorting.
const SMALL: usize = 24;

/// No tetrahedron, no half-face.
pub const NONE: u32 = u32::MAX;

/// `OTHERS[i][j]`: the other two vertices `(k, l)` of a tetrahedron, so that `(i, j, k, l)` is an even permutation.
pub const OTHERS: [[[usize; 2]; 4]; 4] = [
    [[0, 0], [2, 3], [3, 1], [1, 2]],
    [[3, 2], [0, 0], [0, 3], [2, 0]],
    [[1, 3], [3, 0], [0, 0], [0, 1]],
    [[2, 1], [0, 2], [1, 0], [0, 0]],
];

/// Violated invariant of a complex.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ComplexError {
    /// A vertex index out of range, or one vertex twice in a tetrahedron.
    #[error("tetrahedron {tet} has vertices {vertices:?}, which are out of range or not distinct")]
    BadVertices {
        /// The tetrahedron.
        tet: u32,
        /// Its vertices.
        vertices: [u32; 4],
    },
    /// A tetrahedron that is flat or inverted by the exact predicate.
    #[error("tetrahedron {tet} with vertices {vertices:?} is not positive")]
    NotPositive {
        /// The tetrahedron.
        tet: u32,
        /// Its vertices.
        vertices: [u32; 4],
    },
    /// A face shared by more than two tetrahedra, or by two on the same side of it.
    #[error("face {face:?} is shared by more than two tetrahedra, or by two on the same side")]
    FaceNotConforming {
        /// Vertices of the face.
        face: [u32; 3],
    },
    /// Half-faces that are not mutual mates, or that are different faces.
    #[error("face {face} of tetrahedron {tet} does not match that of its neighbour")]
    NotGlued {
        /// The tetrahedron.
        tet: u32,
        /// Face of the tetrahedron.
        face: u32,
    },
    /// The tetrahedron stored for a vertex does not contain it.
    #[error("the tetrahedron kept for vertex {vertex} does not contain it")]
    BadVertexTet {
        /// The vertex.
        vertex: u32,
    },
}

/// Tetrahedra and ghosts over a set of points. See the module's text for half-faces and ghosts.
#[derive(Clone, Debug, Default)]
pub struct Complex {
    /// Vertex positions.
    pub points: Vec<Point3>,
    cells: Vec<Cell>,
    /// Bit `i`: face `i` may not be flipped away. Both half-faces of a frozen face carry it.
    frozen: Vec<u8>,
    free: Vec<u32>,
    vertex_tet: Vec<u32>,
    scratch: ReplaceScratch,
    log: UndoLog,
}

#[derive(Clone, Debug, Default)]
struct ReplaceScratch {
    faces: Vec<FaceRecord>,
    slots: Vec<u32>,
}

/// A face to be matched: its sorted vertices, true if it belongs to a new tetrahedron, its half-face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct FaceRecord {
    key: [u32; 3],
    inner: bool,
    half: u32,
}

/// Vertices of face `i` of a tetrahedron, counter-clockwise seen from outside.
#[inline]
pub fn face_of(v: &[u32; 4], i: usize) -> [u32; 3] {
    TET_FACES[i].map(|k| v[k])
}

impl Complex {
    /// Creates a complex of points without tetrahedra.
    pub fn new(points: Vec<Point3>) -> Self {
        let n = points.len();
        Self { points, vertex_tet: vec![NONE; n], ..Self::default() }
    }

    /// Reserves memory for `tets` tetrahedra.
    pub fn reserve(&mut self, tets: usize) {
        self.cells.reserve(tets);
        self.frozen.reserve(tets);
    }

    /// Creates a complex of connected cells that satisfies [`Complex::sanity_check`], with the ghost vertex last. The
    /// slots `free` hold no tetrahedra.
    pub(super) fn from_cells(points: Vec<Point3>, cells: Vec<Cell>, free: Vec<u32>, vertex_tet: Vec<u32>) -> Self {
        let frozen = vec![0; cells.len()];
        let mut c = Self { points, cells, frozen, free, vertex_tet, ..Self::default() };
        for k in 0..c.free.len() {
            c.cells[c.free[k] as usize].verts = [DEAD; 4];
        }
        c
    }

    /// Connects tetrahedra and closes their boundary with ghosts. The boundary may be any shape, including one that
    /// touches itself in edges or vertices.
    ///
    /// # Errors
    /// Indices out of range, tetrahedra that are not positive, faces that do not conform.
    pub fn from_mesh(points: Vec<Point3>, tets: &[[u32; 4]]) -> Result<Self, ComplexError> {
        let mut c = Self::new(points);
        for (t, v) in tets.iter().enumerate() {
            c.check_vertices(t as u32, v)?;
            c.alloc(*v);
        }
        let open = c.glue_all(tets)?;
        c.add_ghosts(&open);
        Ok(c)
    }

    fn check_vertices(&self, tet: u32, v: &[u32; 4]) -> Result<(), ComplexError> {
        let distinct = (0..4).all(|i| (0..i).all(|j| v[i] != v[j]));
        if !distinct || v.iter().any(|&x| x as usize >= self.points.len()) {
            return Err(ComplexError::BadVertices { tet, vertices: *v });
        }
        if self.orient(v) > 0.0 { Ok(()) } else { Err(ComplexError::NotPositive { tet, vertices: *v }) }
    }

    /// Connects all faces shared by two tetrahedra. Returns the other half-faces.
    fn glue_all(&mut self, tets: &[[u32; 4]]) -> Result<Vec<u32>, ComplexError> {
        let adjacency = tet_adjacency(tets, self.points.len());
        if let Some(&half) = adjacency.crowded.first() {
            return Err(ComplexError::FaceNotConforming { face: self.face(half) });
        }
        let mut open = Vec::new();
        for half in 0..4 * tets.len() as u32 {
            let mate = adjacency.neighbors[(half >> 2) as usize][(half & 3) as usize];
            if mate == NONE {
                open.push(half);
            } else if mate > half && !opposed(self.face(half), self.face(mate)) {
                return Err(ComplexError::FaceNotConforming { face: self.face(half) });
            }
        }
        for (cell, mates) in self.cells.iter_mut().zip(adjacency.neighbors) {
            cell.mates = mates;
        }
        Ok(open)
    }

    /// Extracts the tetrahedra with `keep`, with vertices renamed to `id[v]` (others are [`NONE`]) at `points`, and
    /// closes them with ghosts. Frozen faces stay frozen.
    pub(super) fn part(&self, points: Vec<Point3>, id: &[u32], keep: impl Fn(u32) -> bool) -> Self {
        let mut part = Self::new(points);
        let mut new_tet = vec![NONE; self.slots()];
        let kept: Vec<u32> = self.real_tets().filter(|&t| keep(t)).collect();
        // Ghosts are about a tenth.
        part.reserve(kept.len() + kept.len() / 8);
        for &t in &kept {
            new_tet[t as usize] = part.alloc(self.verts(t).map(|v| id[v as usize]));
        }
        let mut open = Vec::new();
        for (new, &t) in kept.iter().enumerate() {
            part.frozen[new] = self.frozen[t as usize];
            for i in 0..4 {
                let mate = self.cells[t as usize].mates[i];
                let n = new_tet[(mate >> 2) as usize];
                if n == NONE {
                    open.push(4 * new as u32 + i as u32);
                } else {
                    part.cells[new].mates[i] = 4 * n + (mate & 3);
                }
            }
        }
        part.add_ghosts(&open);
        for &half in &open {
            if part.is_frozen(half) {
                part.freeze(half);
            }
        }
        part
    }

    /// Adds a ghost on each open half-face and connects the ghosts to each other.
    fn add_ghosts(&mut self, open: &[u32]) {
        for &half in open {
            let [a, b, c] = self.face(half);
            let ghost = self.alloc([a, b, c, GHOST]);
            self.glue(half, 4 * ghost + 3);
        }
        for &half in open {
            let ghost = self.mate(half) / 4;
            for i in 0..3 {
                if self.mate(4 * ghost + i) == NONE {
                    self.glue_ghost_edge(half, ghost, i);
                }
            }
        }
    }

    /// Connects face `i` of a ghost to the ghost at the other end of the fan of tetrahedra around their edge.
    fn glue_ghost_edge(&mut self, half: u32, ghost: u32, i: u32) {
        let f = self.face(half);
        let edge = [f[(i as usize + 1) % 3], f[(i as usize + 2) % 3]];
        let mut h = half;
        loop {
            // The other face of the tetrahedron at the edge.
            let t = h / 4;
            let next = (0..4)
                .find(|&j| j != h % 4 && !edge.contains(&self.cells[t as usize].verts[j as usize]))
                .map_or(h, |j| 4 * t + j);
            let mate = self.mate(next);
            if !self.is_ghost(mate / 4) {
                h = mate;
                continue;
            }
            let other = mate / 4;
            let v = self.cells[other as usize].verts;
            if let Some(j) = (0..3).find(|&j| !edge.contains(&v[j as usize])) {
                self.glue(4 * ghost + i, 4 * other + j);
            }
            return;
        }
    }

    /// Returns the real tetrahedra in slot order, and all points.
    pub fn into_mesh(mut self) -> TetMesh {
        let points = std::mem::take(&mut self.points);
        TetMesh { points, tets: self.into_tets(|v| v) }
    }

    /// Returns the real tetrahedra in slot order, with vertex `v` renamed to `name(v)`. Collects in place: tetrahedra reuse the
    /// memory of the cells, which have the same alignment.
    pub(super) fn into_tets(self, name: impl Fn(u32) -> u32) -> Vec<[u32; 4]> {
        let real = |cell: &Cell| cell.verts[0] != DEAD && cell.verts[3] != GHOST;
        let mut tets: Vec<[u32; 4]> = self.cells.into_iter().filter(real).map(|cell| cell.verts.map(&name)).collect();
        tets.shrink_to_fit();
        tets
    }

    /// Returns the same complex over `points` in another order, with vertex `v` renamed to `names[v]`.
    pub(super) fn renumbered(mut self, names: &[u32], points: Vec<Point3>) -> Self {
        for v in self.cells.iter_mut().flat_map(|cell| &mut cell.verts) {
            // Neither ghost vertices nor free slots have a name.
            *v = names.get(*v as usize).copied().unwrap_or(*v);
        }
        let mut vertex_tet = vec![NONE; points.len()];
        for (&v, &t) in names.iter().zip(&self.vertex_tet) {
            vertex_tet[v as usize] = t;
        }
        Self { points, vertex_tet, ..self }
    }

    /// As [`Complex::into_mesh`], without unused points from index `fixed` on.
    pub fn into_compact_mesh(self, fixed: usize) -> TetMesh {
        let mut mesh = self.into_mesh();
        mesh.drop_unused_points(fixed);
        mesh
    }

    /// Number of slots. Tetrahedra are numbered below it, including deleted ones.
    pub fn slots(&self) -> usize {
        self.cells.len()
    }

    /// True if slot `t` holds a tetrahedron, real or ghost.
    #[inline]
    pub fn is_alive(&self, t: u32) -> bool {
        self.cells[t as usize].verts[0] != DEAD
    }

    /// True if `t` is a ghost, outside the boundary.
    #[inline]
    pub fn is_ghost(&self, t: u32) -> bool {
        self.cells[t as usize].verts[3] == GHOST
    }

    /// True if `t` is alive and no ghost.
    #[inline]
    pub fn is_real(&self, t: u32) -> bool {
        self.is_alive(t) && !self.is_ghost(t)
    }

    /// Real tetrahedra in slot order.
    pub fn real_tets(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.slots() as u32).filter(|&t| self.is_real(t))
    }

    /// Vertices of `t`.
    #[inline]
    pub fn verts(&self, t: u32) -> [u32; 4] {
        self.cells[t as usize].verts
    }

    /// Content of a slot.
    #[inline]
    pub(super) fn cell(&self, t: u32) -> &Cell {
        &self.cells[t as usize]
    }

    /// Returns up to `count` cells from slot `first` on.
    #[inline]
    pub(super) fn block(&self, first: u32, count: usize) -> &[Cell] {
        let rest = &self.cells[first as usize..];
        &rest[..count.min(rest.len())]
    }

    /// Half-face paired with `half`.
    #[inline]
    pub fn mate(&self, half: u32) -> u32 {
        self.cells[(half >> 2) as usize].mates[(half & 3) as usize]
    }

    /// Tetrahedron across face `i` of `t`.
    #[inline]
    pub fn neighbor(&self, t: u32, i: usize) -> u32 {
        self.cells[t as usize].mates[i] >> 2
    }

    /// Vertices of a half-face, counter-clockwise seen from outside its tetrahedron.
    #[inline]
    pub fn face(&self, half: u32) -> [u32; 3] {
        face_of(&self.cells[(half >> 2) as usize].verts, (half & 3) as usize)
    }

    /// Vertex of the half-face's tetrahedron opposite to it.
    #[inline]
    pub fn apex(&self, half: u32) -> u32 {
        self.cells[(half >> 2) as usize].verts[(half & 3) as usize]
    }

    /// Slot of vertex `v` in `t`.
    #[inline]
    pub fn slot_of(&self, t: u32, v: u32) -> Option<usize> {
        self.cells[t as usize].verts.iter().position(|&x| x == v)
    }

    /// A tetrahedron (perhaps a ghost) at vertex `v`; [`NONE`] if there is none.
    #[inline]
    pub fn vertex_tet(&self, v: u32) -> u32 {
        self.vertex_tet[v as usize]
    }

    /// True if the face may not be flipped away.
    #[inline]
    pub fn is_frozen(&self, half: u32) -> bool {
        self.frozen[(half >> 2) as usize] & (1 << (half & 3)) != 0
    }

    /// Freezes a face on both sides, so that no flip removes it.
    pub fn freeze(&mut self, half: u32) {
        let mate = self.mate(half);
        for h in [half, mate] {
            self.note_slot(h >> 2);
            self.frozen[(h >> 2) as usize] |= 1 << (h & 3);
        }
    }

    /// Thaws a face on both sides.
    pub fn thaw(&mut self, half: u32) {
        let mate = self.mate(half);
        for h in [half, mate] {
            self.note_slot(h >> 2);
            self.frozen[(h >> 2) as usize] &= !(1 << (h & 3));
        }
    }

    /// Exact orientation of a tetrahedron of real vertices: positive, zero or negative.
    #[inline]
    pub fn orient(&self, v: &[u32; 4]) -> f64 {
        let [a, b, c, d] = v.map(|i| &self.points[i as usize]);
        orient3d(a, b, c, d)
    }

    /// Adds a point without a tetrahedron. Returns its vertex.
    pub fn add_point(&mut self, p: Point3) -> u32 {
        self.points.push(p);
        self.vertex_tet.push(NONE);
        self.note_point_added();
        self.points.len() as u32 - 1
    }

    /// Removes the last point, which no tetrahedron may use.
    pub(super) fn pop_point(&mut self) {
        self.note_point_removed();
        self.points.pop();
        self.vertex_tet.pop();
    }

    /// Allocates a slot for a tetrahedron without mates.
    #[inline]
    pub fn alloc(&mut self, v: [u32; 4]) -> u32 {
        let t = if let Some(t) = self.free.pop() {
            self.note_taken(t);
            self.note_slot(t);
            self.cells[t as usize] = Cell { verts: v, mates: [NONE; 4] };
            self.frozen[t as usize] = 0;
            t
        } else {
            self.cells.push(Cell { verts: v, mates: [NONE; 4] });
            self.frozen.push(0);
            self.note_slot_added();
            self.cells.len() as u32 - 1
        };
        self.set_vertex_tets(t);
        t
    }

    #[inline]
    fn set_vertex_tets(&mut self, t: u32) {
        for v in self.cells[t as usize].verts {
            if v != GHOST {
                self.note_vertex(v);
                self.vertex_tet[v as usize] = t;
            }
        }
    }

    /// Deletes a tetrahedron. Its mates keep pointing at it until they are connected again.
    #[inline]
    pub fn free(&mut self, t: u32) {
        self.note_slot(t);
        self.note_freed();
        self.cells[t as usize].verts = [DEAD; 4];
        self.free.push(t);
    }

    /// Makes two half-faces mates.
    #[inline]
    pub fn glue(&mut self, a: u32, b: u32) {
        self.note_slot(a >> 2);
        self.note_slot(b >> 2);
        self.cells[(a >> 2) as usize].mates[(a & 3) as usize] = b;
        self.cells[(b >> 2) as usize].mates[(b & 3) as usize] = a;
    }

    /// Replaces the tetrahedra `old` by others that fill the same volume: the faces of `new` must match each other and
    /// the boundary of `old`. Every local change goes through this function. Frozen faces on the boundary stay frozen.
    /// `created` receives the slots of `new`. Returns false, and changes nothing, if the faces do not match.
    ///
    /// Geometry is not checked: the caller ensures that each of `new` is positive.
    pub fn replace(&mut self, old: &[u32], new: &[[u32; 4]], created: &mut Vec<u32>) -> bool {
        let mut s = std::mem::take(&mut self.scratch);
        let fits = self.collect_faces(old, new, &mut s.faces);
        if fits {
            self.apply(old, new, &mut s, created);
        }
        self.scratch = s;
        fits
    }

    /// Sorts the faces of `new` (as half-faces of `4 * position + face`) and the outer mates of `old` into pairs.
    fn collect_faces(&self, old: &[u32], new: &[[u32; 4]], faces: &mut Vec<FaceRecord>) -> bool {
        faces.clear();
        let mut sorted = Vec::new();
        if old.len() > SMALL {
            sorted.extend_from_slice(old);
            sorted.sort_unstable();
        }
        let inside = |t: u32| if sorted.is_empty() { old.contains(&t) } else { sorted.binary_search(&t).is_ok() };
        for &t in old {
            for i in 0..4 {
                let half = 4 * t + i;
                let mate = self.mate(half);
                if !inside(mate >> 2) {
                    faces.push(FaceRecord { key: face_key(self.face(half)), inner: false, half: mate });
                }
            }
        }
        for (k, v) in new.iter().enumerate() {
            for i in 0..4 {
                faces.push(FaceRecord { key: face_key(face_of(v, i)), inner: true, half: (4 * k + i) as u32 });
            }
        }
        faces.sort_unstable();
        let face = |r: &FaceRecord| {
            if r.inner { face_of(&new[(r.half >> 2) as usize], (r.half & 3) as usize) } else { self.face(r.half) }
        };
        faces.len().is_multiple_of(2)
            && faces.chunks_exact(2).all(|p| p[0].key == p[1].key && p[1].inner && opposed(face(&p[0]), face(&p[1])))
            && faces.windows(3).all(|p| p[0].key != p[2].key)
    }

    fn apply(&mut self, old: &[u32], new: &[[u32; 4]], s: &mut ReplaceScratch, created: &mut Vec<u32>) {
        for &t in old {
            for v in self.verts(t) {
                if v != GHOST {
                    self.note_vertex(v);
                    self.vertex_tet[v as usize] = NONE;
                }
            }
            self.free(t);
        }
        s.slots.clear();
        for v in new {
            s.slots.push(self.alloc(*v));
        }
        let place = |half: u32| 4 * s.slots[(half >> 2) as usize] + (half & 3);
        for pair in s.faces.chunks_exact(2) {
            let b = place(pair[1].half);
            if pair[0].inner {
                self.glue(place(pair[0].half), b);
            } else {
                let a = pair[0].half;
                self.glue(a, b);
                if self.is_frozen(a) {
                    self.frozen[(b >> 2) as usize] |= 1 << (b & 3);
                }
            }
        }
        created.clear();
        created.extend_from_slice(&s.slots);
    }

    /// Checks every invariant: mates are mutual and have equal vertices, real tetrahedra are positive, ghosts cover all
    /// boundary faces, vertices know one of their tetrahedra.
    ///
    /// # Errors
    /// The first violated invariant.
    pub fn sanity_check(&self) -> Result<(), ComplexError> {
        for t in (0..self.slots() as u32).filter(|&t| self.is_alive(t)) {
            let vertices = self.verts(t);
            let real = if self.is_ghost(t) { 3 } else { 4 };
            let known = vertices[..real].iter().all(|&v| (v as usize) < self.points.len());
            if !known || (0..4).any(|i| (0..i).any(|j| vertices[i] == vertices[j])) {
                return Err(ComplexError::BadVertices { tet: t, vertices });
            }
            if real == 4 && self.orient(&vertices) <= 0.0 {
                return Err(ComplexError::NotPositive { tet: t, vertices });
            }
            for i in 0..4 {
                let half = 4 * t + i;
                let mate = self.mate(half);
                let glued = mate != NONE
                    && ((mate >> 2) as usize) < self.slots()
                    && self.is_alive(mate >> 2)
                    && self.mate(mate) == half
                    && self.is_frozen(half) == self.is_frozen(mate)
                    && opposed(self.face(half), self.face(mate));
                if !glued {
                    return Err(ComplexError::NotGlued { tet: t, face: i });
                }
            }
        }
        for (v, &t) in self.vertex_tet.iter().enumerate() {
            if t != NONE && (!self.is_alive(t) || !self.verts(t).contains(&(v as u32))) {
                return Err(ComplexError::BadVertexTet { vertex: v as u32 });
            }
        }
        Ok(())
    }
}

/// True if two faces are the same face with opposite orientation.
pub fn opposed(f: [u32; 3], g: [u32; 3]) -> bool {
    // Branch-free: the rotation cannot be predicted.
    let difference = |i: usize, j: usize, k: usize| (f[0] ^ g[i]) | (f[1] ^ g[j]) | (f[2] ^ g[k]);
    difference(0, 2, 1).min(difference(2, 1, 0)).min(difference(1, 0, 2)) == 0
}

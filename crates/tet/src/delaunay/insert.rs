//! Insertion of one point: locate it by walking, dig the cavity, fill it with the star of the new point.

use super::conflict::{Bounds, Site, View, in_sphere};
use crate::complex::{Cell, GHOST, NONE, face_of};
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::predicates::orient3d;
use rustc_hash::FxHashMap;

/// Maximum cavity vertices for which a square table matches the new tetrahedra.
const TABLE: usize = 64;

/// `BACK[i][k]`: the vertex of a tetrahedron at position `k` of its face `i` seen from inside.
const BACK: [[usize; 3]; 4] = [[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]];

/// Search marks in a tetrahedron's first vertex; vertex numbers are far below.
const INSIDE: u32 = 1 << 31;
const OUTSIDE: u32 = 1 << 30;
const MARKS: u32 = INSIDE | OUTSIDE;

/// A face of the cavity's boundary: the half-face outside, and its vertices counter-clockwise seen from inside.
#[derive(Clone, Copy, Debug, Default)]
struct CavityFace {
    outer: u32,
    face: [u32; 3],
}

/// A stack that pushes without a branch.
#[derive(Debug, Default)]
struct Stack<T> {
    /// The entries, and unused ones behind them.
    items: Vec<T>,
    len: usize,
}

impl<T: Copy + Default> Stack<T> {
    fn clear(&mut self) {
        self.len = 0;
    }

    /// Makes space for further entries.
    #[inline]
    fn reserve(&mut self, more: usize) {
        if self.len + more >= self.items.len() {
            self.items.resize(2 * (self.len + more), T::default());
        }
    }

    /// Adds an entry if `wanted`; there must be space for it.
    #[inline]
    fn push_if(&mut self, item: T, wanted: bool) {
        self.items[self.len] = item;
        self.len += usize::from(wanted);
    }

    fn entries(&self) -> &[T] {
        &self.items[..self.len]
    }
}

/// The growing tetrahedralization and the insertion buffers. The ghost vertex and its site follow the last point.
pub(super) struct Inserter {
    sites: Vec<Site>,
    cells: Vec<Cell>,
    free: Vec<u32>,
    bounds: Bounds,
    ghost: u32,
    now: u32,
    cavity: Stack<u32>,
    walls: Stack<CavityFace>,
    created: Vec<u32>,
    table: Box<[u32; TABLE * TABLE]>,
    pairs: FxHashMap<(u32, u32), u32>,
    hint: u32,
}

impl Inserter {
    pub(super) fn new(points: &[Point3]) -> Self {
        let n = points.len();
        let site = |at: Point3| Site { at, stamp: 0, local: 0 };
        let mut sites = Vec::with_capacity(n + 1);
        sites.extend(points.iter().map(|&at| site(at)));
        sites.push(site(Point3::origin()));
        Self {
            sites,
            cells: Vec::with_capacity(7 * n + 64),
            free: Vec::new(),
            bounds: Bounds::of(points),
            ghost: n as u32,
            now: 0,
            cavity: Stack::default(),
            walls: Stack::default(),
            created: Vec::new(),
            table: Box::new([NONE; TABLE * TABLE]),
            pairs: FxHashMap::default(),
            hint: 0,
        }
    }

    #[inline]
    fn at(&self, v: u32) -> &Point3 {
        &self.sites[v as usize].at
    }

    #[inline]
    fn corners(&self, v: &[u32; 4]) -> [&Point3; 4] {
        v.map(|v| self.at(v))
    }

    #[inline]
    fn cell(&self, t: u32) -> &Cell {
        &self.cells[t as usize]
    }

    /// Starts with one positive tetrahedron and its four ghosts.
    pub(super) fn start(&mut self, v: [u32; 4]) {
        self.cells.push(Cell { verts: v, mates: [7, 11, 15, 19] });
        for i in 0..4 {
            let [a, b, c] = face_of(&v, i);
            self.cells.push(Cell { verts: [a, b, c, self.ghost], mates: [NONE, NONE, NONE, i as u32] });
        }
        // Opposite vertex k of ghost i lies the ghost without that vertex.
        for i in 0..4 {
            for k in 0..3 {
                let lacks = self.cells[i + 1].verts[k];
                let other = (0..4).find(|&j| v[j] == lacks).unwrap_or(0);
                let back = (0..3).find(|&j| self.cells[other + 1].verts[j] == v[i]).unwrap_or(0);
                self.cells[i + 1].mates[k] = 4 * (other as u32 + 1) + back as u32;
            }
        }
    }

    /// Inserts vertex `v`.
    ///
    /// # Errors
    /// An existing vertex at the same position; nothing is changed.
    pub(super) fn insert(&mut self, v: u32) -> Result<(), u32> {
        let p = *self.at(v);
        let first = self.locate(&p);
        let twin = |&&w: &&u32| w != self.ghost && *self.at(w) == p;
        if let Some(&twin) = self.cell(first).verts.iter().find(twin) {
            return Err(twin);
        }
        self.dig(first, &p);
        self.fill(v);
        Ok(())
    }

    /// Finds a tetrahedron in conflict with `p`. Its circumsphere certainly contains `p`, or its closure contains `p`,
    /// or it is a ghost whose face sees `p` from outside. If `p` is a vertex, returns a tetrahedron with it. Visibility
    /// walks in regular triangulations have no cycles (Edelsbrunner 1990), so exact tests end.
    #[inline(never)]
    fn locate(&self, p: &Point3) -> u32 {
        let mut t = self.hint;
        let mut from = 4;
        let first = self.cell(t);
        if first.verts[3] == self.ghost {
            t = first.mates[3] >> 2;
        }
        loop {
            let cell = self.cell(t);
            if cell.verts[3] == self.ghost {
                return t;
            }
            let view = View::new(self.corners(&cell.verts), p);
            if view.sphere > self.bounds.sphere {
                return t;
            }
            let exit = self.exit(&cell.verts, &view, from, p);
            let Some(&mate) = cell.mates.get(exit) else { return t };
            (t, from) = (mate >> 2, (mate & 3) as usize);
        }
    }

    /// Face of the tetrahedron with `p` strictly behind it and the largest volume between; 4 if there is none.
    #[inline]
    fn exit(&self, v: &[u32; 4], view: &View, from: usize, p: &Point3) -> usize {
        let mut exit = 4;
        let mut least = -self.bounds.orient;
        for (i, &w) in view.weights.iter().enumerate() {
            if w < least {
                (exit, least) = (i, w);
            }
        }
        if exit == 4 { self.exit_close(v, view, from, p) } else { exit }
    }

    /// As [`Self::exit`], for faces within the static bound.
    fn exit_close(&self, v: &[u32; 4], view: &View, from: usize, p: &Point3) -> usize {
        let q = self.corners(v);
        let behind = |&i: &usize| {
            let [a, b, c] = face_of(&[0, 1, 2, 3], i).map(|k| q[k as usize]);
            i != from && view.weights[i] <= self.bounds.orient && orient3d(a, b, c, p) > 0.0
        };
        (0..4).find(behind).unwrap_or(4)
    }

    /// True if `p` destroys a tetrahedron.
    #[inline]
    fn in_conflict(&self, cell: &Cell, p: &Point3) -> bool {
        if cell.verts[3] == self.ghost {
            return self.ghost_in_conflict(cell, p);
        }
        in_sphere(self.corners(&cell.verts), p, &self.bounds)
    }

    #[inline(never)]
    fn ghost_in_conflict(&self, cell: &Cell, p: &Point3) -> bool {
        let v = &cell.verts;
        let side = orient3d(self.at(v[0]), self.at(v[1]), self.at(v[2]), p);
        if side != 0.0 {
            return side > 0.0;
        }
        // In the plane of a hull face, its circumcircle decides, through the sphere of the tetrahedron behind.
        let mut behind = self.cell(cell.mates[3] >> 2).verts;
        behind[0] &= !MARKS;
        in_sphere(self.corners(&behind), p, &self.bounds)
    }

    /// Collects the connected tetrahedra in conflict with `p`, and the faces around them.
    #[inline(never)]
    fn dig(&mut self, first: u32, p: &Point3) {
        self.cavity.clear();
        self.walls.clear();
        self.cavity.reserve(1);
        self.cells[first as usize].verts[0] |= INSIDE;
        self.cavity.push_if(first, true);
        let mut head = 0;
        while head < self.cavity.len {
            let mut cell = *self.cell(self.cavity.items[head]);
            cell.verts[0] &= !MARKS;
            head += 1;
            // The answers cannot be predicted: both stacks are written, and one of them grows.
            self.cavity.reserve(4);
            self.walls.reserve(4);
            // All neighbours are fetched before the first is tested. They differ: cells share at most one face.
            let marks = cell.mates.map(|mate| self.cell(mate >> 2).verts[0] & MARKS);
            for i in 0..4 {
                if marks[i] == INSIDE {
                    continue;
                }
                let outer = cell.mates[i];
                let n = outer >> 2;
                let mut inside = false;
                if marks[i] == 0 {
                    inside = self.in_conflict(self.cell(n), p);
                    self.cells[n as usize].verts[0] |= OUTSIDE << u32::from(inside);
                    self.cavity.push_if(n, inside);
                }
                self.walls.push_if(CavityFace { outer, face: BACK[i].map(|k| cell.verts[k]) }, !inside);
            }
        }
    }

    /// Replaces the cavity by tetrahedra that join `v` to its faces.
    #[inline(never)]
    fn fill(&mut self, v: u32) {
        self.now += 1;
        self.take_slots();
        let vertices = self.number_vertices();
        if vertices <= TABLE {
            self.fill_cavity_by_table(v);
        } else {
            self.fill_cavity_by_hash(v);
        }
        self.hint = self.created.last().copied().unwrap_or(self.hint);
    }

    /// Finds a slot for each face, first those of the cavity.
    fn take_slots(&mut self) {
        let needed = self.walls.len;
        self.created.clear();
        self.created.extend_from_slice(self.cavity.entries());
        while self.created.len() > needed {
            self.free.extend(self.created.pop());
        }
        while self.created.len() < needed {
            let slot = self.free.pop().unwrap_or_else(|| {
                self.cells.push(Cell::EMPTY);
                self.cells.len() as u32 - 1
            });
            self.created.push(slot);
        }
    }

    /// Numbers the vertices of the cavity's faces from 0. Returns their number.
    #[inline(never)]
    fn number_vertices(&mut self) -> usize {
        let mut count = 0u32;
        for w in self.walls.entries() {
            for x in w.face {
                let site = &mut self.sites[x as usize];
                if site.stamp != self.now {
                    site.stamp = self.now;
                    site.local = count;
                    count += 1;
                }
            }
        }
        count as usize
    }

    /// Builds a tetrahedron on each face and connects them. Each edge of the boundary occurs once in each direction.
    #[inline(never)]
    fn fill_cavity_by_table(&mut self, v: u32) {
        for (w, &t) in self.walls.entries().iter().zip(&self.created) {
            let l = w.face.map(|x| self.sites[x as usize].local as usize);
            let turn = turn_of(&w.face, self.ghost);
            for i in 0..3 {
                let (from, to) = (l[(i + 1) % 3], l[(i + 2) % 3]);
                self.table[(from * TABLE + to) % (TABLE * TABLE)] = 4 * t + turn[i];
            }
        }
        for (w, &t) in self.walls.entries().iter().zip(&self.created) {
            let l = w.face.map(|x| self.sites[x as usize].local as usize);
            let turn = turn_of(&w.face, self.ghost);
            let mate = |i: usize| {
                let (from, to) = (l[(i + 1) % 3], l[(i + 2) % 3]);
                self.table[(to * TABLE + from) % (TABLE * TABLE)]
            };
            let cell = placed(w, v, [mate(0), mate(1), mate(2)], turn);
            self.cells[t as usize] = cell;
            let outer = &mut self.cells[(w.outer >> 2) as usize];
            outer.mates[(w.outer & 3) as usize] = 4 * t + turn[3];
            outer.verts[0] &= !MARKS;
        }
    }

    /// As [`Self::fill_cavity_by_table`], for any number of vertices.
    #[cold]
    fn fill_cavity_by_hash(&mut self, v: u32) {
        let mut pairs = std::mem::take(&mut self.pairs);
        pairs.clear();
        for (w, &t) in self.walls.entries().iter().zip(&self.created) {
            let turn = turn_of(&w.face, self.ghost);
            for i in 0..3 {
                pairs.insert((w.face[(i + 1) % 3], w.face[(i + 2) % 3]), 4 * t + turn[i]);
            }
        }
        for (w, &t) in self.walls.entries().iter().zip(&self.created) {
            let turn = turn_of(&w.face, self.ghost);
            let mates = [0, 1, 2]
                .map(|i: usize| pairs.get(&(w.face[(i + 2) % 3], w.face[(i + 1) % 3])).copied().unwrap_or(NONE));
            self.cells[t as usize] = placed(w, v, mates, turn);
            let outer = &mut self.cells[(w.outer >> 2) as usize];
            outer.mates[(w.outer & 3) as usize] = 4 * t + turn[3];
            outer.verts[0] &= !MARKS;
        }
        self.pairs = pairs;
    }

    /// Clears the free slots, and drops the data needed only for insertion.
    fn drop_insertion_data(mut self) -> Self {
        self.sites = Vec::new();
        for &t in &self.free {
            self.cells[t as usize].verts = [NONE; 4];
        }
        self
    }

    /// Returns the tetrahedra, with vertex `v` renamed to `order[v]`, and the empty slots.
    pub(super) fn into_cells(self, order: &[u32]) -> (Vec<Cell>, Vec<u32>) {
        let Self { mut cells, free, .. } = self.drop_insertion_data();
        for v in cells.iter_mut().flat_map(|cell| &mut cell.verts) {
            *v = order.get(*v as usize).copied().unwrap_or(GHOST);
        }
        (cells, free)
    }

    /// Returns the tetrahedra with ghosts, the empty slots, and a tetrahedron at each vertex.
    pub(super) fn finish(self) -> (Vec<Cell>, Vec<u32>, Vec<u32>) {
        let Self { mut cells, free, ghost, .. } = self.drop_insertion_data();
        let mut vertex_tet = vec![NONE; ghost as usize];
        for (t, cell) in (0..).zip(&mut cells) {
            for v in &mut cell.verts {
                if *v == ghost {
                    *v = GHOST;
                } else if let Some(own) = vertex_tet.get_mut(*v as usize) {
                    *own = t;
                }
            }
        }
        (cells, free, vertex_tet)
    }
}

/// Positions of the vertices of a face and of the new vertex in a tetrahedron: in order, or with the ghost last.
#[inline]
fn turn_of(face: &[u32; 3], ghost: u32) -> [u32; 4] {
    if face[0] == ghost {
        [3, 1, 0, 2]
    } else if face[1] == ghost {
        [0, 3, 1, 2]
    } else if face[2] == ghost {
        [1, 0, 3, 2]
    } else {
        [0, 1, 2, 3]
    }
}

/// Tetrahedron on a cavity face.
#[inline]
fn placed(w: &CavityFace, v: u32, mates: [u32; 3], turn: [u32; 4]) -> Cell {
    let [a, b, c] = w.face;
    let plain = Cell { verts: [a, b, c, v], mates: [mates[0], mates[1], mates[2], w.outer] };
    if turn[3] == 3 {
        return plain;
    }
    let mut cell = plain;
    for i in 0..4 {
        cell.verts[turn[i] as usize] = plain.verts[i];
        cell.mates[turn[i] as usize] = plain.mates[i];
    }
    cell
}

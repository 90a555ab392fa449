//! One insertion: locate by walking, dig the cavity, fill it with the star of the new point.

use super::perturb::in_sphere_perturbed;
use crate::geometry::Point3;
use crate::geometry::predicates::orient3d;
use crate::tet::complex::{Complex, GHOST, NONE, face_of, ghost_last};
use rustc_hash::FxHashMap;

/// Cavities with at most this many vertices match the new tetrahedra through a square table.
const TABLE: usize = 64;

/// A face of the cavity's boundary: the half-face outside, and its vertices counter-clockwise seen from outside the
/// cavity.
#[derive(Clone, Copy, Debug)]
struct Wall {
    outer: u32,
    face: [u32; 3],
}

/// The growing tetrahedralization and the buffers of its insertions.
pub(super) struct Inserter {
    c: Complex,
    /// Per tetrahedron, `2 · insertion` when seen outside the cavity, `2 · insertion + 1` when in it.
    stamp: Vec<u32>,
    now: u32,
    cavity: Vec<u32>,
    walls: Vec<Wall>,
    created: Vec<u32>,
    /// Per vertex (the ghost last) the insertion that numbered it, and its number within the cavity.
    local: Vec<(u32, u32)>,
    table: Vec<u32>,
    pairs: FxHashMap<(u32, u32), u32>,
    hint: u32,
}

impl Inserter {
    pub(super) fn new(points: Vec<Point3>) -> Self {
        let n = points.len();
        let mut c = Complex::new(points);
        c.reserve(7 * n + 64);
        Self {
            c,
            stamp: vec![0; 7 * n + 64],
            now: 0,
            cavity: Vec::new(),
            walls: Vec::new(),
            created: Vec::new(),
            local: vec![(0, 0); n + 1],
            table: vec![NONE; TABLE * TABLE],
            pairs: FxHashMap::default(),
            hint: 0,
        }
    }

    pub(super) fn points(&self) -> &[Point3] {
        &self.c.points
    }

    /// Begins with one positive tetrahedron and its four ghosts.
    pub(super) fn start(&mut self, v: [u32; 4]) {
        let t = self.c.alloc(v);
        let ghosts: [u32; 4] = std::array::from_fn(|i| {
            let [a, b, d] = face_of(&v, i);
            self.c.alloc([a, b, d, GHOST])
        });
        for (i, &g) in ghosts.iter().enumerate() {
            self.c.glue(4 * t + i as u32, 4 * g + 3);
            for k in 0..3 {
                // Across from vertex k of ghost i stands the ghost that lacks that vertex.
                let lacks = self.c.verts(g)[k];
                if let Some(j) = v.iter().position(|&x| x == lacks)
                    && let Some(back) = self.c.slot_of(ghosts[j], v[i])
                {
                    self.c.glue(4 * g + k as u32, 4 * ghosts[j] + back as u32);
                }
            }
        }
        self.hint = t;
    }

    /// Inserts vertex `v`.
    ///
    /// # Errors
    /// The vertex that stands at the same place already; nothing is changed.
    pub(super) fn insert(&mut self, v: u32) -> Result<(), u32> {
        let p = self.c.points[v as usize];
        let first = self.locate(&p);
        if let Some(&twin) = self.c.verts(first).iter().find(|&&w| w != GHOST && self.c.points[w as usize] == p) {
            return Err(twin);
        }
        self.dig(first, &p);
        self.fill(v);
        Ok(())
    }

    /// A tetrahedron whose closure holds `p`, or a ghost whose face sees `p` from outside. Visibility walks in regular
    /// triangulations have no cycles (Edelsbrunner 1990), so exact tests suffice for an end.
    fn locate(&self, p: &Point3) -> u32 {
        let c = &self.c;
        let mut t = self.hint;
        let mut from = NONE;
        if c.is_ghost(t) {
            t = c.mate(4 * t + 3) >> 2;
        }
        loop {
            let v = c.verts(t);
            let q = v.map(|i| &c.points[i as usize]);
            let mut exit = NONE;
            for i in 0..4u32 {
                if i == from {
                    continue;
                }
                let [a, b, d] = face_of(&[0, 1, 2, 3], i as usize).map(|k| q[k as usize]);
                if orient3d(a, b, d, p) > 0.0 {
                    exit = i;
                    break;
                }
            }
            if exit == NONE {
                return t;
            }
            let mate = c.mate(4 * t + exit);
            (t, from) = (mate >> 2, mate & 3);
            if c.is_ghost(t) {
                return t;
            }
        }
    }

    /// Whether `p` destroys tetrahedron `t`.
    #[inline]
    fn in_conflict(&self, t: u32, p: &Point3) -> bool {
        let c = &self.c;
        let v = c.verts(t);
        let at = |i: u32| &c.points[i as usize];
        if v[3] != GHOST {
            return in_sphere_perturbed([at(v[0]), at(v[1]), at(v[2]), at(v[3])], p);
        }
        let side = orient3d(at(v[0]), at(v[1]), at(v[2]), p);
        if side != 0.0 {
            return side > 0.0;
        }
        // In the plane of a hull face the circle through it decides: the sphere of the tetrahedron behind it.
        let w = c.verts(c.mate(4 * t + 3) >> 2);
        in_sphere_perturbed([at(w[0]), at(w[1]), at(w[2]), at(w[3])], p)
    }

    /// Collects the connected tetrahedra in conflict with `p`, and the walls around them.
    fn dig(&mut self, first: u32, p: &Point3) {
        self.now += 1;
        let inside = 2 * self.now + 1;
        let outside = 2 * self.now;
        self.cavity.clear();
        self.walls.clear();
        self.stamp[first as usize] = inside;
        self.cavity.push(first);
        let mut head = 0;
        while head < self.cavity.len() {
            let t = self.cavity[head];
            head += 1;
            for i in 0..4 {
                let half = 4 * t + i;
                let mate = self.c.mate(half);
                let n = mate >> 2;
                let seen = self.stamp[n as usize];
                if seen == inside {
                    continue;
                }
                if seen != outside && self.in_conflict(n, p) {
                    self.stamp[n as usize] = inside;
                    self.cavity.push(n);
                    continue;
                }
                self.stamp[n as usize] = outside;
                self.walls.push(Wall { outer: mate, face: self.c.face(half) });
            }
        }
    }

    /// Replaces the cavity by the tetrahedra between `v` and its walls.
    fn fill(&mut self, v: u32) {
        self.created.clear();
        let reused = self.cavity.len().min(self.walls.len());
        for t in self.cavity.split_off(reused) {
            self.c.free(t);
        }
        for k in 0..self.walls.len() {
            let Wall { outer, face: [a, b, d] } = self.walls[k];
            let new = ghost_last([a, d, b, v]);
            let t = match self.cavity.get(k) {
                Some(&t) => {
                    self.c.reset(t, new);
                    t
                }
                None => self.c.alloc(new),
            };
            self.created.push(t);
            let apex = self.slot(t, v);
            self.c.glue(4 * t + apex, outer);
        }
        if self.stamp.len() < self.c.slots() {
            self.stamp.resize(self.c.slots() * 2, 0);
        }
        if self.number_vertices() {
            self.match_by_table();
        } else {
            self.match_by_hash();
        }
        self.hint = self.created.last().copied().unwrap_or(self.hint);
    }

    #[inline]
    fn slot(&self, t: u32, v: u32) -> u32 {
        let w = self.c.verts(t);
        if w[3] == v {
            3
        } else if w[2] == v {
            2
        } else {
            u32::from(w[1] == v)
        }
    }

    /// Numbers the vertices of the walls from 0; false when there are too many for the table.
    fn number_vertices(&mut self) -> bool {
        let ghost = self.local.len() - 1;
        let mut count = 0u32;
        // A triangulated sphere with w faces has w / 2 + 2 vertices.
        if self.walls.len() > 2 * (TABLE - 2) {
            return false;
        }
        for w in &self.walls {
            for x in w.face {
                let entry = &mut self.local[(x as usize).min(ghost)];
                if entry.0 != self.now {
                    *entry = (self.now, count);
                    count += 1;
                }
            }
        }
        count as usize <= TABLE
    }

    /// Glues the new tetrahedra to each other: each edge of the walls is run through once in each direction.
    fn match_by_table(&mut self) {
        let ghost = self.local.len() - 1;
        for k in 0..self.walls.len() {
            let f = self.walls[k].face;
            let l = f.map(|x| self.local[(x as usize).min(ghost)].1 as usize);
            let t = self.created[k];
            for i in 0..3 {
                let (from, to) = (l[(i + 1) % 3], l[(i + 2) % 3]);
                self.table[from * TABLE + to] = 4 * t + self.slot(t, f[i]);
            }
        }
        for k in 0..self.walls.len() {
            let l = self.walls[k].face.map(|x| self.local[(x as usize).min(ghost)].1 as usize);
            for i in 0..3 {
                let (from, to) = (l[(i + 1) % 3], l[(i + 2) % 3]);
                if from < to {
                    self.c.glue(self.table[from * TABLE + to], self.table[to * TABLE + from]);
                }
            }
        }
    }

    fn match_by_hash(&mut self) {
        self.pairs.clear();
        for k in 0..self.walls.len() {
            let f = self.walls[k].face;
            let t = self.created[k];
            for i in 0..3 {
                let (from, to) = (f[(i + 1) % 3], f[(i + 2) % 3]);
                let half = 4 * t + self.slot(t, f[i]);
                match self.pairs.get(&(to, from)) {
                    Some(&other) => self.c.glue(half, other),
                    None => {
                        self.pairs.insert((from, to), half);
                    }
                }
            }
        }
    }

    /// The complex over the points in their original order: vertex `v` becomes `order[v]`.
    pub(super) fn finish(self, points: Vec<Point3>, order: &[u32]) -> Complex {
        self.c.renumbered(points, order)
    }
}

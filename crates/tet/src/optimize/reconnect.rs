//! Small-polyhedron reconnection. Branch and bound replaces the tetrahedra of a small cavity by those with the least
//! strain on the same vertices and boundary. (Marot, Remacle, 'Quality tetrahedral mesh generation with
//! HXT', 2020; Liu, Chen, Zheng, 'Small polyhedron reconnection for mesh improvement', 2006.) It includes edge removal,
//! multi-face removal and all their compositions within the cavity.
//!
//! Positive tetrahedra whose faces match each other and the cavity's boundary cover the cavity once. So the search
//! needs no intersection tests; volume and enclosed vertices merely prune it.

use super::allowance::Allowance;
use super::strain::{EASED, ratio_of_strain, strain};
use crate::complex::Complex;
use anastomesh_mesh::geometry::predicates::orient3d;
use anastomesh_mesh::quality::radius_ratio;
use rustc_hash::{FxHashSet, FxHasher};
use std::hash::{Hash, Hasher};

/// Maximum vertices of a cavity.
const MAX_VERTICES: usize = 14;
/// Maximum faces on the front of the search.
const MAX_FRONT: usize = 64;
/// The search ends once the strain has fallen to this fraction of its old value.
const GOOD: f64 = 0.3;
/// Estimated strain of the front's tetrahedra over the summed least strains of its faces. Most close one or two faces.
const SHARE: f64 = 0.4;

const fn choose(n: usize, k: usize) -> usize {
    match k {
        1 => n,
        2 => n * n.saturating_sub(1) / 2,
        3 => n * n.saturating_sub(1) * n.saturating_sub(2) / 6,
        _ => n * n.saturating_sub(1) * n.saturating_sub(2) * n.saturating_sub(3) / 24,
    }
}

/// A tetrahedron of four local vertices in ascending order.
#[derive(Clone, Copy, Debug)]
struct Entry {
    /// Radius ratio relative to the attainable one; NaN if unknown.
    ratio: f64,
    /// Volume with exact sign and rounded magnitude; NaN if unknown.
    volume: f64,
    /// Strain, if the ratio is known.
    strain: f64,
    /// Vertices strictly inside; `UNKNOWN` until computed.
    enclosed: u16,
}

/// Marks a vertex set not yet computed. No tetrahedron or face combines with all vertices.
const UNKNOWN: u16 = u16::MAX;

const NO_ENTRY: Entry = Entry { ratio: f64::NAN, volume: f64::NAN, strain: 0.0, enclosed: UNKNOWN };

/// A face of the front, oriented inwards: (v, f₀, f₁, f₂) is positive for v inside.
#[derive(Clone, Copy, Debug, PartialEq)]
struct FrontFace {
    v: [u8; 3],
    /// Its index in the face table, and that of the face oriented outwards.
    at: [u16; 2],
    /// Vertices that form a tetrahedron above the floor with it.
    mates: u16,
    /// Least strain of these tetrahedra.
    least: f64,
}

impl FrontFace {
    /// Not yet computed.
    const NONE: Self = Self { v: [0; 3], at: [0; 2], mates: UNKNOWN, least: 0.0 };
}

/// Environment of the search.
#[derive(Clone, Copy)]
pub(super) struct SearchScope<'a> {
    pub c: &'a Complex,
    pub allowance: &'a Allowance,
}

/// The search; keeps its buffers.
#[derive(Clone, Debug, Default)]
pub(super) struct Reconnection {
    /// Tetrahedra of the cavity.
    pub tets: Vec<u32>,
    halves: Vec<u32>,
    /// Vertices of the cavity.
    pub vertices: Vec<u32>,
    table: Vec<Entry>,
    /// Faces of three local vertices, in both orientations.
    faces: Vec<FrontFace>,
    front: Vec<FrontFace>,
    /// Position of each table face on the front, counted from 1; 0 if absent.
    place: Vec<u8>,
    stack: Vec<[u8; 4]>,
    best: Vec<[u8; 4]>,
    /// Replacement tetrahedra.
    pub new: Vec<[u32; 4]>,
    /// Buffer for their slots.
    pub created: Vec<u32>,
    /// Hashes of the cavities searched.
    searched: FxHashSet<u64>,
    /// Radius ratio, relative to the attainable one, that each new tetrahedron must exceed.
    floor: f64,
    /// Minimum radius ratio of each new tetrahedron.
    least: f64,
    /// Upper bound on the total strain of the new tetrahedra.
    limit: f64,
    /// Total strain at which the search may end.
    enough: f64,
    nodes: usize,
    /// Volume differences below this are rounding errors.
    slack: f64,
    volume: f64,
    /// Vertices inside the cavity, off its boundary.
    loose: u16,
}

impl Reconnection {
    /// Searches for better tetrahedra in a cavity of up to `size` around `t`. Returns false if none are found within
    /// `nodes` steps. No new tetrahedron has a radius ratio below `least`.
    pub(super) fn find(
        &mut self,
        room: SearchScope,
        [t, size, nodes]: [usize; 3],
        least: f64,
        strain_of: impl Fn(&[u32]) -> f64,
    ) -> bool {
        self.choose_cavity(room.c, t as u32, size);
        if self.tets.len() < 3 || !self.outline(room.c) || self.is_known(room.c, nodes) {
            return false;
        }
        self.limit = strain_of(&self.tets) - EASED;
        self.enough = self.limit * GOOD;
        // A tetrahedron with more strain than all old ones is of no use.
        self.floor = ratio_of_strain(self.limit) * 0.99;
        self.nodes = nodes;
        self.least = least;
        self.search(room);
        self.new.clear();
        self.new.extend(self.best.iter().map(|t| t.map(|v| self.vertices[v as usize])));
        !self.new.is_empty()
    }

    /// Grows a cavity around `t`, always by the tetrahedron with most vertices in common, so that few vertices have
    /// many tetrahedra. Frozen faces are not crossed.
    fn choose_cavity(&mut self, c: &Complex, t: u32, size: usize) {
        self.tets.clear();
        self.vertices.clear();
        self.tets.push(t);
        self.vertices.extend(c.verts(t));
        while self.tets.len() < size {
            let mut best: Option<(usize, u32)> = None;
            for (order, &x) in self.tets.iter().enumerate() {
                for half in 4 * x..4 * x + 4 {
                    let mate = c.mate(half);
                    let n = mate >> 2;
                    if c.is_frozen(half) || c.is_ghost(n) || self.tets.contains(&n) {
                        continue;
                    }
                    // Ranked by a known apex, then by faces shared with the cavity, then by closeness to the start.
                    let known = usize::from(self.vertices.contains(&c.apex(mate)));
                    let shared = (4 * n..4 * n + 4).filter(|&h| self.tets.contains(&(c.mate(h) >> 2))).count();
                    let rank = (known * 8 + shared) * 64 + (63 - order.min(63));
                    if best.is_none_or(|b| rank > b.0) {
                        best = Some((rank, n));
                    }
                }
            }
            let Some((_, n)) = best else { return };
            let fresh = c.verts(n).into_iter().filter(|v| !self.vertices.contains(v)).count();
            if self.vertices.len() + fresh > MAX_VERTICES {
                return;
            }
            for v in c.verts(n) {
                if !self.vertices.contains(&v) {
                    self.vertices.push(v);
                }
            }
            self.tets.push(n);
        }
    }

    /// True if the same cavity, with the same coordinates, was searched with as many steps before. Successful searches
    /// destroy their cavity, so that search failed. Bad tetrahedra with a common cause often grow the same cavity.
    fn is_known(&mut self, c: &Complex, nodes: usize) -> bool {
        let print = |&t: &u32| {
            let mut v = c.verts(t);
            v.sort_unstable();
            let mut hasher = FxHasher::default();
            v.hash(&mut hasher);
            v.iter().flat_map(|&v| c.points[v as usize].iter()).for_each(|x| x.to_bits().hash(&mut hasher));
            hasher.finish()
        };
        !self.searched.insert(self.tets.iter().map(print).fold(nodes as u64, u64::wrapping_add))
    }

    /// Forgets the searched cavities, because the goal has changed.
    pub(super) fn forget(&mut self) {
        self.searched.clear();
    }

    /// Makes the cavity's boundary the front. Returns false if a frozen face lies inside.
    fn outline(&mut self, c: &Complex) -> bool {
        self.halves.clear();
        for &t in &self.tets {
            for half in 4 * t..4 * t + 4 {
                if !self.tets.contains(&(c.mate(half) >> 2)) {
                    self.halves.push(half);
                } else if c.is_frozen(half) {
                    return false;
                }
            }
        }
        self.halves.len() <= MAX_FRONT
    }

    fn local(&self, v: u32) -> u8 {
        self.vertices.iter().position(|&x| x == v).unwrap_or(0) as u8
    }

    /// Table index of the tetrahedron of four local vertices, and true if its orientation is reversed there. `None` if
    /// a vertex occurs twice. Computes its volume.
    fn entry(&mut self, room: SearchScope, v: [u8; 4]) -> Option<(usize, bool)> {
        let (sorted, odd) = sort4(v);
        let [i, j, k, l] = sorted.map(usize::from);
        if i == j || j == k || k == l {
            return None;
        }
        let at = choose(l, 4) + choose(k, 3) + choose(j, 2) + i;
        if self.table[at].volume.is_nan() {
            let [p, q, r, s] = sorted.map(|x| &room.c.points[self.vertices[usize::from(x)] as usize]);
            self.table[at].volume = orient3d(p, q, r, s);
        }
        Some((at, odd))
    }

    /// True if the tetrahedron of four local vertices is positive.
    fn is_positive(&mut self, room: SearchScope, v: [u8; 4]) -> bool {
        self.entry(room, v).is_some_and(|(at, odd)| {
            let volume = self.table[at].volume;
            if odd { volume < 0.0 } else { volume > 0.0 }
        })
    }

    /// Table entry of four local vertices, if positive. Ratio and strain are computed lazily.
    fn tet(&mut self, room: SearchScope, v: [u8; 4]) -> Option<Entry> {
        if !self.is_positive(room, v) {
            return None;
        }
        let (at, odd) = self.entry(room, v)?;
        if self.table[at].ratio.is_nan() {
            let w = sort4(v).0.map(|x| self.vertices[usize::from(x)]);
            let [p, q, r, s] = w.map(|x| &room.c.points[x as usize]);
            let ratio = match radius_ratio(p, q, r, s).abs() {
                ratio if ratio.is_nan() => 0.0,
                // Below the minimum, only the sign matters.
                ratio if ratio < self.least => f64::MIN_POSITIVE,
                ratio => (ratio / room.allowance.of_tet(&w)).min(1.0),
            };
            // Below the floor, the strain is never used.
            let strain = if ratio > self.floor { strain(ratio) } else { f64::INFINITY };
            self.table[at] = Entry { ratio, strain, ..self.table[at] };
        }
        let entry = self.table[at];
        Some(Entry { volume: if odd { -entry.volume } else { entry.volume }, ..entry })
    }

    fn search(&mut self, room: SearchScope) {
        self.table.clear();
        self.table.resize(choose(self.vertices.len(), 4), NO_ENTRY);
        self.faces.clear();
        self.faces.resize(2 * choose(self.vertices.len(), 3), FrontFace::NONE);
        self.place.clear();
        self.place.resize(self.faces.len(), 0);
        self.best.clear();
        self.stack.clear();
        self.front.clear();
        self.volume = self.tets.iter().map(|&t| room.c.orient(&room.c.verts(t))).sum();
        self.slack = 1e-9 * self.volume;
        self.loose = self.loose_vertices(room.c);
        let mut least = 0.0;
        for k in 0..self.halves.len() {
            let [a, b, d] = room.c.face(self.halves[k]).map(|v| self.local(v));
            let face = self.front_face(room, [a, b, d]);
            least += face.least;
            // The search would end immediately.
            if SHARE * least >= self.limit {
                return;
            }
            self.push_front(face);
        }
        self.branch(room, 0.0, self.volume);
    }

    /// Front face of three local vertices.
    fn front_face(&mut self, room: SearchScope, f: [u8; 3]) -> FrontFace {
        let place = face_index(f);
        let at = usize::from(place);
        if self.faces[at].mates == UNKNOWN {
            let (mut mates, mut least) = (0, f64::INFINITY);
            for v in 0..self.vertices.len() as u8 {
                if !f.contains(&v) {
                    let tet = self.tet(room, [v, f[0], f[1], f[2]]);
                    if let Some(Entry { strain, .. }) = tet.filter(|t| t.ratio > self.floor) {
                        mates |= 1 << v;
                        least = least.min(strain);
                    }
                }
            }
            self.faces[at] = FrontFace { v: f, at: [place, place ^ 1], mates, least };
        }
        self.faces[at]
    }

    fn push_front(&mut self, face: FrontFace) {
        self.front.push(face);
        self.place[usize::from(face.at[0])] = self.front.len() as u8;
    }

    /// Removes the face at `i` from the front; the last one takes its position.
    fn remove_front(&mut self, i: usize) -> FrontFace {
        let face = self.front.swap_remove(i);
        self.place[usize::from(face.at[0])] = 0;
        if let Some(moved) = self.front.get(i) {
            self.place[usize::from(moved.at[0])] = i as u8 + 1;
        }
        face
    }

    /// Undoes [`Self::remove_front`].
    fn restore_front(&mut self, i: usize, face: FrontFace) {
        self.push_front(face);
        let last = self.front.len() - 1;
        self.front.swap(i, last);
        for k in [i, last] {
            self.place[usize::from(self.front[k].at[0])] = k as u8 + 1;
        }
    }

    /// Vertices on the front; others are buried.
    fn live(&self) -> u16 {
        self.front.iter().flat_map(|f| f.v).fold(0, |m, v| m | 1 << v)
    }

    /// Vertices inside the cavity, off its boundary. They may be used from any face, or left out.
    fn loose_vertices(&self, c: &Complex) -> u16 {
        let on = |v: u32| self.halves.iter().any(|&h| c.face(h).contains(&v));
        self.vertices.iter().enumerate().filter(|x| !on(*x.1)).fold(0, |m, x| m | 1 << x.0)
    }

    /// Closes the front with tetrahedra above the floor. Volume and number of steps bound the depth.
    fn branch(&mut self, room: SearchScope, sum: f64, volume: f64) {
        if self.front.is_empty() {
            if sum < self.limit && volume.abs() <= self.slack * 1e3 {
                self.limit = sum;
                self.best.clear();
                self.best.extend_from_slice(&self.stack);
            }
            return;
        }
        if self.nodes == 0
            || self.stack.len() > 3 * MAX_VERTICES
            || (self.limit <= self.enough && !self.best.is_empty())
        {
            return;
        }
        self.nodes -= 1;
        if sum + SHARE * self.front.iter().map(|f| f.least).sum::<f64>() >= self.limit {
            return;
        }
        let usable = self.live() | self.loose;
        let Some(at) = (0..self.front.len()).min_by_key(|&i| (self.front[i].mates & usable).count_ones()) else {
            return;
        };
        let face = self.front[at];
        let mut choices = [(0.0, 0u8); MAX_VERTICES];
        let mut count = 0;
        for v in 0..self.vertices.len() as u8 {
            if face.mates & usable & (1 << v) != 0
                && let Some(tet) = self.tet(room, [v, face.v[0], face.v[1], face.v[2]])
                && sum + tet.strain < self.limit
                && tet.volume <= volume + self.slack
            {
                choices[count] = (tet.strain, v);
                count += 1;
            }
        }
        choices[..count].sort_unstable_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        for &(strain, v) in &choices[..count] {
            // The limit may have fallen since.
            let sum = sum + strain;
            if sum >= self.limit {
                break;
            }
            self.take(room, at, v, sum, volume);
            if self.nodes == 0 {
                return;
            }
        }
    }

    /// Adds tetrahedron (v, face `at`), continues the search, and removes it again.
    fn take(&mut self, room: SearchScope, at: usize, v: u8, sum: f64, volume: f64) {
        let [a, b, d] = self.front[at].v;
        if self.encloses(room, [v, a, b, d]) {
            return;
        }
        let size = self.tet(room, [v, a, b, d]).map_or(0.0, |t| t.volume);
        // Positions of faces removed from the front, newest last, and the order of removals and additions.
        let mut removed: [(usize, FrontFace); 4] = [(0, self.front[at]); 4];
        let mut order = [false; 4];
        let (mut steps, mut outs) = (1, 1);
        removed[0] = (at, self.remove_front(at));
        // The other faces of the tetrahedron, oriented towards the remaining cavity.
        let mut fits = true;
        for f in [[v, a, b], [v, b, d], [v, d, a]] {
            let place = face_index(f);
            let [there, back] = [place, place ^ 1].map(|p| self.place[usize::from(p)]);
            if back > 0 {
                let i = usize::from(back) - 1;
                removed[outs] = (i, self.remove_front(i));
                (outs, steps) = (outs + 1, steps + 1);
            } else if self.front.len() >= MAX_FRONT || there > 0 {
                fits = false;
                break;
            } else {
                let face = self.front_face(room, f);
                if face.mates == 0 {
                    fits = false;
                    break;
                }
                self.push_front(face);
                order[steps] = true;
                steps += 1;
            }
        }
        if fits {
            self.stack.push([v, a, b, d]);
            self.branch(room, sum, volume - size);
            self.stack.pop();
        }
        for step in (0..steps).rev() {
            if order[step] {
                self.remove_front(self.front.len() - 1);
            } else {
                outs -= 1;
                let (i, face) = removed[outs];
                self.restore_front(i, face);
            }
        }
    }

    /// True if another vertex of the front lies strictly inside.
    fn encloses(&mut self, room: SearchScope, v: [u8; 4]) -> bool {
        let Some((at, _)) = self.entry(room, v) else { return true };
        if self.table[at].enclosed == UNKNOWN {
            let [v, a, b, d] = v;
            let mut enclosed = 0;
            for x in 0..self.vertices.len() as u8 {
                let inside = ![v, a, b, d].contains(&x)
                    && [[x, a, b, d], [v, x, b, d], [v, a, x, d], [v, a, b, x]]
                        .iter()
                        .all(|&y| self.is_positive(room, y));
                enclosed |= u16::from(inside) << x;
            }
            self.table[at].enclosed = enclosed;
        }
        self.table[at].enclosed & self.live() != 0
    }
}

/// Index of a face of three local vertices in the face table. The reversed face is adjacent.
fn face_index(f: [u8; 3]) -> u16 {
    let ([i, j, k], odd) = sort3(f);
    (2 * (choose(k as usize, 3) + choose(j as usize, 2) + i as usize) + usize::from(odd)) as u16
}

/// Sorts three values. Returns true for an odd permutation.
fn sort3(mut v: [u8; 3]) -> ([u8; 3], bool) {
    let mut odd = false;
    for (i, j) in [(0, 1), (1, 2), (0, 1)] {
        if v[i] > v[j] {
            v.swap(i, j);
            odd = !odd;
        }
    }
    (v, odd)
}

/// Sorts four values. Returns true for an odd permutation.
fn sort4(mut v: [u8; 4]) -> ([u8; 4], bool) {
    let mut odd = false;
    for (i, j) in [(0, 1), (2, 3), (0, 2), (1, 3), (1, 2)] {
        if v[i] > v[j] {
            v.swap(i, j);
            odd = !odd;
        }
    }
    (v, odd)
}

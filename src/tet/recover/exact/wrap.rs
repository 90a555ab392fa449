//! Gift wrapping: the constrained Delaunay tetrahedralization of a polyhedron (Shewchuk 2000; Diazzi, Panozzo, Vaxman,
//! Attene 2023). Exact, with the perturbation of the Delaunay kernel.

use super::space::Space;
use crate::geometry::{Aabb, Vec3};
use crate::tet::complex::face_key;
use rustc_hash::FxHashMap;

/// Wraps polyhedra; keeps its buffers.
#[derive(Default)]
pub(super) struct Wrapper {
    /// Faces that wait for a tetrahedron on the side from which they run counter-clockwise.
    front: FxHashMap<[u32; 3], [u32; 3]>,
    stack: Vec<[u32; 3]>,
    boxes: Vec<(Vec3, Vec3)>,
    candidates: Vec<u32>,
}

/// The rotation of a face that begins with its smallest vertex.
fn rotated([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}

impl Wrapper {
    /// Fills the room in front of `walls`, which run counter-clockwise seen from inside, with tetrahedra on `vertices`.
    /// False when that is not possible, which means that some segment is no edge of the Delaunay complex.
    pub(super) fn fill(&mut self, s: &Space, walls: &[[u32; 3]], vertices: &[u32], out: &mut Vec<[u32; 4]>) -> bool {
        self.front.clear();
        self.stack.clear();
        self.boxes.clear();
        for &w in walls {
            self.front.insert(face_key(w), w);
            self.stack.push(face_key(w));
            self.boxes.push(bounds(s, &w));
        }
        let limit = out.len() + 64 * vertices.len() + vertices.len() * vertices.len();
        while let Some(key) = self.stack.pop() {
            let Some(&face) = self.front.get(&key) else { continue };
            let Some(apex) = self.apex(s, face, walls, vertices) else { return false };
            if out.len() == limit {
                return false;
            }
            let [a, b, c] = face;
            out.push([a, b, c, apex]);
            self.front.remove(&key);
            for outer in [[b, c, apex], [c, a, apex], [a, b, apex]] {
                let key = face_key(outer);
                if self.front.remove(&key).is_none() {
                    self.front.insert(key, outer);
                    self.stack.push(key);
                }
            }
        }
        true
    }

    /// The vertex that completes a face: of those that the face sees, the one whose sphere holds no other. Spheres
    /// through the face are ordered along its axis, so the first that is not hidden is the one.
    fn apex(&mut self, s: &Space, face: [u32; 3], walls: &[[u32; 3]], vertices: &[u32]) -> Option<u32> {
        let [a, b, c] = face;
        self.candidates.clear();
        let ahead = |&v: &u32| !face.contains(&v) && s.orient([a, b, c, v]) > 0;
        self.candidates.extend(vertices.iter().copied().filter(ahead));
        while !self.candidates.is_empty() {
            let mut best = 0;
            for k in 1..self.candidates.len() {
                if s.in_sphere([a, b, c, self.candidates[best]], self.candidates[k]) {
                    best = k;
                }
            }
            let v = self.candidates.swap_remove(best);
            if self.fits(face, v) && !self.crossed(s, [a, b, c, v], walls) {
                return Some(v);
            }
        }
        None
    }

    /// Whether the other faces of a tetrahedron are new, or wait for one on this side.
    fn fits(&self, [a, b, c]: [u32; 3], v: u32) -> bool {
        [[c, b, v], [a, c, v], [b, a, v]]
            .iter()
            .all(|f| self.front.get(&face_key(*f)).is_none_or(|g| rotated(*g) == rotated(*f)))
    }

    /// Whether a wall cuts through a tetrahedron.
    fn crossed(&self, s: &Space, tet: [u32; 4], walls: &[[u32; 3]]) -> bool {
        let (low, high) = bounds(s, &tet);
        self.boxes
            .iter()
            .zip(walls)
            .any(|((l, h), wall)| (0..3).all(|k| l[k] <= high[k] && low[k] <= h[k]) && !separated(s, &tet, wall))
    }
}

/// The box of some vertices, wide enough for what implicit ones are rounded by.
fn bounds(s: &Space, vertices: &[u32]) -> (Vec3, Vec3) {
    let bounds = Aabb::of_points(vertices.iter().map(|&v| s.point(v)));
    let (low, high) = (bounds.min.coords, bounds.max.coords);
    let slack = low.abs().sup(&high.abs()) * 1e-14;
    (low - slack, high + slack)
}

/// Whether a plane separates the inside of a positive tetrahedron from a triangle. If any does, then one through three
/// of their vertices.
fn separated(s: &Space, tet: &[u32; 4], wall: &[u32; 3]) -> bool {
    let [u, v, w] = *wall;
    let side = |p: [u32; 3], x: u32| if p.contains(&x) { 0 } else { s.orient([p[0], p[1], p[2], x]) };
    if tet.iter().filter(|x| wall.contains(x)).count() == 3 {
        return true;
    }
    let splits = |plane: [u32; 3]| {
        let (mut low, mut high) = (1, -1);
        for &x in tet {
            let o = side(plane, x);
            low = low.min(o);
            high = high.max(o);
        }
        // All zero: three vertices on a line.
        if (low < 0 && high > 0) || (low == 0 && high == 0) {
            return false;
        }
        let sign = if high > 0 { 1 } else { -1 };
        wall.iter().all(|&x| side(plane, x) * sign <= 0)
    };
    if splits([u, v, w]) {
        return true;
    }
    let [a, b, c, d] = *tet;
    if [[b, d, c], [a, c, d], [a, d, b], [a, b, c]].iter().any(|&f| splits(f)) {
        return true;
    }
    let edges = [(a, b), (a, c), (a, d), (b, c), (b, d), (c, d)];
    edges.iter().any(|&(p, q)| wall.iter().any(|&x| x != p && x != q && splits([p, q, x])))
        || tet.iter().any(|&x| [(u, v), (v, w), (w, u)].iter().any(|&(p, q)| x != p && x != q && splits([x, p, q])))
}

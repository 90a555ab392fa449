//! Half-edge structure of a closed triangle surface, with edge flip, split and collapse in constant time.
//!
//! Half-edge `3 f + i` runs from corner `i` of triangle `f` to the next corner. The surface is a closed 2-manifold, and
//! every operation preserves this.

use anastomesh_mesh::TriMesh;
use anastomesh_mesh::geometry::{Point3, Vec3};

/// Missing half-edge; also marks removed elements.
pub(crate) const NONE: u32 = u32::MAX;

/// Number of neighbours that are compared in place.
const FEW: usize = 16;

/// Closed 2-manifold triangle surface under edit.
#[derive(Clone, Debug)]
pub(crate) struct HalfEdges {
    /// Vertex positions, removed vertices included.
    pub points: Vec<Point3>,
    /// Start of each half-edge; `NONE` in removed triangles.
    from: Vec<u32>,
    /// Opposite half-edge of each half-edge.
    twin: Vec<u32>,
    /// One half-edge that starts at each vertex; `NONE` for removed vertices.
    out: Vec<u32>,
}

/// Half-edge after `h` in its triangle.
#[inline]
pub(crate) fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// Half-edge before `h` in its triangle.
#[inline]
pub(crate) fn prev(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

impl HalfEdges {
    /// Links the triangles of a closed, consistently oriented surface. The error is an edge (vertex pair) without
    /// exactly one triangle per side. For a vertex with several fans or none, the error repeats that vertex.
    pub(crate) fn new(mesh: &TriMesh) -> Result<Self, [u32; 2]> {
        let n = mesh.points.len();
        let from: Vec<u32> = mesh.triangles.iter().flatten().copied().collect();
        let mut start = vec![0u32; n + 1];
        for &v in &from {
            start[v as usize + 1] += 1;
        }
        for i in 0..n {
            start[i + 1] += start[i];
        }
        let mut fill = start.clone();
        // Half-edges that start at each vertex, with their end vertices.
        let mut starting = vec![(0u32, 0u32); from.len()];
        for (h, &v) in from.iter().enumerate() {
            starting[fill[v as usize] as usize] = (from[next(h as u32) as usize], h as u32);
            fill[v as usize] += 1;
        }
        let at = |v: u32| &starting[start[v as usize] as usize..start[v as usize + 1] as usize];
        let mut twin = vec![NONE; from.len()];
        for a in 0..n as u32 {
            for &(b, h) in at(a).iter().filter(|x| x.0 > a) {
                // Exactly one half-edge runs from b to a, and exactly one from a to b.
                let mut back = at(b).iter().filter(|o| o.0 == a);
                let again = at(a).iter().filter(|o| o.0 == b).nth(1);
                match (back.next(), back.next(), again) {
                    (Some(&(_, o)), None, None) => (twin[h as usize], twin[o as usize]) = (o, h),
                    _ => return Err([a, b]),
                }
            }
        }
        // Loops and unmatched half-edges to a smaller vertex have no twin.
        if let Some(h) = twin.iter().position(|&o| o == NONE) {
            return Err([from[h], from[next(h as u32) as usize]]);
        }
        let out: Vec<u32> = (0..n as u32).map(|v| at(v).first().map_or(NONE, |x| x.1)).collect();
        let surface = Self { points: mesh.points.clone(), from, twin, out };
        for v in 0..n as u32 {
            if surface.fan(v).count() != at(v).len() {
                return Err([v, v]);
            }
        }
        Ok(surface)
    }

    /// Returns the surface without removed elements, in the original order. Also returns the new index of each vertex
    /// (`NONE` for removed ones).
    pub(crate) fn to_mesh(&self) -> (TriMesh, Vec<u32>) {
        let mut map = vec![NONE; self.points.len()];
        let mut mesh = TriMesh::default();
        for (v, &h) in self.out.iter().enumerate() {
            if h != NONE {
                map[v] = mesh.points.len() as u32;
                mesh.points.push(self.points[v]);
            }
        }
        for t in self.from.chunks_exact(3) {
            if t[0] != NONE {
                mesh.triangles.push([map[t[0] as usize], map[t[1] as usize], map[t[2] as usize]]);
            }
        }
        (mesh, map)
    }

    /// Returns the structure without removed elements, numbered as in `to_mesh`.
    pub(crate) fn compacted(&self) -> (Self, Vec<u32>) {
        let mut vertex = vec![NONE; self.points.len()];
        let mut points = Vec::with_capacity(self.points.len());
        for (v, _) in self.out.iter().enumerate().filter(|(_, h)| **h != NONE) {
            vertex[v] = points.len() as u32;
            points.push(self.points[v]);
        }
        let mut half = vec![NONE; self.from.len()];
        let live: Vec<u32> = (0..self.len()).filter(|&h| self.is_live(h)).collect();
        for (new, &h) in (0..).zip(&live) {
            half[h as usize] = new;
        }
        let from = live.iter().map(|&h| vertex[self.from[h as usize] as usize]).collect();
        let twin = live.iter().map(|&h| half[self.twin[h as usize] as usize]).collect();
        let out = self.out.iter().filter(|h| **h != NONE).map(|&h| half[h as usize]).collect();
        (Self { points, from, twin, out }, vertex)
    }

    /// Original triangle (first half-edge over three) of each triangle of `to_mesh`.
    pub(crate) fn live_triangles(&self) -> Vec<u32> {
        (0..self.len() / 3).filter(|&f| self.is_live(3 * f)).collect()
    }

    /// Number of half-edges, including removed ones.
    pub(crate) fn len(&self) -> u32 {
        self.from.len() as u32
    }

    /// True if a half-edge is part of the surface.
    #[inline]
    pub(crate) fn is_live(&self, h: u32) -> bool {
        self.from[h as usize] != NONE
    }

    /// True if a vertex is part of the surface.
    #[inline]
    pub(crate) fn has_vertex(&self, v: u32) -> bool {
        self.out[v as usize] != NONE
    }

    /// Start of a half-edge.
    #[inline]
    pub(crate) fn from(&self, h: u32) -> u32 {
        self.from[h as usize]
    }

    /// End of a half-edge.
    #[inline]
    pub(crate) fn to(&self, h: u32) -> u32 {
        self.from[next(h) as usize]
    }

    /// Vertex opposite a half-edge in its triangle.
    #[inline]
    pub(crate) fn apex(&self, h: u32) -> u32 {
        self.from[prev(h) as usize]
    }

    /// Opposite half-edge.
    #[inline]
    pub(crate) fn twin(&self, h: u32) -> u32 {
        self.twin[h as usize]
    }

    /// Half-edges that start at `v`, clockwise.
    pub(crate) fn fan(&self, v: u32) -> impl Iterator<Item = u32> + '_ {
        let first = self.out[v as usize];
        let mut at = first;
        std::iter::from_fn(move || {
            if at == NONE {
                return None;
            }
            let h = at;
            at = next(self.twin[h as usize]);
            if at == first {
                at = NONE;
            }
            Some(h)
        })
    }

    /// Number of edges at `v`.
    pub(crate) fn valence(&self, v: u32) -> usize {
        self.fan(v).count()
    }

    /// Number of edges at each vertex.
    pub(crate) fn valences(&self) -> Vec<i32> {
        let mut out = vec![0; self.points.len()];
        for &v in self.from.iter().filter(|&&v| v != NONE) {
            out[v as usize] += 1;
        }
        out
    }

    /// True if an edge joins the two vertices.
    pub(crate) fn joined(&self, a: u32, b: u32) -> bool {
        self.fan(a).any(|h| self.to(h) == b)
    }

    #[inline]
    fn point(&self, v: u32) -> &Point3 {
        &self.points[v as usize]
    }

    /// Length of an edge.
    #[inline]
    pub(crate) fn length(&self, h: u32) -> f64 {
        (self.point(self.to(h)) - self.point(self.from(h))).norm()
    }

    /// Twice the area vector of a half-edge's triangle.
    #[inline]
    pub(crate) fn area_vector(&self, h: u32) -> Vec3 {
        let a = self.point(self.from(h));
        (self.point(self.to(h)) - a).cross(&(self.point(self.apex(h)) - a))
    }

    fn place(&mut self, first: u32, corners: [u32; 3]) {
        for (h, v) in (first..).zip(corners) {
            self.from[h as usize] = v;
            self.out[v as usize] = h;
        }
    }

    fn link(&mut self, a: u32, b: u32) {
        self.twin[a as usize] = b;
        self.twin[b as usize] = a;
    }

    /// True if a flip preserves the manifold: both ends keep three edges, and the new edge does not exist yet.
    pub(crate) fn can_flip(&self, h: u32) -> bool {
        let o = self.twin(h);
        self.fan(self.from(h)).nth(3).is_some()
            && self.fan(self.to(h)).nth(3).is_some()
            && self.apex(h) != self.apex(o)
            && !self.joined(self.apex(h), self.apex(o))
    }

    /// Replaces the edge by the other diagonal of its two triangles. Requires `can_flip`.
    pub(crate) fn flip(&mut self, h: u32) {
        let o = self.twin(h);
        let (a, b, c, d) = (self.from(h), self.to(h), self.apex(h), self.apex(o));
        let (bc, ca, ad, db) = (self.twin(next(h)), self.twin(prev(h)), self.twin(next(o)), self.twin(prev(o)));
        let (x, y) = (h - h % 3, o - o % 3);
        self.place(x, [a, d, c]);
        self.place(y, [d, b, c]);
        self.link(x, ad);
        self.link(x + 1, y + 2);
        self.link(x + 2, ca);
        self.link(y, db);
        self.link(y + 1, bc);
    }

    /// True if a collapse preserves the manifold (link condition). The ends share only the two apexes as neighbours, and
    /// every vertex keeps at least three edges.
    pub(crate) fn can_collapse(&self, h: u32) -> bool {
        let (a, b) = (self.from(h), self.to(h));
        // Neighbours of `b`, so that its fan is read once.
        let mut beside = [NONE; FEW];
        let mut count = 0;
        for e in self.fan(b) {
            if count < FEW {
                beside[count] = self.to(e);
            }
            count += 1;
        }
        let is_beside = |v: u32| if count <= FEW { beside[..count].contains(&v) } else { self.joined(v, b) };
        let common = self.fan(a).filter(|&e| is_beside(self.to(e))).count();
        let apexes = [self.apex(h), self.apex(self.twin(h))];
        common == 2
            && apexes[0] != apexes[1]
            && apexes.iter().all(|&v| self.fan(v).nth(3).is_some())
            && self.valence(a) + count >= 7
    }

    /// Collapses the start of `h` into its end. Requires `can_collapse`.
    pub(crate) fn collapse(&mut self, h: u32) {
        let o = self.twin(h);
        let (a, b, c, d) = (self.from(h), self.to(h), self.apex(h), self.apex(o));
        let (bc, ca, ad, db) = (self.twin(next(h)), self.twin(prev(h)), self.twin(next(o)), self.twin(prev(o)));
        let mut e = self.out[a as usize];
        loop {
            self.from[e as usize] = b;
            e = next(self.twin[e as usize]);
            if self.from[e as usize] == b {
                break;
            }
        }
        for f in [h - h % 3, o - o % 3] {
            for k in f..f + 3 {
                self.from[k as usize] = NONE;
                self.twin[k as usize] = NONE;
            }
        }
        self.link(bc, ca);
        self.link(ad, db);
        self.out[a as usize] = NONE;
        self.out[b as usize] = ca;
        self.out[c as usize] = bc;
        self.out[d as usize] = ad;
        // `ca` is the twin of c→a: it starts at a, now b; `ad` is the twin of a→d: it starts at d.
        debug_assert!(self.from(ca) == b && self.from(bc) == c && self.from(ad) == d);
    }

    /// Inserts a vertex on the edge and returns it.
    pub(crate) fn split(&mut self, h: u32, p: Point3) -> u32 {
        let o = self.twin(h);
        let (a, b, c, d) = (self.from(h), self.to(h), self.apex(h), self.apex(o));
        let (bc, ca, ad, db) = (self.twin(next(h)), self.twin(prev(h)), self.twin(next(o)), self.twin(prev(o)));
        let m = self.points.len() as u32;
        self.points.push(p);
        self.out.push(NONE);
        let (x, y, z) = (h - h % 3, o - o % 3, self.len());
        let w = z + 3;
        self.from.resize(self.from.len() + 6, NONE);
        self.twin.resize(self.twin.len() + 6, NONE);
        self.place(x, [a, m, c]);
        self.place(z, [m, b, c]);
        self.place(y, [b, m, d]);
        self.place(w, [m, a, d]);
        for (p, q) in
            [(x, w), (x + 1, z + 2), (x + 2, ca), (z, y), (z + 1, bc), (y + 1, w + 2), (y + 2, db), (w + 1, ad)]
        {
            self.link(p, q);
        }
        m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::shapes::sphere_surface;
    use proptest::prelude::*;

    #[test]
    fn open_or_pinched_surfaces_are_refused() {
        let mut mesh = sphere_surface(0);
        assert!(HalfEdges::new(&mesh).is_ok());
        mesh.triangles.pop();
        assert!(HalfEdges::new(&mesh).is_err());
    }

    proptest! {
        #[test]
        fn any_sequence_of_operations_keeps_a_closed_manifold(steps in prop::collection::vec((0u8..3, any::<u32>()), 1..60)) {
            let mut s = HalfEdges::new(&sphere_surface(0)).unwrap();
            for (what, pick) in steps {
                let h = pick % s.len();
                if !s.is_live(h) {
                    continue;
                }
                match what {
                    0 if s.can_flip(h) => s.flip(h),
                    1 if s.can_collapse(h) => s.collapse(h),
                    2 => {
                        let p = nalgebra::center(&s.points[s.from(h) as usize], &s.points[s.to(h) as usize]);
                        s.split(h, p);
                    }
                    _ => continue,
                }
                let (mesh, map) = s.to_mesh();
                prop_assert!(HalfEdges::new(&mesh).is_ok());
                let (compact, numbers) = s.compacted();
                prop_assert_eq!(numbers, map);
                prop_assert_eq!(&compact.twin, &HalfEdges::new(&mesh).unwrap().twin);
                prop_assert_eq!(&compact.from, mesh.triangles.as_flattened());
                prop_assert!((0..mesh.points.len() as u32).all(|v| compact.from(compact.out[v as usize]) == v));
                prop_assert_eq!(super::super::euler_characteristic(&mesh), 2);
            }
        }
    }
}

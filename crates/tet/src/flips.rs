//! Local changes of a complex: face removal (2-3 flip) and edge removal (3-2, 4-4, …). Exact predicates validate each
//! one first. Frozen faces and the boundary are never touched.

use super::complex::Complex;
use super::star::EdgeRing;

/// Maximum tetrahedra around an edge to remove.
pub const MAX_RING: usize = 12;

/// Reason for a refused flip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Refusal {
    /// A frozen face, boundary face or boundary edge would be removed.
    Frozen,
    /// No arrangement of the new tetrahedra is valid (or good enough).
    NotValid,
    /// Too many tetrahedra surround the edge.
    RingTooLarge,
    /// The tetrahedron does not have that edge or face.
    Missing,
}

/// Plans and makes flips; reuses its buffers.
#[derive(Clone, Debug, Default)]
pub struct Flipper {
    ring: EdgeRing,
    old: Vec<u32>,
    new: Vec<[u32; 4]>,
    created: Vec<u32>,
    best: Vec<f64>,
    split: Vec<u8>,
    stack: Vec<(usize, usize)>,
}

impl Flipper {
    /// Slots of the tetrahedra created by the last flip.
    pub fn created(&self) -> &[u32] {
        &self.created
    }

    /// Plans the 2-3 flip of a face, which exchanges it for the edge between its two apices. Returns the smallest score
    /// of the new tetrahedra. `score` must be `None` for a tetrahedron that is not positive. Its first three vertices are
    /// a new face, the first two the new edge.
    ///
    /// # Errors
    /// [`Refusal::Frozen`] for a frozen or boundary face, [`Refusal::NotValid`] if the two tetrahedra are not convex.
    pub fn plan_face(
        &mut self,
        c: &Complex,
        half: u32,
        mut score: impl FnMut(&Complex, &[u32; 4]) -> Option<f64>,
    ) -> Result<f64, Refusal> {
        let mate = c.mate(half);
        let (t, n) = (half >> 2, mate >> 2);
        if c.is_frozen(half) || c.is_ghost(t) || c.is_ghost(n) {
            return Err(Refusal::Frozen);
        }
        let f = c.face(half);
        let (a, d) = (c.apex(half), c.apex(mate));
        self.old.clear();
        self.old.extend([t, n]);
        self.new.clear();
        let mut worst = f64::INFINITY;
        for i in 0..3 {
            let v = [a, d, f[i], f[(i + 1) % 3]];
            worst = worst.min(score(c, &v).ok_or(Refusal::NotValid)?);
            self.new.push(v);
        }
        Ok(worst)
    }

    /// Plans the removal of edge `a, b` of tetrahedron `t`. Triangulates the ring by Klincsek's dynamic programming
    /// (Shewchuk, 'Two discrete optimization algorithms for the topological improvement of tetrahedral meshes', 2002).
    /// Returns the maximal worst score. `score` must be `None` for a tetrahedron that is not positive.
    ///
    /// # Errors
    /// See [`Refusal`].
    pub fn plan_edge(
        &mut self,
        c: &Complex,
        t: u32,
        a: u32,
        b: u32,
        max_ring: usize,
        score: impl FnMut(&Complex, &[u32; 4]) -> Option<f64>,
    ) -> Result<f64, Refusal> {
        self.plan_edge_if(c, [t, a, b], max_ring, |_, _| true, score)
    }

    /// As [`Flipper::plan_edge`], for edge `a, b` of `t` in `[t, a, b]`. Makes only the edges that `chord` accepts. The
    /// first three vertices of each tetrahedron given to `score` are a new face.
    ///
    /// # Errors
    /// See [`Refusal`].
    pub fn plan_edge_if(
        &mut self,
        c: &Complex,
        edge: [u32; 3],
        max_ring: usize,
        chord: impl Fn(&Complex, [u32; 2]) -> bool,
        score: impl FnMut(&Complex, &[u32; 4]) -> Option<f64>,
    ) -> Result<f64, Refusal> {
        let mut ring = std::mem::take(&mut self.ring);
        let result = self.plan_ring(c, &mut ring, edge, max_ring.min(MAX_RING), (chord, score));
        self.ring = ring;
        result
    }

    fn plan_ring(
        &mut self,
        c: &Complex,
        ring: &mut EdgeRing,
        [t, a, b]: [u32; 3],
        max_ring: usize,
        rules: (impl Fn(&Complex, [u32; 2]) -> bool, impl FnMut(&Complex, &[u32; 4]) -> Option<f64>),
    ) -> Result<f64, Refusal> {
        if !ring.collect(c, t, a, b, max_ring) {
            let missing = c.slot_of(t, a).is_none() || c.slot_of(t, b).is_none();
            return Err(if missing { Refusal::Missing } else { Refusal::RingTooLarge });
        }
        if ring.touches_ghost() {
            return Err(Refusal::Frozen);
        }
        for i in 0..ring.len() {
            if ring.spoke(c, i).is_none_or(|h| c.is_frozen(h)) {
                return Err(Refusal::Frozen);
            }
        }
        self.triangulate_ring(c, ring, rules)
    }

    /// Fills `old` and `new` with the best triangulation of the ring.
    fn triangulate_ring(
        &mut self,
        c: &Complex,
        ring: &EdgeRing,
        (chord, mut score): (impl Fn(&Complex, [u32; 2]) -> bool, impl FnMut(&Complex, &[u32; 4]) -> Option<f64>),
    ) -> Result<f64, Refusal> {
        let n = ring.len();
        self.best.clear();
        self.best.resize(n * n, f64::INFINITY);
        self.split.clear();
        self.split.resize(n * n, 0);
        for span in 2..n {
            for i in 0..n - span {
                let j = i + span;
                let (mut top, mut at) = (f64::NEG_INFINITY, 0);
                for k in i + 1..j {
                    let sides = self.best[i * n + k].min(self.best[k * n + j]);
                    if sides <= top {
                        continue;
                    }
                    let [below, above] = wedge(ring, i, k, j);
                    let Some(q) = score(c, &below) else { continue };
                    let q = q.min(sides);
                    if q <= top {
                        continue;
                    }
                    let Some(r) = score(c, &above) else { continue };
                    if q.min(r) > top {
                        (top, at) = (q.min(r), k);
                    }
                }
                let whole = span == n - 1;
                if top > f64::NEG_INFINITY && !whole && !chord(c, [ring.rim[i], ring.rim[j]]) {
                    top = f64::NEG_INFINITY;
                }
                self.best[i * n + j] = top;
                self.split[i * n + j] = at as u8;
            }
        }
        let worst = self.best[n - 1];
        if worst == f64::NEG_INFINITY || n < 3 {
            return Err(Refusal::NotValid);
        }
        self.old.clear();
        self.old.extend_from_slice(&ring.tets);
        self.new.clear();
        self.stack.clear();
        self.stack.push((0, n - 1));
        while let Some((i, j)) = self.stack.pop() {
            if j - i >= 2 {
                let k = self.split[i * n + j] as usize;
                self.new.extend(wedge(ring, i, k, j));
                self.stack.push((i, k));
                self.stack.push((k, j));
            }
        }
        Ok(worst)
    }

    /// Tetrahedra that the planned change would create.
    pub fn planned(&self) -> &[[u32; 4]] {
        &self.new
    }

    /// Tetrahedra that the planned change would remove.
    pub fn removed_tets(&self) -> &[u32] {
        &self.old
    }

    /// Makes the planned change; the complex must be unchanged since. New positive tetrahedra that fit the boundary of
    /// the old ones cover the same volume once, so no edge can exist twice.
    ///
    /// # Errors
    /// [`Refusal::NotValid`] if the new tetrahedra do not fit (the ring folds over itself); nothing is changed.
    pub fn commit(&mut self, c: &mut Complex) -> Result<(), Refusal> {
        let mut created = std::mem::take(&mut self.created);
        let done = c.replace(&self.old, &self.new, &mut created);
        self.created = created;
        if done { Ok(()) } else { Err(Refusal::NotValid) }
    }
}

/// The two tetrahedra between triangle `i, k, j` of the rim and the ends of the edge.
fn wedge(ring: &EdgeRing, i: usize, k: usize, j: usize) -> [[u32; 4]; 2] {
    let (ri, rk, rj) = (ring.rim[i], ring.rim[k], ring.rim[j]);
    [[ri, rj, rk, ring.a], [ri, rk, rj, ring.b]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::geometry::Point3;

    /// `n` tetrahedra around the edge 0-1 along z, rim of radius 1.
    fn wheel(n: u32) -> Complex {
        let mut points = vec![Point3::new(0.0, 0.0, -1.0), Point3::new(0.0, 0.0, 1.0)];
        for i in 0..n {
            let w = f64::from(i) / f64::from(n) * std::f64::consts::TAU;
            points.push(Point3::new(libm::cos(w), libm::sin(w), 0.0));
        }
        let tets: Vec<_> = (0..n).map(|i| [0, 1, 2 + i, 2 + (i + 1) % n]).collect();
        let c = Complex::from_mesh(points, &tets).unwrap();
        c.sanity_check().unwrap();
        c
    }

    /// Score of flips that must be possible, not good.
    fn valid(c: &Complex, v: &[u32; 4]) -> Option<f64> {
        (c.orient(v) > 0.0).then_some(1.0)
    }

    impl Flipper {
        fn flip_face(&mut self, c: &mut Complex, half: u32) -> Result<(), Refusal> {
            self.plan_face(c, half, valid)?;
            self.commit(c)
        }

        fn remove_edge(&mut self, c: &mut Complex, t: u32, a: u32, b: u32) -> Result<(), Refusal> {
            self.plan_edge(c, t, a, b, MAX_RING, valid)?;
            self.commit(c)
        }
    }

    fn volume(c: &Complex) -> f64 {
        c.real_tets().map(|t| c.orient(&c.verts(t))).sum()
    }

    #[test]
    fn edge_removal_keeps_the_room_for_every_ring() {
        for n in 3..=MAX_RING as u32 {
            let mut c = wheel(n);
            let before = volume(&c);
            let mut f = Flipper::default();
            let t = c.vertex_tet(0);
            let t = if c.is_ghost(t) { c.real_tets().next().unwrap() } else { t };
            f.remove_edge(&mut c, t, 0, 1).unwrap();
            c.sanity_check().unwrap();
            assert_eq!(c.real_tets().count() as u32, 2 * (n - 2));
            assert!((volume(&c) - before).abs() < 1e-12);
        }
    }

    #[test]
    fn face_flip_undoes_a_three_ring_and_refuses_the_boundary() {
        let mut c = wheel(3);
        let mut f = Flipper::default();
        let t = c.real_tets().next().unwrap();
        f.remove_edge(&mut c, t, 0, 1).unwrap();
        let inner = c.real_tets().flat_map(|t| (0..4).map(move |i| 4 * t + i)).find(|&h| !c.is_ghost(c.mate(h) >> 2));
        let inner = inner.unwrap();
        c.freeze(inner);
        assert_eq!(f.flip_face(&mut c, inner), Err(Refusal::Frozen));
        c.thaw(inner);
        f.flip_face(&mut c, inner).unwrap();
        c.sanity_check().unwrap();
        assert_eq!(c.real_tets().count(), 3);
        let t = c.real_tets().next().unwrap();
        let hull = (0..4).map(|i| 4 * t + i).find(|&h| c.is_ghost(c.mate(h) >> 2)).unwrap();
        assert_eq!(f.flip_face(&mut c, hull), Err(Refusal::Frozen));
        assert_eq!(f.remove_edge(&mut c, t, 0, 2), Err(Refusal::Frozen));
    }

    #[test]
    fn a_ring_that_is_not_convex_is_refused() {
        // The rim's third point lies on the wrong side of the edge, so no triangle can replace the edge.
        let points = vec![
            Point3::new(0.0, 0.0, -1.0),
            Point3::new(0.0, 0.0, 1.0),
            Point3::new(1.0, 0.0, 3.0),
            Point3::new(-0.5, 0.8, 3.0),
            Point3::new(-0.5, -0.8, 3.0),
        ];
        let mut c = Complex::from_mesh(points, &[[0, 1, 2, 3], [0, 1, 3, 4], [0, 1, 4, 2]]).unwrap();
        let mut f = Flipper::default();
        let t = c.real_tets().next().unwrap();
        assert_eq!(f.remove_edge(&mut c, t, 0, 1), Err(Refusal::NotValid));
        c.sanity_check().unwrap();
    }

    #[test]
    fn frozen_faces_survive_a_change_beside_them() {
        let mut c = wheel(5);
        let t = c.real_tets().next().unwrap();
        let hull: Vec<u32> = c
            .real_tets()
            .flat_map(|t| (0..4).map(move |i| 4 * t + i))
            .filter(|&h| c.is_ghost(c.mate(h) >> 2))
            .collect();
        for h in hull {
            c.freeze(h);
        }
        Flipper::default().remove_edge(&mut c, t, 0, 1).unwrap();
        c.sanity_check().unwrap();
        let frozen = c.real_tets().flat_map(|t| (0..4).map(move |i| 4 * t + i)).filter(|&h| c.is_frozen(h)).count();
        assert_eq!(frozen, 10);
    }
}

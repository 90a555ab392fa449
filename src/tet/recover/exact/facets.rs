//! Facets: each triangle of the input becomes a union of faces. What crosses it is replaced by the constrained Delaunay
//! tetrahedralizations of the rooms on both its sides, which exist once all segments are Delaunay edges (Shewchuk, 'A
//! condition guaranteeing the existence of higher-dimensional constrained Delaunay triangulations', 1998).

use super::polygon::{outline, point_above, triangulate};
use super::segments::Segments;
use super::space::Space;
use super::wrap::Wrapper;
use crate::tet::complex::face_key;
use crate::tet::error::{Obstacle, Stuck, TetError};
use crate::tet::star::{EdgeRing, Star};
use rustc_hash::{FxHashMap, FxHashSet};

/// The faces that each facet consists of, counter-clockwise as the facet is.
pub(super) struct Facets {
    /// Facets with vertices on their sides; others are one face.
    pub pieces: FxHashMap<u32, Vec<[u32; 3]>>,
    /// Facets that had to be recovered.
    pub missing: usize,
}

/// Recovers all triangles and freezes their faces.
pub(super) fn recover(s: &mut Space, segments: &Segments, triangles: &[[u32; 3]]) -> Result<Facets, TetError> {
    let mut facets = Facets { pieces: FxHashMap::default(), missing: 0 };
    let mut polygon = Vec::new();
    for (&triangle, id) in triangles.iter().zip(0..) {
        outline(segments, triangle, &mut polygon);
        if polygon.len() > 3 {
            let above = point_above(s, triangle)?;
            let mut pieces = Vec::new();
            if !triangulate(s, &polygon, &above, &mut pieces) {
                return Err(stuck(triangle, Stuck::Intersection));
            }
            facets.pieces.insert(id, pieces);
        }
    }
    let missing = freeze_present(s, triangles, &facets);
    facets.missing = missing.len();
    let mut r = Recovery {
        s,
        segments,
        star: Star::default(),
        ring: EdgeRing::default(),
        wrapper: Wrapper::default(),
        sign: FxHashMap::default(),
        cavity: Vec::new(),
        inside: FxHashSet::default(),
    };
    for id in missing {
        let triangle = triangles[id as usize];
        let whole = [triangle];
        let pieces = facets.pieces.get(&id).map_or(&whole[..], |p| p);
        r.recover(triangle, pieces)?;
    }
    Ok(facets)
}

/// Freezes all pieces that are faces; returns the facets that lack some.
fn freeze_present(s: &mut Space, triangles: &[[u32; 3]], facets: &Facets) -> Vec<u32> {
    let mut wanted: FxHashMap<[u32; 3], u32> = FxHashMap::default();
    wanted.reserve(triangles.len());
    let mut left = vec![0u32; triangles.len()];
    let mut corner = vec![false; s.c.points.len()];
    for (triangle, id) in triangles.iter().zip(0..) {
        let whole = [*triangle];
        for piece in facets.pieces.get(&id).map_or(&whole[..], |p| p) {
            wanted.insert(face_key(*piece), id);
            left[id as usize] += 1;
            for &v in piece {
                corner[v as usize] = true;
            }
        }
    }
    for t in 0..s.c.slots() as u32 {
        if !s.c.is_real(t) {
            continue;
        }
        for half in 4 * t..4 * t + 4 {
            let f = s.c.face(half);
            if half < s.c.mate(half)
                && f.iter().all(|&v| corner[v as usize])
                && let Some(&id) = wanted.get(&face_key(f))
            {
                s.c.freeze(half);
                left[id as usize] -= 1;
            }
        }
    }
    (0..triangles.len() as u32).filter(|&id| left[id as usize] > 0).collect()
}

fn stuck(triangle: [u32; 3], reason: Stuck) -> TetError {
    TetError::Stuck { part: Obstacle::Triangle(triangle), reason }
}

struct Recovery<'a> {
    s: &'a mut Space,
    segments: &'a Segments,
    star: Star,
    ring: EdgeRing,
    wrapper: Wrapper,
    /// On which side of the facet vertices lie.
    sign: FxHashMap<u32, i32>,
    /// The tetrahedra that cross the facet.
    cavity: Vec<u32>,
    inside: FxHashSet<u32>,
}

impl Recovery<'_> {
    fn recover(&mut self, triangle: [u32; 3], pieces: &[[u32; 3]]) -> Result<(), TetError> {
        self.sign.clear();
        for &v in pieces.iter().flatten() {
            self.sign.insert(v, 0);
        }
        let mut missing: Vec<[u32; 3]> = Vec::new();
        for &piece in pieces {
            match self.star.find_face(&self.s.c, piece) {
                Some(half) => self.s.c.freeze(half),
                None => missing.push(piece),
            }
        }
        while !missing.is_empty() {
            let (part, seed) = self.region(&mut missing).ok_or(stuck(triangle, Stuck::Intersection))?;
            self.flood(triangle, seed)?;
            self.retriangulate(triangle, &part)?;
        }
        Ok(())
    }

    /// A connected part of the missing pieces that crosses no edge of the complex, and a tetrahedron that crosses it.
    fn region(&mut self, missing: &mut Vec<[u32; 3]>) -> Option<(Vec<[u32; 3]>, u32)> {
        let mut part = vec![missing.pop()?];
        let mut seed = None;
        let mut head = 0;
        while let Some(&[a, b, c]) = part.get(head) {
            head += 1;
            for [u, w, d] in [[a, b, c], [b, c, a], [c, a, b]] {
                if let Some(t) = self.star.find_edge(&self.s.c, u, w) {
                    seed = seed.or_else(|| self.crossing_at([u, w, d], t));
                } else if let Some(k) = missing.iter().position(|f| f.contains(&u) && f.contains(&w)) {
                    part.push(missing.swap_remove(k));
                }
            }
        }
        seed.map(|t| (part, t))
    }

    /// The tetrahedron at edge `u, w` into which the facet goes towards `d`.
    fn crossing_at(&mut self, [u, w, d]: [u32; 3], t: u32) -> Option<u32> {
        if !self.ring.collect(&self.s.c, t, u, w, usize::MAX) || self.ring.touches_ghost() {
            return None;
        }
        let side: Vec<i32> = self.ring.rim.iter().map(|&v| self.s.orient([u, w, d, v])).collect();
        let n = side.len();
        (0..n).find(|&i| side[i] < 0 && side[(i + 1) % n] > 0).map(|i| self.ring.tets[i])
    }

    fn side(&mut self, triangle: [u32; 3], v: u32) -> i32 {
        if let Some(&sign) = self.sign.get(&v) {
            return sign;
        }
        let sign = self.s.orient([triangle[0], triangle[1], triangle[2], v]);
        self.sign.insert(v, sign);
        sign
    }

    /// Collects the connected tetrahedra that cross the facet.
    fn flood(&mut self, triangle: [u32; 3], seed: u32) -> Result<(), TetError> {
        self.cavity.clear();
        self.inside.clear();
        self.cavity.push(seed);
        self.inside.insert(seed);
        let mut head = 0;
        while let Some(&t) = self.cavity.get(head) {
            head += 1;
            if self.s.c.is_ghost(t) {
                return Err(stuck(triangle, Stuck::Intersection));
            }
            let v = self.s.c.verts(t);
            let side = v.map(|x| self.side(triangle, x));
            for i in 0..4 {
                for j in 0..i {
                    if side[i] * side[j] < 0
                        && let Some(edge) = self.segments.of_piece(v[i], v[j])
                    {
                        return Err(TetError::EdgeMeets { edge, obstacle: Obstacle::Triangle(triangle) });
                    }
                }
                let others = (0..4).filter(|&k| k != i).map(|k| side[k]);
                let crosses = others.clone().any(|x| x > 0) && others.clone().any(|x| x < 0);
                let half = 4 * t + i as u32;
                if crosses && self.s.c.is_frozen(half) {
                    return Err(stuck(triangle, Stuck::Intersection));
                }
                let n = self.s.c.mate(half) >> 2;
                if crosses && self.inside.insert(n) {
                    self.cavity.push(n);
                }
            }
        }
        Ok(())
    }

    /// Replaces the cavity by tetrahedra above and below the part of the facet, and freezes that.
    fn retriangulate(&mut self, triangle: [u32; 3], part: &[[u32; 3]]) -> Result<(), TetError> {
        let mut walls: [Vec<[u32; 3]>; 2] = [part.to_vec(), part.iter().map(|&[a, b, c]| [a, c, b]).collect()];
        let mut vertices: [Vec<u32>; 2] = [Vec::new(), Vec::new()];
        for &t in &self.cavity {
            for v in self.s.c.verts(t) {
                let side = self.sign.get(&v).copied().unwrap_or(0);
                if side >= 0 {
                    vertices[0].push(v);
                }
                if side <= 0 {
                    vertices[1].push(v);
                }
            }
            for half in 4 * t..4 * t + 4 {
                if self.inside.contains(&(self.s.c.mate(half) >> 2)) {
                    continue;
                }
                let [a, b, c] = self.s.c.face(half);
                let above = [a, b, c].iter().any(|v| self.sign.get(v).is_some_and(|&s| s > 0));
                walls[usize::from(!above)].push([a, c, b]);
            }
        }
        let mut new = Vec::new();
        for (walls, vertices) in walls.iter().zip(&mut vertices) {
            vertices.sort_unstable();
            vertices.dedup();
            if !self.wrapper.fill(self.s, walls, vertices, &mut new) {
                return Err(stuck(triangle, Stuck::Intersection));
            }
        }
        let mut created = Vec::new();
        if !self.s.c.replace(&self.cavity, &new, &mut created) {
            return Err(stuck(triangle, Stuck::Intersection));
        }
        for piece in part {
            let half = self.star.find_face(&self.s.c, *piece).ok_or(stuck(triangle, Stuck::Intersection))?;
            self.s.c.freeze(half);
        }
        Ok(())
    }
}

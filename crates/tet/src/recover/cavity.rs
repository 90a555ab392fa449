//! Cavity for a new vertex that respects frozen faces.

use crate::complex::{Complex, GHOST};
use crate::input::SurfaceEdges;
use anastomesh_mesh::geometry::Point3;
use anastomesh_mesh::geometry::predicates::{insphere, orient3d};

/// Maximum tetrahedra in a cavity.
pub(super) const MAX_CAVITY: usize = 64;

/// Builds cavities for single points; reuses its buffers.
#[derive(Clone, Debug, Default)]
pub(super) struct Cavity {
    tets: Vec<u32>,
    new: Vec<[u32; 4]>,
    created: Vec<u32>,
}

impl Cavity {
    /// Inserts `p` in a cavity that contains at least `core`; `p` lies strictly inside the union of the core. The
    /// cavity crosses no frozen face, keeps surface edges and loses no vertex. Returns the vertex, or `None` if the
    /// core violates this.
    pub(super) fn insert(&mut self, c: &mut Complex, edges: &SurfaceEdges, core: &[u32], p: Point3) -> Option<u32> {
        self.dig(c, core, &p);
        while let Some(bad) = self.flaw(c, edges, core, &p) {
            if core.contains(&bad) {
                if self.tets.len() == core.len() {
                    return None;
                }
                self.tets.truncate(core.len());
            } else {
                self.tets.retain(|&x| x != bad);
            }
        }
        let v = c.points.len() as u32;
        self.new.clear();
        for &x in &self.tets {
            for i in 0..4u32 {
                let half = 4 * x + i;
                if !self.tets.contains(&(c.mate(half) >> 2)) {
                    let [a, b, d] = c.face(half);
                    self.new.push([a, d, b, v]);
                }
            }
        }
        c.add_point(p);
        if c.replace(&self.tets, &self.new, &mut self.created) {
            Some(v)
        } else {
            c.pop_point();
            None
        }
    }

    fn dig(&mut self, c: &Complex, core: &[u32], p: &Point3) {
        self.tets.clear();
        self.tets.extend_from_slice(core);
        let mut head = 0;
        while head < self.tets.len() && self.tets.len() < MAX_CAVITY {
            let cur = self.tets[head];
            head += 1;
            for i in 0..4 {
                let half = 4 * cur + i;
                let n = c.mate(half) >> 2;
                if c.is_frozen(half) || c.is_ghost(n) || self.tets.contains(&n) {
                    continue;
                }
                let [a, b, d, e] = c.verts(n).map(|v| &c.points[v as usize]);
                if insphere(a, b, d, e, p) > 0.0 {
                    self.tets.push(n);
                }
            }
        }
    }

    /// Finds a tetrahedron that must leave the cavity. It has a face that `p` does not see, or it encloses a vertex,
    /// surface edge or frozen face.
    fn flaw(&self, c: &Complex, edges: &SurfaceEdges, core: &[u32], p: &Point3) -> Option<u32> {
        let mut walls: Vec<[u32; 3]> = Vec::new();
        for &x in &self.tets {
            for i in 0..4u32 {
                let half = 4 * x + i;
                if !self.tets.contains(&(c.mate(half) >> 2)) {
                    let f = c.face(half);
                    if !sees(c, &f, p) {
                        return Some(x);
                    }
                    walls.push(f);
                } else if c.is_frozen(half) {
                    // The cavity surrounds the rim of a recovered part, so only one side is kept.
                    return Some(if core.contains(&x) { c.mate(half) >> 2 } else { x });
                }
            }
        }
        self.tets.iter().rev().copied().find(|&x| {
            let v = c.verts(x);
            let hidden = v.iter().any(|y| !walls.iter().any(|w| w.contains(y)));
            hidden
                || (0..4).any(|i| {
                    (0..i).any(|j| {
                        edges.contains(v[i], v[j]) && !walls.iter().any(|w| w.contains(&v[i]) && w.contains(&v[j]))
                    })
                })
        })
    }
}

/// True if `p` lies strictly behind a face that is counter-clockwise seen from its front.
fn sees(c: &Complex, f: &[u32; 3], p: &Point3) -> bool {
    if f.contains(&GHOST) {
        return false;
    }
    let [a, b, d] = f.map(|v| &c.points[v as usize]);
    orient3d(a, b, d, p) < 0.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_tetrahedra_with_the_point_strictly_in_their_sphere_are_removed() {
        // A corner of a cube, and a tetrahedron beyond that contains the opposite corner.
        let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0], [3.0, 3.0, 3.0]];
        let tets = [[0, 1, 2, 3], [1, 2, 3, 4]];
        let points = corners.map(Point3::from).to_vec();
        let c = Complex::new(points.clone());
        let positive = tets.map(|v| if c.orient(&v) > 0.0 { v } else { [v[1], v[0], v[2], v[3]] });
        let mut made = Vec::new();
        for at in [1.99, 2.0, 2.01] {
            let mut c = Complex::from_mesh(points.clone(), &positive).unwrap();
            let second = c.real_tets().find(|&t| c.slot_of(t, 4).is_some()).unwrap();
            let edges = SurfaceEdges::default();
            let v = Cavity::default().insert(&mut c, &edges, &[second], Point3::new(at, at, at));
            c.sanity_check().unwrap();
            assert_eq!(v, Some(5));
            made.push(c.real_tets().count());
        }
        assert_eq!(made, [6, 5, 5]);
    }
}

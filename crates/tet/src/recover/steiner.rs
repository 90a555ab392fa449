//! Steiner points near the obstacles of missing edges and triangles.

use super::Recovery;
use super::cavity::MAX_CAVITY;
use super::march::{Crossing, first_crossing, piercing_edge};
use crate::delaunay::hash;
use anastomesh_mesh::geometry::{Point3, Vec3};

impl Recovery<'_> {
    /// Inserts a point near the obstacle of each lost edge, and of each lost triangle whose edges exist. Returns the
    /// number of points.
    pub(super) fn add_steiner_points(&mut self, edges: &[[u32; 2]], triangles: &[u32], round: u32) -> usize {
        let mut added = 0;
        for &f in triangles {
            let mut tri = self.surface.triangles[f as usize];
            if (0..3).any(|i| self.star.find_edge(self.c, tri[i], tri[(i + 1) % 3]).is_none()) {
                continue;
            }
            tri.rotate_left(round as usize % 3);
            if let Some((t, p, q)) = piercing_edge(self.c, &mut self.star, &mut self.ring, tri) {
                let done = if round % 6 < 5 { self.make_room(t, p, q, round) } else { self.split_edge(t, p, q, round) };
                added += usize::from(done);
            }
        }
        for &[a, b] in edges {
            let (a, b) = if round.is_multiple_of(2) { (a, b) } else { (b, a) };
            added += usize::from(match first_crossing(self.c, &mut self.star, a, b) {
                Crossing::Face(half) => match round % 6 {
                    0 | 1 | 3 | 4 => {
                        let f = self.c.face(half);
                        let k = round as usize % 3;
                        self.make_room(half >> 2, f[k], f[(k + 1) % 3], round)
                    }
                    2 => self.insert_in(half >> 2, round),
                    _ => self.split_face(half, round),
                },
                Crossing::Edge(t, p, q) if round % 6 < 5 => self.make_room(t, p, q, round),
                Crossing::Edge(t, p, q) => self.split_edge(t, p, q, round),
                Crossing::Vertex(_) | Crossing::Nothing | Crossing::Exists => false,
            });
        }
        added
    }

    /// Inserts a point just off a face. Its replacements can be flipped, even if all its edges are surface edges.
    fn split_face(&mut self, half: u32, round: u32) -> bool {
        let other = self.c.mate(half) >> 2;
        if self.c.is_ghost(half >> 2) || self.c.is_ghost(other) || self.c.is_frozen(half) {
            return false;
        }
        let f = self.c.face(half);
        let near = self.blend(&f, round);
        let apex = self.c.points[self.c.apex(half) as usize];
        (0..8).any(|k| {
            let p = near + (apex - near) * 0.1_f64.powi(k + 1);
            self.cavity.insert(self.c, self.edges, &[half >> 2, other], p).is_some()
        })
    }

    /// Inserts a point just off an edge.
    fn split_edge(&mut self, t: u32, p: u32, q: u32, round: u32) -> bool {
        if !self.ring.collect(self.c, t, p, q, MAX_CAVITY) || self.ring.touches_ghost() {
            return false;
        }
        let near = self.blend(&[p, q], round);
        let k = hash(Self::salt(round) ^ u64::from(p)) as usize % self.ring.len();
        let aim = self.c.points[self.ring.rim[k] as usize];
        (0..8).any(|k| {
            let x = near + (aim - near) * 0.1_f64.powi(k + 1);
            self.cavity.insert(self.c, self.edges, &self.ring.tets, x).is_some()
        })
    }

    /// Inserts a point into the largest tetrahedron at edge `p, q` of `t`, since obstacles are often slivers with
    /// little room. Uses `t` itself every third round.
    fn make_room(&mut self, t: u32, p: u32, q: u32, round: u32) -> bool {
        let mut best = t;
        if round % 3 != 2 && self.ring.collect(self.c, t, p, q, MAX_CAVITY) && !self.ring.touches_ghost() {
            let mut most = 0.0;
            for &x in &self.ring.tets {
                let volume = self.c.orient(&self.c.verts(x));
                if volume > most {
                    (best, most) = (x, volume);
                }
            }
        }
        self.insert_in(best, round)
    }

    /// Inserts a point inside `t`, at another place each round.
    fn insert_in(&mut self, t: u32, round: u32) -> bool {
        if self.c.is_ghost(t) {
            return false;
        }
        let p = self.blend(&self.c.verts(t), round);
        self.cavity.insert(self.c, self.edges, &[t], p).is_some()
    }

    /// Random convex combination of vertices, different in each round.
    fn blend(&self, vertices: &[u32], round: u32) -> Point3 {
        let mut sum = 0.0;
        let mut p = Vec3::zeros();
        for (k, &x) in vertices.iter().enumerate() {
            let coin = hash(Self::salt(round) + k as u64 + (u64::from(x) << 20)) >> 40;
            let w = 1.0 + coin as f64 / (1_u64 << 24) as f64;
            p += self.c.points[x as usize].coords * w;
            sum += w;
        }
        Point3::from(p / sum)
    }
}

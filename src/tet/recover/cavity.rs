//! Steiner points: a new vertex in a cavity that respects what is frozen.

use super::Recovery;
use super::march::{Crossing, first_crossing, piercing_edge};
use crate::geometry::Point3;
use crate::geometry::predicates::{insphere, orient3d};
use crate::tet::complex::{Complex, GHOST};
use crate::tet::delaunay::hash;
use crate::tet::input::SurfaceEdges;

/// Largest cavity.
const MAX_CAVITY: usize = 64;

/// Digs cavities for single points; keeps its buffers.
#[derive(Clone, Debug, Default)]
pub(super) struct Cavity {
    tets: Vec<u32>,
    new: Vec<[u32; 4]>,
    created: Vec<u32>,
}

impl Cavity {
    /// Inserts `p` in a cavity that holds at least `core`, tetrahedra whose common room `p` sees strictly inside. The
    /// cavity does not cross frozen faces, keeps the edges of the surface and loses no vertex. Returns the new vertex,
    /// or nothing when already the core does not allow that.
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

    /// A tetrahedron that must leave the cavity: one with a wall that `p` does not see, or one that hides a vertex, an
    /// edge of the surface or a frozen face inside the cavity.
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
                    // The cavity has grown around the rim of what is recovered so far: keep the part on one side.
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

/// Whether `p` lies strictly behind a face that runs counter-clockwise seen from its front.
fn sees(c: &Complex, f: &[u32; 3], p: &Point3) -> bool {
    if f.contains(&GHOST) {
        return false;
    }
    let [a, b, d] = f.map(|v| &c.points[v as usize]);
    orient3d(a, b, d, p) < 0.0
}

impl Recovery<'_> {
    /// Puts a point near what blocks each of the lost edges, and each lost triangle that has its edges. Returns
    /// the number of points.
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

    /// Puts a point just off a face: it goes, and what takes its place can be flipped, even where all of its edges are
    /// edges of the surface.
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

    /// Puts a point just off an edge.
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

    /// Inserts a point into a tetrahedron at edge `p, q` of `t`: the largest one, since those that block are often
    /// slivers, in which a point gives no room; `t` itself every third round.
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

    /// Inserts a point somewhere inside `t`, other places in other rounds.
    fn insert_in(&mut self, t: u32, round: u32) -> bool {
        if self.c.is_ghost(t) {
            return false;
        }
        let p = self.blend(&self.c.verts(t), round);
        self.cavity.insert(self.c, self.edges, &[t], p).is_some()
    }

    /// A point amid vertices, other places in other rounds.
    fn blend(&self, vertices: &[u32], round: u32) -> Point3 {
        let mut sum = 0.0;
        let mut p = crate::geometry::Vec3::zeros();
        for (k, &x) in vertices.iter().enumerate() {
            let coin = hash(Self::salt(round) + k as u64 + (u64::from(x) << 20)) >> 40;
            let w = 1.0 + coin as f64 / (1_u64 << 24) as f64;
            p += self.c.points[x as usize].coords * w;
            sum += w;
        }
        Point3::from(p / sum)
    }
}

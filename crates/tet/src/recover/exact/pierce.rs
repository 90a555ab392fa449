//! Temporary vertices in facet planes. A complex edge that pierces a plane is split, so that the plane consists of
//! faces there. Once all surface edges are recovered, a vertex on each side replaces it.

use super::level::Level;
use super::plane::Plane;
use super::polygon::triangulate;
use super::sectors::{Fan, outline, sectors};
use super::space::Space;
use super::wider::Wider;
use anastomesh_mesh::geometry::predicates::orient3d;
use anastomesh_mesh::geometry::{Point3, unit_normal};
use rustc_hash::FxHashMap;

impl Level<'_> {
    /// Splits the edge that pierces a plane to the right of an edge in it. Returns the new vertex.
    pub(super) fn pierce_beside(&mut self, edge: [u32; 2], plane: &Plane) -> Option<u32> {
        let ring = self.s.ring(edge[0], edge[1])?;
        let n = ring.len();
        (0..n).find_map(|i| {
            self.pierce([ring.rim[i], ring.rim[(i + 1) % n]], plane, |s, p| {
                orient3d(s.point(edge[0]), s.point(edge[1]), p, &plane.above) < 0.0
            })
        })
    }

    /// Splits the edges that pierce a plane ahead of vertex `a`, towards `b`. Returns true if any was split.
    pub(super) fn pierce_before(&mut self, [a, b]: [u32; 2], plane: &Plane) -> bool {
        let ahead = |s: &Space, t: u32| {
            let half = 4 * t + s.c.slot_of(t, a)? as u32;
            let f = s.c.face(half);
            let inside = !s.c.is_ghost(t) && (0..3).all(|i| s.orient([a, b, f[i], f[(i + 1) % 3]]) >= 0);
            inside.then_some(f)
        };
        let Some(f) = self.s.star(a).into_iter().find_map(|t| ahead(&*self.s, t)) else { return false };
        let sides = [[f[0], f[1]], [f[1], f[2]], [f[2], f[0]]];
        sides.into_iter().filter(|&edge| self.pierce(edge, plane, |_, _| true).is_some()).count() > 0
    }

    /// Splits an edge that pierces a plane well away from its ends, if `wanted` accepts the point.
    fn pierce(&mut self, [u, v]: [u32; 2], plane: &Plane, wanted: impl Fn(&Space, &Point3) -> bool) -> Option<u32> {
        let s = &*self.s;
        let (p, q) = (*s.point(u), *s.point(v));
        let (x, y) = (plane.height(&p), plane.height(&q));
        let far = self.tolerance.min(self.clearance);
        let pierces = x.min(y) < -far && x.max(y) > far;
        if !pierces || self.spare == 0 || self.keep.contains(u, v) {
            return None;
        }
        let at = p + (q - p) * (x / (x - y));
        if !wanted(s, &at) {
            return None;
        }
        let ring = self.s.ring(u, v)?;
        let walls: Vec<[u32; 3]> = self.s.walls(&ring.tets).iter().map(|&[a, b, c]| [a, c, b]).collect();
        if !walls.iter().all(|&f| self.sees(f, &at)) {
            return None;
        }
        let w = self.s.fill(&ring.tets, &walls, at)?;
        self.spare -= 1;
        self.inside.push((w, *plane));
        self.within.insert(w);
        Some(w)
    }

    /// True if a point lies sufficiently far above a face.
    fn sees(&self, f: [u32; 3], p: &Point3) -> bool {
        let [a, b, c] = f.map(|v| self.s.point(v).coords);
        self.s.orient_to(f, p) > 0 && unit_normal(a, b, c).dot(&(p.coords - a)) > 0.5 * self.clearance
    }

    /// Removes the inserted vertices from their planes.
    pub(super) fn leave(&mut self) {
        let mut inside = std::mem::take(&mut self.inside);
        loop {
            let before = inside.len();
            inside.retain(|&(w, plane)| !self.take_out(w, &plane));
            if inside.len() == before {
                break;
            }
        }
        self.made.extend(inside.into_iter().map(|(w, _)| w));
    }

    /// Moves a vertex out of its plane. Its faces in the plane are retriangulated without it, and the cavities above
    /// and below are joined to a vertex on each side.
    fn take_out(&mut self, w: u32, plane: &Plane) -> bool {
        let star = self.s.star(w);
        let mut old = Vec::new();
        let mut next: FxHashMap<u32, u32> = FxHashMap::default();
        for half in star.iter().flat_map(|&t| 4 * t..4 * t + 4) {
            let f = self.s.c.face(half);
            let Some(i) = f.iter().position(|&v| v == w) else { continue };
            let [p, q] = [f[(i + 1) % 3], f[(i + 2) % 3]];
            let turn = |s: &Space| s.orient_to([w, p, q], &plane.above);
            if self.lies_in(p, plane) && self.lies_in(q, plane) && turn(self.s) > 0 && next.insert(p, q).is_none() {
                old.push([w, p, q]);
            }
        }
        let Some(polygon) = outline(&next, None) else { return false };
        let mut new = Vec::new();
        if !triangulate(self.s, &polygon, &plane.above, &mut new) {
            return false;
        }
        let fans = [Fan { facet: 0, old, new }];
        let Some(sectors) = sectors(self.s, w, &star, &fans).filter(|sectors| sectors.len() == 2) else {
            return false;
        };
        let stays = |a: u32, b: u32| self.keep.contains(a, b);
        let mut wider = Wider::new(self.s, &stays, Some(w), *self.s.point(w), star);
        let filled: Option<Vec<_>> = sectors.into_iter().map(|sector| self.apex(&mut wider, sector)).collect();
        let old = wider.cavity;
        filled.is_some_and(|filled| self.fill(&old, &filled))
    }
}

//! Cavities wider than a sector of a star. If a sector has too little clearance, the tetrahedra behind its limiting or
//! hidden faces are added.

use super::kernel::{Apex, Kernel};
use super::parts::{sides, sorted};
use super::sectors::Sector;
use super::space::Space;
use anastomesh_mesh::geometry::{Point3, unit_normal};
use rustc_hash::FxHashSet;

/// Enlarges sectors around one vertex or position.
pub(super) struct Wider<'a> {
    s: &'a Space,
    /// True for edges that must stay.
    stays: &'a dyn Fn(u32, u32) -> bool,
    /// Vertex to be removed.
    v: Option<u32>,
    pub origin: Point3,
    /// All tetrahedra to be removed.
    pub cavity: Vec<u32>,
}

impl<'a> Wider<'a> {
    pub(super) fn new(
        s: &'a Space,
        stays: &'a dyn Fn(u32, u32) -> bool,
        v: Option<u32>,
        origin: Point3,
        cavity: Vec<u32>,
    ) -> Self {
        Self { s, stays, v, origin, cavity }
    }

    /// Finds an apex with clearance of at least `least` times the size. Adds at most `steps` tetrahedra to the sector.
    pub(super) fn apex(&mut self, sector: &mut Sector, least: f64, steps: usize) -> Option<Apex> {
        for _ in 0..steps {
            if let Ok(apex) = Kernel::new(self.s, self.origin, &sector.faces).apex(self.s, least) {
                return Some(apex);
            }
            if !self.step(sector) {
                return None;
            }
        }
        None
    }

    /// Enlarges a sector by at most `steps` tetrahedra until vertex `w` sees all its faces from further than `least`.
    /// Leaves the rest of the budget in `steps`. Only vertices that are `free` may be removed.
    pub(super) fn seen_from(
        &mut self,
        sector: &Sector,
        w: u32,
        (least, steps): (f64, &mut usize),
        free: impl Fn(u32) -> bool,
    ) -> Option<Sector> {
        let s = self.s;
        let p = s.point(w).coords;
        let sees = |f: [u32; 3]| {
            let [a, b, c] = f.map(|v| s.point(v).coords);
            f.contains(&w) || (unit_normal(a, b, c).dot(&(p - a)) > least && s.orient([f[0], f[1], f[2], w]) > 0)
        };
        let facets = &sector.faces[sector.halves.len()..];
        s.count(sector.faces.len());
        let before = self.cavity.len();
        let halves = if facets.iter().all(|&f| sees(f)) { self.grow(&sector.halves, sees, *steps) } else { None };
        s.count(4 * (self.cavity.len() - before));
        *steps -= self.cavity.len() - before;
        let wide = halves.map(|halves| {
            let faces = halves.iter().map(|&half| s.wall(half)).chain(facets.iter().copied()).collect();
            Sector { faces, halves }
        });
        let wide = wide.filter(|wide| self.keeps(wide, &self.cavity[before..], |v| v == w || free(v)));
        if wide.is_none() {
            self.cavity.truncate(before);
        }
        wide
    }

    /// Adds the tetrahedra behind faces that are not visible until all faces are; returns these faces. Returns `None`
    /// if a frozen face or a ghost is in the way, or after `steps` tetrahedra.
    fn grow(&mut self, halves: &[u32], sees: impl Fn([u32; 3]) -> bool, steps: usize) -> Option<Vec<u32>> {
        let c = &self.s.c;
        let before = self.cavity.len();
        let mut taken: FxHashSet<u32> = self.cavity.iter().copied().collect();
        let mut border: FxHashSet<u32> = halves.iter().copied().collect();
        let mut open = halves.to_vec();
        let mut walls = Vec::new();
        while let Some(half) = open.pop() {
            if !border.contains(&half) {
                continue;
            }
            if sees(self.s.wall(half)) {
                walls.push(half);
                continue;
            }
            let next = c.mate(half) >> 2;
            let full = self.cavity.len() == before + steps;
            if full || c.is_frozen(half) || c.is_ghost(next) || !taken.insert(next) {
                return None;
            }
            self.cavity.push(next);
            border.remove(&half);
            for inner in (4 * next..4 * next + 4).filter(|&inner| c.mate(inner) != half) {
                if !border.remove(&c.mate(inner)) {
                    border.insert(inner);
                    open.push(inner);
                } else if c.is_frozen(inner) {
                    return None;
                }
            }
        }
        walls.retain(|half| border.contains(half));
        Some(walls)
    }

    /// True if all vertices and edges of `tets` that must stay lie on the faces of the sector.
    fn keeps(&self, sector: &Sector, tets: &[u32], free: impl Fn(u32) -> bool) -> bool {
        let corners: FxHashSet<u32> = sector.faces.iter().flatten().copied().collect();
        let edges: FxHashSet<[u32; 2]> = sector.faces.iter().flat_map(|&f| sides(f)).collect();
        tets.iter().map(|&t| self.s.c.verts(t)).all(|v| {
            v.iter().all(|&x| free(x) || corners.contains(&x))
                && (0..4).all(|i| (0..i).all(|j| !(self.stays)(v[i], v[j]) || edges.contains(&sorted(v[i], v[j]))))
        })
    }

    /// Adds the tetrahedron behind the limiting face that gains most clearance. Returns false if there is none.
    fn step(&mut self, sector: &mut Sector) -> bool {
        let Some((walls, _)) = Kernel::new(self.s, self.origin, &sector.faces).bounds(self.s) else { return false };
        let mut best: Option<(f64, u32, Sector)> = None;
        for wall in walls {
            let Some(half) = sector.halves.get(wall) else { continue };
            let next = self.s.c.mate(*half) >> 2;
            let Some(wider) = self.add(sector, next) else { continue };
            let Some((_, depth)) = Kernel::new(self.s, self.origin, &wider.faces).bounds(self.s) else { continue };
            if best.as_ref().is_none_or(|b| depth > b.0) {
                best = Some((depth, next, wider));
            }
        }
        let Some((_, next, wider)) = best else { return false };
        self.cavity.push(next);
        *sector = wider;
        true
    }

    /// Adds a tetrahedron to a sector, unless a vertex or edge that must stay would become interior.
    fn add(&self, sector: &Sector, next: u32) -> Option<Sector> {
        let c = &self.s.c;
        let corners = c.verts(next);
        if c.is_ghost(next) || self.v.is_some_and(|v| corners.contains(&v)) || self.cavity.contains(&next) {
            return None;
        }
        let mut halves = sector.halves.clone();
        for half in 4 * next..4 * next + 4 {
            let Some(k) = halves.iter().position(|&x| x == c.mate(half)) else {
                halves.push(half);
                continue;
            };
            if c.is_frozen(half) {
                return None;
            }
            halves.swap_remove(k);
        }
        let facets = &sector.faces[sector.halves.len()..];
        let faces: Vec<[u32; 3]> = halves.iter().map(|&half| self.s.wall(half)).chain(facets.iter().copied()).collect();
        let wider = Sector { faces, halves };
        self.keeps(&wider, &[next], |_| false).then_some(wider)
    }
}

//! Cavities that are wider than a sector of a star: where the room in a sector is too small, the tetrahedra behind the
//! walls that bound it are taken as well.

use super::room::{Apex, Room};
use super::sectors::Sector;
use super::space::Space;
use crate::geometry::Point3;

/// Makes sectors around one vertex, or place, wider.
pub(super) struct Wider<'a> {
    s: &'a Space,
    /// Edges that have to stay.
    stays: &'a dyn Fn(u32, u32) -> bool,
    /// The vertex that goes.
    v: Option<u32>,
    pub origin: Point3,
    /// All tetrahedra that go.
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

    /// What takes the place of the vertex in a sector that is made wider, by so many tetrahedra at most, until it has at
    /// least `least` times its size of room.
    pub(super) fn apex(&mut self, sector: &mut Sector, least: f64, steps: usize) -> Option<Apex> {
        for _ in 0..steps {
            if let Ok(apex) = Room::new(self.s, self.origin, &sector.faces).apex(self.s, least) {
                return Some(apex);
            }
            if !self.step(sector) {
                return None;
            }
        }
        None
    }

    /// Adds to a sector the tetrahedron behind one of the walls that bound its room, the one that gains most. False when
    /// there is none.
    fn step(&mut self, sector: &mut Sector) -> bool {
        let Some((walls, _)) = Room::new(self.s, self.origin, &sector.faces).bounds() else { return false };
        let mut best: Option<(f64, u32, Sector)> = None;
        for wall in walls {
            let Some(half) = sector.halves.get(wall) else { continue };
            let next = self.s.c.mate(*half) >> 2;
            let Some(wider) = self.add(sector, next) else { continue };
            let Some((_, depth)) = Room::new(self.s, self.origin, &wider.faces).bounds() else { continue };
            if best.as_ref().is_none_or(|b| depth > b.0) {
                best = Some((depth, next, wider));
            }
        }
        let Some((_, next, wider)) = best else { return false };
        self.cavity.push(next);
        *sector = wider;
        true
    }

    /// A sector with one more tetrahedron, unless something that has to stay would be inside.
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
        let has = |part: &[u32]| faces.iter().any(|f| part.iter().all(|x| f.contains(x)));
        let keeps = corners.iter().all(|&x| has(&[x]))
            && (0..4).all(|i| (0..i).all(|j| !(self.stays)(corners[i], corners[j]) || has(&[corners[i], corners[j]])));
        keeps.then_some(Sector { faces, halves })
    }
}

//! Moves vertices off segments and facets, one copy into each sector between facets (George, Borouchaki, Saltel,
//! 'Ultimate robustness in meshing an arbitrary polyhedron', 2003). Positions are floating point and verified by exact
//! predicates.

use super::dig;
use super::facets::Cover;
use super::kernel::{Apex, Kernel, LEVELS};
use super::looks::{Looks, PlacementMethod};
use super::parts::sides;
use super::sectors::{Fan, Sector, refill, sectors};
use super::segments::Segments;
use super::space::{self, Space};
use super::ways::operations;
use super::wider::Wider;
use crate::error::{Obstacle, Stuck, TetError};
use crate::progress::Watch;
use anastomesh_mesh::geometry::Vec3;
use anastomesh_mesh::geometry::implicit::OnTriangle;
use rustc_hash::FxHashMap;
use std::ops::Range;

/// Maximum tetrahedra added to one sector.
const STEPS: usize = 24;

/// The clearance level drops when a pass moves less than 1/64 of the vertices: every pass costs the same.
const SLOW: usize = 64;

/// Index in [`LEVELS`] of the first clearance for wider cavities. They are the most expensive, and a last resort.
const WIDER_FROM: usize = 3;

#[cfg(test)]
thread_local! {
    /// True if wider cavities are tried first instead of last.
    pub(super) static WIDER_FIRST: std::cell::Cell<bool> = const { std::cell::Cell::new(false) };
}

/// Segment or facet that carries a vertex to be moved off.
#[derive(Clone, Copy, Debug)]
enum Host {
    /// Index of a segment.
    Segment(u32),
    /// Index of a facet.
    Facet(u32),
    /// No longer on a segment or facet.
    Free(u32),
}

/// Result of pushing a vertex.
enum Pushed {
    Off,
    /// No position has more clearance than `room`, relative to the size.
    Not {
        room: f64,
    },
}

/// State to which [`Push::undo`] returns.
pub(super) struct Mark {
    space: space::Mark,
    triangles: usize,
    free: Vec<u32>,
}

#[derive(Clone)]
pub(super) struct Push<'a> {
    pub s: Space,
    pub segments: Segments<'a>,
    /// Input triangles, then helpers.
    pub triangles: Vec<[u32; 3]>,
    /// Vertices to be pushed off their segment or facet.
    left: Vec<(Host, u32)>,
    /// Faces of the facets that carry vertices.
    pieces: FxHashMap<u32, Vec<[u32; 3]>>,
    /// Facets at segments.
    around: FxHashMap<u32, Vec<u32>>,
    /// Vertices made here that lie on no segment or facet.
    free: Vec<u32>,
    looks: Looks,
}

impl<'a> Push<'a> {
    pub(super) fn new(s: Space, segments: Segments<'a>, triangles: Vec<[u32; 3]>) -> Self {
        let (pieces, around, looks) = (FxHashMap::default(), FxHashMap::default(), Looks::default());
        Self { s, segments, triangles, left: Vec::new(), pieces, around, free: Vec::new(), looks }
    }

    /// Takes over free vertices; unneeded ones are removed later.
    pub(super) fn adopt(&mut self, free: Vec<u32>) {
        self.free.extend(free);
    }

    /// Registers a covered facet, whose interior vertices have to be pushed off. Returns their number.
    pub(super) fn add_facet(&mut self, id: u32, cover: Cover) -> usize {
        self.bind(&cover.inner);
        self.left.extend(cover.inner.iter().map(|&v| (Host::Facet(id), v)));
        self.pieces.insert(id, cover.pieces);
        for [a, b] in sides(self.triangles[id as usize]) {
            if let Some(segment) = self.segments.between(a, b) {
                self.around.entry(segment).or_default().push(id);
            }
        }
        cover.inner.len()
    }

    /// Registers a segment with recovered facets, whose inner vertices have to be pushed off. Returns their number.
    pub(super) fn add_segment(&mut self, id: u32) -> usize {
        let chain = &self.segments.list[id as usize].chain;
        let inner = chain[1..chain.len() - 1].to_vec();
        self.bind(&inner);
        self.left.extend(inner.iter().map(|&v| (Host::Segment(id), v)));
        inner.len()
    }

    /// Removes vertices from the free ones that lie exactly on a segment or facet.
    fn bind(&mut self, on: &[u32]) {
        let met: Vec<u32> = on.iter().copied().filter(|&v| !self.s.is_implicit(v)).collect();
        if !met.is_empty() {
            self.free.retain(|v| !met.contains(v));
        }
    }

    /// Registers a covered helper facet.
    pub(super) fn add_helper(&mut self, id: u32, cover: Cover) -> Vec<u32> {
        let inner = cover.inner.clone();
        self.add_facet(id, Cover { inner: Vec::new(), ..cover });
        inner
    }

    /// Drops helpers with their faces and the segments at their sides. Vertices on them, and `inner`, must be removed.
    pub(super) fn drop_helpers(&mut self, triangles: &[u32], segments: Range<u32>, inner: Vec<u32>) {
        for id in triangles {
            for piece in self.pieces.remove(id).unwrap_or_default() {
                if let Some(half) = self.s.find_face(piece) {
                    self.s.c.thaw(half);
                }
            }
        }
        self.bind(&inner);
        self.left.extend(inner.into_iter().map(|v| (Host::Free(v), v)));
        for id in segments {
            let chain = self.segments.forget(id);
            self.bind(&chain[1..chain.len() - 1]);
            self.left.extend(chain[1..chain.len() - 1].iter().map(|&v| (Host::Free(v), v)));
            // The corners beside the edge are free and may be removed, too.
            self.free.extend(chain.last());
        }
        self.free.sort_unstable();
        self.free.dedup();
    }

    /// Pushes all vertices off their segments and facets. Vertices without clearance are retried after others have
    /// moved. The clearance level drops only if nothing better exists, since tight positions leave less to others.
    pub(super) fn settle(&mut self, watch: &Watch) -> Result<(), TetError> {
        let mut left = std::mem::take(&mut self.left);
        #[cfg(test)]
        if WIDER_FIRST.get() {
            self.push_into_wider_cavities(&mut left, watch)?;
        }
        self.clear(&mut left, watch)?;
        self.push_into_wider_cavities(&mut left, watch)?;
        while !left.is_empty() {
            let before = left.len();
            let moved = left.iter().filter(|&&(host, v)| self.slide(host, v)).count();
            if moved == 0 {
                break;
            }
            self.clear(&mut left, watch)?;
            self.push_into_wider_cavities(&mut left, watch)?;
            if left.len() == before {
                break;
            }
        }
        if let Some(&(host, _)) = left.first() {
            return Err(self.stuck(host, Stuck::Precision));
        }
        Ok(())
    }

    /// Ends a part. Returns the number of new vertices that stay.
    pub(super) fn finish(&mut self) -> usize {
        self.looks.forget();
        self.relax(0.0);
        self.forget_part();
        std::mem::take(&mut self.free).len()
    }

    /// Forgets what belongs to a part alone. Its segments are edges of the complex now, or still missing.
    fn forget_part(&mut self) {
        self.left.clear();
        self.pieces.clear();
        self.around.clear();
        self.looks.forget();
        self.segments.clear();
    }

    /// Records all changes until [`Push::keep`] or [`Push::undo`].
    pub(super) fn record(&mut self) -> Mark {
        Mark { space: self.s.record(), triangles: self.triangles.len(), free: self.free.clone() }
    }

    /// Keeps the recorded changes.
    pub(super) fn keep(&mut self) {
        self.s.keep();
    }

    /// Takes back the recorded changes.
    pub(super) fn undo(&mut self, mark: Mark) {
        self.s.undo(&mark.space);
        self.triangles.truncate(mark.triangles);
        self.free = mark.free;
        self.forget_part();
    }

    /// Pushes off all vertices that have clearance, level by level.
    fn clear(&mut self, left: &mut Vec<(Host, u32)>, watch: &Watch) -> Result<(), TetError> {
        let mut level = 0;
        while level < LEVELS.len() && !left.is_empty() {
            let before = left.len();
            // Vertices that merge with a neighbor leave clearance for the others, so they come first.
            self.pass(left, level, PlacementMethod::Corners, watch)?;
            let slow = |left: &[(Host, u32)]| (before - left.len()) * SLOW < before;
            if slow(left) {
                self.relax(LEVELS[level]);
                self.pass(left, level, PlacementMethod::Points, watch)?;
            }
            level = if slow(left) { level + 1 } else { level };
        }
        Ok(())
    }

    /// Pushes vertices without clearance into wider cavities.
    fn push_into_wider_cavities(&mut self, left: &mut Vec<(Host, u32)>, watch: &Watch) -> Result<(), TetError> {
        let mut level = WIDER_FROM;
        #[cfg(test)]
        if WIDER_FIRST.get() {
            level = 0;
        }
        while level < LEVELS.len() && !left.is_empty() {
            let before = left.len();
            self.pass(left, level, PlacementMethod::Wider, watch)?;
            if left.len() == before {
                level += 1;
            } else {
                self.clear(left, watch)?;
            }
        }
        Ok(())
    }

    /// Moves a vertex along its segment to the middle of the interval that sees its whole star.
    fn slide(&mut self, host: Host, v: u32) -> bool {
        let Host::Segment(id) = host else { return false };
        let ends = self.segments.list[id as usize].ends;
        let star = self.s.star(v);
        let Some(weight) = dig::middle(&self.s, ends, &star) else { return false };
        let on = OnTriangle::on_segment(ends.map(|v| *self.s.point(v)), weight);
        let faces = self.s.walls(&star);
        let moved = self.s.move_to(v, &faces, on);
        if moved {
            self.looks.change(faces.into_iter().flatten().chain([v]));
        }
        moved
    }

    fn pass(
        &mut self,
        left: &mut Vec<(Host, u32)>,
        level: usize,
        way: PlacementMethod,
        watch: &Watch,
    ) -> Result<(), TetError> {
        let mut again = Vec::with_capacity(left.len());
        for &(host, v) in left.iter() {
            let least = LEVELS[level];
            if self.looks.worth(v, least, way) {
                watch.spend(operations(&self.s))?;
                match self.push(host, v, least, way)? {
                    Pushed::Off => continue,
                    Pushed::Not { room } => self.looks.found(v, room, way),
                }
            }
            again.push((host, v));
        }
        *left = again;
        Ok(())
    }

    /// Removes unneeded free vertices, and moves the others to the largest clearance.
    fn relax(&mut self, least: f64) {
        let mut free = std::mem::take(&mut self.free);
        free.retain(|&v| {
            if !self.looks.worth_relaxing(v) {
                return true;
            }
            let star = self.s.star(v);
            let mut faces = Vec::with_capacity(star.len());
            for &t in &star {
                if let Some(i) = self.s.c.slot_of(t, v) {
                    let [a, b, c] = self.s.c.face(4 * t + i as u32);
                    faces.push([a, c, b]);
                }
            }
            let kernel = Kernel::new(&self.s, *self.s.point(v), &faces);
            if let Ok(w) = kernel.neighbor(&self.s, least) {
                let others = faces.iter().filter(|f| !f.contains(&w));
                let new: Vec<[u32; 4]> = others.map(|&[a, b, c]| [a, b, c, w]).collect();
                if self.s.c.replace(&star, &new, &mut Vec::new()) {
                    self.looks.change(faces.iter().flatten().copied());
                    return false;
                }
            }
            let here = kernel.depth(&Vec3::zeros()) / kernel.size;
            if let Ok(p) = kernel.place(&self.s, 1.2 * here) {
                self.s.c.move_point(v, p);
                self.looks.change(faces.iter().flatten().copied());
            }
            true
        });
        self.free = free;
    }

    fn stuck(&self, host: Host, reason: Stuck) -> TetError {
        let part = match host {
            Host::Segment(i) => Obstacle::Edge(self.segments.list[i as usize].ends),
            Host::Facet(id) => Obstacle::Triangle(self.triangles[id as usize]),
            Host::Free(v) => Obstacle::Point(v),
        };
        TetError::Stuck { part, reason }
    }

    fn push(&mut self, host: Host, v: u32, least: f64, way: PlacementMethod) -> Result<Pushed, TetError> {
        let star = self.s.star(v);
        let Some(fans) = self.fans(host, v)? else { return Err(self.stuck(host, Stuck::Intersection)) };
        if fans.len() < 2 && matches!(host, Host::Segment(_)) {
            return Ok(Pushed::Not { room: f64::NEG_INFINITY });
        }
        let Some(sectors) = sectors(&self.s, v, &star, &fans) else {
            return Err(self.stuck(host, Stuck::Intersection));
        };
        let stays = |a: u32, b: u32| self.segments.of_piece(a, b).is_some();
        let mut wider = Wider::new(&self.s, &stays, Some(v), *self.s.point(v), star);
        let mut filled = Vec::with_capacity(sectors.len());
        for mut sector in sectors {
            let kernel = Kernel::new(&self.s, *self.s.point(v), &sector.faces);
            let apex = match way {
                PlacementMethod::Corners => kernel.neighbor(&self.s, least).map(Apex::Vertex),
                PlacementMethod::Points => kernel.apex(&self.s, least),
                PlacementMethod::Wider => wider.apex(&mut sector, least, STEPS).ok_or(least.next_down()),
            };
            match apex {
                Ok(apex) => filled.push((sector, apex)),
                Err(room) => return Ok(Pushed::Not { room }),
            }
        }
        let cavity = wider.cavity;
        if !self.commit(v, &cavity, &fans, &filled) {
            return Err(self.stuck(host, Stuck::Intersection));
        }
        if let Host::Segment(i) = host {
            self.segments.list[i as usize].chain.retain(|&x| x != v);
        }
        Ok(Pushed::Off)
    }

    /// Retriangulated facets around a vertex without it. Returns `None` if a facet is inconsistent.
    fn fans(&self, host: Host, v: u32) -> Result<Option<Vec<Fan>>, TetError> {
        let fan = |facet: u32, ends| {
            let pieces = self.pieces.get(&facet).map_or(&[][..], |p| p);
            Fan::of(&self.s, pieces, (facet, self.triangles[facet as usize]), v, ends)
        };
        let segment = match host {
            Host::Free(_) => return Ok(Some(Vec::new())),
            Host::Facet(id) => return Ok(fan(id, None)?.map(|fan| vec![fan])),
            Host::Segment(segment) => segment,
        };
        let chain = &self.segments.list[segment as usize].chain;
        let Some(at) = chain.iter().position(|&x| x == v) else { return Ok(None) };
        let ends = [chain[at - 1], chain[at + 1]];
        let mut fans = Vec::new();
        for &facet in self.around.get(&segment).into_iter().flatten() {
            let Some(fan) = fan(facet, Some(ends))? else { return Ok(None) };
            fans.push(fan);
        }
        Ok(Some(fans))
    }

    /// Replaces a vertex by its new apices.
    fn commit(&mut self, v: u32, cavity: &[u32], fans: &[Fan], sectors: &[(Sector, Apex)]) -> bool {
        let before = self.s.c.points.len() as u32;
        let facets: Vec<[u32; 3]> = fans.iter().flat_map(|fan| &fan.new).copied().collect();
        let Some(new) = refill(&mut self.s, cavity, sectors, &facets) else { return false };
        self.looks.change(new.into_iter().flatten());
        for fan in fans {
            if let Some(pieces) = self.pieces.get_mut(&fan.facet) {
                pieces.retain(|f| !f.contains(&v));
                pieces.extend(&fan.new);
            }
        }
        self.free.extend(before..self.s.c.points.len() as u32);
        true
    }
}

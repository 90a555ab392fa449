//! Terminals end in flat discs (3.2.2 of the paper, without the round tip). The tip beyond the plane is taken off, a
//! regular ring is put on the plane and filled, a strip is woven between the wall that is left and the ring, and the
//! wall near it is relaxed on the level set.

#[cfg(test)]
mod tests;
mod weave;

use super::disc::{MEAN_EDGE, corners, disc};
use super::halfedge::HalfEdges;
use super::relax::{Hold, Level, Relaxation};
use super::shared_disc::SharedDisc;
use super::sizes::{Finer, GROWTH};
use super::{Field, SizedWall, SurfaceParams};
use anastomesh_mesh::geometry::{Point3, Section, Vec3};
use anastomesh_mesh::{Kept, TriMesh};
use anastomesh_skeleton::NodeId;
use weave::weave;

/// A closed wall whose terminals are flat discs.
#[derive(Clone, Debug, PartialEq)]
pub struct CappedSurface {
    /// The surface: closed, 2-manifold, oriented outwards.
    pub mesh: TriMesh,
    /// For every triangle the index, into the ends that were given, of the cap it belongs to; none for the wall.
    pub cap: Vec<Option<u32>>,
}

/// Why an end could not be capped.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CapError {
    /// The surface is not a closed 2-manifold.
    #[error("the wall is not a closed manifold at edge {} – {}", edge[0], edge[1])]
    NotManifold {
        /// Vertices of the edge (equal: of the vertex).
        edge: [u32; 2],
    },
    /// One end could not be capped.
    #[error("end {end} at {origin} cannot be capped: {reason}")]
    End {
        /// Index of the end.
        end: u32,
        /// The terminal's node; none for a cut.
        node: Option<NodeId>,
        /// Centre of the cap that was to be.
        origin: Point3,
        /// Why.
        reason: CapFailure,
    },
}

/// What is wrong at an end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CapFailure {
    /// The tip lies within another vessel, all of its disc: there is no wall.
    #[error("the tip lies within another vessel")]
    Buried,
    /// The vessel does not reach beyond the plane.
    #[error("no tip lies beyond the plane")]
    NoTip,
    /// What lies beyond the plane is not only this vessel's tip.
    #[error("the tip is joined to another vessel")]
    Merged,
    /// What is left of the wall does not end in one loop.
    #[error("the wall does not end in one loop")]
    Loops,
    /// The disc could not be triangulated.
    #[error("the disc could not be triangulated")]
    Disc,
}

/// The strip between wall and ring starts so far (in edge lengths) before the plane; less where that leaves no wall.
const MARGINS: [f64; 3] = [0.4, 0.2, 0.05];
/// The wall is relaxed up to so far (in edge lengths) before the plane.
const RELAXED: f64 = 3.5;
/// A tip is longer than so many radii only where it runs into another vessel.
const LONGEST_TIP: f64 = 3.0;
/// What lies further (in radii) from the axis than this belongs to another vessel.
const WIDTH: f64 = 1.1;

/// Maximum passes that remove triangles from a rim until it is one loop. One pass removes one row of triangles; 20 rows are far
/// more than the four edge lengths of `DEEPEST_RIM`.
const MAX_RIM_PASSES: usize = 20;
/// How far before the plane, in edge lengths, triangles may go for the rim's sake.
const DEEPEST_RIM: f64 = 4.0;

/// An end, and the disc that closes it where that is given.
#[derive(Clone, Copy, Debug)]
pub struct Closing<'a> {
    /// The plane; its axis points out of the vessel.
    pub section: Section,
    /// The terminal's node; none for a cut.
    pub node: Option<NodeId>,
    /// The disc, seen along the end's axis; none: one that suits the wall.
    pub disc: Option<&'a SharedDisc>,
}

impl Closing<'_> {
    /// The edge length of the disc.
    fn edge(&self, params: &SurfaceParams) -> f64 {
        self.disc.map_or_else(|| params.edge_at(self.section.radius), |disc| disc.edge)
    }
}

/// Replaces the tips beyond the `ends` by flat discs. `field` is the field that the wall is a level set of, `params` are
/// those that it was made with.
///
/// # Errors
/// A surface that is not closed; an end whose tip is missing, joined to another vessel, or does not leave one loop.
pub fn cap_terminals(
    wall: &SizedWall,
    field: &mut Field,
    ends: &[Closing],
    params: &SurfaceParams,
) -> Result<CappedSurface, CapError> {
    let mut closed = closed(wall, ends, params, &MARGINS);
    // An end that was closed before may have left nothing of the wall between the two.
    for first in 1..MARGINS.len() {
        if !matches!(closed, Err(CapError::End { reason: CapFailure::Loops, .. })) {
            break;
        }
        closed = self::closed(wall, ends, params, &MARGINS[first..]).or(closed);
    }
    let (mesh, sizes, cap) = closed?.finish();
    relaxed(&mesh, sizes, &cap, field, ends, params, &wall.finer)
}

/// The wall with all ends closed, the strips beginning so far before the planes as the first of `margins` says that can be
/// had.
fn closed<'a>(
    wall: &'a SizedWall,
    ends: &[Closing],
    params: &SurfaceParams,
    margins: &[f64],
) -> Result<Cutter<'a>, CapError> {
    let surface = &wall.mesh;
    let mut cutter = Cutter {
        surface: &wall.halves,
        longest: longest_edge(surface),
        removed: vec![false; surface.triangles.len()],
        points: surface.points.clone(),
        sizes: wall.sizes.clone(),
        added: Vec::new(),
        cap: Vec::new(),
    };
    for (i, closing) in ends.iter().enumerate() {
        cutter.cut(closing, i as u32, closing.edge(params), margins).map_err(|reason| CapError::End {
            end: i as u32,
            node: closing.node,
            origin: closing.section.origin,
            reason,
        })?;
    }
    Ok(cutter)
}

/// The surface while tips are taken off and discs put on.
struct Cutter<'a> {
    surface: &'a HalfEdges,
    /// Length of the longest edge.
    longest: f64,
    removed: Vec<bool>,
    points: Vec<Point3>,
    /// The edge length aimed at, at each point.
    sizes: Vec<f64>,
    added: Vec<[u32; 3]>,
    cap: Vec<Option<u32>>,
}

impl Cutter<'_> {
    /// Takes one tip off and puts the disc on.
    fn cut(&mut self, closing: &Closing, end: u32, edge: f64, margins: &[f64]) -> Result<(), CapFailure> {
        let section = &closing.section;
        let seed = self.tip(section).ok_or(CapFailure::NoTip)?;
        let rim = self.opened(section, seed, edge, margins)?;
        if rim.iter().any(|&v| section.height(&self.points[v as usize]) > LONGEST_TIP * section.radius) {
            return Err(CapFailure::Merged);
        }
        let low: Vec<Point3> = rim.iter().map(|&v| self.points[v as usize]).collect();
        if let Some(given) = closing.disc {
            self.put(section, end, &rim, &low, given);
        } else {
            let suited = suited_disc(section, &low, edge).ok_or(CapFailure::Disc)?;
            self.put(section, end, &rim, &low, &suited);
        }
        self.sizes.resize(self.points.len(), edge);
        Ok(())
    }

    /// Takes the tip off; the loop in which the wall then ends. Where another end is so near that nothing is left of the
    /// wall between the two, less is taken.
    fn opened(&mut self, section: &Section, seed: u32, edge: f64, margins: &[f64]) -> Result<Vec<u32>, CapFailure> {
        let mut failure = CapFailure::Loops;
        for margin in margins {
            let mut tip = self.beyond(section, seed, margin * edge)?;
            match self.rim(section, &mut tip, edge) {
                Ok(rim) => return Ok(rim),
                Err(why) => failure = why,
            }
            for face in tip {
                self.removed[face as usize] = false;
            }
        }
        Err(failure)
    }

    fn triangle(&self, face: u32) -> [Point3; 3] {
        [0, 1, 2].map(|i| self.points[self.surface.from(3 * face + i) as usize])
    }

    /// The triangle through which the axis leaves the vessel beyond the plane.
    fn tip(&self, section: &Section) -> Option<u32> {
        let (u, w) = section.frame();
        let reach = LONGEST_TIP * section.radius;
        let mut best = (reach, None);
        let far = (reach + self.longest).powi(2);
        for face in 0..self.removed.len() as u32 {
            let corner = self.points[self.surface.from(3 * face) as usize];
            if (corner - section.origin).norm_squared() > far {
                continue;
            }
            let local = self.triangle(face).map(|p| {
                let d = p - section.origin;
                Vec3::new(d.dot(&u), d.dot(&w), d.dot(&section.axis))
            });
            let side = |a: &Vec3, b: &Vec3| a.x * b.y - a.y * b.x;
            let [a, b, c] = &local;
            let (wa, wb, wc) = (side(b, c), side(c, a), side(a, b));
            let total = wa + wb + wc;
            // Seen from outside, along the axis from above, an exit is counter-clockwise.
            if wa >= 0.0 && wb >= 0.0 && wc >= 0.0 && total > 0.0 {
                let height = (wa * a.z + wb * b.z + wc * c.z) / total;
                if height > 0.0 && height < best.0 {
                    best = (height, Some(face));
                }
            }
        }
        best.1
    }

    /// Marks the connected triangles round `seed` that reach above `margin` before the plane as removed, within the
    /// vessel's own cylinder: where another vessel leans on the tip, the wall will rise from the ring to that vessel.
    fn beyond(&mut self, section: &Section, seed: u32, margin: f64) -> Result<Vec<u32>, CapFailure> {
        let (wide, long) = (WIDTH * section.radius + margin, section.radius * LONGEST_TIP + margin);
        let across = |p: &Point3, height: f64| (p - section.origin - section.axis * height).norm();
        let mut tip = vec![seed];
        self.removed[seed as usize] = true;
        let mut at = 0;
        while at < tip.len() {
            let face = tip[at];
            at += 1;
            if self.triangle(face).iter().any(|p| section.height(p) > long) {
                return Err(CapFailure::Merged);
            }
            for h in 3 * face..3 * face + 3 {
                let next = self.surface.twin(h) / 3;
                let reaches = self.triangle(next).iter().any(|p| {
                    let height = section.height(p);
                    height > -margin && across(p, height) < wide
                });
                if reaches && !self.removed[next as usize] {
                    self.removed[next as usize] = true;
                    tip.push(next);
                }
            }
        }
        Ok(tip)
    }

    /// The loop in which the wall now ends, counter-clockwise about the axis; removes more where it is pinched, has
    /// teeth, or is not one loop.
    fn rim(&mut self, section: &Section, tip: &mut Vec<u32>, edge: f64) -> Result<Vec<u32>, CapFailure> {
        for _ in 0..MAX_RIM_PASSES {
            let boundary = self.boundary(tip);
            let extra = self.spoilers(&boundary);
            if extra.is_empty() {
                return self.walk(&boundary);
            }
            for face in extra {
                if self.triangle(face).iter().any(|p| section.height(p) < -DEEPEST_RIM * edge) {
                    return Err(CapFailure::Loops);
                }
                if !self.removed[face as usize] {
                    self.removed[face as usize] = true;
                    tip.push(face);
                }
            }
        }
        Err(CapFailure::Loops)
    }

    /// The half-edges of the kept wall along the removed tip.
    fn boundary(&self, tip: &[u32]) -> Vec<u32> {
        let sides = tip.iter().flat_map(|&f| 3 * f..3 * f + 3).map(|h| self.surface.twin(h));
        sides.filter(|&h| !self.removed[h as usize / 3]).collect()
    }

    /// Kept triangles to remove as well: teeth (two sides on the boundary) and fans of pinched vertices.
    fn spoilers(&self, boundary: &[u32]) -> Vec<u32> {
        let mut faces: Vec<u32> = boundary.iter().map(|h| h / 3).collect();
        faces.sort_unstable();
        let mut extra: Vec<u32> = faces.windows(2).filter(|w| w[0] == w[1]).map(|w| w[0]).collect();
        let mut starts: Vec<u32> = boundary.iter().map(|&h| self.surface.from(h)).collect();
        starts.sort_unstable();
        for w in starts.windows(2).filter(|w| w[0] == w[1]) {
            extra.extend(self.surface.fan(w[0]).map(|h| h / 3).filter(|&f| !self.removed[f as usize]));
        }
        extra.sort_unstable();
        extra.dedup();
        extra
    }

    /// The boundary as one loop of vertices, against the direction of its half-edges.
    fn walk(&self, boundary: &[u32]) -> Result<Vec<u32>, CapFailure> {
        let mut pairs: Vec<(u32, u32)> = boundary.iter().map(|&h| (self.surface.to(h), self.surface.from(h))).collect();
        pairs.sort_unstable();
        let Some(&(start, _)) = pairs.first() else { return Err(CapFailure::Loops) };
        let mut rim = Vec::with_capacity(pairs.len());
        let mut v = start;
        loop {
            rim.push(v);
            let i = pairs.binary_search_by_key(&v, |p| p.0).map_err(|_| CapFailure::Loops)?;
            v = pairs[i].1;
            if v == start {
                break;
            }
            if rim.len() > pairs.len() {
                return Err(CapFailure::Loops);
            }
        }
        if rim.len() == pairs.len() && rim.len() >= 3 { Ok(rim) } else { Err(CapFailure::Loops) }
    }

    /// Adds the disc and the strip between it and the rim.
    fn put(&mut self, section: &Section, end: u32, rim: &[u32], low: &[Point3], disc: &SharedDisc) {
        let first = self.points.len() as u32;
        self.points.extend(&disc.points);
        let high: Vec<Point3> = disc.rim.iter().map(|&v| disc.points[v as usize]).collect();
        let strip = weave(low, &high, &section.origin, &section.axis);
        let ids: Vec<u32> = disc.rim.iter().map(|v| first + v).collect();
        self.added.extend(strip.iter().map(|step| step.triangle(rim, &ids)));
        self.cap.resize(self.added.len(), None);
        self.added.extend(disc.triangles.iter().map(|t| t.map(|v| first + v)));
        self.cap.resize(self.added.len(), Some(end));
    }

    /// The mesh with the triangles that are left and those added, without the vertices that are no longer used.
    fn finish(self) -> (TriMesh, Vec<f64>, Vec<Option<u32>>) {
        let kept = (0..self.removed.len() as u32).filter(|&f| !self.removed[f as usize]);
        let mut triangles: Vec<[u32; 3]> = kept.map(|f| [0, 1, 2].map(|i| self.surface.from(3 * f + i))).collect();
        let mut cap = vec![None; triangles.len()];
        triangles.extend(self.added);
        cap.extend(self.cap);
        let used = Kept::used(&triangles, self.points.len(), 0);
        let (points, sizes) = (used.select(&self.points), used.select(&self.sizes));
        let triangles = triangles.iter().map(|t| used.cell(t)).collect();
        (TriMesh { points, triangles }, sizes, cap)
    }
}

fn longest_edge(surface: &TriMesh) -> f64 {
    let length = |t: &[u32; 3], i: usize| {
        (surface.points[t[(i + 1) % 3] as usize] - surface.points[t[i] as usize]).norm_squared()
    };
    surface.triangles.iter().flat_map(|t| (0..3).map(|i| length(t, i))).fold(0.0, f64::max).sqrt()
}

/// The disc whose ring goes best with the loop's points.
fn suited_disc(section: &Section, low: &[Point3], edge: f64) -> Option<SharedDisc> {
    let corners = corners(section.radius, edge);
    let flat = disc(section.radius, corners, phase(section, low, corners))?;
    let (u, w) = section.frame();
    Some(SharedDisc {
        points: flat.points.iter().map(|&[x, y]| section.origin + u * x + w * y).collect(),
        triangles: flat.triangles,
        rim: (0..corners).collect(),
        edge,
    })
}

/// The angle of the first ring point at which a regular ring fits the loop's points best.
fn phase(section: &Section, low: &[Point3], corners: u32) -> f64 {
    let (u, w) = section.frame();
    let m = f64::from(corners);
    let (mut s, mut c) = (0.0, 0.0);
    for p in low {
        let d = p - section.origin;
        let angle = m * d.dot(&w).atan2(d.dot(&u));
        s += angle.sin();
        c += angle.cos();
    }
    // Ring points go between those of the loop.
    (s.atan2(c) + std::f64::consts::PI) / m
}

/// The level set, raised by what a polyhedron of this edge length lacks; none beyond the plane, where the wall rises
/// from the ring to another vessel.
struct Raised<'a> {
    field: &'a mut Field,
    by: f64,
    section: &'a Section,
    /// The edge length, and where edges are shorter.
    edge: f64,
    finer: &'a Finer,
}

impl Level for Raised<'_> {
    fn value_and_gradient(&mut self, p: &Point3) -> (f64, Vec3) {
        if self.section.height(p) > 0.0 {
            return (1.0, Vec3::zeros());
        }
        let (value, gradient) = self.field.value_and_gradient(p);
        (value - self.by * self.finer.factor(p, self.edge).powi(2), gradient)
    }
}

/// Relaxes the wall next to each disc; discs and everything further away stay.
fn relaxed(
    mesh: &TriMesh,
    mut sizes: Vec<f64>,
    cap: &[Option<u32>],
    field: &mut Field,
    ends: &[Closing],
    params: &SurfaceParams,
    finer: &Finer,
) -> Result<CappedSurface, CapError> {
    let mut surface = HalfEdges::new(mesh).map_err(|edge| CapError::NotManifold { edge })?;
    let mut on_disc = vec![false; mesh.points.len()];
    for (t, _) in mesh.triangles.iter().zip(cap).filter(|(_, c)| c.is_some()) {
        for &v in t {
            on_disc[v as usize] = true;
        }
    }
    let mut on_rim = vec![false; mesh.points.len()];
    for t in mesh.triangles.iter().filter(|t| t.iter().any(|&v| on_disc[v as usize])) {
        for &v in t {
            on_rim[v as usize] = !on_disc[v as usize];
        }
    }
    for closing in ends {
        let section = &closing.section;
        let edge = closing.edge(params);
        let chord = MEAN_EDGE * edge / section.radius;
        let mut level = Raised { field: &mut *field, by: chord * chord / 16.0, section, edge, finer };
        let before = |height: f64| height > -RELAXED * edge && height < 0.0;
        let leaning = |height: f64| height >= 0.0 && height < LONGEST_TIP * section.radius;
        on_disc.resize(surface.points.len(), false);
        on_rim.resize(surface.points.len(), false);
        let mut leaned_on = false;
        let mut hold: Vec<Hold> = on_disc.iter().map(|&d| if d { Hold::Disc } else { Hold::Still }).collect();
        let ball = (1.5 * section.radius + edge + (RELAXED * edge).max(LONGEST_TIP * section.radius)).powi(2);
        for (v, p) in surface.points.iter().enumerate() {
            if on_disc[v] || (p - section.origin).norm_squared() > ball {
                continue;
            }
            let height = section.height(p);
            let across = (p - section.origin - section.axis * height).norm();
            let near = across < 1.5 * section.radius + edge;
            let leans = near && leaning(height) && on_rim[v];
            leaned_on |= leans;
            if leans || near && before(height) {
                hold[v] = Hold::Free;
                if closing.disc.is_some() {
                    // A disc that is given may have longer or shorter edges than the wall.
                    let stray = GROWTH * height.abs();
                    sizes[v] = sizes[v].clamp(edge - stray.min(edge), edge + stray);
                }
            }
        }
        let mut relaxation = Relaxation::new(&mut surface, &mut level, sizes, hold);
        relaxation.mend(if leaned_on { 12 } else { 3 });
        sizes = relaxation.sizes;
    }
    let faces = surface.live_triangles();
    let cap = faces.iter().map(|&f| cap.get(f as usize).copied().flatten()).collect();
    Ok(CappedSurface { mesh: surface.to_mesh().0, cap })
}

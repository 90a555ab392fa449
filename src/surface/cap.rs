//! Flat caps at terminals (section 3.2.2 of the paper, without the round tip). The tip beyond the plane is removed, and
//! a filled regular ring is placed on the plane. A triangle strip joins the ring with the wall, which is then relaxed
//! near it.

#[cfg(test)]
mod tests;
mod weave;

use super::disc::{MEAN_EDGE, corners, disc};
use super::halfedge::HalfEdges;
use super::relax::{Hold, Level, Relaxation};
use super::shared_disc::SharedDisc;
use super::sizes::Finer;
use super::{Field, SizedWall, SurfaceParams};
use anastomesh_mesh::budget::Stop;
use anastomesh_mesh::geometry::{Aabb, Bvh, Point3, Section, Vec3};
use anastomesh_mesh::{Kept, TriMesh};
use anastomesh_skeleton::NodeId;
use anastomesh_skeleton::resolution::GROWTH;
use anastomesh_tet::parts::Watch;
use weave::weave;

/// Closed wall with flat caps at its terminals.
#[derive(Clone, Debug, PartialEq)]
pub struct CappedSurface {
    /// Closed 2-manifold, oriented outwards.
    pub mesh: TriMesh,
    /// Cap of each triangle, as an index into the given ends; `None` for the wall.
    pub cap: Vec<Option<u32>>,
}

/// Errors of capping.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CapError {
    /// The surface is not a closed 2-manifold.
    #[error("the wall is not a closed manifold at edge {} – {}", edge[0], edge[1])]
    NotManifold {
        /// Vertices of the edge; both are equal if a vertex is at fault.
        edge: [u32; 2],
    },
    /// The caller asked for a stop, or the budget is exceeded.
    #[error(transparent)]
    Stopped(#[from] Stop),
    /// One end could not be capped.
    #[error("end {end} at {origin} cannot be capped: {reason}")]
    End {
        /// Index of the end.
        end: u32,
        /// Node of the terminal; `None` for a cut.
        node: Option<NodeId>,
        /// Centre of the intended cap.
        origin: Point3,
        /// Reason for the failure.
        reason: CapFailure,
    },
}

/// Reasons why an end cannot be capped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CapFailure {
    /// The disc of the tip lies within another vessel and has no wall.
    #[error("the tip lies within another vessel")]
    Buried,
    /// The vessel does not extend beyond the plane.
    #[error("no tip lies beyond the plane")]
    NoTip,
    /// The part beyond the plane includes more than the tip of this vessel.
    #[error("the tip is joined to another vessel")]
    Merged,
    /// The remaining wall does not end in one loop.
    #[error("the wall does not end in one loop")]
    Loops,
    /// The disc could not be triangulated.
    #[error("the disc could not be triangulated")]
    Disc,
}

/// Start of the strip between wall and ring, in edge lengths before the plane. Smaller values are for short walls.
const MARGINS: [f64; 3] = [0.4, 0.2, 0.05];
/// Extent of the relaxed wall before the plane, in edge lengths.
const RELAXED: f64 = 3.5;
/// Target edge length, in edges of the disc, below which a vertex near a given disc belongs to a thinner vessel and keeps its
/// target.
const THIN: f64 = 0.5;
/// Maximum tip length, in radii. Longer tips occur only if the vessel runs into another one.
const LONGEST_TIP: f64 = 3.0;
/// Maximum number of ends whose tips are searched without a tree.
const FEW: usize = 6;
/// Operations per end besides those of search and relaxation, and faces searched in the time of an operation, as counted by
/// budgets.
const PER_END: usize = 300;
const FACES_PER_OPERATION: usize = 8;
/// Maximum distance from the axis, in radii. Anything beyond belongs to another vessel.
const WIDTH: f64 = 1.1;

/// Maximum rounds that repair a rim. Each round removes one row of triangles, so the limit is far above `DEEPEST_RIM`.
const MAX_RIM_PASSES: usize = 20;
/// Maximum depth before the plane, in edge lengths, of triangles removed to repair the rim.
const DEEPEST_RIM: f64 = 4.0;

/// An end and the optional given disc that closes it.
#[derive(Clone, Copy, Debug)]
pub struct Closing<'a> {
    /// Cap plane; its axis points out of the vessel.
    pub section: Section,
    /// Node of the terminal; `None` for a cut.
    pub node: Option<NodeId>,
    /// Disc seen along the end's axis; `None` for one fitted to the wall.
    pub disc: Option<&'a SharedDisc>,
}

impl Closing<'_> {
    /// Edge length of the disc.
    fn edge(&self, params: &SurfaceParams) -> f64 {
        self.disc.map_or_else(|| params.edge_at(self.section.radius), |disc| disc.edge)
    }
}

/// Replaces the tips beyond the `ends` by flat discs. The wall is a level set of `field` and was created with `params`. If
/// `may_leave`, terminals that cannot be capped are left open.
///
/// # Errors
/// The surface is not closed, or a tip is missing, joined to another vessel, or does not leave one loop. `Stopped` if the
/// watch stops it.
pub fn cap_terminals(
    wall: &SizedWall,
    field: &mut Field,
    ends: &[Closing],
    params: &SurfaceParams,
    may_leave: bool,
    watch: &Watch,
) -> Result<CappedSurface, CapError> {
    let cuts = Cuts { wall, ends, tips: tips(wall, ends, watch)?, params, watch };
    let mut kept: Vec<u32> = (0..ends.len() as u32).collect();
    let cutter = loop {
        match cuts.closed(&kept) {
            Ok(cutter) => break cutter,
            // Terminates, as each iteration removes one end.
            Err(CapError::End { end, node: Some(_), .. }) if may_leave => kept.retain(|&other| other != end),
            Err(error) => return Err(error),
        }
    };
    let (mesh, sizes, cap) = cutter.finish();
    let ends: Vec<&Closing> = kept.iter().map(|&end| &ends[end as usize]).collect();
    relaxed(&mesh, sizes, &cap, field, (&ends, params, &wall.finer), watch)
}

/// Tip of each end: the triangle through which the axis leaves the vessel beyond the plane.
fn tips(wall: &SizedWall, ends: &[Closing], watch: &Watch) -> Result<Vec<Option<u32>>, CapError> {
    let search = TipSearch::of(&wall.mesh, ends.len());
    ends.iter()
        .map(|end| {
            let (tip, looked) = search.tip(&end.section);
            watch.spend(looked / FACES_PER_OPERATION)?;
            Ok(tip)
        })
        .collect()
}

/// Wall to be cut at its ends.
struct Cuts<'a> {
    wall: &'a SizedWall,
    ends: &'a [Closing<'a>],
    /// Tip of each end.
    tips: Vec<Option<u32>>,
    params: &'a SurfaceParams,
    watch: &'a Watch<'a>,
}

impl<'a> Cuts<'a> {
    /// Closes some of the ends.
    fn closed(&self, kept: &[u32]) -> Result<Cutter<'a>, CapError> {
        let mut closed = self.with_margins(kept, &MARGINS);
        // An end closed earlier may have removed the wall between two ends, so smaller margins follow.
        for first in 1..MARGINS.len() {
            if !matches!(closed, Err(CapError::End { reason: CapFailure::Loops, .. })) {
                break;
            }
            closed = self.with_margins(kept, &MARGINS[first..]).or(closed);
        }
        closed
    }

    /// Closes some of the ends. Strips start at the first of `margins` that works.
    fn with_margins(&self, kept: &[u32], margins: &[f64]) -> Result<Cutter<'a>, CapError> {
        let wall = self.wall;
        self.watch.spend(wall.mesh.points.len() / FACES_PER_OPERATION)?;
        let mut cutter = Cutter {
            surface: &wall.halves,
            removed: vec![false; wall.mesh.triangles.len()],
            points: wall.mesh.points.clone(),
            sizes: wall.sizes.clone(),
            added: Vec::new(),
            cap: Vec::new(),
        };
        for &end in kept {
            self.watch.spend(PER_END)?;
            let (closing, tip) = (&self.ends[end as usize], self.tips[end as usize]);
            let done = tip.ok_or(CapFailure::NoTip).and_then(|tip| {
                let edge = closing.edge(self.params);
                cutter.cut(closing, end, tip, edge, margins)
            });
            done.map_err(|reason| {
                let Closing { node, section, .. } = *closing;
                CapError::End { end, node, origin: section.origin, reason }
            })?;
        }
        Ok(cutter)
    }
}

/// Surface during capping.
struct Cutter<'a> {
    surface: &'a HalfEdges,
    removed: Vec<bool>,
    points: Vec<Point3>,
    /// Target edge length at each point.
    sizes: Vec<f64>,
    added: Vec<[u32; 3]>,
    cap: Vec<Option<u32>>,
}

impl Cutter<'_> {
    /// Replaces one tip by its disc.
    fn cut(&mut self, closing: &Closing, end: u32, seed: u32, edge: f64, margins: &[f64]) -> Result<(), CapFailure> {
        let section = &closing.section;
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

    /// Removes the tip and returns the boundary loop of the wall. If nothing remains of the wall towards another end, a
    /// smaller margin is tried.
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

    /// Marks the connected triangles around `seed` above `-margin` as removed, within the vessel's own cylinder. If
    /// another vessel touches the tip, the wall later rises from the ring to that vessel.
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

    /// Returns the boundary loop of the wall, counter-clockwise about the axis. Removes further triangles if the loop
    /// is pinched, has teeth, or is not single.
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

    /// Returns the half-edges of the kept wall along the removed tip.
    fn boundary(&self, tip: &[u32]) -> Vec<u32> {
        let sides = tip.iter().flat_map(|&f| 3 * f..3 * f + 3).map(|h| self.surface.twin(h));
        sides.filter(|&h| !self.removed[h as usize / 3]).collect()
    }

    /// Returns further triangles to remove: teeth (two sides on the boundary) and fans of pinched vertices.
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

    /// Returns the boundary as one loop of vertices, against the direction of its half-edges.
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

    /// Returns the mesh of remaining and added triangles, without unused vertices.
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

/// Search for tips: faces of a wall by the place of their first corner.
struct TipSearch<'a> {
    surface: &'a TriMesh,
    /// Length of the longest edge.
    longest: f64,
    /// Search tree over first corners; `None` for few ends.
    tree: Option<Bvh>,
}

impl<'a> TipSearch<'a> {
    fn of(surface: &'a TriMesh, ends: usize) -> Self {
        let corner = |t: &[u32; 3]| Aabb::of_points([&surface.points[t[0] as usize]]);
        let boxes = || surface.triangles.iter().map(corner).collect::<Vec<Aabb>>();
        Self { surface, longest: longest_edge(surface), tree: (ends > FEW).then(|| Bvh::new(&boxes())) }
    }

    /// Faces whose first corner may lie within a distance of a point, in ascending order.
    fn near(&self, p: &Point3, distance: f64) -> Vec<u32> {
        let Some(tree) = &self.tree else { return (0..self.surface.triangles.len() as u32).collect() };
        let mut found = Vec::new();
        tree.query(&Aabb::of_points([p]).grown(distance), |face| found.push(face));
        found.sort_unstable();
        found
    }

    /// Returns the triangle through which the axis leaves the vessel beyond the plane, and the number of faces searched.
    fn tip(&self, section: &Section) -> (Option<u32>, usize) {
        let (u, w) = section.frame();
        let reach = LONGEST_TIP * section.radius;
        let mut best = (reach, None);
        let far = reach + self.longest;
        let near = self.near(&section.origin, far);
        for &face in &near {
            let corners = self.surface.triangles[face as usize].map(|v| self.surface.points[v as usize]);
            if (corners[0] - section.origin).norm_squared() > far.powi(2) {
                continue;
            }
            let local = corners.map(|p| {
                let d = p - section.origin;
                Vec3::new(d.dot(&u), d.dot(&w), d.dot(&section.axis))
            });
            let side = |a: &Vec3, b: &Vec3| a.x * b.y - a.y * b.x;
            let [a, b, c] = &local;
            let (wa, wb, wc) = (side(b, c), side(c, a), side(a, b));
            let total = wa + wb + wc;
            // An exit is counter-clockwise seen from above, along the axis.
            if wa >= 0.0 && wb >= 0.0 && wc >= 0.0 && total > 0.0 {
                let height = (wa * a.z + wb * b.z + wc * c.z) / total;
                if height > 0.0 && height < best.0 {
                    best = (height, Some(face));
                }
            }
        }
        (best.1, near.len())
    }
}

fn longest_edge(surface: &TriMesh) -> f64 {
    let length = |t: &[u32; 3], i: usize| {
        (surface.points[t[(i + 1) % 3] as usize] - surface.points[t[i] as usize]).norm_squared()
    };
    surface.triangles.iter().flat_map(|t| (0..3).map(|i| length(t, i))).fold(0.0, f64::max).sqrt()
}

/// Returns the disc whose ring fits the loop's points best.
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

/// Returns the angle of the first ring point for the best fit of a regular ring to the loop.
fn phase(section: &Section, low: &[Point3], corners: u32) -> f64 {
    let (u, w) = section.frame();
    let m = f64::from(corners);
    let (mut s, mut c) = (0.0, 0.0);
    for p in low {
        let d = p - section.origin;
        let angle = m * libm::atan2(d.dot(&w), d.dot(&u));
        s += libm::sin(angle);
        c += libm::cos(angle);
    }
    // Ring points lie between those of the loop.
    (libm::atan2(s, c) + std::f64::consts::PI) / m
}

/// Level set shifted by the chord error of a polyhedron with this edge length. It does not constrain vertices beyond
/// the plane, where the wall may rise to another vessel.
struct Raised<'a> {
    field: &'a mut Field,
    by: f64,
    section: &'a Section,
    /// Edge length, before the refinement of `finer`.
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

    fn operations(&mut self) -> usize {
        self.field.operations()
    }
}

/// Relaxes the wall next to each disc; keeps discs and more distant parts fixed.
fn relaxed(
    mesh: &TriMesh,
    mut sizes: Vec<f64>,
    cap: &[Option<u32>],
    field: &mut Field,
    (ends, params, finer): (&[&Closing], &SurfaceParams, &Finer),
    watch: &Watch,
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
                if closing.disc.is_some() && sizes[v] > THIN * edge {
                    // The edges of a given disc may be longer or shorter than those of the wall.
                    let stray = GROWTH * height.abs();
                    sizes[v] = sizes[v].clamp(edge - stray.min(edge), edge + stray);
                }
            }
        }
        watch.spend(surface.points.len() / 8)?;
        let mut relaxation = Relaxation::new(&mut surface, &mut level, sizes, hold, *watch);
        relaxation.mend(if leaned_on { 12 } else { 3 })?;
        sizes = relaxation.sizes;
    }
    let faces = surface.live_triangles();
    let cap = faces.iter().map(|&f| cap.get(f as usize).copied().flatten()).collect();
    Ok(CappedSurface { mesh: surface.to_mesh().0, cap })
}

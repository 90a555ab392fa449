//! Recovery of edges among facets that are coplanar up to rounding. Each crossing edge is exchanged for the other
//! diagonal of its quadrilateral (Sloan, 'A fast algorithm for generating constrained Delaunay triangulations', 1993).
//! In space, the exchange removes the ring of tetrahedra around the edge. Each half of the ring, above and below the
//! plane, is joined to an apex that sees all of it. The apex is a corner, a vertex far above the plane with the
//! tetrahedra between removed, or a new vertex. Points of the plane leave no clearance for vertices between them.

use super::kernel::{Apex, Kernel, LEVELS};
use super::parts::{Missing, sides, sorted};
use super::plane::{Patch, Plane};
use super::push::Push;
use super::sectors::{Sector, refill};
use super::space::Space;
use super::ways::operations;
use super::wider::Wider;
use crate::error::TetError;
use crate::input::SurfaceEdges;
use crate::progress::Watch;
use crate::recover::rule::least_height;
use crate::star::EdgeRing;
use anastomesh_mesh::geometry::{Point3, unit_normal};
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::VecDeque;

/// Maximum edges that cross one missing edge.
const FAR: usize = 1024;

/// Maximum vertices inserted into a plane for one edge. A long edge crosses many edges that pierce the plane.
const PIERCED: usize = 128;

/// Maximum tetrahedra added to one half of a ring.
const STEPS: usize = 6;

/// Maximum corners of one half of a ring tried as its apex, highest first.
const HIGHEST: usize = 12;

/// Minimum distance of such a corner from the faces that it sees, relative to its height.
const MARGIN: f64 = 1e-3;

/// Maximum tetrahedra removed, over all these corners, so that a corner sees the whole half. Needles need many; apices
/// further down would cost more.
const MAX_REMOVED_TETS: usize = 1000;

/// Cost of a refused exchange, in exchanges.
const REFUSED: usize = 8;

/// Apex heights to try before the cavity is enlarged.
const HEIGHTS_BEFORE_ENLARGING: usize = 4;

/// Maximum facets used to estimate the plane of one facet.
const AROUND: usize = 200;

/// Tolerances of coplanarity, in units of the flatness tolerance.
#[derive(Clone, Copy)]
struct Measure {
    /// Maximum height of a flat tetrahedron.
    flat: f64,
    /// Minimum distance of new vertices from the surrounding planes.
    clearance: f64,
    /// Minimum height of an intermediate triangle. Rounding may tilt a thinner one by any angle.
    thin: f64,
}

/// Strict first, since vertices with little clearance obstruct later edges. Recovered edges leave fewer obstacles.
const MEASURES: [Measure; 4] = [
    Measure { flat: 1.0, clearance: 20.0, thin: 1.0 },
    Measure { flat: 1.0, clearance: 5.0, thin: 1.0 },
    Measure { flat: 1.0, clearance: 0.3, thin: 1.0 },
    Measure { flat: 4.0, clearance: 0.3, thin: 0.0 },
];

/// Minimum fraction of the edges recovered with one measure before the next is tried.
const GAIN: f64 = 0.1;

/// Fraction of the edges tried before the number of failures is extrapolated.
const SAMPLE: f64 = 0.25;

/// Minimum number of edges tried before the number of failures is extrapolated.
const MANY: usize = 64;

/// Maximum exchanges for one edge: per crossing edge, plus a constant.
const WORK: (usize, usize) = (8, 32);

/// A crossing edge and the two opposite vertices of its quadrilateral in the plane.
#[derive(Clone, Copy)]
struct Diagonal {
    edge: [u32; 2],
    across: [u32; 2],
}

/// Inserts edges into planes of facets.
pub(super) struct Level<'a> {
    pub s: &'a mut Space,
    pub keep: &'a SurfaceEdges,
    /// Missing facets at each of their sides.
    pub facets: FxHashMap<[u32; 2], Vec<[u32; 3]>>,
    /// Vertices that may still be inserted into planes for the current edge.
    pub spare: usize,
    /// Number of input points.
    pub points: usize,
    /// Maximum height of a flat tetrahedron.
    pub tolerance: f64,
    /// Minimum distance of a new vertex from the surrounding planes.
    pub clearance: f64,
    /// Minimum height of an intermediate triangle.
    thin: f64,
    /// Cached planes of missing facets, with the areas they were estimated from.
    planes: FxHashMap<[u32; 3], (f64, Plane)>,
    /// New vertices that lie in no plane.
    pub made: Vec<u32>,
    /// New vertices in planes.
    pub inside: Vec<(u32, Plane)>,
    /// New vertices in planes, as a set.
    pub within: FxHashSet<u32>,
}

/// Missing edges and triangles.
type Left = (Vec<[u32; 2]>, Vec<u32>);

/// Recovers edges that lie in planes of facets up to rounding. Returns the edges and triangles still missing. Returns
/// `None` as soon as more than `share` of all edges are expected to stay missing.
pub(super) fn level_out(
    push: &mut Push,
    keep: &SurfaceEdges,
    missing: Missing,
    share: f64,
    watch: &Watch,
) -> Result<Option<Left>, TetError> {
    let mut facets: FxHashMap<[u32; 2], Vec<[u32; 3]>> = FxHashMap::default();
    for &t in missing.triangles {
        let triangle = push.triangles[t as usize];
        for side in sides(triangle) {
            facets.entry(side).or_default().push(triangle);
        }
    }
    let mut level = Level::new(push, keep, facets);
    let mut left = missing.edges.to_vec();
    let goal = share * left.len() as f64;
    for (measure, others) in MEASURES.into_iter().zip((0..MEASURES.len()).rev()) {
        level.look(measure);
        let before = left.len();
        // Later measures seldom gain more than the current one.
        let hopeless = |tried: usize, failed: usize| {
            let lost = failed as f64 / tried as f64 * before as f64;
            let told = tried >= MANY && tried as f64 >= SAMPLE * before as f64;
            told && lost - others as f64 * (before as f64 - lost) > goal
        };
        let mut again = Vec::new();
        for (tried, edge) in left.into_iter().enumerate() {
            watch.spend(operations(level.s))?;
            if !level.insert(edge) {
                again.push(edge);
            }
            if hopeless(tried + 1, again.len()) {
                return Ok(None);
            }
        }
        let gained = before - again.len();
        left = again;
        if (gained as f64) < GAIN * left.len() as f64 {
            break;
        }
    }
    left.retain(|&[a, b]| !level.s.has_edge(a, b));
    if left.len() as f64 > goal {
        return Ok(None);
    }
    level.leave();
    let made = level.made;
    push.adopt(made);
    let lost_edges = missing.edges.iter().copied().filter(|&[a, b]| !push.s.has_edge(a, b)).collect();
    let mut lost_triangles = Vec::new();
    for &t in missing.triangles {
        match push.s.find_face(push.triangles[t as usize]) {
            Some(half) => push.s.c.freeze(half),
            None => lost_triangles.push(t),
        }
    }
    Ok(Some((lost_edges, lost_triangles)))
}

impl<'a> Level<'a> {
    fn new(push: &'a mut Push, keep: &'a SurfaceEdges, facets: FxHashMap<[u32; 2], Vec<[u32; 3]>>) -> Self {
        Self {
            points: push.segments.points,
            s: &mut push.s,
            keep,
            facets,
            spare: 0,
            tolerance: 0.0,
            clearance: 0.0,
            thin: 0.0,
            planes: FxHashMap::default(),
            made: Vec::new(),
            inside: Vec::new(),
            within: FxHashSet::default(),
        }
    }

    fn look(&mut self, measure: Measure) {
        self.tolerance = measure.flat * self.s.flat;
        self.clearance = measure.clearance * self.s.flat;
        self.thin = measure.thin * self.s.flat;
        self.planes.clear();
    }

    /// Makes an edge if it lies in the plane of one of its facets. After a failure, harmless changes stay.
    pub(super) fn insert(&mut self, [a, b]: [u32; 2]) -> bool {
        if self.s.has_edge(a, b) {
            return true;
        }
        self.spare = PIERCED;
        let facets = self.facets.get(&sorted(a, b)).cloned().unwrap_or_default();
        let mut planes: Vec<(f64, Plane)> = facets.into_iter().map(|facet| self.plane_of(facet)).collect();
        planes.sort_by(|x, y| y.0.total_cmp(&x.0));
        planes.into_iter().any(|(_, plane)| {
            let course = self.course([a, b], &plane).or_else(|| self.course([b, a], &plane));
            course.is_some_and(|course| self.turn([a, b], course, &plane))
        })
    }

    /// True if an input vertex, or one inserted into a plane, lies in `plane` up to rounding.
    pub(super) fn lies_in(&self, v: u32, plane: &Plane) -> bool {
        ((v as usize) < self.points || self.within.contains(&v))
            && plane.height(self.s.point(v)).abs() < 4.0 * self.tolerance
    }

    fn plane_of(&mut self, facet: [u32; 3]) -> (f64, Plane) {
        if let Some(&known) = self.planes.get(&facet) {
            return known;
        }
        let plane = self.plane(facet);
        self.planes.insert(facet, plane);
        plane
    }

    /// Fits the plane of a facet to all coplanar facets around it; returns their area, too. A needle alone defines its
    /// plane only near its long side.
    fn plane(&self, facet: [u32; 3]) -> (f64, Plane) {
        let mut patch = Patch::new(self.s, facet);
        let mut near = vec![facet];
        let mut known = FxHashSet::from_iter([facet]);
        let mut head = 0;
        while let Some(&triangle) = near.get(head).filter(|_| near.len() < AROUND) {
            head += 1;
            for other in sides(triangle).iter().filter_map(|side| self.facets.get(side)).flatten() {
                if known.contains(other) {
                    continue;
                }
                let wider = patch.with(self.s, *other);
                let plane = wider.plane();
                if facet.iter().chain(other).all(|&v| self.lies_in(v, &plane)) {
                    near.push(*other);
                    known.insert(*other);
                    patch = wider;
                }
            }
        }
        (patch.area(), patch.plane())
    }

    /// Exchanges the edges that cross the missing edge as far as possible.
    fn turn(&mut self, [a, b]: [u32; 2], mut waiting: VecDeque<[u32; 2]>, plane: &Plane) -> bool {
        let mut work = WORK.0 * waiting.len() + WORK.1;
        let mut refused = 0;
        while let Some(edge) = waiting.pop_front() {
            if work == 0 || refused > waiting.len() {
                return false;
            }
            work -= 1;
            let flat = self.quadrilateral(edge, plane);
            let convex = flat.filter(|q| self.convex(q, plane) && self.is_edge_allowed(q.across, q.edge, [a, b]));
            let Some(Diagonal { across: [x, y], .. }) = convex.filter(|q| self.exchange(q)) else {
                work = if convex.is_some() { work.saturating_sub(REFUSED) } else { work };
                refused += 1;
                waiting.push_back(edge);
                continue;
            };
            refused = 0;
            let ends = [a, b].contains(&x) || [a, b].contains(&y);
            if !ends && self.side([a, b], x, plane) * self.side([a, b], y, plane) < 0 {
                waiting.push_back([x, y]);
            }
        }
        self.s.has_edge(a, b)
    }

    /// Side of an edge on which a vertex lies, seen from above: positive to the left.
    fn side(&self, [a, b]: [u32; 2], v: u32, plane: &Plane) -> i32 {
        self.s.orient_to([a, b, v], &plane.above)
    }

    /// Edges that the missing edge crosses from its first end to its second, in a plane.
    fn course(&mut self, [a, b]: [u32; 2], plane: &Plane) -> Option<VecDeque<[u32; 2]>> {
        let first = self.first([a, b], plane);
        let first = first.or_else(|| if self.pierce_before([a, b], plane) { self.first([a, b], plane) } else { None });
        // Always directed so that `b` lies to its right.
        let mut edge = first?;
        let mut course = VecDeque::from([edge]);
        while course.len() < FAR {
            if self.keep.contains(edge[0], edge[1]) {
                return None;
            }
            let beyond = self.quadrilateral(edge, plane).map(|q| q.across[0]);
            let next = match beyond {
                Some(next) => next,
                None => self.pierce_beside(edge, plane)?,
            };
            if next == b {
                return Some(course);
            }
            match self.side([a, b], next, plane) {
                0 => return None,
                1 => edge[1] = next,
                _ => edge[0] = next,
            }
            course.push_back(edge);
        }
        None
    }

    /// First edge crossed beyond a face at the first end, directed from right to left.
    fn first(&mut self, [a, b]: [u32; 2], plane: &Plane) -> Option<[u32; 2]> {
        let mut best: Option<(f64, [u32; 2])> = None;
        for t in self.s.star(a) {
            for half in 4 * t..4 * t + 4 {
                let f = self.s.c.face(half);
                let Some(i) = f.iter().position(|&v| v == a) else { continue };
                if self.s.c.is_ghost(t) || self.s.c.is_frozen(half) {
                    continue;
                }
                let [p, q] = [f[(i + 1) % 3], f[(i + 2) % 3]];
                let height = least_height([a, p, q, b].map(|v| self.s.point(v)));
                let crosses = height < self.tolerance
                    && self.lies_in(p, plane)
                    && self.lies_in(q, plane)
                    && self.side([a, b], p, plane) < 0
                    && self.side([a, b], q, plane) > 0
                    && self.side([p, q], a, plane) > 0
                    && self.side([p, q], b, plane) < 0;
                if crosses && best.is_none_or(|x| height < x.0) {
                    best = Some((height, [p, q]));
                }
            }
        }
        best.map(|(_, edge)| edge)
    }

    /// Vertices opposite an edge that are coplanar with it, to its right and left seen from above.
    fn quadrilateral(&mut self, edge: [u32; 2], plane: &Plane) -> Option<Diagonal> {
        let ring = self.s.ring(edge[0], edge[1])?;
        let side = |&v: &u32| if self.lies_in(v, plane) { self.side(edge, v, plane) } else { 0 };
        let sides: Vec<i32> = ring.rim.iter().map(side).collect();
        let mut best: Option<(f64, [u32; 2])> = None;
        for (&x, _) in ring.rim.iter().zip(&sides).filter(|&(_, &side)| side < 0) {
            for (&y, _) in ring.rim.iter().zip(&sides).filter(|&(_, &side)| side > 0) {
                let height = least_height([edge[0], edge[1], x, y].map(|v| self.s.point(v)));
                if height < self.tolerance && best.is_none_or(|b| height < b.0) {
                    best = Some((height, [x, y]));
                }
            }
        }
        best.map(|(_, across)| Diagonal { edge, across })
    }

    fn convex(&self, &Diagonal { edge: [p, q], across }: &Diagonal, plane: &Plane) -> bool {
        self.side(across, p, plane) * self.side(across, q, plane) < 0
    }

    /// True if an edge may be made as an intermediate. It must not make a triangle that is too thin.
    fn is_edge_allowed(&self, [x, y]: [u32; 2], corners: [u32; 2], wanted: [u32; 2]) -> bool {
        let (p, along) = (self.s.point(x), self.s.point(y) - self.s.point(x));
        let high = |&v: &u32| along.cross(&(self.s.point(v) - p)).norm() > self.thin * along.norm();
        sorted(x, y) == sorted(wanted[0], wanted[1]) || self.keep.contains(x, y) || corners.iter().all(high)
    }

    /// Exchanges an edge for the other diagonal.
    fn exchange(&mut self, &Diagonal { edge: [p, q], across: [x, y] }: &Diagonal) -> bool {
        let Some(ring) = self.s.ring(p, q) else { return false };
        if (0..ring.len()).any(|i| ring.spoke(&self.s.c, i).is_none_or(|half| self.s.c.is_frozen(half))) {
            return false;
        }
        let Some(halves) = halves(self.s, &ring, [x, y]) else { return false };
        let middle = Point3::from((self.s.point(p).coords + self.s.point(q).coords) * 0.5);
        let stays = |a: u32, b: u32| self.keep.contains(a, b);
        let mut wider = Wider::new(self.s, &stays, None, middle, ring.tets.clone());
        let filled: Option<Vec<_>> = halves.into_iter().map(|half| self.apex(&mut wider, half)).collect();
        let old = wider.cavity;
        filled.is_some_and(|filled| self.fill(&old, &filled))
    }

    /// Replaces tetrahedra by sectors, each joined to its apex.
    pub(super) fn fill(&mut self, old: &[u32], sectors: &[(Sector, Apex)]) -> bool {
        let before = self.s.c.points.len() as u32;
        let fits = refill(self.s, old, sectors, &[]).is_some();
        self.made.extend(before..self.s.c.points.len() as u32);
        fits
    }

    /// Finds an apex well above the faces of a sector: a corner of the sector if possible, otherwise a new vertex.
    /// Enlarges the sector if neither exists.
    pub(super) fn apex(&self, wider: &mut Wider, sector: Sector) -> Option<(Sector, Apex)> {
        let origin = wider.origin;
        let least = self.least(&Kernel::new(self.s, origin, &sector.faces));
        let direct = |levels: &[f64]| {
            let kernel = Kernel::new(self.s, origin, &sector.faces);
            levels.iter().find_map(|level| kernel.apex(self.s, level.max(least)).ok())
        };
        let (ample, scant) = LEVELS.split_at(HEIGHTS_BEFORE_ENLARGING);
        if let Some(found) = self.corner(wider, &sector, ample, least) {
            return Some(found);
        }
        if let Some(apex) = direct(ample) {
            return Some(self.raised(origin, sector, apex, least));
        }
        let (mut wide, narrow) = (sector.clone(), wider.cavity.len());
        if let Some(apex) = wider.apex(&mut wide, LEVELS[HEIGHTS_BEFORE_ENLARGING].max(least), STEPS) {
            return Some(self.raised(origin, wide, apex, least));
        }
        wider.cavity.truncate(narrow);
        let apex = direct(scant)?;
        Some(self.raised(origin, sector, apex, least))
    }

    /// Finds a corner that sees all faces of a sector, or a high corner with the tetrahedra in its view removed. As
    /// long as few high vertices see the whole plane, later exchanges have clearance; each new vertex would be lower.
    fn corner(&self, wider: &mut Wider, sector: &Sector, ample: &[f64], least: f64) -> Option<(Sector, Apex)> {
        let kernel = Kernel::new(self.s, wider.origin, &sector.faces);
        if let Some(w) = ample.iter().find_map(|level| kernel.neighbor(self.s, level.max(least)).ok()) {
            return Some((sector.clone(), Apex::Vertex(w)));
        }
        let [a, b, c] = sector.faces.last()?.map(|v| self.s.point(v).coords);
        let up = unit_normal(a, b, c);
        let mut rim: Vec<u32> = sector.faces.iter().flatten().copied().collect();
        rim.sort_unstable();
        rim.dedup();
        let height = |v: u32| up.dot(&(self.s.point(v).coords - a));
        let mut high: Vec<(f64, u32)> = rim.into_iter().map(|v| (height(v), v)).collect();
        high.retain(|&(height, _)| height > self.clearance);
        high.sort_unstable_by(|x, y| y.0.total_cmp(&x.0).then(x.1.cmp(&y.1)));
        let free = |v: u32| (v as usize) >= self.points && !self.within.contains(&v);
        let mut budget = MAX_REMOVED_TETS;
        high.into_iter().take(HIGHEST).find_map(|(height, w)| {
            let least = (MARGIN * height).max(self.clearance);
            wider.seen_from(sector, w, (least, &mut budget), free).map(|sector| (sector, Apex::Vertex(w)))
        })
    }

    /// Raises a new apex as far as possible above the new faces, to leave clearance for later exchanges.
    fn raised(&self, origin: Point3, sector: Sector, apex: Apex, least: f64) -> (Sector, Apex) {
        let mut apex = apex;
        if let (Apex::Point(_), Some(&face)) = (apex, sector.faces.last()) {
            let [a, b, c] = face.map(|v| self.s.point(v).coords);
            let kernel = Kernel::new(self.s, origin, &sector.faces);
            if let Some(p) = kernel.tallest(self.s, &unit_normal(a, b, c), least) {
                apex = Apex::Point(p);
            }
        }
        (sector, apex)
    }

    /// Minimum clearance relative to the size.
    fn least(&self, kernel: &Kernel) -> f64 {
        self.clearance / kernel.size
    }
}

/// Splits a ring, without its edge, into two sectors closed by the two triangles at the edge from `x` to `y`.
fn halves(s: &Space, ring: &EdgeRing, [x, y]: [u32; 2]) -> Option<[Sector; 2]> {
    let n = ring.len();
    let at = |v: u32| ring.rim.iter().position(|&w| w == v);
    let (i, j) = (at(x)?, at(y)?);
    let half = |from: usize, to: usize| {
        let (p, q) = (ring.a, ring.b);
        let (x, y) = (ring.rim[from], ring.rim[to]);
        let mut halves = Vec::new();
        let mut k = from;
        while k != to {
            let t = ring.tets[k];
            halves.extend([p, q].iter().filter_map(|&end| s.c.slot_of(t, end)).map(|i| 4 * t + i as u32));
            k = (k + 1) % n;
        }
        let mut faces: Vec<[u32; 3]> = halves.iter().map(|&half| s.wall(half)).collect();
        faces.extend([[x, p, y], [q, x, y]]);
        Sector { faces, halves }
    };
    Some([half(i, j), half(j, i)])
}

//! Surface under change: triangles, feature lines, and the input points that each triangle stands for.

use super::features::{Freedom, edge, normal_of};
use super::reference::Reference;
use super::sizes::Sizes;
use anastomesh_mesh::geometry::predicates::collinear;
use anastomesh_mesh::geometry::{Point3, point_segment, point_triangle};
use rustc_hash::{FxHashMap, FxHashSet};

/// Marks a vertex that is no point of the input, and the corners of removed triangles.
pub(super) const NONE: u32 = u32::MAX;

/// A triangle that replaces others, after all checks.
pub(super) struct Piece {
    pub corners: [u32; 3],
    pub patch: u32,
    /// Input triangle near the centroid.
    near: u32,
    /// Input points to which this is the closest of the new triangles.
    held: Vec<u32>,
}

/// Surface under change.
pub(super) struct Surface<'a> {
    pub reference: &'a Reference<'a>,
    pub points: Vec<Point3>,
    /// Corners; removed triangles have `NONE`.
    pub triangles: Vec<[u32; 3]>,
    /// Patch of the input of each triangle, and an input triangle near it.
    pub patch: Vec<u32>,
    pub near: Vec<u32>,
    /// Input points that are no vertices, at the triangle closest to them.
    pub held: Vec<Vec<u32>>,
    /// Triangles at each vertex.
    pub around: Vec<Vec<u32>>,
    pub freedom: Vec<Freedom>,
    /// Input point at each vertex, or `NONE`.
    pub given: Vec<u32>,
    /// Edge lengths without limits, and with them.
    pub base: Vec<f64>,
    pub wanted: Vec<f64>,
    /// Feature edges, smaller vertex first. Each has the input points of its line between its ends, in this direction.
    pub lines: FxHashMap<[u32; 2], Vec<u32>>,
    /// Edges that stay.
    pub locked: FxHashSet<[u32; 2]>,
    /// Triangles that changed since the last flips.
    pub changed: Vec<u32>,
    /// True for vertices whose triangles changed since the last attempt to move them.
    pub is_due: Vec<bool>,
    /// Pass in which the triangles of each vertex changed last, the present pass, and the last one with collapses.
    pub touched: Vec<u32>,
    pub pass: u32,
    pub collapsed: u32,
    free: Vec<u32>,
}

impl<'a> Surface<'a> {
    /// The input, with frozen triangles.
    pub fn new(reference: &'a Reference, sizes: &Sizes, frozen: &[bool]) -> Self {
        let plc = reference.plc;
        let surface = plc.surface;
        let n = surface.points.len();
        let mut around = vec![Vec::new(); n];
        for (t, corners) in (0..).zip(&surface.triangles) {
            for &v in corners {
                around[v as usize].push(t);
            }
        }
        let mut freedom = reference.features.freedom.clone();
        let mut locked: FxHashSet<[u32; 2]> = plc.segments.iter().map(|&[a, b]| edge(a, b)).collect();
        for (&[a, b, c], _) in surface.triangles.iter().zip(frozen).filter(|(_, frozen)| **frozen) {
            locked.extend([edge(a, b), edge(b, c), edge(c, a)]);
            for v in [a, b, c] {
                freedom[v as usize] = Freedom::Fixed;
            }
        }
        Self {
            reference,
            points: surface.points.clone(),
            triangles: surface.triangles.clone(),
            patch: reference.features.patches.clone(),
            near: (0..surface.triangles.len() as u32).collect(),
            held: vec![Vec::new(); surface.triangles.len()],
            around,
            freedom,
            given: (0..n as u32).collect(),
            base: sizes.base.clone(),
            wanted: sizes.wanted.clone(),
            lines: reference.features.lines.iter().map(|&line| (line, Vec::new())).collect(),
            locked,
            changed: (0..surface.triangles.len() as u32).collect(),
            is_due: vec![true; n],
            touched: vec![0; n],
            pass: 0,
            collapsed: 0,
            free: Vec::new(),
        }
    }

    pub fn corners(&self, t: [u32; 3]) -> [&Point3; 3] {
        t.map(|v| &self.points[v as usize])
    }

    pub fn length(&self, [a, b]: [u32; 2]) -> f64 {
        (self.points[a as usize] - self.points[b as usize]).norm()
    }

    /// Length of an edge in wanted lengths.
    pub fn relative_length(&self, [a, b]: [u32; 2]) -> f64 {
        self.length([a, b]) / f64::midpoint(self.wanted[a as usize], self.wanted[b as usize]).max(f64::MIN_POSITIVE)
    }

    /// True for a triangle that is not removed.
    pub fn is_alive(&self, t: u32) -> bool {
        self.triangles[t as usize][0] != NONE
    }

    /// All edges, ascending.
    pub fn edges(&self) -> Vec<[u32; 2]> {
        edges_of(self.triangles.iter())
    }

    /// Edges of the triangles that changed since the last call, ascending.
    pub fn take_changed_edges(&mut self) -> Vec<[u32; 2]> {
        let changed = std::mem::take(&mut self.changed);
        edges_of(changed.iter().map(|&t| &self.triangles[t as usize]))
    }

    /// Triangles at an edge.
    pub fn at_edge(&self, [a, b]: [u32; 2]) -> Vec<u32> {
        let has = |t: &u32| self.triangles[*t as usize].contains(&b);
        self.around[a as usize].iter().copied().filter(has).collect()
    }

    /// Neighbours of a vertex, ascending.
    pub fn neighbours(&self, v: u32) -> Vec<u32> {
        let corners = self.around[v as usize].iter().flat_map(|&t| self.triangles[t as usize]);
        let mut all: Vec<u32> = corners.filter(|&w| w != v).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Corner of a triangle beside an edge of it.
    pub fn apex(&self, t: u32, [a, b]: [u32; 2]) -> u32 {
        self.triangles[t as usize].into_iter().find(|&v| v != a && v != b).unwrap_or(a)
    }

    /// Input points between the ends of a feature edge, from `a` to `b`; `None` for other edges.
    pub fn chain(&self, a: u32, b: u32) -> Option<Vec<u32>> {
        let mut chain = self.lines.get(&edge(a, b))?.clone();
        if a > b {
            chain.reverse();
        }
        Some(chain)
    }

    /// Sets the input points between the ends of a feature edge, from `a` to `b`.
    pub fn set_chain(&mut self, a: u32, b: u32, mut chain: Vec<u32>) {
        if a > b {
            chain.reverse();
        }
        self.lines.insert(edge(a, b), chain);
    }

    /// True if input points lie within their tolerance of a segment.
    pub fn is_near_segment(&self, chain: &[u32], [a, b]: [&Point3; 2]) -> bool {
        let r = self.reference;
        chain.iter().all(|&i| point_segment(&r.plc.surface.points[i as usize], a, b).1 <= r.allowed_points[i as usize])
    }

    /// Smallest angle of a triangle, in radians.
    pub fn smallest_angle(&self, t: [u32; 3]) -> f64 {
        smallest_angle(self.corners(t))
    }

    /// Smallest angle of some triangles.
    pub fn smallest_angle_of(&self, triangles: &[u32]) -> f64 {
        triangles.iter().map(|&t| self.smallest_angle(self.triangles[t as usize])).fold(f64::INFINITY, f64::min)
    }

    /// Checks triangles that are to replace `old`: their smallest angle, normals and distances from the input in both directions.
    /// `extra` are input points that are no vertices any more.
    pub fn plan(&self, old: &[u32], new: &[([u32; 3], u32)], extra: &[u32], least: f64) -> Option<Vec<Piece>> {
        let hints: Vec<u32> = old.iter().map(|&t| self.near[t as usize]).collect();
        let mut pieces = Vec::with_capacity(new.len());
        for &(corners, patch) in new {
            let angle = self.smallest_angle(corners);
            if angle.is_nan() || angle < least {
                return None;
            }
            pieces.push(Piece { corners, patch, near: self.near_input(corners, patch, &hints)?, held: Vec::new() });
        }
        let held = old.iter().flat_map(|&t| &self.held[t as usize]).chain(extra);
        self.distribute(held, &mut pieces, true).then_some(pieces)
    }

    /// Input triangle near the centroid of a triangle; `None` if one of its samples is too far from the input.
    fn near_input(&self, corners: [u32; 3], patch: u32, hints: &[u32]) -> Option<u32> {
        let [a, b, c] = self.corners(corners);
        if collinear(a, b, c) {
            return None;
        }
        let normal = normal_of([a, b, c]);
        let middles = [(a, b), (b, c), (c, a)].map(|(p, q)| nalgebra::center(p, q));
        let is_near = |p: &Point3| self.reference.within(p, &normal, patch, hints).is_some();
        if !middles.iter().all(is_near) {
            return None;
        }
        let centroid = Point3::from((a.coords + b.coords + c.coords) / 3.0);
        self.reference.within(&centroid, &normal, patch, hints)
    }

    /// Gives input points to the closest piece. Returns false if one is farther than allowed, and `is_strict`.
    fn distribute<'b>(&self, points: impl Iterator<Item = &'b u32>, pieces: &mut [Piece], is_strict: bool) -> bool {
        for &i in points {
            let p = &self.reference.plc.surface.points[i as usize];
            let mut best = (f64::INFINITY, 0);
            for (k, piece) in pieces.iter().enumerate() {
                let distance = point_triangle(p, self.corners(piece.corners)).1;
                if distance < best.0 {
                    best = (distance, k);
                }
            }
            if is_strict && best.0 > self.reference.allowed_points[i as usize] {
                return false;
            }
            if let Some(piece) = pieces.get_mut(best.1) {
                piece.held.push(i);
            }
        }
        true
    }

    /// Pieces of triangles whose shape does not change, without checks of the distance; `None` if one has no area.
    pub fn unchecked(&self, old: &[u32], new: &[([u32; 3], u32)], near: &[u32]) -> Option<Vec<Piece>> {
        if new.iter().any(|&(t, _)| {
            let [a, b, c] = self.corners(t);
            collinear(a, b, c)
        }) {
            return None;
        }
        let piece =
            |(&(corners, patch), &near): (&([u32; 3], u32), &u32)| Piece { corners, patch, near, held: Vec::new() };
        let mut pieces: Vec<Piece> = new.iter().zip(near).map(piece).collect();
        self.distribute(old.iter().flat_map(|&t| &self.held[t as usize]), &mut pieces, false);
        Some(pieces)
    }

    /// Replaces triangles by pieces.
    pub fn replace(&mut self, old: &[u32], pieces: Vec<Piece>) {
        for &t in old {
            for v in std::mem::replace(&mut self.triangles[t as usize], [NONE; 3]) {
                self.around[v as usize].retain(|&u| u != t);
            }
            self.held[t as usize].clear();
        }
        self.free.extend(old.iter().rev());
        for Piece { corners, patch, near, held } in pieces {
            let t = self.slot();
            self.triangles[t as usize] = corners;
            (self.patch[t as usize], self.near[t as usize], self.held[t as usize]) = (patch, near, held);
            self.changed.push(t);
            for v in corners {
                self.around[v as usize].push(t);
                self.is_due[v as usize] = true;
                self.touched[v as usize] = self.pass;
            }
        }
    }

    /// Index for a new triangle.
    fn slot(&mut self) -> u32 {
        self.free.pop().unwrap_or_else(|| {
            self.triangles.push([NONE; 3]);
            self.patch.push(0);
            self.near.push(0);
            self.held.push(Vec::new());
            self.triangles.len() as u32 - 1
        })
    }

    /// Number of triangles.
    pub fn count(&self) -> usize {
        self.triangles.len() - self.free.len()
    }

    /// Adds a vertex.
    pub fn add(&mut self, point: Point3, freedom: Freedom, given: u32, [base, wanted]: [f64; 2]) -> u32 {
        self.points.push(point);
        self.freedom.push(freedom);
        self.given.push(given);
        self.base.push(base);
        self.wanted.push(wanted);
        self.around.push(Vec::new());
        self.is_due.push(true);
        self.touched.push(self.pass);
        self.points.len() as u32 - 1
    }

    /// Removes the last vertex, which has no triangles.
    pub fn remove_last(&mut self) {
        self.points.pop();
        self.freedom.pop();
        self.given.pop();
        self.base.pop();
        self.wanted.pop();
        self.around.pop();
        self.is_due.pop();
        self.touched.pop();
    }
}

/// Edges of triangles that are not removed, ascending.
fn edges_of<'a>(triangles: impl Iterator<Item = &'a [u32; 3]>) -> Vec<[u32; 2]> {
    let alive = triangles.filter(|t| t[0] != NONE);
    let mut edges: Vec<[u32; 2]> = alive.flat_map(|&[a, b, c]| [edge(a, b), edge(b, c), edge(c, a)]).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// Smallest angle of a triangle, in radians.
pub(super) fn smallest_angle([a, b, c]: [&Point3; 3]) -> f64 {
    let angle = |p: &Point3, q: &Point3, r: &Point3| {
        let (u, v) = (q - p, r - p);
        libm::atan2(u.cross(&v).norm(), u.dot(&v))
    };
    angle(a, b, c).min(angle(b, c, a)).min(angle(c, a, b))
}

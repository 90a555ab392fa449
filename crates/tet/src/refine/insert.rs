//! Delaunay refinement inside a fixed boundary: tetrahedra that violate the goals are split at their circumcentres,
//! worst first. (Ruppert 1995; Shewchuk, 'Tetrahedral mesh generation by Delaunay refinement', 1998.) Cavities never
//! cross a frozen face. A point is rejected if it comes closer to others than the violation justifies. This ensures
//! termination, even for input with small angles.

use super::goals::{Fault, Goals, circumcenter, encroaches};
use crate::complex::Complex;
use anastomesh_mesh::geometry::predicates::{in_exact_range, insphere, orient3d};
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::quality::radius_ratio;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Maximum tetrahedra in a cavity.
const MAX_CAVITY: usize = 4096;
/// Maximum trims of a cavity before its point is rejected.
const MAX_TRIMS: usize = 24;
/// Maximum steps of a walk to a point.
const MAX_STEPS: usize = 200;
/// Positions of a new point, as parts of the way from the centroid to the circumcentre.
const SHARES: [f64; 3] = [1.0, 0.5, 0.0];
/// Minimum radius ratio of a new tetrahedron on the boundary, unless the worst replaced one is lower.
const AT_BOUNDARY: f64 = 0.25;
/// Minimum radius ratio of a new inner tetrahedron, unless the worst replaced one is lower.
const INSIDE: f64 = 0.02;

/// Report of a refinement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct RefineReport {
    /// Points added.
    pub points: usize,
    /// Tetrahedra that still violate the goals, because of the boundary or the point limit.
    pub left: usize,
    /// True if the point limit ended the refinement.
    pub limit_reached: bool,
}

impl RefineReport {
    /// Adds the counts of another part.
    pub(crate) fn add(&mut self, other: &Self) {
        self.points += other.points;
        self.left += other.left;
        self.limit_reached |= other.limit_reached;
    }
}

/// A tetrahedron to split, ordered by its violation.
#[derive(Clone, Copy, Debug)]
struct Task {
    excess: f64,
    tet: u32,
    verts: [u32; 4],
}

impl PartialEq for Task {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Task {}

impl PartialOrd for Task {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Task {
    fn cmp(&self, other: &Self) -> Ordering {
        self.excess.total_cmp(&other.excess).then(other.tet.cmp(&self.tet)).then(self.verts.cmp(&other.verts))
    }
}

/// Refines a carved complex in place. `regions` are the regions of the tetrahedra, by slot; it may be empty. `continues` is
/// called periodically with the number of points added.
pub fn refine_complex(
    c: &mut Complex,
    goals: &Goals,
    regions: Vec<u32>,
    mut continues: impl FnMut(usize) -> bool,
) -> RefineReport {
    let mut r = Refiner {
        c,
        goals,
        regions,
        tasks: BinaryHeap::new(),
        stamp: Vec::new(),
        now: 0,
        cavity: Vec::new(),
        new: Vec::new(),
        created: Vec::new(),
        flawed: Vec::new(),
        outline: Vec::new(),
    };
    for t in 0..r.c.slots() as u32 {
        if r.c.is_real(t) {
            r.note(t);
        }
    }
    let limit = goals.max_points.unwrap_or(usize::MAX).min((u32::MAX / 64) as usize - r.c.points.len());
    let mut report = RefineReport::default();
    let mut visits = 0_usize;
    while let Some(task) = r.tasks.pop() {
        if !r.c.is_real(task.tet) || r.c.verts(task.tet) != task.verts {
            continue;
        }
        visits += 1;
        if visits.is_multiple_of(1024) && !continues(report.points) {
            break;
        }
        if report.points >= limit {
            report.limit_reached = true;
            break;
        }
        report.points += usize::from(r.split(task.tet));
    }
    report.left = r.c.real_tets().filter(|&t| r.fault(t).is_some()).count();
    report
}

struct Refiner<'a, 'g> {
    c: &'a mut Complex,
    goals: &'a Goals<'g>,
    /// Region of each slot; may be empty.
    regions: Vec<u32>,
    tasks: BinaryHeap<Task>,
    stamp: Vec<u32>,
    now: u32,
    cavity: Vec<u32>,
    new: Vec<[u32; 4]>,
    created: Vec<u32>,
    /// Tetrahedra that must leave the cavity.
    flawed: Vec<u32>,
    /// Vertices of the cavity's faces.
    outline: Vec<u32>,
}

impl Refiner<'_, '_> {
    fn corners(&self, t: u32) -> [&Point3; 4] {
        self.c.verts(t).map(|v| &self.c.points[v as usize])
    }

    fn region(&self, t: u32) -> Option<u32> {
        self.regions.get(t as usize).copied()
    }

    fn fault(&self, t: u32) -> Option<Fault> {
        self.goals.fault(self.corners(t), self.region(t))
    }

    fn note(&mut self, t: u32) {
        if let Some(fault) = self.fault(t) {
            self.tasks.push(Task { excess: fault.excess, tet: t, verts: self.c.verts(t) });
        }
    }

    /// Splits a tetrahedron that violates the goals. Returns false if no position for a point is found.
    fn split(&mut self, t: u32) -> bool {
        let Some(fault) = self.fault(t) else { return false };
        let p = self.corners(t);
        let sum: Vec3 = p.iter().map(|x| x.coords).sum();
        let middle = Point3::from(sum / 4.0);
        let Some(center) = circumcenter(p) else { return self.insert(t, middle, fault) };
        // If the circumcentre is outside or too close to the boundary, a nearer position may do. For the radius-edge
        // ratio, positions near the centroid do more harm beside needles than good elsewhere.
        let shares = if fault.is_ratio { &SHARES[..2] } else { &SHARES[..] };
        shares.iter().any(|&share| self.insert(t, middle + (center - middle) * share, fault))
    }

    fn insert(&mut self, t: u32, p: Point3, fault: Fault) -> bool {
        if !p.iter().all(|&x| in_exact_range(x)) {
            return false;
        }
        let Some(start) = self.walk(t, &p) else { return false };
        if !self.dig(start, &p, fault.is_ratio) || !self.trim(start, &p) || !self.is_worthwhile(&p, fault.spacing) {
            return false;
        }
        let region = self.region(start);
        let v = self.c.add_point(p);
        self.new.clear();
        for k in 0..self.cavity.len() {
            let x = self.cavity[k];
            for half in 4 * x..4 * x + 4 {
                if !self.is_in(self.c.mate(half) >> 2) {
                    let [a, b, d] = self.c.face(half);
                    self.new.push([v, a, b, d]);
                }
            }
        }
        let mut created = std::mem::take(&mut self.created);
        let done = self.c.replace(&self.cavity, &self.new, &mut created);
        if done {
            for &x in &created {
                if let Some(region) = region {
                    self.regions.resize(self.c.slots(), u32::MAX);
                    self.regions[x as usize] = region;
                }
                self.note(x);
            }
        } else {
            self.c.pop_point();
        }
        self.created = created;
        done
    }

    /// Finds the tetrahedron that contains `p` by a walk from `t` that crosses no frozen face.
    fn walk(&self, mut t: u32, p: &Point3) -> Option<u32> {
        let mut from = u32::MAX;
        for step in 0..MAX_STEPS {
            let mut next = None;
            for i in 0..4 {
                // The order changes with each step to prevent cycles.
                let half = 4 * t + (i + step as u32) % 4;
                if half == from {
                    continue;
                }
                let [a, b, d] = self.c.face(half).map(|v| &self.c.points[v as usize]);
                if orient3d(p, a, b, d) < 0.0 {
                    next = Some(half);
                    break;
                }
            }
            let Some(half) = next else { return Some(t) };
            let mate = self.c.mate(half);
            if self.c.is_frozen(half) || self.c.is_ghost(mate >> 2) {
                return None;
            }
            from = mate;
            t = mate >> 2;
        }
        None
    }

    fn is_in(&self, t: u32) -> bool {
        self.stamp.get(t as usize) == Some(&self.now)
    }

    fn mark(&mut self, t: u32) {
        self.stamp[t as usize] = self.now;
        self.cavity.push(t);
    }

    /// Collects the tetrahedra around `start` whose circumspheres contain `p`. With `away`, returns false if the point
    /// lies in the smallest sphere of a fixed triangle that it sees. Such points lead to ever
    /// more points without gain.
    fn dig(&mut self, start: u32, p: &Point3, away: bool) -> bool {
        self.stamp.resize(self.c.slots(), 0);
        self.now += 1;
        self.cavity.clear();
        self.mark(start);
        let mut head = 0;
        while head < self.cavity.len() && self.cavity.len() < MAX_CAVITY {
            let t = self.cavity[head];
            head += 1;
            for half in 4 * t..4 * t + 4 {
                let n = self.c.mate(half) >> 2;
                if self.c.is_frozen(half) || self.c.is_ghost(n) {
                    if away && encroaches(p, self.c.face(half).map(|v| &self.c.points[v as usize])) {
                        return false;
                    }
                    continue;
                }
                if self.is_in(n) {
                    continue;
                }
                let [a, b, d, e] = self.corners(n);
                if insphere(a, b, d, e, p) > 0.0 {
                    self.mark(n);
                }
            }
        }
        true
    }

    /// Removes tetrahedra that hide a face, vertex or frozen face from `p`. Returns false if `start` is one.
    fn trim(&mut self, start: u32, p: &Point3) -> bool {
        for _ in 0..MAX_TRIMS {
            self.flawed.clear();
            self.find_flaws(start, p);
            if self.flawed.is_empty() {
                return true;
            }
            if self.flawed.contains(&start) {
                return false;
            }
            for k in 0..self.flawed.len() {
                self.stamp[self.flawed[k] as usize] = 0;
            }
            self.keep_connected(start);
        }
        false
    }

    /// Drops the part of the cavity that is not connected to `start`.
    fn keep_connected(&mut self, start: u32) {
        let old = self.now;
        self.now += 1;
        self.cavity.clear();
        self.mark(start);
        let mut head = 0;
        while let Some(&t) = self.cavity.get(head) {
            head += 1;
            for half in 4 * t..4 * t + 4 {
                let n = self.c.mate(half) >> 2;
                if !self.c.is_frozen(half) && self.stamp.get(n as usize) == Some(&old) {
                    self.mark(n);
                }
            }
        }
    }

    fn find_flaws(&mut self, start: u32, p: &Point3) {
        let mut outline = std::mem::take(&mut self.outline);
        outline.clear();
        for k in 0..self.cavity.len() {
            let t = self.cavity[k];
            for half in 4 * t..4 * t + 4 {
                let mate = self.c.mate(half);
                if self.is_in(mate >> 2) {
                    if self.c.is_frozen(half) {
                        self.flawed.push(if t == start { mate >> 2 } else { t });
                    }
                    continue;
                }
                let f = self.c.face(half);
                let [a, b, d] = f.map(|v| &self.c.points[v as usize]);
                if orient3d(p, a, b, d) <= 0.0 {
                    self.flawed.push(t);
                }
                outline.extend(f);
            }
        }
        if self.flawed.is_empty() {
            outline.sort_unstable();
            outline.dedup();
            let hidden = |t: u32| self.c.verts(t).iter().any(|v| outline.binary_search(v).is_err());
            // One of the tetrahedra around a hidden vertex must leave, not `start` if possible.
            let bad = self.cavity.iter().rev().copied().find(|&t| hidden(t));
            self.flawed.extend(bad);
        }
        self.outline = outline;
    }

    /// True if a point in the cavity makes neither short edges nor bad tetrahedra.
    fn is_worthwhile(&self, p: &Point3, spacing: f64) -> bool {
        let mut old = f64::INFINITY;
        for &t in &self.cavity {
            let x = self.corners(t);
            old = old.min(radius_ratio(x[0], x[1], x[2], x[3]));
            if x.iter().any(|q| (*q - p).norm_squared() < spacing * spacing) {
                return false;
            }
        }
        self.cavity.iter().flat_map(|&t| 4 * t..4 * t + 4).all(|half| {
            let n = self.c.mate(half) >> 2;
            if self.is_in(n) {
                return true;
            }
            let wall = self.c.is_frozen(half) || self.c.is_ghost(n);
            let [a, b, d] = self.c.face(half).map(|v| &self.c.points[v as usize]);
            radius_ratio(p, a, b, d) >= old.min(if wall { AT_BOUNDARY } else { INSIDE })
        })
    }
}

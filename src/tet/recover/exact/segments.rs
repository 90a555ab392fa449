//! Segments: each missing one is split until all its pieces are edges of the Delaunay complex (Shewchuk 1998; Si,
//! Gärtner, 'Meshing piecewise linear complexes by constrained Delaunay tetrahedralizations', 2005).

use super::insert::Digger;
use super::space::Space;
use crate::geometry::implicit::OnSegment;
use crate::geometry::{Point3, Vec3};
use crate::tet::complex::Complex;
use crate::tet::error::{Obstacle, Stuck, TetError};
use crate::tet::star::Star;
use rustc_hash::FxHashMap;
use std::collections::VecDeque;

/// Splits allowed per segment on the whole, and in any case.
const SPLITS: (usize, usize) = (64, 100_000);

/// Segments at a vertex that meet at a smaller angle make it acute: cosine of 60°.
const ACUTE: f64 = 0.5;

/// A segment of the input and the vertices on it, from its first end to its second.
#[derive(Clone, Debug)]
pub(super) struct Segment {
    pub ends: [u32; 2],
    pub chain: Vec<u32>,
}

/// All segments.
pub(super) struct Segments {
    pub list: Vec<Segment>,
    /// The segment of each piece, smaller vertex first.
    pieces: FxHashMap<(u32, u32), u32>,
    /// Segment of each pair of ends, smaller vertex first.
    by_ends: FxHashMap<(u32, u32), u32>,
    /// Segments at each of the points.
    acute: Vec<bool>,
    on_segment: Vec<bool>,
}

fn sorted(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}

/// What a line meets first on leaving its start.
enum Crossing {
    Exists,
    Face([u32; 3]),
    Edge([u32; 2]),
    Vertex(u32),
    Nothing,
}

impl Segments {
    /// The sides of the triangles, and the edges, each once.
    pub(super) fn new(points: &[Point3], triangles: &[[u32; 3]], edges: &[[u32; 2]]) -> Self {
        let sides = triangles.iter().flat_map(|t| [sorted(t[0], t[1]), sorted(t[1], t[2]), sorted(t[2], t[0])]);
        let mut all: Vec<(u32, u32)> = sides.chain(edges.iter().map(|e| sorted(e[0], e[1]))).collect();
        all.sort_unstable();
        all.dedup();
        let list: Vec<Segment> = all.iter().map(|&(a, b)| Segment { ends: [a, b], chain: vec![a, b] }).collect();
        let pieces: FxHashMap<(u32, u32), u32> = all.iter().copied().zip(0..).collect();
        let acute = acute_vertices(points, &all);
        let mut on_segment = vec![false; points.len()];
        for &(a, b) in &all {
            on_segment[a as usize] = true;
            on_segment[b as usize] = true;
        }
        Self { list, by_ends: pieces.clone(), pieces, acute, on_segment }
    }

    /// The segment between two points of the input.
    pub(super) fn between(&self, a: u32, b: u32) -> Option<u32> {
        self.by_ends.get(&sorted(a, b)).copied()
    }

    /// The ends of the segment that has piece `a, b`.
    pub(super) fn of_piece(&self, a: u32, b: u32) -> Option<[u32; 2]> {
        if !self.wants(a, b) {
            return None;
        }
        self.pieces.get(&sorted(a, b)).map(|&i| self.list[i as usize].ends)
    }

    fn wants(&self, a: u32, b: u32) -> bool {
        let on = |v: u32| self.on_segment.get(v as usize).copied().unwrap_or(false);
        on(a) && on(b)
    }

    /// The pieces that are no edges.
    pub(super) fn missing(&self, c: &Complex) -> Vec<(u32, u32)> {
        let mut found = vec![0u32; self.list.len()];
        let mut seen: FxHashMap<(u32, u32), ()> = FxHashMap::default();
        for t in c.real_tets() {
            let w = c.verts(t);
            for i in 0..4 {
                for j in 0..i {
                    if !self.wants(w[i], w[j]) {
                        continue;
                    }
                    let key = sorted(w[i], w[j]);
                    let Some(&s) = self.pieces.get(&key) else { continue };
                    if self.list[s as usize].chain.len() == 2 {
                        found[s as usize] = 1;
                    } else {
                        seen.insert(key, ());
                    }
                }
            }
        }
        let mut missing = Vec::new();
        for (s, count) in self.list.iter().zip(&found) {
            if s.chain.len() > 2 || *count == 0 {
                missing.extend(s.chain.windows(2).map(|p| sorted(p[0], p[1])).filter(|k| !seen.contains_key(k)));
            }
        }
        missing
    }

    /// Splits segments until all their pieces are edges. Returns the number of vertices added.
    pub(super) fn recover(&mut self, s: &mut Space) -> Result<usize, TetError> {
        let mut queue: VecDeque<(u32, u32)> = self.missing(&s.c).into();
        let mut budget = SPLITS.0 * queue.len() + SPLITS.1;
        let mut star = Star::default();
        let mut digger = Digger::default();
        let mut added = 0;
        while let Some((a, b)) = queue.pop_front() {
            let Some(&segment) = self.pieces.get(&sorted(a, b)) else { continue };
            let Some((on, start)) = self.split(s, &mut star, segment, a, b)? else { continue };
            let ends = self.list[segment as usize].ends;
            if budget == 0 {
                return Err(stuck(ends, Stuck::Budget));
            }
            budget -= 1;
            let v = s.add_implicit(on);
            digger.insert(s, v, start, |p, q| self.wants(p, q) && self.pieces.contains_key(&(p, q)));
            added += 1;
            self.on_segment.resize(v as usize + 1, false);
            self.on_segment[v as usize] = true;
            self.pieces.remove(&sorted(a, b));
            for end in [a, b] {
                self.pieces.insert(sorted(end, v), segment);
                queue.push_back((end, v));
            }
            let chain = &mut self.list[segment as usize].chain;
            let at = chain.iter().position(|&x| x == a || x == b).unwrap_or(0);
            chain.insert(at + 1, v);
            queue.extend(digger.lost.iter().filter(|&&(p, q)| self.pieces.contains_key(&(p, q))));
        }
        Ok(added)
    }

    /// Where to split piece `a, b`, and a tetrahedron near there; nothing if it is an edge.
    fn split(
        &self,
        s: &Space,
        star: &mut Star,
        segment: u32,
        a: u32,
        b: u32,
    ) -> Result<Option<(OnSegment, u32)>, TetError> {
        let ends = self.list[segment as usize].ends;
        // From first to last along the segment.
        let at = |v: u32| if v == ends[0] { 0.0 } else { s.parameter(v).unwrap_or(1.0) };
        let (p, q) = if at(a) < at(b) { (a, b) } else { (b, a) };
        let mut reference: Option<(f64, u32)> = None;
        let mut start = s.c.vertex_tet(p);
        for (from, to, line) in [(p, q, ends), (q, p, [ends[1], ends[0]])] {
            let (crossing, t) = first_crossing(s, star, from, to, line);
            match crossing {
                Crossing::Exists => return Ok(None),
                Crossing::Face(f) => f.iter().for_each(|&v| prefer(s, &mut reference, p, q, v)),
                Crossing::Edge([u, v]) => {
                    if let Some(other) = self.of_piece(u, v) {
                        return Err(TetError::EdgeMeets { edge: ends, obstacle: Obstacle::Edge(other) });
                    }
                    prefer(s, &mut reference, p, q, u);
                    prefer(s, &mut reference, p, q, v);
                }
                Crossing::Vertex(v) if !s.is_implicit(v) => {
                    return Err(TetError::EdgeMeets { edge: ends, obstacle: Obstacle::Point(v) });
                }
                Crossing::Vertex(_) | Crossing::Nothing => return Err(stuck(ends, Stuck::Intersection)),
            }
            start = t;
        }
        let Some((_, reference)) = reference else { return Err(stuck(ends, Stuck::Intersection)) };
        let (t0, t1) = (at(p), at(q));
        let t = self.position(s, ends, (p, t0), (q, t1), reference);
        if t <= t0 || t >= t1 {
            return Err(stuck(ends, Stuck::Precision));
        }
        let [a, b] = ends.map(|v| *s.point(v));
        Ok(Some((OnSegment { a, b, t }, start)))
    }

    /// The parameter at which a piece is split because of a reference vertex.
    fn position(&self, s: &Space, ends: [u32; 2], (p, t0): (u32, f64), (q, t1): (u32, f64), r: u32) -> f64 {
        let [a, b] = ends.map(|v| s.point(v));
        let length = (b - a).norm();
        let [acute_a, acute_b] = ends.map(|v| self.acute[v as usize]);
        let from_a = match (acute_a, acute_b) {
            (false, false) => return plain(s, length, (p, t0), (q, t1), r),
            (true, true) if t0 < 0.5 && t1 > 0.5 => return 0.5,
            (true, true) => t1 <= 0.5,
            (x, _) => x,
        };
        // Distances from the acute end: pieces at it end on spheres that all its segments share.
        let (near, far, apex) = if from_a { (t0, t1, a) } else { (1.0 - t1, 1.0 - t0, b) };
        let (near, far) = (near * length, far * length);
        let mut d = (s.point(r) - apex).norm();
        let on_segment = |d: f64| if from_a { a + (b - a) * (d / length) } else { b + (a - b) * (d / length) };
        let gap = (on_segment(d) - s.point(r)).norm();
        if far - d < gap {
            d = if gap < 0.5 * (d - near) { d - gap } else { 0.5 * (near + d) };
        }
        if d <= near || d >= far {
            d = 0.5 * (near + far);
        }
        let t = d / length;
        fit(if from_a { t } else { 1.0 - t }, t0, t1, OnSegment::UNIT)
    }
}

/// For a segment whose ends are not acute: at a third or less from an end that the reference vertex is near, else in
/// the middle.
fn plain(s: &Space, length: f64, (p, t0): (u32, f64), (q, t1): (u32, f64), r: u32) -> f64 {
    let half = 0.5 * (t1 - t0);
    let dp = (s.point(r) - s.point(p)).norm() / length;
    let dq = (s.point(r) - s.point(q)).norm() / length;
    let t = if dp < half {
        t0 + dp
    } else if dq < half {
        t1 - dq
    } else {
        t0 + half
    };
    // Few bits make exact arithmetic short.
    let nearest = (t - t0).min(t1 - t);
    let mut unit = 1.0;
    while unit > nearest / 64.0 && unit > OnSegment::UNIT {
        unit *= 0.5;
    }
    fit(t, t0, t1, unit)
}

/// The multiple of `unit` next to `t` that lies strictly between `t0` and `t1`, if there is one.
fn fit(t: f64, t0: f64, t1: f64, unit: f64) -> f64 {
    let rounded = (t / unit).round() * unit;
    if rounded > t0 && rounded < t1 { rounded } else { ((t0 + t1) / 2.0 / OnSegment::UNIT).round() * OnSegment::UNIT }
}

pub(super) fn stuck(edge: [u32; 2], reason: Stuck) -> TetError {
    TetError::Stuck { part: Obstacle::Edge(edge), reason }
}

/// Keeps the vertex from which `p, q` is seen at the largest angle.
fn prefer(s: &Space, best: &mut Option<(f64, u32)>, p: u32, q: u32, v: u32) {
    let (x, y) = (s.point(p) - s.point(v), s.point(q) - s.point(v));
    let cosine = x.dot(&y) / (x.norm() * y.norm());
    if best.is_none_or(|(c, _)| cosine < c) {
        *best = Some((cosine, v));
    }
}

/// What the piece from `a` towards `b` of the line through `line` meets first, and the tetrahedron at `a` in which.
fn first_crossing(s: &Space, star: &mut Star, a: u32, b: u32, [p, q]: [u32; 2]) -> (Crossing, u32) {
    let tets = star.around(&s.c, a);
    if let Some(&t) = tets.iter().find(|&&t| s.c.slot_of(t, b).is_some()) {
        return (Crossing::Exists, t);
    }
    for &t in tets {
        let Some(i) = s.c.slot_of(t, a) else { continue };
        if s.c.is_ghost(t) {
            continue;
        }
        let f = s.c.face(4 * t + i as u32);
        let mut sides = [0; 3];
        let inside = (0..3).all(|k| {
            sides[k] = s.orient([p, q, f[(k + 1) % 3], f[(k + 2) % 3]]);
            sides[k] >= 0
        });
        if !inside {
            continue;
        }
        // The cone opposite has all signs reversed; only where two vanish the direction has to be looked at.
        let zeros: Vec<usize> = (0..3).filter(|&k| sides[k] == 0).collect();
        match zeros[..] {
            [] => return (Crossing::Face(f), t),
            [k] => return (Crossing::Edge([f[(k + 1) % 3], f[(k + 2) % 3]]), t),
            [k, l] => {
                let v = f[3 - k - l];
                if s.compare(v, a) == s.compare(b, a) {
                    return (Crossing::Vertex(v), t);
                }
            }
            _ => {}
        }
    }
    (Crossing::Nothing, s.c.vertex_tet(a))
}

/// The vertices at which two segments meet at less than 60°.
fn acute_vertices(points: &[Point3], segments: &[(u32, u32)]) -> Vec<bool> {
    let mut sides: Vec<(u32, u32)> = segments.iter().flat_map(|&(a, b)| [(a, b), (b, a)]).collect();
    sides.sort_unstable();
    let mut acute = vec![false; points.len()];
    for run in sides.chunk_by(|x, y| x.0 == y.0) {
        let v = run[0].0 as usize;
        let direction = |w: u32| (points[w as usize] - points[v]).normalize();
        let mut seen: Vec<Vec3> = Vec::new();
        for &(_, w) in run {
            let d = direction(w);
            // Of more than twelve directions two are always this close, so this ends early.
            if seen.iter().any(|e| e.dot(&d) > ACUTE) {
                acute[v] = true;
                break;
            }
            seen.push(d);
        }
    }
    acute
}

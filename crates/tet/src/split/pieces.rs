//! Surface whose triangles are split, and whose flat edges are flipped.

use crate::Tetrahedralization;
use crate::options::Boundary;
use crate::outside::without;
use crate::plc::Plc;
use anastomesh_mesh::geometry::{Aabb, Point3};
use rustc_hash::FxHashMap;

/// Maximum triangles of the split surface.
const MAX_TRIANGLES: usize = 20_000_000;

/// A surface being split.
#[derive(Clone)]
pub(super) struct Pieces {
    pub plc: Plc,
    /// Input triangle of each piece.
    origin: Vec<u32>,
    /// Input segment of each piece.
    segment_origin: Vec<u32>,
    /// Triangles at each edge.
    pub at_edge: FxHashMap<[u32; 2], Vec<u32>>,
    pub segments: FxHashMap<[u32; 2], u32>,
    /// Triangles that were halved or flipped since this list was emptied.
    pub changed: Vec<u32>,
    /// Number of points of the input.
    given_points: usize,
    /// Size of the surface.
    pub extent: f64,
    /// Ends of the input's edge of which a divided crease, and a point on it, is a part.
    line_of_edge: FxHashMap<[u32; 2], [u32; 2]>,
    line_of_point: FxHashMap<u32, [u32; 2]>,
}

/// Key of an edge.
pub(super) fn edge(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

pub(super) fn edges_of(t: [u32; 3]) -> [[u32; 2]; 3] {
    [edge(t[0], t[1]), edge(t[1], t[2]), edge(t[2], t[0])]
}

impl Pieces {
    pub(super) fn new(plc: Plc) -> Self {
        let mut at_edge: FxHashMap<[u32; 2], Vec<u32>> = FxHashMap::default();
        for (i, t) in plc.surface.triangles.iter().enumerate() {
            for e in edges_of(*t) {
                at_edge.entry(e).or_default().push(i as u32);
            }
        }
        let segments = plc.segments.iter().zip(0..).map(|(e, i)| (edge(e[0], e[1]), i)).collect();
        let origin = (0..plc.surface.triangles.len() as u32).collect();
        let segment_origin = (0..plc.segments.len() as u32).collect();
        let bounds = Aabb::of_points(&plc.surface.points);
        let (given_points, extent) = (plc.surface.points.len(), (bounds.max - bounds.min).norm());
        let (changed, line_of_edge, line_of_point) = Default::default();
        Self {
            plc,
            origin,
            segment_origin,
            at_edge,
            segments,
            changed,
            given_points,
            extent,
            line_of_edge,
            line_of_point,
        }
    }

    pub(super) fn length(&self, [a, b]: [u32; 2]) -> f64 {
        (self.plc.surface.points[a as usize] - self.plc.surface.points[b as usize]).norm()
    }

    fn middle(&self, [a, b]: [u32; 2]) -> Point3 {
        nalgebra::center(&self.plc.surface.points[a as usize], &self.plc.surface.points[b as usize])
    }

    /// Point at which an edge is divided: at the middle, or at a power of two from an input vertex on a crease. Creases that
    /// meet at a small angle are then divided at equal distances, so that the refinement ends. These are the concentric shells of
    /// Ruppert, 'A Delaunay refinement algorithm for quality 2-dimensional mesh generation', 1995.
    pub(super) fn dividing(&self, e: [u32; 2]) -> Point3 {
        let Some(&from) = e.iter().find(|&&v| (v as usize) < self.given_points) else { return self.middle(e) };
        let length = self.length(e);
        let distance = libm::exp2(libm::log2(length / 3.0).ceil());
        if self.is_flat(e) || !(distance > 0.0 && distance < length) {
            return self.middle(e);
        }
        let to = if from == e[0] { e[1] } else { e[0] };
        let [from, to] = [from, to].map(|v| self.plc.surface.points[v as usize]);
        from + (to - from) * (distance / length)
    }

    /// Halves an edge and its triangles. An edge too short to have a midpoint stays.
    pub(super) fn halve(&mut self, e: [u32; 2]) -> bool {
        let (middle, is_flat) = (self.dividing(e), self.is_flat(e));
        let ends = e.map(|v| self.plc.surface.points[v as usize]);
        let count = self.at_edge.get(&e).map_or(0, Vec::len);
        let full = self.plc.surface.triangles.len() + count > MAX_TRIANGLES;
        if ends.contains(&middle) || full || (count == 0 && !self.segments.contains_key(&e)) {
            return false;
        }
        let segment = self.segments.remove(&e);
        let triangles = self.at_edge.remove(&e).unwrap_or_default();
        let m = self.plc.surface.points.len() as u32;
        self.plc.surface.points.push(middle);
        let [a, b] = e;
        if !is_flat {
            let line = self.line_of_edge.remove(&e).unwrap_or(e);
            self.line_of_point.insert(m, line);
            self.line_of_edge.extend([(edge(a, m), line), (edge(m, b), line)]);
        }
        if let Some(s) = segment {
            self.plc.segments[s as usize] = [a, m];
            self.segments.insert(edge(a, m), s);
            self.segments.insert(edge(m, b), self.plc.segments.len() as u32);
            self.plc.segments.push([m, b]);
            self.segment_origin.push(self.segment_origin[s as usize]);
        }
        for i in triangles {
            let t = self.plc.surface.triangles[i as usize];
            let new = self.plc.surface.triangles.len() as u32;
            let first = t.map(|v| if v == b { m } else { v });
            let second = t.map(|v| if v == a { m } else { v });
            self.plc.surface.triangles.push(second);
            self.origin.push(self.origin[i as usize]);
            if let Some(&marker) = self.plc.markers.get(i as usize) {
                self.plc.markers.push(marker);
            }
            for e in edges_of(second) {
                self.at_edge.entry(e).or_default().push(new);
            }
            self.changed.push(new);
            self.replace(i, first);
        }
        true
    }

    /// True if a vertex lies on an edge of the input that has a common end with that of a crease.
    pub(super) fn is_beside_line(&self, v: u32, crease: [u32; 2]) -> bool {
        let line = self.line_of_edge.get(&crease).unwrap_or(&crease);
        let own = self.line_of_point.get(&v).copied().unwrap_or([v; 2]);
        own.iter().any(|end| line.contains(end))
    }

    /// Gives a triangle other vertices.
    pub(super) fn replace(&mut self, t: u32, vertices: [u32; 3]) {
        let before = std::mem::replace(&mut self.plc.surface.triangles[t as usize], vertices);
        for old in edges_of(before) {
            if let Some(list) = self.at_edge.get_mut(&old) {
                list.retain(|&x| x != t);
            }
        }
        for e in edges_of(vertices) {
            self.at_edge.entry(e).or_default().push(t);
        }
        self.changed.push(t);
    }

    /// Halves edges until none is much longer than `size` at its midpoint. The longest edge of a triangle goes first,
    /// so that angles do not shrink.
    pub(super) fn split_to(&mut self, size: &dyn Fn(&Point3) -> f64) {
        let mut due: Vec<u32> = (0..self.plc.surface.triangles.len() as u32).collect();
        while !due.is_empty() {
            let mut next = Vec::new();
            for i in due {
                let longest = self.longest(i);
                let wanted = size(&self.middle(longest));
                if wanted > 0.0 && self.length(longest) > Boundary::LONGER * wanted {
                    let touched = self.at_edge.get(&longest).cloned().unwrap_or_default();
                    let first = self.plc.surface.triangles.len() as u32;
                    if self.halve(longest) {
                        next.extend(touched);
                        next.extend(first..self.plc.surface.triangles.len() as u32);
                    }
                }
            }
            next.sort_unstable();
            next.dedup();
            due = next;
        }
    }

    /// Renames pieces to the triangles and segments of the input.
    pub(super) fn name_origins(&self, done: &mut Tetrahedralization) {
        let left_out = &mut done.summary.left_out;
        done.origins = without(&self.origin, &left_out.triangles);
        for (ids, origin) in [(&mut left_out.triangles, &self.origin), (&mut left_out.segments, &self.segment_origin)] {
            for id in ids.iter_mut() {
                *id = origin[*id as usize];
            }
            ids.sort_unstable();
            ids.dedup();
        }
    }

    pub(super) fn longest(&self, triangle: u32) -> [u32; 2] {
        let mut edges = edges_of(self.plc.surface.triangles[triangle as usize]);
        edges.sort_unstable_by(|x, y| self.length(*y).total_cmp(&self.length(*x)).then(x.cmp(y)));
        edges[0]
    }
}

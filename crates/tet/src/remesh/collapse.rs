//! Collapses of short edges.

use super::features::{Freedom, edge};
use super::split::LONG;
use super::surface::{NONE, Surface};
use crate::progress::Counter;
use anastomesh_mesh::budget::Stop;
use anastomesh_mesh::face_key;

/// Relative length below which edges are collapsed (Botsch and Kobbelt 2004).
const SHORT: f64 = 4.0 / 5.0;

/// Angle in radians below which the smallest angle of the triangles around may not fall: 15°.
const LEAST: f64 = 0.26;

/// Operations of a collapse, as counted by budgets.
const OPERATIONS: usize = 100;

impl Surface<'_> {
    /// Collapses edges that are too short, the shortest first. Returns their number.
    ///
    /// # Errors
    /// [`Stop`] if the watch stops it.
    pub fn collapse_short(&mut self, counter: &mut Counter) -> Result<usize, Stop> {
        // A refused collapse stays refused as long as the triangles around both ends stay.
        let is_due = |&[a, b]: &[u32; 2]| self.touched[a as usize].max(self.touched[b as usize]) >= self.collapsed;
        let lengths = self.edges().into_iter().filter(is_due).map(|e| (self.relative_length(e), e));
        let mut short: Vec<(f64, [u32; 2])> = lengths.filter(|(length, _)| *length < SHORT).collect();
        self.pass += 1;
        self.collapsed = self.pass;
        short.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        let mut collapses = 0;
        for (_, [a, b]) in short {
            counter.add(OPERATIONS)?;
            if self.relative_length([a, b]) < SHORT && (self.collapse(a, b, LONG) || self.collapse(b, a, LONG)) {
                collapses += 1;
            }
        }
        Ok(collapses)
    }

    /// Collapses vertex `a` into its neighbour `b` if all checks allow it. New edges are at most `longest` relative lengths.
    pub fn collapse(&mut self, a: u32, b: u32, longest: f64) -> bool {
        let removed = self.at_edge([a, b]);
        if removed.is_empty() || !self.is_contractible(a, b, &removed) {
            return false;
        }
        let line = match self.freedom[a as usize] {
            Freedom::Fixed => return false,
            Freedom::Patch => None,
            Freedom::Line => match self.shorter_line(a, b) {
                Some(line) => Some(line),
                None => return false,
            },
        };
        let old = self.around[a as usize].clone();
        let kept: Vec<u32> = old.iter().copied().filter(|t| !removed.contains(t)).collect();
        let moved = |&t: &u32| (self.triangles[t as usize].map(|v| if v == a { b } else { v }), self.patch[t as usize]);
        let new: Vec<([u32; 3], u32)> = kept.iter().map(moved).collect();
        if new.is_empty() || self.has_duplicate(b, &new, &removed) {
            return false;
        }
        let is_long = |&v: &u32| v != b && self.relative_length([b, v]) > longest.max(self.relative_length([a, v]));
        if new.iter().flat_map(|(t, _)| t).any(is_long) {
            return false;
        }
        let extra = self.given[a as usize];
        let extra = if extra == NONE { &[][..] } else { &[extra] };
        let Some(pieces) = self.plan(&old, &new, extra, self.smallest_angle_of(&old).min(LEAST)) else { return false };
        self.replace(&old, pieces);
        if let Some((c, chain)) = line {
            self.lines.remove(&edge(a, b));
            self.lines.remove(&edge(a, c));
            self.set_chain(c, b, chain);
        }
        true
    }

    /// True if the collapse of an edge keeps the topology: the neighbours that both ends share are those of its triangles.
    fn is_contractible(&self, a: u32, b: u32, at_edge: &[u32]) -> bool {
        let mut apexes: Vec<u32> = at_edge.iter().map(|&t| self.apex(t, [a, b])).collect();
        apexes.sort_unstable();
        let others = self.neighbours(b);
        let shared: Vec<u32> = self.neighbours(a).into_iter().filter(|v| others.binary_search(v).is_ok()).collect();
        shared == apexes
    }

    /// Other end `c` of the line at vertex `a`, and the input points of the edge from `c` to `b` after `a` is removed.
    fn shorter_line(&self, a: u32, b: u32) -> Option<(u32, Vec<u32>)> {
        let after = self.chain(a, b)?;
        let c = self.beyond(a, b)?;
        let mut chain = self.chain(c, a)?;
        if self.given[a as usize] != NONE {
            chain.push(self.given[a as usize]);
        }
        chain.extend(after);
        let ends = [&self.points[c as usize], &self.points[b as usize]];
        let is_edge = self.around[c as usize].iter().any(|&t| self.triangles[t as usize].contains(&b));
        (!is_edge && self.is_near_segment(&chain, ends)).then_some((c, chain))
    }

    /// Vertex on the other side of `a` on the line from `b` through `a`.
    pub fn beyond(&self, a: u32, b: u32) -> Option<u32> {
        self.neighbours(a).into_iter().find(|&v| v != b && self.lines.contains_key(&edge(a, v)))
    }

    /// True if a vertex has one of the new triangles already.
    fn has_duplicate(&self, b: u32, new: &[([u32; 3], u32)], removed: &[u32]) -> bool {
        let kept = self.around[b as usize].iter().filter(|t| !removed.contains(t));
        let keys: Vec<[u32; 3]> = kept.map(|&t| face_key(self.triangles[t as usize])).collect();
        new.iter().any(|(t, _)| keys.contains(&face_key(*t)))
    }
}

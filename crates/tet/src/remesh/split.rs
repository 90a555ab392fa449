//! Splits of long edges.

use super::features::{Freedom, edge};
use super::sizes::GRADING;
use super::surface::{NONE, Surface};
use crate::progress::Counter;
use anastomesh_mesh::budget::Stop;
use anastomesh_mesh::geometry::Point3;

/// Relative length above which edges are split (Botsch and Kobbelt 2004).
pub(super) const LONG: f64 = 4.0 / 3.0;

/// Angle in radians, 5°, and share of the present smallest angle. Splits make no angle that is smaller than both.
const LEAST: f64 = 0.09;
const KEPT: f64 = 0.4;

/// Operations of a split, as counted by budgets.
const OPERATIONS: usize = 50;

impl Surface<'_> {
    /// Splits edges that are too long, the longest first, as long as there are at most `most` triangles. Returns their number.
    ///
    /// # Errors
    /// [`Stop`] if the watch stops it.
    pub fn split_long(&mut self, most: usize, counter: &mut Counter) -> Result<usize, Stop> {
        let mut long: Vec<(f64, [u32; 2])> = self
            .edges()
            .into_iter()
            .map(|e| (self.relative_length(e), e))
            .filter(|(length, _)| *length > LONG)
            .collect();
        long.sort_by(|x, y| y.0.total_cmp(&x.0).then(x.1.cmp(&y.1)));
        let mut splits = 0;
        for (_, edge) in long {
            counter.add(OPERATIONS)?;
            if self.count() < most && self.split(edge).is_some() {
                splits += 1;
            }
        }
        Ok(splits)
    }

    /// Splits an edge near its middle. Returns the new vertex.
    pub fn split(&mut self, [a, b]: [u32; 2]) -> Option<u32> {
        if self.locked.contains(&edge(a, b)) {
            return None;
        }
        let old = self.at_edge([a, b]);
        let middle = nalgebra::center(&self.points[a as usize], &self.points[b as usize]);
        let wanted = self.wanted_at(&middle, [a, b], &old);
        if let Some(chain) = self.chain(a, b) {
            return self.split_line([a, b], &old, &chain, (middle, wanted));
        }
        let m = self.add(middle, Freedom::Patch, NONE, wanted);
        self.split_at([a, b], m, &old).then_some(m)
    }

    /// Edge lengths at a new vertex on an edge: the mean of its ends, graded from all vertices around.
    fn wanted_at(&self, p: &Point3, [a, b]: [u32; 2], triangles: &[u32]) -> [f64; 2] {
        let base = f64::midpoint(self.base[a as usize], self.base[b as usize]);
        let around = triangles.iter().map(|&t| self.apex(t, [a, b])).chain([a, b]);
        let graded = around.map(|v| self.wanted[v as usize] + GRADING * (self.points[v as usize] - p).norm());
        [base, graded.fold(base, f64::min)]
    }

    /// Splits a feature edge at an input point of its line, or at its middle.
    fn split_line(
        &mut self,
        [a, b]: [u32; 2],
        old: &[u32],
        chain: &[u32],
        (middle, wanted): (Point3, [f64; 2]),
    ) -> Option<u32> {
        let input = &self.reference.plc.surface.points;
        let nearest = |i: &usize, j: &usize| {
            let distance = |k: usize| (input[chain[k] as usize] - middle).norm_squared();
            distance(*i).total_cmp(&distance(*j))
        };
        if let Some(k) = (0..chain.len()).min_by(nearest) {
            let m = self.add(input[chain[k] as usize], Freedom::Line, chain[k], wanted);
            let (before, after) = (&chain[..k], &chain[k + 1..]);
            let [p, q, r] = self.corners([a, m, b]);
            let fits = self.is_near_segment(before, [p, q]) && self.is_near_segment(after, [q, r]);
            if fits && self.replace_halves([a, b], m, old, true) {
                self.lines.remove(&edge(a, b));
                self.set_chain(a, m, before.to_vec());
                self.set_chain(m, b, after.to_vec());
                return Some(m);
            }
            self.remove_last();
        }
        let m = self.add(middle, Freedom::Line, NONE, wanted);
        let [p, r] = [a, b].map(|v| self.points[v as usize]);
        let cut =
            chain.iter().take_while(|&&i| (input[i as usize] - p).norm() < (input[i as usize] - r).norm()).count();
        let (before, after) = (chain[..cut].to_vec(), chain[cut..].to_vec());
        if !self.replace_halves([a, b], m, old, false) {
            self.remove_last();
            return None;
        }
        self.lines.remove(&edge(a, b));
        self.set_chain(a, m, before);
        self.set_chain(m, b, after);
        Some(m)
    }

    /// Splits an edge inside a patch at the last vertex, which moves to the input where the checks allow it.
    fn split_at(&mut self, ends: [u32; 2], m: u32, old: &[u32]) -> bool {
        let middle = self.points[m as usize];
        let patch = old.first().map_or(0, |&t| self.patch[t as usize]);
        let hints: Vec<u32> = old.iter().map(|&t| self.near[t as usize]).collect();
        if let Some(normal) = self.normal_at(old)
            && let Some((point, _)) = self.reference.project(&middle, &normal, patch, &hints)
            && point != middle
        {
            self.points[m as usize] = point;
            if self.replace_halves(ends, m, old, true) {
                return true;
            }
            self.points[m as usize] = middle;
        }
        let done = self.replace_halves(ends, m, old, false);
        if !done {
            self.remove_last();
        }
        done
    }

    /// Replaces the triangles at an edge by their halves at the vertex `m`.
    fn replace_halves(&mut self, [a, b]: [u32; 2], m: u32, old: &[u32], is_checked: bool) -> bool {
        let (mut new, mut near) = (Vec::with_capacity(4), Vec::with_capacity(4));
        for &t in old {
            for end in [a, b] {
                let half = self.triangles[t as usize].map(|v| if v == end { m } else { v });
                new.push((half, self.patch[t as usize]));
                near.push(self.near[t as usize]);
            }
        }
        let least = (KEPT * self.smallest_angle_of(old)).min(LEAST);
        let pieces = if is_checked {
            self.plan(old, &new, &[], least)
        } else if new.iter().all(|(t, _)| self.smallest_angle(*t) >= least) {
            self.unchecked(old, &new, &near)
        } else {
            None
        };
        pieces.map(|pieces| self.replace(old, pieces)).is_some()
    }
}

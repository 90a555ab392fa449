//! Relaxation: vertices move along the surface, or along their line, towards the centre of their neighbours.

use super::features::{Freedom, edge, normal_of};
use super::surface::{NONE, Surface};
use crate::progress::Counter;
use anastomesh_mesh::budget::Stop;
use anastomesh_mesh::geometry::{Point3, Vec3};

/// Angle in radians down to which a motion may reduce the smallest angle around: 30°.
const ENOUGH: f64 = 0.52;

/// Minimum motion, relative to the wanted edge length.
const LEAST: f64 = 0.03;

/// Shares of the wanted motion that are tried.
const STEPS: [f64; 2] = [1.0, 0.4];

/// Operations of a motion, as counted by budgets.
const OPERATIONS: usize = 100;

impl Surface<'_> {
    /// Moves all free vertices once, in their order.
    ///
    /// # Errors
    /// [`Stop`] if the watch stops it.
    pub fn relax(&mut self, counter: &mut Counter) -> Result<(), Stop> {
        for v in 0..self.points.len() as u32 {
            counter.add(OPERATIONS)?;
            // A refused motion stays refused as long as the triangles around stay.
            if !std::mem::take(&mut self.is_due[v as usize]) || self.around[v as usize].is_empty() {
                continue;
            }
            match self.freedom[v as usize] {
                Freedom::Patch => self.relax_in_patch(v),
                Freedom::Line => self.slide(v),
                Freedom::Fixed => {}
            }
        }
        Ok(())
    }

    /// Moves a vertex inside a patch towards the centroid of its triangles, weighted by area over the squared wanted length.
    fn relax_in_patch(&mut self, v: u32) {
        let p = self.points[v as usize];
        let (mut normal, mut sum, mut weights) = (Vec3::zeros(), Vec3::zeros(), 0.0);
        for &t in &self.around[v as usize] {
            let corners = self.triangles[t as usize];
            let [a, b, c] = self.corners(corners);
            let double_area = (b - a).cross(&(c - a));
            let size: f64 = corners.iter().map(|&w| self.wanted[w as usize]).sum();
            let weight = double_area.norm() / (size * size).max(f64::MIN_POSITIVE);
            normal += double_area;
            sum += (a.coords + b.coords + c.coords) * (weight / 3.0);
            weights += weight;
        }
        let Some(normal) = normal.try_normalize(0.0).filter(|_| weights > 0.0) else { return };
        let step = sum / weights - p.coords;
        let step = step - normal * step.dot(&normal);
        if step.norm() <= LEAST * self.wanted[v as usize] {
            return;
        }
        let around = &self.around[v as usize];
        let patch = around.first().map_or(0, |&t| self.patch[t as usize]);
        let hints: Vec<u32> = around.iter().map(|&t| self.near[t as usize]).collect();
        for share in STEPS {
            let projected = self.reference.project(&(p + step * share), &normal, patch, &hints);
            if projected.is_some_and(|(point, _)| self.move_to(v, point)) {
                break;
            }
        }
    }

    /// Moves a vertex if its triangles stay near the input and keep their angles.
    fn move_to(&mut self, v: u32, point: Point3) -> bool {
        let old = self.around[v as usize].clone();
        let new: Vec<([u32; 3], u32)> =
            old.iter().map(|&t| (self.triangles[t as usize], self.patch[t as usize])).collect();
        let least = self.smallest_angle_of(&old).min(ENOUGH);
        let given = self.given[v as usize];
        let extra = if given == NONE { &[][..] } else { &[given] };
        let before = std::mem::replace(&mut self.points[v as usize], point);
        let Some(pieces) = self.plan(&old, &new, extra, least) else {
            self.points[v as usize] = before;
            return false;
        };
        self.replace(&old, pieces);
        self.given[v as usize] = NONE;
        true
    }

    /// Moves a vertex along its line, so that the edges to both sides have equal relative lengths.
    fn slide(&mut self, v: u32) {
        let mut ends = self.neighbours(v).into_iter().filter(|&w| self.lines.contains_key(&edge(v, w)));
        let (Some(a), Some(b)) = (ends.next(), ends.next()) else { return };
        let (Some(mut chain), Some(after)) = (self.chain(a, v), self.chain(v, b)) else { return };
        let [before, behind] = [self.relative_length([a, v]), self.relative_length([v, b])];
        let wanted = self.length([a, v]) * (f64::midpoint(before, behind) / before.max(f64::MIN_POSITIVE));
        if (wanted - self.length([a, v])).abs() <= 0.1 * self.wanted[v as usize] {
            return;
        }
        if self.given[v as usize] != NONE {
            chain.push(self.given[v as usize]);
        }
        chain.extend(after);
        let Some((point, cut)) = self.point_on_line([a, b], &chain, wanted) else { return };
        let [p, q] = [a, b].map(|v| self.points[v as usize]);
        let fits =
            self.is_near_segment(&chain[..cut], [&p, &point]) && self.is_near_segment(&chain[cut..], [&point, &q]);
        if fits && self.move_to(v, point) {
            self.set_chain(a, v, chain[..cut].to_vec());
            self.set_chain(v, b, chain[cut..].to_vec());
        }
    }

    /// Point at a length from `a` on the line from `a` through input points to `b`, and the number of points before it.
    fn point_on_line(&self, [a, b]: [u32; 2], chain: &[u32], length: f64) -> Option<(Point3, usize)> {
        let input = &self.reference.plc.surface.points;
        let mut from = self.points[a as usize];
        let mut left = length;
        let ends = chain.iter().map(|&i| input[i as usize]).chain([self.points[b as usize]]);
        for (cut, to) in ends.enumerate() {
            let step = (to - from).norm();
            if left < step {
                return Some((from + (to - from) * (left / step), cut));
            }
            left -= step;
            from = to;
        }
        None
    }

    /// Sum of the unit normals of triangles.
    pub fn normal_at(&self, triangles: &[u32]) -> Option<Vec3> {
        let normals = triangles.iter().map(|&t| normal_of(self.corners(self.triangles[t as usize])));
        normals.sum::<Vec3>().try_normalize(0.0)
    }
}

//! Repair of the worst triangles after the iterations.

use super::features::{Freedom, edge};
use super::surface::Surface;
use crate::progress::Counter;
use anastomesh_mesh::budget::Stop;

/// Smallest angle in radians below which a triangle is repaired: 25°.
const BAD: f64 = 0.44;

/// Maximum relative length of edges that repairs make.
const LONGEST: f64 = 2.0;

/// Operations of a repair, as counted by budgets.
const OPERATIONS: usize = 200;

impl Surface<'_> {
    /// Collapses the shortest edge of triangles with a small angle. If that is not allowed, and the triangle is low above a
    /// feature edge, that edge gets a vertex, and the apex collapses into it. Returns the number of repairs.
    ///
    /// # Errors
    /// [`Stop`] if the watch stops it.
    pub fn mend(&mut self, counter: &mut Counter) -> Result<usize, Stop> {
        let is_bad = |t: &u32| self.is_alive(*t) && self.smallest_angle(self.triangles[*t as usize]) < BAD;
        let bad: Vec<u32> = (0..self.triangles.len() as u32).filter(is_bad).collect();
        let mut repairs = 0;
        for t in bad {
            counter.add(OPERATIONS)?;
            if self.is_alive(t) && self.smallest_angle(self.triangles[t as usize]) < BAD && self.mend_one(t) {
                repairs += 1;
            }
        }
        Ok(repairs)
    }

    fn mend_one(&mut self, t: u32) -> bool {
        let [a, b, c] = self.triangles[t as usize];
        let mut edges = [[a, b], [b, c], [c, a]];
        edges.sort_by(|x, y| self.length(*x).total_cmp(&self.length(*y)));
        let [short, middle, long] = edges;
        if [short, middle].into_iter().any(|[a, b]| self.collapse(a, b, LONGEST) || self.collapse(b, a, LONGEST)) {
            return true;
        }
        let apex = self.apex(t, long);
        let is_low = self.length(short) + self.length(middle) < 1.2 * self.length(long);
        let key = edge(long[0], long[1]);
        if !is_low || self.freedom[apex as usize] != Freedom::Patch || !self.lines.contains_key(&key) {
            return false;
        }
        self.split(long).is_some_and(|m| self.collapse(apex, m, LONGEST))
    }
}

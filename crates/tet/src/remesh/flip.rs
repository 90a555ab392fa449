//! Flips that enlarge the smallest angle.

use super::features::edge;
use super::surface::Surface;
use crate::progress::Counter;
use anastomesh_mesh::budget::Stop;

/// Minimum gain of the smallest angle in radians. Avoids endless flips of cocircular points.
const GAIN: f64 = 1e-6;

/// Maximum flips per edge.
const MAX_FLIPS: usize = 8;

/// Operations of a flip, as counted by budgets.
const OPERATIONS: usize = 20;

impl Surface<'_> {
    /// Flips edges as long as that enlarges the smaller of the smallest angles of their triangles.
    ///
    /// # Errors
    /// [`Stop`] if the watch stops it.
    pub fn flip_all(&mut self, counter: &mut Counter) -> Result<(), Stop> {
        // A refused flip stays refused as long as the two triangles stay.
        let mut edges = self.take_changed_edges();
        let mut left = MAX_FLIPS * edges.len();
        while let Some(edge) = edges.pop() {
            counter.add(OPERATIONS)?;
            if left == 0 {
                break;
            }
            if let Some(outer) = self.flip(edge) {
                left -= 1;
                edges.extend(outer);
            }
        }
        self.changed.clear();
        Ok(())
    }

    /// Flips an edge if that enlarges the smallest angle. Returns the edges of the two triangles.
    fn flip(&mut self, [a, b]: [u32; 2]) -> Option<[[u32; 2]; 4]> {
        let key = edge(a, b);
        if self.lines.contains_key(&key) || self.locked.contains(&key) {
            return None;
        }
        let old = self.at_edge([a, b]);
        let &[t, u] = old.as_slice() else { return None };
        let [first, second] = [t, u].map(|t| self.triangles[t as usize]);
        let (c, d) = (self.apex(t, [a, b]), self.apex(u, [a, b]));
        let least = self.smallest_angle_of(&old) + GAIN;
        if self.smallest_angle([a, c, d]).min(self.smallest_angle([b, c, d])) < least {
            return None;
        }
        let is_edge = self.around[c as usize].iter().any(|&t| self.triangles[t as usize].contains(&d));
        if c == d || is_edge {
            return None;
        }
        let swap = |t: [u32; 3], from: u32, to: u32| t.map(|v| if v == from { to } else { v });
        // The first keeps its side at `a`, the second at `b`.
        let new = [(swap(first, b, d), self.patch[t as usize]), (swap(second, a, c), self.patch[u as usize])];
        let pieces = self.plan(&old, &new, &[], least)?;
        self.replace(&old, pieces);
        Some([edge(a, c), edge(c, b), edge(b, d), edge(d, a)])
    }
}

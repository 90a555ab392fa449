//! A strip of triangles between two loops of vertices (3.2.3, Fig. 6).
//!
//! Merging by angle is optimal for regular rings only; here dynamic programming over both loops finds the strip with
//! the best shapes, which is never worse and does not fold where a strip without folds exists.

use super::shape::triangle_ratio;
use crate::geometry::{Point3, Vec3};

/// Cost of a strip: Σ (radius ratio)⁻³, dominated by its worst triangle.
pub type WeaveCost = f64;

/// A strip of this cost per triangle is taken without looking for a better start: a mean radius ratio of about 0.87.
const GOOD: WeaveCost = 1.5;

/// A folded or degenerate triangle costs this much.
const FOLD: f64 = 1e9;

/// Weaves two loops, both counter-clockwise about `axis`, `upper` on the side to which it points. `center` is a point on
/// the axis between them. Triangles face away from the axis. `None` when every strip folds or a loop has fewer than
/// three vertices.
pub fn weave(
    points: &[Point3],
    lower: &[u32],
    upper: &[u32],
    center: Point3,
    axis: Vec3,
) -> Option<(Vec<[u32; 3]>, WeaveCost)> {
    if lower.len() < 3 || upper.len() < 3 {
        return None;
    }
    let mut strip = Strip { points, lower, upper: upper.to_vec(), center, axis };
    let mut best: Option<(f64, Vec<[u32; 3]>)> = None;
    for start in strip.starts() {
        strip.upper = upper.to_vec();
        strip.upper.rotate_left(start);
        let (cost, triangles) = strip.solve();
        if best.as_ref().is_none_or(|b| cost < b.0) {
            best = Some((cost, triangles));
        }
        if cost < GOOD * (lower.len() + upper.len()) as f64 {
            break;
        }
    }
    best.filter(|b| b.0 < FOLD).map(|(cost, triangles)| (triangles, cost))
}

struct Strip<'a> {
    points: &'a [Point3],
    lower: &'a [u32],
    upper: Vec<u32>,
    center: Point3,
    axis: Vec3,
}

impl Strip<'_> {
    /// Upper vertices that the first lower vertex may be joined to: the nearest ones by angle.
    fn starts(&self) -> Vec<usize> {
        let direction = |v: u32| {
            let d = self.points[v as usize] - self.center;
            (d - self.axis * d.dot(&self.axis)).normalize()
        };
        let a = direction(self.lower[0]);
        let mut order: Vec<usize> = (0..self.upper.len()).collect();
        let closeness: Vec<f64> = self.upper.iter().map(|&v| a.dot(&direction(v))).collect();
        order.sort_by(|&i, &j| closeness[j].total_cmp(&closeness[i]));
        order.truncate(4);
        order
    }

    fn cost(&self, t: [u32; 3]) -> f64 {
        let p = t.map(|v| self.points[v as usize]);
        let normal = (p[1] - p[0]).cross(&(p[2] - p[0]));
        let c = Point3::from((p[0].coords + p[1].coords + p[2].coords) / 3.0) - self.center;
        let radial = c - self.axis * c.dot(&self.axis);
        let cosine = normal.dot(&radial) / (normal.norm() * radial.norm()).max(f64::MIN_POSITIVE);
        let q = triangle_ratio(&p) * (cosine / 0.7).min(1.0);
        if q > 1e-3 { 1.0 / (q * q * q) } else { FOLD }
    }

    /// The cheapest strip that joins the two first vertices: `value[i][j]` is the cost up to the edge from lower `i` to
    /// upper `j`.
    fn solve(&self) -> (f64, Vec<[u32; 3]>) {
        let (n, m) = (self.lower.len(), self.upper.len());
        let width = m + 1;
        let mut value = vec![f64::INFINITY; (n + 1) * width];
        let mut from_lower = vec![false; (n + 1) * width];
        value[0] = 0.0;
        let band = 0.25 + 2.0 / n.min(m) as f64;
        for i in 0..=n {
            for j in 0..=m {
                if (i, j) == (0, 0) || (i as f64 / n as f64 - j as f64 / m as f64).abs() > band {
                    continue;
                }
                let (below, left) = self.triangles(i, j);
                let at = i * width + j;
                if i > 0 && value[at - width].is_finite() {
                    value[at] = value[at - width] + self.cost(below);
                    from_lower[at] = true;
                }
                if j > 0 && value[at - 1].is_finite() {
                    let other = value[at - 1] + self.cost(left);
                    if other < value[at] {
                        value[at] = other;
                        from_lower[at] = false;
                    }
                }
            }
        }
        let (mut i, mut j) = (n, m);
        let mut triangles = Vec::with_capacity(n + m);
        while (i, j) != (0, 0) {
            let (below, left) = self.triangles(i, j);
            if from_lower[i * width + j] && i > 0 {
                triangles.push(below);
                i -= 1;
            } else if j > 0 {
                triangles.push(left);
                j -= 1;
            } else {
                return (f64::INFINITY, triangles);
            }
        }
        triangles.reverse();
        (value[n * width + m], triangles)
    }

    /// The triangles that arrive at state `(i, j)` by a step on the lower and on the upper loop.
    fn triangles(&self, i: usize, j: usize) -> ([u32; 3], [u32; 3]) {
        let (n, m) = (self.lower.len(), self.upper.len());
        let (l, u) = (self.lower[i % n], self.upper[j % m]);
        let (l0, u0) = (self.lower[(i + n - 1) % n], self.upper[(j + m - 1) % m]);
        ([l0, l, u], [l, u, u0])
    }
}

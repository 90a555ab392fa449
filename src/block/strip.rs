//! Strips of a connector's wall: the strip between two loops with the best triangle shapes.

use super::shape::facing_ratio;
use crate::surface::strip::{Step, cheapest};
use anastomesh_mesh::geometry::{Point3, Vec3};

/// Cost of a strip: Σ (radius ratio)⁻³, dominated by its worst triangle.
pub type StripCost = f64;

/// Cost per triangle below which no other start is tried: a mean radius ratio of about 0.87.
const GOOD: StripCost = 1.5;

/// Radius ratio below which a triangle counts as degenerate: its cost would be that of a fold.
const FLATTEST: f64 = 1e-3;

/// Cost of a folded or degenerate triangle, above that of any valid strip.
const FOLD: f64 = 1e9;

/// Joins two loops, both counter-clockwise about `axis`, with `upper` on the side to which it points. `center` is a
/// point on the axis between them. Triangles face away from the axis. Returns `None` if every strip folds or a loop has
/// fewer than three vertices.
pub fn best_strip(
    points: &[Point3],
    lower: &[u32],
    upper: &[u32],
    center: Point3,
    axis: Vec3,
) -> Option<(Vec<[u32; 3]>, StripCost)> {
    if lower.len() < 3 || upper.len() < 3 {
        return None;
    }
    let strip = Strip { points, lower, upper, center, axis };
    let sizes = [lower.len(), upper.len()];
    let band = 0.25 + 2.0 / lower.len().min(upper.len()) as f64;
    let mut best: Option<(f64, Vec<Step>)> = None;
    for start in strip.starts() {
        let Some(found) = cheapest(sizes, start, band, |step| strip.cost(step)) else { continue };
        let good = found.0 < GOOD * (lower.len() + upper.len()) as f64;
        if best.as_ref().is_none_or(|b| found.0 < b.0) {
            best = Some(found);
        }
        if good {
            break;
        }
    }
    let (cost, steps) = best.filter(|b| b.0 < FOLD)?;
    Some((steps.iter().map(|step| step.triangle(lower, upper)).collect(), cost))
}

struct Strip<'a> {
    points: &'a [Point3],
    lower: &'a [u32],
    upper: &'a [u32],
    center: Point3,
    axis: Vec3,
}

impl Strip<'_> {
    /// Candidate partners of the first lower vertex: the nearest upper vertices by angle.
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

    fn cost(&self, step: Step) -> f64 {
        let p = step.triangle(self.lower, self.upper).map(|v| self.points[v as usize]);
        let c = Point3::from((p[0].coords + p[1].coords + p[2].coords) / 3.0) - self.center;
        let radial = c - self.axis * c.dot(&self.axis);
        let q = facing_ratio(&p, &radial);
        if q > FLATTEST { 1.0 / (q * q * q) } else { FOLD }
    }
}

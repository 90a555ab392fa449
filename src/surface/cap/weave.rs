//! Strip between the ragged end of a wall and the ring of a cap.

use crate::surface::strip::{Step, cheapest};
use anastomesh_mesh::geometry::{Point3, Vec3};

/// Maximum offset of the first rung from the nearest upper vertex, in steps of the upper loop.
const SPREAD: usize = 2;
/// Cost of an inverted triangle.
const INVERTED: f64 = 1e6;

/// Returns the strip between two closed loops, both counter-clockwise about the `axis` through `center`. Triangles face
/// away from the axis if the upper loop is further along it. Empty if a loop has fewer than three points.
pub(crate) fn weave(low: &[Point3], high: &[Point3], center: &Point3, axis: &Vec3) -> Vec<Step> {
    let (n, m) = (low.len(), high.len());
    if n < 3 || m < 3 {
        return Vec::new();
    }
    // Some rung starts at low[0]: try the nearest upper points.
    let distance = |j: usize| (high[j] - low[0]).norm_squared();
    let nearest = (0..m).min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
    let spread = SPREAD.min((m - 1) / 2);
    // Each triangle is needed once per first rung, so all costs are computed beforehand.
    let of = |step: Step| badness(step, low, high, center, axis);
    let along_low: Vec<f64> =
        (0..n * m).map(|k| of(Step::Low { from: k / m, to: (k / m + 1) % n, apex: k % m })).collect();
    let along_high: Vec<f64> =
        (0..n * m).map(|k| of(Step::High { from: k % m, to: (k % m + 1) % m, apex: k / m })).collect();
    let cost = |step: Step| match step {
        Step::Low { from, apex, .. } => along_low[from * m + apex],
        Step::High { from, apex, .. } => along_high[apex * m + from],
    };
    let mut best: Option<(f64, Vec<Step>)> = None;
    for k in 0..=2 * spread {
        let first = (nearest + m + k - spread) % m;
        if let Some(found) = cheapest([n, m], first, f64::INFINITY, cost)
            && best.as_ref().is_none_or(|b| found.0 < b.0)
        {
            best = Some(found);
        }
    }
    best.map_or_else(Vec::new, |(_, steps)| steps)
}

/// Cost of a triangle: 1 if equilateral, large for slivers and for triangles whose loop edge runs backwards. The
/// outward normal is the tangent times `rise`, the vector from the lower to the upper loop.
fn badness(step: Step, low: &[Point3], high: &[Point3], center: &Point3, axis: &Vec3) -> f64 {
    let [a, b, c] = step.triangle(low, high);
    let rise = match step {
        Step::Low { from, to, apex } => high[apex] - nalgebra::center(&low[from], &low[to]),
        Step::High { from, to, apex } => nalgebra::center(&high[from], &high[to]) - low[apex],
    };
    let normal = (b - a).cross(&(c - a));
    let lengths = (b - a).norm_squared() + (c - b).norm_squared() + (a - c).norm_squared();
    let tangent = axis.cross(&((a - center) + (b - center) + (c - center)));
    let outside = tangent.cross(&rise);
    let area = normal.norm();
    let shape = lengths / (2.0 * 3f64.sqrt() * area).max(1e-9 * lengths);
    if normal.dot(&outside) <= 0.05 * area * outside.norm() { INVERTED + shape } else { shape * shape }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(n: usize, z: f64, phase: f64) -> Vec<Point3> {
        (0..n)
            .map(|i| {
                let t = std::f64::consts::TAU * (i as f64 + phase) / n as f64;
                Point3::new(libm::cos(t), libm::sin(t), z)
            })
            .collect()
    }

    #[test]
    fn a_strip_looks_outwards() {
        for (n, m, phase) in [(10, 10, 0.3), (3, 12, 0.0), (17, 9, 0.9), (40, 50, 0.5)] {
            let (low, high) = (ring(n, 0.0, 0.0), ring(m, 0.4, phase));
            let strip = weave(&low, &high, &Point3::origin(), &Vec3::z());
            assert_eq!(strip.len(), n + m);
            for step in &strip {
                let [a, b, c] = step.triangle(&low, &high);
                let normal = (b - a).cross(&(c - a));
                assert!(normal.x * (a.x + b.x + c.x) + normal.y * (a.y + b.y + c.y) > 0.0);
            }
        }
    }
}

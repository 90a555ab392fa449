//! The triangle strip between two loops, by dynamic programming: of all strips the one with the least sum of badness.

use crate::geometry::{Point3, Vec3};

/// A strip triangle: corners are indices into the lower loop (`Low`) or the upper one (`High`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Corner {
    /// Index into the lower loop.
    Low(u32),
    /// Index into the upper loop.
    High(u32),
}

/// How far, in steps of the upper loop, the first rung may be from the nearest one.
const SPREAD: usize = 2;
/// Badness of a triangle that is turned over.
const INVERTED: f64 = 1e6;

/// The strip between two closed loops, both counter-clockwise about the `axis` through `center`; where the upper loop is
/// further along the axis, triangles look away from it. Empty when a loop has less than three points.
pub(crate) fn weave(low: &[Point3], high: &[Point3], center: &Point3, axis: &Vec3) -> Vec<[Corner; 3]> {
    let (n, m) = (low.len(), high.len());
    if n < 3 || m < 3 {
        return Vec::new();
    }
    // Some rung starts at low[0]: try the upper points nearest to it.
    let distance = |j: usize| (high[j] - low[0]).norm_squared();
    let nearest = (0..m).min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap_or(0);
    let mut best: Option<(f64, usize, Vec<bool>)> = None;
    for k in 0..=2 * SPREAD.min((m - 1) / 2) {
        let first = (nearest + m + k - SPREAD.min((m - 1) / 2)) % m;
        let (cost, steps) = cheapest(low, high, first, center, axis);
        if best.as_ref().is_none_or(|b| cost < b.0) {
            best = Some((cost, first, steps));
        }
    }
    let Some((_, first, steps)) = best else { return Vec::new() };
    let (mut i, mut j) = (0, 0);
    let mut strip = Vec::with_capacity(n + m);
    for on_low in steps {
        let (l, h) = (Corner::Low((i % n) as u32), Corner::High(((first + j) % m) as u32));
        if on_low {
            strip.push([l, Corner::Low(((i + 1) % n) as u32), h]);
            i += 1;
        } else {
            strip.push([Corner::High(((first + j + 1) % m) as u32), h, l]);
            j += 1;
        }
    }
    strip
}

/// Cost and steps (true: along the lower loop) of the best strip whose first rung joins low[0] and high[first].
fn cheapest(low: &[Point3], high: &[Point3], first: usize, center: &Point3, axis: &Vec3) -> (f64, Vec<bool>) {
    let (n, m) = (low.len(), high.len());
    let (l, h) = (|i: usize| &low[i % n], |j: usize| &high[(first + j) % m]);
    let at = |i: usize, j: usize| i * (m + 1) + j;
    let mut cost = vec![f64::INFINITY; (n + 1) * (m + 1)];
    let mut by_low = vec![false; cost.len()];
    cost[0] = 0.0;
    for i in 0..=n {
        for j in 0..=m {
            let here = cost[at(i, j)];
            if i < n {
                let c = here + badness([l(i), l(i + 1), h(j)], h(j) - nalgebra::center(l(i), l(i + 1)), center, axis);
                if c < cost[at(i + 1, j)] {
                    cost[at(i + 1, j)] = c;
                    by_low[at(i + 1, j)] = true;
                }
            }
            if j < m {
                let c = here + badness([h(j + 1), h(j), l(i)], nalgebra::center(h(j), h(j + 1)) - l(i), center, axis);
                if c < cost[at(i, j + 1)] {
                    cost[at(i, j + 1)] = c;
                    by_low[at(i, j + 1)] = false;
                }
            }
        }
    }
    let mut steps = Vec::with_capacity(n + m);
    let (mut i, mut j) = (n, m);
    while i + j > 0 {
        let low_step = by_low[at(i, j)];
        steps.push(low_step);
        if low_step { i -= 1 } else { j -= 1 }
    }
    steps.reverse();
    (cost[at(n, m)], steps)
}

/// One for an equilateral triangle, large for slivers and for those whose loop edge runs backwards round the axis:
/// the strip's outside is that of the tangent times `rise`, the way from the lower loop to the upper one.
fn badness([a, b, c]: [&Point3; 3], rise: Vec3, center: &Point3, axis: &Vec3) -> f64 {
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
                Point3::new(t.cos(), t.sin(), z)
            })
            .collect()
    }

    #[test]
    fn a_strip_uses_every_loop_edge_once_and_looks_outwards() {
        for (n, m, phase) in [(10, 10, 0.3), (3, 12, 0.0), (17, 9, 0.9), (40, 50, 0.5)] {
            let (low, high) = (ring(n, 0.0, 0.0), ring(m, 0.4, phase));
            let strip = weave(&low, &high, &Point3::origin(), &Vec3::z());
            assert_eq!(strip.len(), n + m);
            let point = |c: Corner| match c {
                Corner::Low(i) => low[i as usize],
                Corner::High(j) => high[j as usize],
            };
            let mut edges = std::collections::HashMap::new();
            for t in &strip {
                let [a, b, c] = t.map(point);
                let normal = (b - a).cross(&(c - a));
                assert!(normal.x * (a.x + b.x + c.x) + normal.y * (a.y + b.y + c.y) > 0.0);
                for i in 0..3 {
                    *edges.entry(format!("{:?}{:?}", t[i], t[(i + 1) % 3])).or_insert(0) += 1;
                }
            }
            for i in 0..n as u32 {
                assert_eq!(edges[&format!("{:?}{:?}", Corner::Low(i), Corner::Low((i + 1) % n as u32))], 1);
            }
            for j in 0..m as u32 {
                assert_eq!(edges[&format!("{:?}{:?}", Corner::High((j + 1) % m as u32), Corner::High(j))], 1);
            }
        }
    }
}

//! Regular part of a connector: rings of vertices between two rims.
//!
//! The ring next to a rim has vertices at the mid-angles of the rim and follows its height and radius. From ring to
//! ring, angles become even, and height and radius approach those of the vessel. The seam triangles are thus as good as
//! the rim permits, and irregularities decay within two or three rings.

use super::path::AxisPath;
use anastomesh_mesh::geometry::turn;
use std::f64::consts::TAU;

/// Rim in path coordinates: arc length, angle (increasing), distance from the axis.
#[derive(Clone, Debug)]
pub(super) struct Rim {
    pub s: Vec<f64>,
    pub theta: Vec<f64>,
    pub distance: Vec<f64>,
    /// Mean arc length.
    pub level: f64,
}

impl Rim {
    /// Creates a rim from (arc length, angle, distance) of its vertices, in order around the axis.
    pub(super) fn new(vertices: &[(f64, f64, f64)]) -> Self {
        let mut theta = Vec::with_capacity(vertices.len());
        let mut at = vertices.first().map_or(0.0, |v| v.1);
        for v in vertices {
            at += turn(v.1 - at);
            theta.push(at);
        }
        let s: Vec<f64> = vertices.iter().map(|v| v.0).collect();
        let level = s.iter().sum::<f64>() / s.len().max(1) as f64;
        Self { s, theta, distance: vertices.iter().map(|v| v.2).collect(), level }
    }

    pub(super) fn len(&self) -> usize {
        self.theta.len()
    }

    /// Height above the rim's mean and distance from the axis at an angle, linear between vertices.
    pub(super) fn at(&self, theta: f64) -> (f64, f64) {
        let n = self.len();
        // First edge whose angles enclose `theta`; a non-monotone rim may have several.
        for i in 0..n {
            let j = (i + 1) % n;
            let (span, here) = (turn(self.theta[j] - self.theta[i]), turn(theta - self.theta[i]));
            if span > 0.0 && here >= 0.0 && here <= span {
                let t = here / span;
                let s = self.s[i] + t * (self.s[j] - self.s[i]);
                return (s - self.level, self.distance[i] + t * (self.distance[j] - self.distance[i]));
            }
        }
        (0.0, self.distance.iter().sum::<f64>() / n as f64)
    }
}

/// Ring vertex: arc length, angle and distance from the axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct RingVertex {
    pub s: f64,
    pub theta: f64,
    pub distance: f64,
}

/// Decay per ring of a rim's height and distance deviations.
const DECAY_HEIGHT: f64 = 0.45;
const DECAY_DISTANCE: f64 = 0.4;
/// Ratio of axial to angular step for equilateral triangles.
pub(super) const EQUILATERAL: f64 = 0.866_025_403_784_438_6;
/// Minimum thickness of a strip relative to the axial step, where the rims are closest.
const THINNEST: f64 = 0.45;

/// Number of triangle strips between two rims, at least 1; `density` > 1 increases it.
pub(super) fn strip_count(path: &AxisPath, rims: [&Rim; 2], density: f64) -> usize {
    let step = axial_step(path, rims);
    let width = rims[1].level - rims[0].level;
    let mut narrowest = f64::MAX;
    for k in 0..48 {
        let theta = TAU * f64::from(k) / 48.0;
        narrowest = narrowest.min(width + rims[1].at(theta).0 - rims[0].at(theta).0);
    }
    let most = (narrowest / (THINNEST * step)).floor().max(1.0);
    (width / step * density).round().clamp(1.0, most.min(100_000.0)) as usize
}

/// Axial step for equilateral triangles, from the mean angular step of the rims.
fn axial_step(path: &AxisPath, rims: [&Rim; 2]) -> f64 {
    let edge = |rim: &Rim, s: f64| TAU * path.at(s).radius / rim.len() as f64;
    EQUILATERAL * 0.5 * (edge(rims[0], 0.0) + edge(rims[1], path.length()))
}

/// The `strips − 1` rings of a connector with `strips` strips, from the first rim to the second.
pub(super) fn rings(path: &AxisPath, rims: [&Rim; 2], strips: usize) -> Vec<Vec<RingVertex>> {
    let count = strips.saturating_sub(1);
    let sizes: Vec<usize> = (0..count).map(|k| ring_size(rims, k, count)).collect();
    let forward = angles(&rims[0].theta, sizes.iter().copied());
    let mut backward = angles(&rims[1].theta, sizes.iter().rev().copied());
    backward.reverse();
    (0..count)
        .map(|k| {
            let t = (k + 1) as f64 / strips as f64;
            let weight = if count == 1 { 0.5 } else { smooth_step(k as f64 / (count - 1) as f64) };
            let theta = blend(&forward[k], &backward[k], weight);
            theta.into_iter().map(|theta| place(path, rims, sizes[k], k, count, t, theta)).collect()
        })
        .collect()
}

/// Vertex count of ring `k` of `count`: those of the rims next to them, linear in between.
fn ring_size(rims: [&Rim; 2], k: usize, count: usize) -> usize {
    let (a, b) = (rims[0].len() as f64, rims[1].len() as f64);
    let t = if count > 1 { k as f64 / (count - 1) as f64 } else { 0.5 };
    ((a + (b - a) * t).round() as usize).max(5)
}

fn smooth_step(t: f64) -> f64 {
    t * t * (3.0 - 2.0 * t)
}

/// Angles of successive rings, each at the mid-angles of the previous one (resampled if the count changes).
fn angles(first: &[f64], sizes: impl Iterator<Item = usize>) -> Vec<Vec<f64>> {
    let mut last = first.to_vec();
    let mut out = Vec::new();
    for m in sizes {
        let n = last.len();
        let at = |x: f64| {
            let i = x.floor();
            let (lap, k) = ((i / n as f64).floor(), (i as usize) % n);
            let here = last[k] + lap * TAU;
            let next = if k + 1 < n { last[k + 1] + lap * TAU } else { last[0] + (lap + 1.0) * TAU };
            here + (x - i) * (next - here)
        };
        let next: Vec<f64> = (0..m).map(|i| at((i as f64 + 0.5) * n as f64 / m as f64)).collect();
        last.clone_from(&next);
        out.push(next);
    }
    out
}

/// Interpolates the angles of two rings of equal size after the best rotational match.
fn blend(a: &[f64], b: &[f64], weight: f64) -> Vec<f64> {
    let m = a.len();
    let distance = |o: usize| -> f64 { (0..m).map(|i| turn(b[(i + o) % m] - a[i]).powi(2)).sum() };
    let offset = (0..m).min_by(|&x, &y| distance(x).total_cmp(&distance(y))).unwrap_or(0);
    (0..m).map(|i| a[i] + weight * turn(b[(i + offset) % m] - a[i])).collect()
}

fn place(path: &AxisPath, rims: [&Rim; 2], size: usize, k: usize, count: usize, t: f64, theta: f64) -> RingVertex {
    let level = rims[0].level + (rims[1].level - rims[0].level) * t;
    let radius = path.at(level).radius * chord_factor(size);
    let (mut s, mut scale) = (level, 1.0);
    for (rim, from, end) in [(rims[0], k + 1, 0.0), (rims[1], count - k, path.length())] {
        let (height, distance) = rim.at(theta);
        let there = path.at(end).radius * chord_factor(rim.len());
        let bulge = (distance / there - 1.0).clamp(-0.3, 0.3);
        s += height * DECAY_HEIGHT.powi(from as i32);
        scale += bulge * DECAY_DISTANCE.powi(from as i32);
    }
    RingVertex { s, theta, distance: radius * scale }
}

/// Factor on the radius of staggered rings of `size` vertices for which the tube has the volume of the round one. It is
/// 1 + h²/(16 r²) with the chord h = 2πr/size, to second order.
pub(super) fn chord_factor(size: usize) -> f64 {
    let x = TAU / size.max(3) as f64;
    1.0 + x * x / 16.0
}

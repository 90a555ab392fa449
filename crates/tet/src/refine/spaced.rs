//! Selection of points whose distances are in proportion to a graded length.
//!
//! Points are taken by ascending length. Each excludes others within a share of its length. (Bridson, 'Fast Poisson disk
//! sampling in arbitrary dimensions', 2007, with candidates from a lattice.) An octree balanced 2:1 grows by at most a
//! fifth per layer, however fast lengths may grow. A selection of its points follows any length.

use super::grading::Grading;
use anastomesh_mesh::geometry::hilbert::hilbert_keys;
use anastomesh_mesh::geometry::{Point3, Vec3};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

/// Minimum distance of points, relative to the length at the finer one. Their mean edge has about that length then.
const SPACING: f64 = 0.8;

/// Maximum increase of lengths per distance. It bounds the levels that are searched, to 11.
const MAX_SLOPE: f64 = 1000.0;

/// A point with the radius around it that others keep clear of.
#[derive(Clone, Copy, Debug)]
struct Ball {
    center: Point3,
    radius: f64,
}

/// Selected balls in grids of cubes. A level has cubes of side `2^level`, at least twice the radius of its balls.
#[derive(Default)]
struct Balls {
    list: Vec<Ball>,
    /// Previous ball in the same cube; `u32::MAX` without one.
    previous: Vec<u32>,
    /// Last ball of each cube.
    last: FxHashMap<(i32, [i32; 3]), u32>,
}

/// Level of balls with a radius.
fn level_of(radius: f64) -> i32 {
    libm::log2(2.0 * radius).ceil() as i32
}

fn cube_of(p: &Point3, level: i32) -> [i32; 3] {
    let side = libm::exp2(f64::from(level));
    [p.x, p.y, p.z].map(|x| (x / side).floor() as i32)
}

impl Balls {
    fn insert(&mut self, ball: Ball) {
        let level = level_of(ball.radius);
        let last = self.last.entry((level, cube_of(&ball.center, level))).or_insert(u32::MAX);
        self.previous.push(*last);
        *last = self.list.len() as u32;
        self.list.push(ball);
    }

    /// True if a ball of one of these levels contains a point.
    fn contain(&self, p: &Point3, levels: std::ops::RangeInclusive<i32>) -> bool {
        levels.into_iter().any(|level| {
            let quarter = 0.5 * libm::exp2(f64::from(level));
            // Balls reach half a side, so that two cubes per axis suffice.
            let low = cube_of(&(p - Vec3::repeat(quarter)), level);
            (0..8).any(|n| {
                let cube = [low[0] + (n & 1), low[1] + ((n >> 1) & 1), low[2] + (n >> 2)];
                self.contains_in((level, cube), p)
            })
        })
    }

    fn contains_in(&self, cube: (i32, [i32; 3]), p: &Point3) -> bool {
        let mut next = self.last.get(&cube).copied().unwrap_or(u32::MAX);
        while let Some(ball) = self.list.get(next as usize) {
            if (ball.center - p).norm_squared() < ball.radius * ball.radius {
                return true;
            }
            next = self.previous[next as usize];
        }
        false
    }
}

/// Points of a lattice that are as far apart as the lengths of a grading ask. The lattice should be finer.
pub fn spaced_points(points: &[Point3], grading: &Grading) -> Vec<Point3> {
    spaced_after(&[], points, grading)
}

/// As [`spaced_points`]; all points of the first list are tried before those of the second.
pub fn spaced_after(first: &[Point3], second: &[Point3], grading: &Grading) -> Vec<Point3> {
    let points = [first, second].concat();
    let is_second = |i: u32| i as usize >= first.len();
    let from = points.first().map_or_else(Point3::origin, |p| *p);
    // Cube indices count from a point of the lattice.
    let local = |p: &Point3| Point3::from(p - from);
    let mut order: Vec<(f64, u32)> = grading.along(&points).into_iter().zip(0..).collect();
    order
        .par_sort_unstable_by(|a, b| is_second(a.1).cmp(&is_second(b.1)).then(a.0.total_cmp(&b.0)).then(a.1.cmp(&b.1)));
    let steepest = 1.0 + SPACING * grading.slope().min(MAX_SLOPE);
    let mut taken = Balls::default();
    let mut kept = Vec::new();
    for (length, i) in order {
        let p = &points[i as usize];
        let center = local(p);
        let radius = SPACING * length;
        // Balls around a point have lengths up to its own, except those of the first list, and not much smaller.
        let largest = if is_second(i) && !first.is_empty() { radius * steepest } else { radius };
        let levels = level_of(radius / steepest)..=level_of(largest);
        if !taken.contain(&center, levels) {
            taken.insert(Ball { center, radius });
            kept.push(i);
        }
    }
    // Neighbours in space are near in memory, for all later steps.
    let places = || kept.iter().map(|&i| points[i as usize]);
    let mut keyed: Vec<(u64, u32)> = hilbert_keys(places()).zip(kept.iter().copied()).collect();
    keyed.par_sort_unstable();
    keyed.into_iter().map(|(_, i)| points[i as usize]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_as_far_apart_as_lengths_ask() {
        let grading = Grading::new([(&[Point3::origin()][..], &[0.1][..])], 0.4, 0.3);
        let at = |i: u32| f64::from(i) / 20.0 - 0.5;
        let lattice: Vec<Point3> = (0..8000).map(|n| Point3::new(at(n % 20), at(n / 20 % 20), at(n / 400))).collect();
        let kept = spaced_points(&lattice, &grading);
        for (i, p) in kept.iter().enumerate() {
            let near = |q: &&Point3| (*q - p).norm() < SPACING * grading.at(p).min(grading.at(q));
            assert!(!kept[..i].iter().any(|q| near(&q)), "{p}");
        }
        // No point of the lattice is free.
        let covers = |p: &Point3, q: &Point3| (p - q).norm() < SPACING * grading.at(p);
        assert!(lattice.iter().all(|q| kept.iter().any(|p| covers(p, q))));
        assert!(kept.len() * 5 < lattice.len() && kept.len() > 50, "{}", kept.len());
    }
}

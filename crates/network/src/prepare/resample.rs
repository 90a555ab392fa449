//! Resampling of polylines to the points that their shape needs.
//!
//! The remaining points of a branch define straight tapering tubes. Every omitted point lies within a fraction of its
//! radius from the chord (and so does the axis, as a tube is convex). Its radius is within a fraction of the chord's
//! radius. Chords are found by doubling and bisection, in O(n log n) for any chord length. Noise of dense points can be
//! smoothed first, by half of the tolerance; errors are relative to the given points.

use super::smooth::smoothed;
use anastomesh_mesh::geometry::{Point3, point_segment};
use anastomesh_skeleton::{Branch, Edge, NodeId, Skeleton, SkeletonError, clean};
use rustc_hash::FxHashSet;
use serde::Serialize;

/// Fraction of the tolerances available for smoothing.
const FOR_NOISE: f64 = 0.5;

/// Report of the resampling.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ResampleReport {
    /// Node count before.
    pub before: usize,
    /// Node count after.
    pub after: usize,
    /// Maximum distance of a given point from the new axis, in radii.
    pub furthest: f64,
    /// Maximum relative difference of a radius.
    pub radius: f64,
}

/// Resamples all branches, with or without smoothing.
pub(super) fn resample(
    skeleton: &Skeleton,
    axis: f64,
    radius: f64,
    smooth: bool,
) -> Result<(Skeleton, ResampleReport), SkeletonError> {
    let share = if smooth { FOR_NOISE } else { 0.0 };
    let branches = skeleton.branches(&skeleton.adjacency());
    let mut report = ResampleReport { before: skeleton.nodes.len(), ..ResampleReport::default() };
    let (mut nodes, mut edges) = (skeleton.nodes.clone(), Vec::new());
    let mut joined: FxHashSet<[NodeId; 2]> = FxHashSet::default();
    for branch in &branches.list {
        let line = SmoothedBranch::new(skeleton, branch, [share * axis, share * radius]);
        let mut stay = line.simplified([axis, radius]);
        if branch.is_closed() {
            stay = at_least(stay, branch.nodes.len(), 4);
        } else if stay.len() == 2 {
            let [a, b] = branch.ends();
            if !joined.insert([a.min(b), a.max(b)]) {
                // Two vessels connect the same two branch points.
                stay = at_least(stay, branch.nodes.len(), 3);
            }
        }
        for ends in stay.windows(2) {
            let worst = line.worst(ends[0], ends[1]);
            report.furthest = report.furthest.max(worst[0]);
            report.radius = report.radius.max(worst[1]);
            edges.push(Edge {
                nodes: [branch.nodes[ends[0]], branch.nodes[ends[1]]],
                radii: [line.radii[ends[0]], line.radii[ends[1]]],
            });
        }
        for &at in &stay[1..stay.len() - 1] {
            let node = &mut nodes[branch.nodes[at].index()];
            node.position = line.points[at];
            node.radius = line.radii[at];
        }
    }
    let (result, _) = clean(&Skeleton { nodes, edges })?;
    report.after = result.nodes.len();
    Ok((result, report))
}

/// Adds evenly numbered points until `count` remain; returns all points if there are fewer.
fn at_least(stay: Vec<usize>, points: usize, count: usize) -> Vec<usize> {
    if stay.len() >= count || points < count {
        return if stay.len() >= count { stay } else { (0..points).collect() };
    }
    let mut more: Vec<usize> = (0..count).map(|i| i * (points - 1) / (count - 1)).chain(stay).collect();
    more.sort_unstable();
    more.dedup();
    more
}

/// Given and smoothed points of a branch.
struct SmoothedBranch {
    given: Vec<Point3>,
    given_radii: Vec<f64>,
    points: Vec<Point3>,
    radii: Vec<f64>,
}

impl SmoothedBranch {
    fn new(skeleton: &Skeleton, branch: &Branch, noise: [f64; 2]) -> Self {
        let given: Vec<Point3> = branch.nodes.iter().map(|&n| skeleton.node(n).position).collect();
        let mut given_radii: Vec<f64> = branch.tubes(skeleton).map(|t| t.ra).collect();
        given_radii.extend(branch.tubes(skeleton).last().map(|t| t.rb));
        let (points, radii) = smoothed(&given, &given_radii, noise);
        Self { given, given_radii, points, radii }
    }

    /// Maximum error of a chord between two points: distance of given points in radii, and relative radius error.
    fn worst(&self, a: usize, b: usize) -> [f64; 2] {
        let mut worst = [0.0_f64; 2];
        for i in a..=b {
            let [off, radius] = self.off(a, b, i);
            worst = [worst[0].max(off), worst[1].max(radius)];
        }
        worst
    }

    fn off(&self, a: usize, b: usize, i: usize) -> [f64; 2] {
        let (t, distance) = point_segment(&self.given[i], &self.points[a], &self.points[b]);
        let radius = self.radii[a] + (self.radii[b] - self.radii[a]) * t;
        [distance / self.given_radii[i], (radius - self.given_radii[i]).abs() / self.given_radii[i]]
    }

    fn follows(&self, a: usize, b: usize, bounds: [f64; 2]) -> bool {
        let within = |i: usize| {
            let off = self.off(a, b, i);
            off[0] <= bounds[0] && off[1] <= bounds[1]
        };
        self.points[a] != self.points[b] && (a..=b).all(within)
    }

    /// Indices of the remaining points, including the ends.
    fn simplified(&self, bounds: [f64; 2]) -> Vec<usize> {
        let last = self.points.len() - 1;
        let mut stay = vec![0];
        let mut at = 0;
        while at < last {
            let (mut good, mut step) = (at + 1, 2);
            let mut bad = last + 1;
            while good < last && bad > last {
                let next = (at + step).min(last);
                if self.follows(at, next, bounds) {
                    good = next;
                    step *= 2;
                } else {
                    bad = next;
                }
            }
            while good + 1 < bad && bad <= last {
                let middle = good.midpoint(bad);
                if self.follows(at, middle, bounds) {
                    good = middle;
                } else {
                    bad = middle;
                }
            }
            stay.push(good);
            at = good;
        }
        stay
    }
}

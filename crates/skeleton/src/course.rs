//! Axis of a branch by arc length, and its direction at cut planes.

use super::{Branch, Chains, Skeleton};
use anastomesh_mesh::geometry::{Point3, Section, Tube, Vec3};

/// Direction along a branch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Towards larger arc lengths: out of the piece at side 0 of a cut.
    Onward,
    /// Towards smaller arc lengths: out of the piece at side 1 of a cut.
    Back,
}

impl Way {
    /// Outward directions of a piece of a branch, at its start and at its end.
    pub const BOTH: [Self; 2] = [Self::Back, Self::Onward];

    /// +1 or −1.
    pub fn sign(self) -> f64 {
        match self {
            Way::Onward => 1.0,
            Way::Back => -1.0,
        }
    }

    /// Side of a cut whose cluster has its plane in this direction.
    pub fn side(self) -> usize {
        match self {
            Way::Onward => 0,
            Way::Back => 1,
        }
    }

    /// Index of the end of a piece in this direction.
    pub fn end_index(self) -> usize {
        match self {
            Way::Onward => 1,
            Way::Back => 0,
        }
    }
}

/// Maximum distance of the start of a straight run from where it would be, in lengths of the run: it moves to a node.
const SNAP: f64 = 0.25;

/// Courses of all branches, each built on access.
#[derive(Clone, Copy)]
pub struct Courses<'a> {
    /// The skeleton.
    pub skeleton: &'a Skeleton,
    /// Its branches.
    pub chains: &'a Chains,
}

impl<'a> Courses<'a> {
    /// Number of courses.
    pub fn len(self) -> usize {
        self.chains.len()
    }

    /// Returns `true` if the list is empty.
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// Returns the course of a branch.
    pub fn get(self, branch: u32) -> Course {
        Course::new(self.skeleton, self.chains.branch(self.skeleton, branch))
    }

    /// Iterates over the courses of all branches.
    pub fn iter(self) -> impl Iterator<Item = Course> + 'a {
        (0..self.len() as u32).map(move |branch| self.get(branch))
    }
}

/// A branch with its geometry.
pub struct Course {
    /// The branch.
    pub branch: Branch,
    /// Positions of `branch.nodes`.
    pub points: Vec<Point3>,
    /// Radii of each edge at its start and end, in the direction of the branch.
    pub radii: Vec<[f64; 2]>,
}

impl Course {
    /// Course of a branch of the skeleton.
    pub fn new(skeleton: &Skeleton, branch: Branch) -> Self {
        let points = branch.nodes.iter().map(|n| skeleton.nodes[n.0 as usize].position).collect();
        let radii = branch.tubes(skeleton).map(|t| [t.ra, t.rb]).collect();
        Self { branch, points, radii }
    }

    /// Returns the length of the branch.
    pub fn length(&self) -> f64 {
        self.branch.length()
    }

    fn arc(&self) -> &[f64] {
        &self.branch.arc
    }

    /// Edge at `s`. A node belongs to the edge before it (`Onward`: a plane there ends it) or after it (`Back`).
    fn edge_at(&self, s: f64, way: Way) -> usize {
        let inner = &self.arc()[1..self.radii.len()];
        match way {
            Way::Onward => inner.partition_point(|&end| end < s),
            Way::Back => inner.partition_point(|&end| end <= s),
        }
    }

    fn parameter(&self, edge: usize, s: f64) -> f64 {
        let (start, end) = (self.arc()[edge], self.arc()[edge + 1]);
        if end > start { ((s - start) / (end - start)).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Axis point at arc length `s`.
    pub fn point(&self, s: f64) -> Point3 {
        let i = self.edge_at(s, Way::Back);
        let t = self.parameter(i, s);
        // Nodes are reproduced exactly.
        if t >= 1.0 { self.points[i + 1] } else { self.points[i] + (self.points[i + 1] - self.points[i]) * t }
    }

    /// Radius at arc length `s`. If it jumps at a node, that of the edge before the node (`Onward`) or after it.
    pub fn radius(&self, s: f64, way: Way) -> f64 {
        let i = self.edge_at(s, way);
        let [ra, rb] = self.radii[i];
        ra + (rb - ra) * self.parameter(i, s)
    }

    /// Edges that overlap (lo, hi).
    fn edges_between(&self, lo: f64, hi: f64) -> std::ops::RangeInclusive<usize> {
        self.edge_at(lo, Way::Back)..=self.edge_at(hi, Way::Onward)
    }

    /// Smallest and largest radius in [lo, hi].
    pub fn radius_range(&self, lo: f64, hi: f64) -> [f64; 2] {
        let ends = [self.radius(lo, Way::Back), self.radius(hi, Way::Onward)];
        let mut range = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        let (first, last) = self.edges_between(lo, hi).into_inner();
        for i in first..=last {
            for (inside, r) in [(i > first, self.radii[i][0]), (i < last, self.radii[i][1])] {
                if inside {
                    range = [range[0].min(r), range[1].max(r)];
                }
            }
        }
        range
    }

    /// True if a node lies strictly between `lo` and `hi`.
    pub fn has_node_between(&self, lo: f64, hi: f64) -> bool {
        self.edge_at(lo, Way::Back) < self.edge_at(hi, Way::Onward)
    }

    /// Mean radius, weighted by length.
    pub fn mean_radius(&self) -> f64 {
        let sum: f64 = self.radii.iter().zip(self.arc().windows(2)).map(|(r, s)| (r[0] + r[1]) * (s[1] - s[0])).sum();
        0.5 * sum / self.length()
    }

    /// Part of edge `i` in [lo, hi], if any.
    pub fn clipped(&self, i: usize, lo: f64, hi: f64) -> Option<Tube> {
        let (start, end) = (self.arc()[i], self.arc()[i + 1]);
        let (lo, hi) = (lo.max(start), hi.min(end));
        if lo > hi {
            return None;
        }
        let whole = Tube { a: self.points[i], b: self.points[i + 1], ra: self.radii[i][0], rb: self.radii[i][1] };
        if lo <= start && hi >= end {
            return Some(whole);
        }
        let (t, u) = (self.parameter(i, lo), self.parameter(i, hi));
        Some(Tube { a: whole.point(t), b: whole.point(u), ra: whole.radius(t), rb: whole.radius(u) })
    }

    /// Length of the straight run before an end plane: a radius, or less on a short branch.
    fn run_length(&self, s: f64, way: Way) -> f64 {
        self.radius(s, way).min(0.375 * self.length())
    }

    /// Start of the straight run that ends at the plane at `s` in direction `way`. Polylines have edges shorter than
    /// their radius; a run of one radius makes the vessel cross the plane along the plane's axis.
    pub fn run_start(&self, s: f64, way: Way) -> f64 {
        let run = self.run_length(s, way);
        let edge = self.edge_at(s, way);
        let node = match way {
            Way::Onward => self.arc()[edge],
            Way::Back => self.arc()[edge + 1],
        };
        if (s - node) * way.sign() >= run {
            return node;
        }
        let target = (s - run * way.sign()).clamp(0.0, self.length());
        // A node near the target avoids a tiny edge.
        let arc = self.arc();
        let after = arc.partition_point(|&x| x < target).min(arc.len() - 1);
        let before = after.saturating_sub(1);
        let nearest = if arc[after] - target < target - arc[before] { arc[after] } else { arc[before] };
        if (nearest - target).abs() <= SNAP * run { nearest } else { target }
    }

    /// Minimum distance of a plane from the end that the branch leaves by `way`, so that the straight runs before both do not
    /// overlap.
    pub(crate) fn clear_of_runs(&self, way: Way) -> f64 {
        let distance = |s: f64| if way == Way::Onward { s } else { self.length() - s };
        let at_end = self.radius(if way == Way::Onward { 0.0 } else { self.length() }, way);
        let mut clear = 0.0_f64;
        for (s, radii) in self.arc().windows(2).zip(&self.radii) {
            let [a, b] = [0, 1].map(|i| distance(s[i]));
            let [over_a, over_b] = [(a, radii[0]), (b, radii[1])].map(|(d, r)| (1.0 + SNAP) * (r + at_end) - d);
            if over_a > 0.0 || over_b > 0.0 {
                // The overlap is linear along an edge.
                let zero = a + (b - a) * over_a / (over_a - over_b);
                clear = clear.max(if over_a > 0.0 && over_b > 0.0 { a.max(b) } else { zero });
            }
        }
        clear
    }

    /// Unit direction of the vessel at a plane at `s`, pointing `way`.
    fn direction(&self, s: f64, way: Way) -> Vec3 {
        let chord = self.point(s) - self.point(self.run_start(s, way));
        chord.try_normalize(0.0).unwrap_or_else(|| {
            let i = self.edge_at(s, way);
            (self.points[i + 1] - self.points[i]).normalize() * way.sign()
        })
    }

    /// End plane at `s`, its axis pointing `way`.
    pub fn section(&self, s: f64, way: Way) -> Section {
        Section::new(self.point(s), self.direction(s, way), self.radius(s, way))
    }

    /// Unit direction of the axis at `s`, over a radius to either side.
    pub fn tangent(&self, s: f64) -> Vec3 {
        let run = self.run_length(s, Way::Back);
        let chord = self.point((s + run).min(self.length())) - self.point((s - run).max(0.0));
        chord.try_normalize(0.0).unwrap_or_else(|| self.direction(s, Way::Onward))
    }

    /// Direction in which the branch leaves an end: the first one if `way` is `Onward`, else the last one.
    pub fn leaving(&self, way: Way, window: f64) -> Vec3 {
        let window = window.min(self.length());
        let (from, to) = match way {
            Way::Onward => (0.0, window),
            Way::Back => (self.length(), self.length() - window),
        };
        let first = if way == Way::Onward { 0 } else { self.points.len() - 2 };
        let chord = self.point(to) - self.point(from);
        chord
            .try_normalize(0.0)
            .unwrap_or_else(|| (self.points[first + 1] - self.points[first]).normalize() * way.sign())
    }

    /// Angle in radians between the vessel's directions over one radius before and after inner node `i`.
    fn turn(&self, i: usize) -> f64 {
        let s = self.arc()[i];
        let run = self.run_length(s, Way::Onward).max(self.run_length(s, Way::Back));
        let here = self.points[i];
        let back = here - self.point((s - run).max(0.0));
        let onward = self.point((s + run).min(self.length())) - here;
        libm::atan2(back.cross(&onward).norm(), back.dot(&onward))
    }

    /// Maximal parts of [lo, hi] away from nodes where the vessel turns by more than `max_turn` over one radius. The
    /// distance is about one radius, and larger at sharp turns. Their limbs are like branches at a junction, where
    /// equation 12 with equal radii is r tan(turn / 2).
    pub fn straight_parts(&self, lo: f64, hi: f64, max_turn: f64) -> Vec<[f64; 2]> {
        let mut parts = Vec::new();
        let mut start = lo;
        for i in 1..self.points.len() - 1 {
            let turn = self.turn(i);
            if turn <= max_turn {
                continue;
            }
            let radius = self.radii[i - 1][1].max(self.radii[i][0]);
            let reach = radius * (0.8 + 1.25 * libm::tan(0.5 * turn).abs());
            let (from, to) = (self.arc()[i] - reach, self.arc()[i] + reach);
            if to <= lo || from >= hi {
                continue;
            }
            // A sharp turn may reach back over parts before it.
            while parts.last().is_some_and(|p: &[f64; 2]| p[0] >= from) {
                parts.pop();
            }
            if let Some(last) = parts.last_mut() {
                last[1] = last[1].min(from);
            }
            if from > start {
                parts.push([start, from]);
            }
            start = start.max(to);
        }
        if hi > start {
            parts.push([start, hi]);
        }
        parts
    }

    /// The vessel in [lo, hi] as straight tubes; at a `flat` end, the vessel runs straight into its plane.
    pub fn tubes(&self, lo: f64, hi: f64, flat: [bool; 2]) -> Vec<Tube> {
        let mut from = if flat[0] { self.run_start(lo, Way::Back) } else { lo };
        let mut to = if flat[1] { self.run_start(hi, Way::Onward) } else { hi };
        if from > to {
            // One of the runs lies in one edge and contains the start of the other, or both are that edge.
            let within =
                |run: f64, s: f64| self.edge_at(run.min(s), Way::Back) == self.edge_at(run.max(s), Way::Onward);
            match (within(from, lo), within(to, hi)) {
                (true, true) => (from, to) = (lo, hi),
                (true, false) => from = to,
                _ => to = from,
            }
        }
        let mut stations = vec![lo];
        let inner = &self.arc()[1..self.arc().len() - 1];
        let first = inner.partition_point(|&s| s < from);
        let last = inner.partition_point(|&s| s <= to).max(first);
        for s in std::iter::once(from).chain(inner[first..last].iter().copied()).chain([to]) {
            if s > stations[stations.len() - 1] && s < hi {
                stations.push(s);
            }
        }
        stations.push(hi);
        let tube = |s: &[f64]| Tube {
            a: self.point(s[0]),
            b: self.point(s[1]),
            ra: self.radius(s[0], Way::Back),
            rb: self.radius(s[1], Way::Onward),
        };
        stations.windows(2).map(tube).collect()
    }
}

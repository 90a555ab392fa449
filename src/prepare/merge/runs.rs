//! Where a line runs together with those that are kept, and how much of it goes.

use super::line::Line;
use crate::geometry::{Aabb, Bvh, Point3, Vec3, point_segment};
use crate::skeleton::{EdgeId, Skeleton};

/// Vessels that enclose less than 45 degrees have the same direction.
const SAME_WAY: f64 = 0.707;
/// Lines as close as this, in radii, have one axis.
const SAME_AXIS: f64 = 0.1;
/// How far upstream of where VMTK ends a vessel its two lines are looked at for one axis, in radii.
const UPSTREAM: f64 = 3.0;
/// Runs shorter than this, in radii, that do not take a whole line are left: every fork begins so.
const SHORTEST: f64 = 1.0;
/// Edges looked at, at most: more than any network has that is not all in one place.
const MOST_LOOKS: usize = 300_000_000;

/// A place on a line that is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Foot {
    pub edge: EdgeId,
    /// Parameter in [0, 1] along the edge.
    pub t: f64,
    /// Distance of the line that asked.
    pub distance: f64,
    /// Whether the line of the foot ends there.
    pub at_end: bool,
}

/// A stretch of a line that goes, by its first and last node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run {
    pub first: usize,
    pub last: usize,
    /// The nodes at which the line leaves the tube, where the run does not reach the line's end.
    pub parts: [Option<usize>; 2],
}

/// The search for lines that are kept.
pub(super) struct Kept<'a> {
    skeleton: &'a Skeleton,
    tree: Bvh,
    tangents: Vec<Vec3>,
    /// Whether an edge belongs to a line that is kept, and at which of its ends the line ends.
    state: Vec<Option<[bool; 2]>>,
    looks: usize,
}

impl<'a> Kept<'a> {
    pub(super) fn new(skeleton: &'a Skeleton) -> Self {
        let boxes = skeleton.edge_ids().map(|e| {
            let tube = skeleton.tube(e);
            Aabb::of_points([&tube.a, &tube.b]).grown(tube.max_radius())
        });
        let tree = Bvh::new(&boxes.collect::<Vec<_>>());
        let edges = skeleton.edges.len();
        Self { skeleton, tree, tangents: vec![Vec3::zeros(); edges], state: vec![None; edges], looks: 0 }
    }

    /// Whether so many edges lay upon each other that the search was given up.
    pub(super) fn gave_up(&self) -> bool {
        self.looks >= MOST_LOOKS
    }

    /// Keeps a line but for its runs.
    pub(super) fn keep(&mut self, line: &Line, runs: &[Run]) {
        let gone = |piece: usize| runs.iter().any(|r| r.first <= piece && piece < r.last);
        for (piece, &edge) in line.edges.iter().enumerate().filter(|(piece, _)| !gone(*piece)) {
            let ends = [piece == 0 || gone(piece - 1), piece + 1 == line.edges.len() || gone(piece + 1)];
            let forwards = self.skeleton.edge(edge).nodes[0] == line.nodes[piece];
            self.state[edge.index()] = Some(if forwards { ends } else { [ends[1], ends[0]] });
            self.tangents[edge.index()] = line.tangents[piece];
        }
    }

    /// The place closest to a point of a line, on a line that is kept, runs the same way there and is within the radius of
    /// this one as this is within that one's.
    fn foot(&mut self, point: &Point3, radius: f64, tangent: &Vec3) -> Option<Foot> {
        let Self { skeleton, tree, tangents, state, looks } = self;
        let mut best: Option<Foot> = None;
        if *looks >= MOST_LOOKS {
            return None;
        }
        tree.query(&Aabb::of_points([point]), |id| {
            *looks += 1;
            let Some(ends) = state[id as usize] else { return };
            if tangents[id as usize].dot(tangent).abs() < SAME_WAY {
                return;
            }
            let tube = skeleton.tube(EdgeId(id));
            let (t, distance) = point_segment(point, &tube.a, &tube.b);
            let at_end = t <= 0.0 && ends[0] || t >= 1.0 && ends[1];
            // Where a line goes on, another one begins at its end: that is no double.
            let key = |f: &Foot| (f.distance, f.edge.0);
            let foot = Foot { edge: EdgeId(id), t, distance, at_end: at_end && distance > 0.0 };
            if distance < radius.min(tube.radius(t)) && best.is_none_or(|b| key(&foot) < key(&b)) {
                best = Some(foot);
            }
        });
        best
    }

    /// The feet of all nodes of a line.
    pub(super) fn feet(&mut self, line: &Line) -> Vec<Option<Foot>> {
        let feet = (0..line.nodes.len()).map(|i| {
            let point = self.skeleton.node(line.nodes[i]).position;
            self.foot(&point, line.radii[i], &line.tangents[i])
        });
        feet.collect()
    }
}

/// The stretches of a line that go. `open` says which of its ends are tips.
pub(super) fn runs(line: &Line, feet: &[Option<Foot>], open: [bool; 2], points: &[Point3]) -> Vec<Run> {
    let inside = |i: usize| feet[i].is_some_and(|f| !f.at_end);
    let mut together: Vec<[usize; 2]> = Vec::new();
    for i in (0..feet.len()).filter(|&i| inside(i)) {
        match together.last_mut() {
            // Where noise lifts a line out of the tube for less than a radius it runs on.
            Some([_, last]) if *last + 1 == i || line.arc[i] - line.arc[*last] < line.radii[i] => *last = i,
            _ => together.push([i, i]),
        }
    }
    together.iter().filter_map(|&ends| run(line, feet, to_tips(line, ends, open), points)).collect()
}

/// A run that comes within a radius of a tip takes it along: lines of one vessel do not end at the very same place.
fn to_tips(line: &Line, [mut first, mut last]: [usize; 2], open: [bool; 2]) -> [usize; 2] {
    if open[0] && line.arc[first] < line.radii[0] {
        first = 0;
    }
    if open[1] && line.length() - line.arc[last] < line.radii[line.last()] {
        last = line.last();
    }
    [first, last]
}

/// What of a run goes, once the places where the line parts are found.
fn run(line: &Line, feet: &[Option<Foot>], [first, last]: [usize; 2], points: &[Point3]) -> Option<Run> {
    let whole = [first == 0, last == line.last()];
    let radius = line.radii[first].max(line.radii[last]);
    let from = if whole[0] { first } else { parting(line, feet, [last, first], points)? };
    let to = if whole[1] { last } else { parting(line, feet, [first, last], points)? };
    let length = line.arc[to] - line.arc[from.min(to)];
    if to <= from || length < SHORTEST * radius && whole != [true; 2] {
        return None;
    }
    Some(Run { first: from, last: to, parts: [(!whole[0]).then_some(first), (!whole[1]).then_some(last)] })
}

/// Where the vessel of two lines ends of which one leaves the other's tube at the last of `[start, exit]`.
///
/// Antiga and Steinman (2004) end a vessel where the inscribed sphere touches the point at which the line of one branch
/// leaves the tube of the other: one sphere upstream of it. Upstream of that, the last node counts at which the two
/// lines have one axis, so that no axis is bent; the closest, where there is none.
fn parting(line: &Line, feet: &[Option<Foot>], [start, exit]: [usize; 2], points: &[Point3]) -> Option<usize> {
    let steps = start.abs_diff(exit);
    let at = |k: usize| if exit > start { exit - k } else { exit + k };
    let touches = |i: usize| (points[i] - points[exit]).norm() >= line.radii[i];
    let sphere = (0..=steps).find(|&k| touches(at(k)))?;
    let reach = |k: usize| (line.arc[at(k)] - line.arc[at(sphere)]).abs() <= UPSTREAM * line.radii[at(sphere)];
    let mut best: Option<(f64, usize)> = None;
    for k in (sphere..=steps).take_while(|&k| reach(k)) {
        let Some(foot) = feet[at(k)].filter(|f| !f.at_end) else { continue };
        let apart = foot.distance / line.radii[at(k)];
        if apart <= SAME_AXIS {
            return Some(at(k));
        }
        if best.is_none_or(|b| apart < b.0) {
            best = Some((apart, at(k)));
        }
    }
    best.map(|b| b.1)
}

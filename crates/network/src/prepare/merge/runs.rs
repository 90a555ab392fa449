//! Runs: parts of a line that coincide with kept lines and are removed.

use super::line::SampledLine;
use anastomesh_mesh::geometry::{Aabb, Bvh, DisjointSets, Point3, Vec3, point_segment};
use anastomesh_skeleton::{EdgeId, Kinship, LineGroup, NodeId, Skeleton};

/// Cosine above which vessels have the same direction (45°).
pub(super) const SAME_WAY: f64 = 0.707;
/// Maximum distance of lines with a common axis, in radii.
const SAME_AXIS: f64 = 0.1;
/// Maximum distance of lines in one lumen, in radii, that the file assigns to different vessels.
const SAME_LUMEN: f64 = 0.3;
/// Search distance upstream of VMTK's end of a vessel for a common axis, in radii.
const UPSTREAM: f64 = 3.0;
/// Minimum length of a run that is not a whole line, in radii: every bifurcation begins with a short run.
const SHORTEST: f64 = 1.0;
/// Sampling step of a line between nodes, in radii, and maximum number of steps.
const STEP: f64 = 0.5;
const MOST_STEPS: f64 = 64.0;
/// Maximum number of edge tests. Only networks with all lines in one place exceed it.
const MOST_LOOKS: usize = 300_000_000;

/// Position on a kept line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Foot {
    pub edge: EdgeId,
    /// Parameter in [0, 1] along the edge.
    pub t: f64,
    /// Distance from the queried line.
    pub distance: f64,
    /// True if the line of the foot ends there.
    pub at_end: bool,
    /// Connected component of the kept lines at the time of the query.
    pub piece: u32,
}

/// Removed part of a line, by its first and last node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DoubledStretch {
    pub first: usize,
    pub last: usize,
    /// Nodes at which the line leaves the tube, for ends of the run inside the line.
    pub parts: [Option<usize>; 2],
}

/// Search structure for kept lines.
pub(super) struct KeptLines<'a> {
    skeleton: &'a Skeleton,
    tree: Bvh,
    tangents: Vec<Vec3>,
    /// Vessel group of each edge, if the file has groups.
    groups: Vec<Option<LineGroup>>,
    /// For each edge of a kept line: flags of the ends at which the line ends.
    state: Vec<Option<[bool; 2]>>,
    /// Connectivity of nodes through kept lines.
    pieces: DisjointSets,
    looks: usize,
}

impl<'a> KeptLines<'a> {
    pub(super) fn new(skeleton: &'a Skeleton, groups: Vec<Option<LineGroup>>) -> Self {
        let boxes = skeleton.edge_ids().map(|e| {
            let tube = skeleton.tube(e);
            Aabb::of_points([&tube.a, &tube.b]).grown(tube.max_radius())
        });
        let tree = Bvh::new(&boxes.collect::<Vec<_>>());
        let edges = skeleton.edges.len();
        Self {
            skeleton,
            tree,
            tangents: vec![Vec3::zeros(); edges],
            groups,
            state: vec![None; edges],
            pieces: DisjointSets::new(skeleton.nodes.len()),
            looks: 0,
        }
    }

    /// True if the search stopped because too many edges overlap.
    pub(super) fn gave_up(&self) -> bool {
        self.looks >= MOST_LOOKS
    }

    /// Keeps a line except for its runs.
    pub(super) fn keep(&mut self, line: &SampledLine, runs: &[DoubledStretch]) {
        let gone = |piece: usize| runs.iter().any(|r| r.first <= piece && piece < r.last);
        for (piece, &edge) in line.edges.iter().enumerate().filter(|(piece, _)| !gone(*piece)) {
            let ends = [piece == 0 || gone(piece - 1), piece + 1 == line.edges.len() || gone(piece + 1)];
            let forwards = self.skeleton.edge(edge).nodes[0] == line.nodes[piece];
            self.state[edge.index()] = Some(if forwards { ends } else { [ends[1], ends[0]] });
            self.tangents[edge.index()] = line.tangents[piece];
            let [a, b] = self.skeleton.edge(edge).nodes;
            self.pieces.join(a.0, b.0);
        }
    }

    /// Returns the closest position on a kept line of similar direction. The distance must be below both radii. One
    /// radius suffices if the file assigns both lines to one vessel. Lines of different vessels match only near their axes.
    fn foot(&mut self, point: &Point3, radius: f64, tangent: &Vec3, of: EdgeId) -> Option<Foot> {
        let Self { skeleton, tree, tangents, groups, state, pieces, looks } = self;
        let group = groups[of.index()];
        let reach = if group.is_some() { radius } else { 0.0 };
        let mut best: Option<Foot> = None;
        if *looks >= MOST_LOOKS {
            return None;
        }
        tree.query(&Aabb::of_points([point]).grown(reach), |id| {
            *looks += 1;
            let Some(ends) = state[id as usize] else { return };
            let kinship = LineGroup::kinship(group, groups[id as usize]);
            if tangents[id as usize].dot(tangent).abs() < SAME_WAY {
                return;
            }
            let tube = skeleton.tube(EdgeId(id));
            let (t, distance) = point_segment(point, &tube.a, &tube.b);
            let at_end = t <= 0.0 && ends[0] || t >= 1.0 && ends[1];
            // A line that starts at the end of another continues it and is no duplicate.
            let key = |f: &Foot| (f.distance, f.edge.0);
            let foot = Foot { edge: EdgeId(id), t, distance, at_end: at_end && distance > 0.0, piece: 0 };
            let within = match kinship {
                Kinship::Same => radius.max(tube.radius(t)),
                Kinship::Different => SAME_LUMEN * radius.min(tube.radius(t)),
                Kinship::Unknown => radius.min(tube.radius(t)),
            };
            if distance < within && best.is_none_or(|b| key(&foot) < key(&b)) {
                best = Some(foot);
            }
        });
        best.map(|foot| Foot { piece: pieces.root(skeleton.edge(foot.edge).nodes[0].0), ..foot })
    }

    /// Attaches a node of a line to a kept line.
    pub(super) fn attach(&mut self, node: NodeId, foot: &Foot) {
        self.pieces.join(node.0, self.skeleton.edge(foot.edge).nodes[0].0);
    }

    /// For each edge of a line: true if the points between its nodes also have feet. The nodes alone do not suffice for
    /// a short vessel between two others.
    pub(super) fn along(&mut self, line: &SampledLine) -> Vec<bool> {
        let mut along = Vec::with_capacity(line.edges.len());
        for piece in 0..line.edges.len() {
            let [a, b] = [piece, piece + 1].map(|i| self.skeleton.node(line.nodes[i]).position);
            let [ra, rb] = [line.radii[piece], line.radii[piece + 1]];
            let count = ((b - a).norm() / (STEP * ra.min(rb))).ceil().min(MOST_STEPS);
            let between = |k: usize| k as f64 / count;
            along.push((1..count as usize).all(|k| {
                let t = between(k);
                let of = line.edges[piece];
                self.foot(&(a + (b - a) * t), ra + (rb - ra) * t, &line.tangents[piece], of).is_some_and(|f| !f.at_end)
            }));
        }
        along
    }

    /// Returns the feet of all nodes of a line.
    pub(super) fn feet(&mut self, line: &SampledLine) -> Vec<Option<Foot>> {
        let feet = (0..line.nodes.len()).map(|i| {
            let point = self.skeleton.node(line.nodes[i]).position;
            self.foot(&point, line.radii[i], &line.tangents[i], line.edges[i.min(line.edges.len() - 1)])
        });
        feet.collect()
    }
}

/// Line and its relation to kept lines.
pub(super) struct Course<'a> {
    pub line: &'a SampledLine,
    /// Foot of each node.
    pub feet: &'a [Option<Foot>],
    /// For each edge: true if it coincides with kept lines between its nodes.
    pub along: &'a [bool],
    /// Position of each node.
    pub points: &'a [Point3],
}

/// Returns the parts of a line to remove. `open` marks the ends that are tips.
pub(super) fn runs(course: &Course, open: [bool; 2]) -> Vec<DoubledStretch> {
    let Course { line, feet, along, .. } = course;
    let inside = |i: usize| feet[i].is_some_and(|f| !f.at_end);
    let mut together: Vec<[usize; 2]> = Vec::new();
    let piece = |i: usize| feet[i].map(|f| f.piece);
    for i in (0..feet.len()).filter(|&i| inside(i)) {
        // A run continues if noise lifts the line out of the tube for less than a radius.
        let on = |last: usize| if last + 1 == i { along[last] } else { line.arc[i] - line.arc[last] < line.radii[i] };
        match together.last_mut() {
            // A line between two components of the kept lines connects them.
            Some([_, last]) if piece(*last) == piece(i) && on(*last) => *last = i,
            _ => together.push([i, i]),
        }
    }
    together.iter().filter_map(|&ends| course.run(to_tips(line, ends, open), open)).collect()
}

/// Extends a run that comes within a radius of a tip to that tip: lines of one vessel end at different places.
fn to_tips(line: &SampledLine, [mut first, mut last]: [usize; 2], open: [bool; 2]) -> [usize; 2] {
    if first == last {
        return [first, last];
    }
    if open[0] && line.arc[first] <= line.radii[0] {
        first = 0;
    }
    if open[1] && line.length() - line.arc[last] <= line.radii[line.last()] {
        last = line.last();
    }
    [first, last]
}

impl Course<'_> {
    /// Returns the removed part of a run, up to the points of separation.
    fn run(&self, [first, last]: [usize; 2], open: [bool; 2]) -> Option<DoubledStretch> {
        let line = self.line;
        let radius = line.radii[first].max(line.radii[last]);
        let [from, to] =
            [self.end(first, last, first == 0, open[0])?, self.end(last, first, last == line.last(), open[1])?];
        let whole = from == 0 && to == line.last();
        if to <= from || line.arc[to] - line.arc[from] < SHORTEST * radius && !whole {
            return None;
        }
        Some(DoubledStretch {
            first: from,
            last: to,
            parts: [(from > 0).then_some(first), (to < line.last()).then_some(last)],
        })
    }

    /// End of a run on one side: the point of separation, or the line's end if `at_end` is set.
    fn end(&self, exit: usize, start: usize, at_end: bool, open: bool) -> Option<usize> {
        let apart = || self.feet[exit].map_or(f64::INFINITY, |f| f.distance / self.line.radii[exit]);
        if at_end && (open || apart() <= SAME_AXIS) {
            return Some(exit);
        }
        self.parting(start, exit, at_end)
    }

    /// End of the common vessel of two lines, one of which leaves the other's tube at the end of `[start, exit]`.
    ///
    /// Antiga and Steinman (2004) end a vessel one inscribed sphere upstream of the point where one line leaves the
    /// tube of the other. Upstream of that sphere, the last node with a common axis counts, so that no axis bends; else
    /// the closest node. A line that continues beyond a branch point (`inside`) has not left the tube yet.
    fn parting(&self, start: usize, exit: usize, inside: bool) -> Option<usize> {
        let Self { line, feet, points, .. } = self;
        let steps = start.abs_diff(exit);
        let at = |k: usize| if exit > start { exit - k } else { exit + k };
        let touches = |i: usize| (points[i] - points[exit]).norm() >= line.radii[i];
        let sphere = if inside { 0 } else { (0..=steps).find(|&k| touches(at(k)))? };
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
}

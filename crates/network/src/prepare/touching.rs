//! Tips that end in or on another vessel, without space for a cap.

use anastomesh_mesh::geometry::{Aabb, Bvh, Point3, point_segment};
use anastomesh_skeleton::{
    Adjacency, BranchId, Branches, Edge, EdgeId, LocalDistances, Node, NodeId, Skeleton, SkeletonError, clean,
};
use serde::Serialize;

/// Treatment of a tip that touches another vessel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Touching {
    /// Keep the tip.
    Keep,
    /// Retract the tip along its own vessel until its cap is clear.
    #[default]
    Retract,
    /// Join the tip to the other vessel.
    Join,
}

/// Result for a tip.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "done", rename_all = "snake_case")]
pub enum TouchedBy {
    /// The tip was retracted.
    Retracted {
        /// Distance, in the unit of the network.
        by: f64,
    },
    /// The tip was extended past the other vessel, as its own vessel has no space for a cap.
    Extended {
        /// Distance, in the unit of the network.
        by: f64,
    },
    /// The tip was joined to the other vessel.
    Joined,
    /// The vessel had no space for a cap and was removed.
    Removed,
    /// The tip is unchanged: its vessel runs along the other one for longer than a tip would.
    Left,
}

/// Tip that touches another vessel.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TouchingTip {
    /// Tip node.
    pub tip: u32,
    /// Nodes of the touched edge.
    pub with: [u32; 2],
    /// Result of the treatment.
    #[serde(flatten)]
    pub done: TouchedBy,
}

/// Clear distance of a cap from the axis of another vessel, in sums of the radii. Closer walls fuse.
const CLEAR: f64 = 1.15;
/// Maximum retraction of a tip, in sums of the radii.
const FURTHEST: f64 = 4.0;
/// Maximum retracted length outside other vessels before a refinement, in radii. A longer loss is a defect of the mesh, and
/// the overlap is left to the refinement. The last radius lies within the wall around the new end.
const LOST: f64 = 2.75;
/// Maximum length of a removed vessel outside other vessels before a refinement, in radii.
const LOST_WHOLE: f64 = 1.9;
/// First retraction of a tip that could not be capped, in its radii. The next ones are twice as long each.
const BACK: f64 = 2.0;
/// Minimum extension of such a tip, in its radii: a block tries shorter ones. Maximum extension of any tip.
const FORTH: f64 = 3.25;
const FURTHEST_FORTH: f64 = 6.0;
/// Minimum distance of an extended tip from other walls, in its radii.
const OUT: f64 = 0.3;
/// Minimum remaining length of a retracted vessel, in radii of its branch point. Shorter vessels are spurs.
const LEFT: f64 = 2.0;
/// Step of the retraction, in radii of the tip.
const STEP: f64 = 0.25;
/// Distance along the skeleton, in radii, within which vessels count as the tip's own.
const OWN: f64 = 6.0;

/// Treats all tips in ascending order.
pub(super) fn treat(
    skeleton: &Skeleton,
    how: Touching,
    lossless: bool,
) -> Result<(Skeleton, Vec<TouchingTip>), SkeletonError> {
    if how == Touching::Keep {
        return Ok((skeleton.clone(), Vec::new()));
    }
    let mut work = Work { lossless, ..Work::new(skeleton) };
    let mut found = Vec::new();
    for tip in work.adjacency.terminals() {
        if let Some(done) = work.tip(tip, how) {
            found.push(done);
        }
    }
    if found.iter().all(|f| f.done == TouchedBy::Left) {
        return Ok((skeleton.clone(), found));
    }
    Ok((clean(&work.result())?.0, found))
}

/// Retracts tips that could not be capped by some radii, or removes the remains of their vessels. `tips` holds their
/// numbers in the input, each with the number of its earlier retractions.
///
/// # Errors
/// No vessel remains.
pub fn take_back(skeleton: &Skeleton, tips: &[(u32, u32)]) -> Result<(Skeleton, Vec<TouchingTip>), SkeletonError> {
    let mut work = Work::new(skeleton);
    let mut found = Vec::new();
    for tip in work.adjacency.terminals() {
        let name = skeleton.node(tip).original;
        let Some((_, before)) = tips.iter().find(|(tip, _)| *tip == name) else { continue };
        if let Some(way) = work.way(tip) {
            let with = skeleton.edge(work.beside(&way)).nodes.map(|n| skeleton.node(n).original);
            let back = BACK * f64::from(1_u32 << before.min(&8));
            found.push(TouchingTip { tip: name, with, done: work.draw_back(&way, back) });
        }
    }
    Ok((clean(&work.result())?.0, found))
}

/// Network during the treatment. Bounding boxes are those of the given vessels; extended ones are clear of all others.
struct Work<'a> {
    given: &'a Skeleton,
    adjacency: Adjacency,
    branches: Branches,
    tree: Bvh,
    nodes: Vec<Node>,
    gone: Vec<bool>,
    /// Edges that join a tip to a position on another edge.
    joints: Vec<(NodeId, EdgeId, f64)>,
    /// True if a tip stays where its treatment would lose too much.
    lossless: bool,
}

/// Remaining part of a branch, starting from its tip.
struct TipBranch {
    tip: NodeId,
    branch: BranchId,
    edges: Vec<EdgeId>,
    length: f64,
    /// Branch point at its other end, if any.
    from: Option<NodeId>,
}

/// Position along a vessel at which a tip is tested.
struct Stand {
    /// Distance from the tip.
    arc: f64,
    /// Edge index, counted from the tip.
    piece: usize,
    point: Point3,
    radius: f64,
}

impl<'a> Work<'a> {
    fn new(given: &'a Skeleton) -> Self {
        let boxes = given.edge_ids().map(|e| {
            let tube = given.tube(e);
            Aabb::of_points([&tube.a, &tube.b]).grown(CLEAR * tube.max_radius())
        });
        let adjacency = given.adjacency();
        let branches = given.branches(&adjacency);
        let tree = Bvh::new(&boxes.collect::<Vec<_>>());
        Self {
            given,
            adjacency,
            branches,
            tree,
            nodes: given.nodes.clone(),
            gone: vec![false; given.edges.len()],
            joints: Vec::new(),
            lossless: false,
        }
    }

    fn tip(&mut self, tip: NodeId, how: Touching) -> Option<TouchingTip> {
        let way = self.way(tip)?;
        let first = self.given.edge(way.edges[0]);
        let radius = first.radii[first.end(tip)];
        let at_tip = Stand { arc: 0.0, piece: 0, point: self.given.node(tip).position, radius };
        let (with, other) = self.in_the_way(&way, &at_tip)?;
        let name = |n: NodeId| self.given.node(n).original;
        let names = self.given.edge(with).nodes.map(name);
        let done = match how {
            Touching::Join => self.join(tip, with),
            _ => self.retract(&way, radius + other),
        };
        Some(TouchingTip { tip: name(tip), with: names, done })
    }

    /// Returns the path from a tip; `None` if nothing remains of its branch.
    fn way(&self, tip: NodeId) -> Option<TipBranch> {
        let (id, _) = self.branches.of_edge[self.adjacency.edges(tip).first()?.index()];
        let branch = &self.branches.list[id.index()];
        let mut edges = branch.edges.clone();
        let [mut near, mut far] = branch.ends();
        if near != tip {
            edges.reverse();
            (near, far) = (far, near);
        }
        // The other tip of the vessel may have been retracted.
        let there = edges.iter().take_while(|e| !self.gone[e.index()]).count();
        edges.truncate(there);
        let length = edges.iter().map(|&e| self.given.length(e)).sum();
        let from = (self.adjacency.valence(far) > 2).then_some(far);
        (!edges.is_empty() && near == tip).then_some(TipBranch { tip, branch: id, edges, length, from })
    }

    /// Nearest vessel that leaves no space for a cap at a position, and its radius there.
    fn in_the_way(&self, way: &TipBranch, stand: &Stand) -> Option<(EdgeId, f64)> {
        self.closer_than(CLEAR, way, stand)
    }

    /// Nearest vessel at a position whose axis is closer than `clear` times the sum of the radii, at most `CLEAR`.
    fn closer_than(&self, clear: f64, way: &TipBranch, stand: &Stand) -> Option<(EdgeId, f64)> {
        let reach = Aabb::of_points([&stand.point]).grown(CLEAR * stand.radius);
        let mut nearest: Option<(f64, EdgeId, f64)> = None;
        self.tree.query(&reach, |id| {
            let edge = EdgeId(id);
            if self.gone[edge.index()] {
                return;
            }
            let [a, b] = self.given.edge(edge).nodes.map(|n| self.nodes[n.index()].position);
            let (t, distance) = point_segment(&stand.point, &a, &b);
            let radii = self.given.edge(edge).radii;
            let radius = radii[0] + (radii[1] - radii[0]) * t;
            let gap = distance - clear * (stand.radius + radius);
            let is_nearer = nearest.is_none_or(|(g, e, _)| gap < g || gap <= g && edge < e);
            if gap < 0.0 && is_nearer && !self.is_own(way, stand, edge, radius) {
                nearest = Some((gap, edge, radius));
            }
        });
        nearest.map(|(_, edge, radius)| (edge, radius))
    }

    /// True if a whole section of a path lies within another vessel.
    fn is_buried(&self, way: &TipBranch, stand: &Stand) -> bool {
        self.is_near_a_wall(way, stand, -stand.radius)
    }

    /// True if the axis of a path lies within another vessel, or at most `margin` outside. Other edges of its own branch count
    /// if the position is between their ends, as the branch is folded then.
    fn is_near_a_wall(&self, way: &TipBranch, stand: &Stand, margin: f64) -> bool {
        let mut found = false;
        self.tree.query(&Aabb::of_points([&stand.point]).grown(margin.max(0.0)), |id| {
            let edge = EdgeId(id);
            let tube = self.given.tube(edge);
            let (t, distance) = point_segment(&stand.point, &tube.a, &tube.b);
            let is_other = self.branches.of_edge[edge.index()].0 != way.branch
                || edge != way.edges[stand.piece] && 0.0 < t && t < 1.0;
            found |= is_other && !self.gone[edge.index()] && distance - margin <= tube.radius(t);
        });
        found
    }

    /// True if an edge is near a position along the skeleton and thus no obstacle.
    fn is_own(&self, way: &TipBranch, stand: &Stand, edge: EdgeId, radius: f64) -> bool {
        let near = OWN * stand.radius.max(radius);
        if self.branches.of_edge[edge.index()].0 == way.branch {
            let before: f64 = way.edges.iter().take_while(|&&e| e != edge).map(|&e| self.given.length(e)).sum();
            return (before - stand.arc).abs() <= near + self.given.length(edge);
        }
        let Some(from) = way.from else { return false };
        let ends = self.given.edge(edge).nodes;
        if ends.contains(&from) {
            return true;
        }
        let mut along = LocalDistances::default();
        along.search(self.given, &self.adjacency, from, near);
        let reached = ends.map(|n| along.of(n)).into_iter().fold(f64::INFINITY, f64::min);
        way.length - stand.arc + reached <= near
    }

    fn join(&mut self, tip: NodeId, with: EdgeId) -> TouchedBy {
        let [a, b] = self.given.edge(with).nodes.map(|n| self.nodes[n.index()].position);
        let (t, _) = point_segment(&self.given.node(tip).position, &a, &b);
        self.joints.push((tip, with, t));
        TouchedBy::Joined
    }

    /// Retracts a tip to the first position with space for a cap.
    fn retract(&mut self, way: &TipBranch, radii: f64) -> TouchedBy {
        let last = way.edges[way.edges.len() - 1];
        let keep = LEFT * self.given.tube(last).max_radius();
        let (mut lost, mut before) = (0.0, 0.0);
        for stand in self.stands(way) {
            if !self.is_near_a_wall(way, &stand, 0.0) {
                lost += (stand.arc - before) / stand.radius;
            }
            before = stand.arc;
            if stand.arc > way.length - keep {
                break;
            }
            if stand.arc > FURTHEST * radii || self.lossless && lost > LOST {
                return TouchedBy::Left;
            }
            if self.in_the_way(way, &stand).is_none() {
                self.cut(way, &stand);
                return TouchedBy::Retracted { by: stand.arc };
            }
        }
        // The remains of a vessel on another one are a spur; a free vessel is none.
        if way.from.is_none() || way.length > FURTHEST * radii + keep {
            return TouchedBy::Left;
        }
        self.extend_or_remove(way, STEP)
    }

    /// Extends a tip straight on to the first position with space for a cap. If another vessel is in the way, the vessel of the
    /// tip is removed, unless too much is lost. The extension is at least `least` radii, and at most the length of the vessel.
    fn extend_or_remove(&mut self, way: &TipBranch, least: f64) -> TouchedBy {
        let is_buried = self.stands(way).first().is_some_and(|stand| self.is_buried(way, stand));
        if let Some(stand) = self.beyond(way, least).filter(|_| !is_buried) {
            let original = self.nodes[way.tip.index()].original;
            self.nodes[way.tip.index()] = Node { position: stand.point, radius: stand.radius, original };
            return TouchedBy::Extended { by: -stand.arc };
        }
        if self.lossless && self.lost(way) > LOST_WHOLE {
            return TouchedBy::Left;
        }
        way.edges.iter().for_each(|e| self.gone[e.index()] = true);
        TouchedBy::Removed
    }

    /// Length of a path outside other vessels, in its radii.
    fn lost(&self, way: &TipBranch) -> f64 {
        let (mut lost, mut before) = (0.0, 0.0);
        for stand in self.stands(way) {
            if !self.is_near_a_wall(way, &stand, 0.0) {
                lost += (stand.arc - before) / stand.radius;
            }
            before = stand.arc;
        }
        lost
    }

    fn beyond(&self, way: &TipBranch, least: f64) -> Option<Stand> {
        let first = self.given.edge(way.edges[0]);
        let radius = first.radii[first.end(way.tip)];
        let [tip, before] = [way.tip, first.other(way.tip)].map(|n| self.given.node(n).position);
        let direction = (tip - before).try_normalize(0.0)?;
        let furthest = (FURTHEST_FORTH * radius).min(way.length);
        for k in 1.. {
            let by = f64::from(k) * STEP * radius;
            if by > furthest {
                return None;
            }
            let stand = Stand { arc: -by, piece: 0, point: tip + direction * by, radius };
            if self.closer_than(1.0, way, &stand).is_some() {
                return None;
            }
            // The cap must leave the vessels of its own branch point, too.
            let is_clear =
                |stand| self.in_the_way(way, stand).is_none() && !self.is_near_a_wall(way, stand, OUT * radius);
            if by >= least * radius && is_clear(&stand) {
                return Some(stand);
            }
        }
        None
    }

    /// Retracts a tip by `back` radii, and further until its disc leaves other vessels.
    fn draw_back(&mut self, way: &TipBranch, back: f64) -> TouchedBy {
        let stands = self.stands(way);
        let radius = stands[0].radius;
        let keep = LEFT * self.given.tube(way.edges[way.edges.len() - 1]).max_radius();
        let has_room = |stand: &&Stand| stand.arc <= way.length - keep && !self.is_buried(way, stand);
        match stands.iter().skip_while(|stand| stand.arc < back * radius).find(has_room) {
            Some(stand) => {
                self.cut(way, stand);
                TouchedBy::Retracted { by: stand.arc }
            }
            None if way.from.is_none() => TouchedBy::Left,
            // A branch that lies within another vessel throughout is a spur of any length.
            None if way.length > (back + FURTHEST) * radius + keep && !self.is_buried(way, &stands[0]) => {
                TouchedBy::Left
            }
            None => self.extend_or_remove(way, FORTH),
        }
    }

    /// Edge of another vessel nearest to a tip, or the path's own last edge if none is near.
    fn beside(&self, way: &TipBranch) -> EdgeId {
        let last = self.given.edge(way.edges[0]);
        let (point, radius) = (self.given.node(way.tip).position, last.radii[last.end(way.tip)]);
        let mut nearest: Option<(f64, EdgeId)> = None;
        self.tree.query(&Aabb::of_points([&point]).grown(FURTHEST * radius), |id| {
            let edge = EdgeId(id);
            let tube = self.given.tube(edge);
            let gap = point_segment(&point, &tube.a, &tube.b).1 - tube.max_radius();
            let other = self.branches.of_edge[edge.index()].0 != way.branch;
            if other && nearest.is_none_or(|(g, e)| gap < g || gap <= g && edge < e) {
                nearest = Some((gap, edge));
            }
        });
        nearest.map_or(way.edges[0], |(_, edge)| edge)
    }

    /// Positions along a path, starting from its tip.
    fn stands(&self, way: &TipBranch) -> Vec<Stand> {
        let mut stands = Vec::new();
        let (mut arc, mut node) = (0.0, way.tip);
        for (piece, &id) in way.edges.iter().enumerate() {
            let edge = self.given.edge(id);
            let [from, to] = [edge.end(node), 1 - edge.end(node)];
            let [p, q] = [from, to].map(|i| self.given.node(edge.nodes[i]).position);
            let [r, s] = [from, to].map(|i| edge.radii[i]);
            let length = (q - p).norm();
            let count = (length / (STEP * r.min(s))).ceil().clamp(1.0, 256.0);
            stands.extend((0..count as usize).map(|k| {
                let t = k as f64 / count;
                Stand { arc: arc + t * length, piece, point: p + (q - p) * t, radius: r + (s - r) * t }
            }));
            arc += length;
            node = edge.other(node);
        }
        stands
    }

    /// Removes the part of a path before a position and moves its tip there.
    fn cut(&mut self, way: &TipBranch, stand: &Stand) {
        let mut node = way.tip;
        for &edge in &way.edges[..stand.piece] {
            self.gone[edge.index()] = true;
            node = self.given.edge(edge).other(node);
        }
        // The node before the position becomes the tip and inherits the number of the old tip.
        let original = self.nodes[way.tip.index()].original;
        self.nodes[node.index()] = Node { position: stand.point, radius: stand.radius, original };
    }

    /// Returns the network with all changes.
    fn result(self) -> Skeleton {
        let mut skeleton = Skeleton { nodes: self.nodes, edges: Vec::new() };
        let mut joints = self.joints;
        joints.sort_by(|a, b| a.1.cmp(&b.1).then(a.2.total_cmp(&b.2)).then(a.0.cmp(&b.0)));
        let mut joints = joints.into_iter().peekable();
        for id in self.given.edge_ids() {
            let mut edge = *self.given.edge(id);
            for (radius, node) in edge.radii.iter_mut().zip(edge.nodes) {
                // The edge of a retracted tip has the radius of the new position.
                if skeleton.node(node).position != self.given.node(node).position {
                    *radius = skeleton.node(node).radius;
                }
            }
            let [a, b] = edge.nodes.map(|n| skeleton.node(n).position);
            let radii = edge.radii;
            // Tips joined to this edge, in order along it.
            while let Some((tip, _, t)) = joints.next_if(|j| j.1 == id) {
                let radius = radii[0] + (radii[1] - radii[0]) * t;
                let foot = NodeId(skeleton.nodes.len() as u32);
                let original = skeleton.node(edge.nodes[usize::from(t > 0.5)]).original;
                skeleton.nodes.push(Node { position: a + (b - a) * t, radius, original });
                let own = skeleton.node(tip).radius;
                skeleton.edges.push(Edge { nodes: [tip, foot], radii: [own; 2] });
                skeleton.edges.push(Edge { nodes: [edge.nodes[0], foot], radii: [edge.radii[0], radius] });
                edge = Edge { nodes: [foot, edge.nodes[1]], radii: [radius, edge.radii[1]] };
            }
            if !self.gone[id.index()] {
                skeleton.edges.push(edge);
            }
        }
        skeleton
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_skeleton::fixtures::network;

    /// A trunk of radius 1 with a side branch of the given length at its middle.
    fn fork(length: f64) -> Skeleton {
        let points = [[-20.0, 0.0, 0.0], [0.0; 3], [20.0, 0.0, 0.0], [0.0, length, 0.0]];
        network(&points, 1.0, &[(0, 1), (1, 2), (1, 3)])
    }

    #[test]
    fn a_tip_that_could_not_be_capped_is_drawn_back_and_a_stub_taken_off() {
        for (length, done) in [(12.0, TouchedBy::Retracted { by: BACK }), (3.0, TouchedBy::Removed)] {
            let (result, told) = take_back(&fork(length), &[(3, 0)]).expect("vessels");
            let [tip] = told[..] else { panic!("one tip: {told:?}") };
            assert_eq!((tip.tip, tip.done), (3, done));
            assert_eq!(result.check(), Ok(()));
            let end = result.nodes.iter().find(|node| node.original == 3);
            match done {
                TouchedBy::Removed => assert!(end.is_none()),
                _ => assert!((end.expect("there").position.y - (length - BACK)).abs() < 1e-9),
            }
        }
        // A hair that does not leave its trunk, though it is long for its width.
        let mut hair = fork(0.9);
        hair.edges[2].radii = [0.02; 2];
        hair.nodes[3].radius = 0.02;
        let (_, told) = take_back(&hair, &[(3, 0)]).expect("vessels");
        assert_eq!(told[0].done, TouchedBy::Removed);
        // A thin end that folds back into its own vessel.
        let points = [[-20.0, 0.0, 0.0], [0.0; 3], [-0.6, 0.5, 0.0], [-0.9, 0.4, 0.0]];
        let mut folded = network(&points, 1.0, &[(0, 1), (1, 2), (2, 3)]);
        folded.edges[1].radii = [0.1; 2];
        folded.edges[2].radii = [0.01; 2];
        let (cut, told) = take_back(&folded, &[(3, 0)]).expect("vessels");
        let TouchedBy::Retracted { by } = told[0].done else { panic!("{told:?}") };
        assert!(by > 1.0, "{by}");
        let end = cut.nodes.iter().find(|node| node.original == 3).expect("there");
        assert!(end.position.y == 0.0 && end.radius == 1.0, "{end:?}");
        // A stub that has space beyond.
        let mut stub = fork(2.5);
        stub.edges[2].radii = [0.7; 2];
        stub.nodes[3].radius = 0.7;
        let (extended, told) = take_back(&stub, &[(3, 0)]).expect("vessels");
        let TouchedBy::Extended { by } = told[0].done else { panic!("{told:?}") };
        assert!((FORTH * 0.7..=2.5).contains(&by), "{by}");
        let end = extended.nodes.iter().find(|node| node.original == 3).expect("there");
        assert!((end.position.y - 2.5 - by).abs() < 1e-9);
        let given = fork(12.0);
        assert_eq!(take_back(&given, &[(1, 0), (77, 0)]).expect("vessels"), (given, Vec::new()));
    }

    #[test]
    fn a_tip_that_faces_another_one_is_in_its_way_however_near_its_branch_point_is() {
        // The other vessel is an obstacle, although the branch point is near.
        let mut broken = fork(4.0);
        let other = network(&[[0.0, 4.5, 0.0], [0.0, 24.0, 0.0]], 1.0, &[(0, 1)]);
        let first = broken.nodes.len() as u32;
        broken.nodes.extend(other.nodes.iter().map(|n| Node { original: n.original + first, ..*n }));
        let moved = |e: &Edge| Edge { nodes: e.nodes.map(|n| NodeId(n.0 + first)), ..*e };
        broken.edges.extend(other.edges.iter().map(moved));
        let (_, told) = treat(&broken, Touching::Retract, false).expect("vessels");
        assert!(told.iter().any(|tip| tip.done != TouchedBy::Left), "{told:?}");
        let (joined, _) = treat(&broken, Touching::Join, false).expect("vessels");
        assert_eq!(joined.components(&joined.adjacency()).list.len(), 1);
    }
}

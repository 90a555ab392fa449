//! Contact handling: pairs of vessels to watch, and the corrections that push them apart.

use super::frame::Frame;
use super::overlapping::in_crotches;
use super::push::{Push, project};
use anastomesh_mesh::geometry::{Aabb, Bvh, Tube, Vec3, segment_segment, tube_tube};
use anastomesh_skeleton::{Adjacency, Edge, EdgeId, JOINED, LocalDistances, NodeId, Skeleton, deepest_apart};
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

/// Distances along the skeleton between the ends of two edges; infinite if long.
type Ways = [[f64; 2]; 2];

/// Two edges without a common node that may come close to each other, in ascending order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub edges: [EdgeId; 2],
    /// Index into `Contacts::ways`; `u32::MAX` if all distances are long.
    ways: u32,
    /// Distance that the two edges may move together, from the search on, before they can be too close.
    slack: f32,
}

impl Pair {
    /// True if the two edges are near each other along the skeleton.
    pub fn is_near_along(&self) -> bool {
        self.ways != u32::MAX
    }
}

/// Pairs to watch.
#[derive(Default)]
pub(super) struct Contacts {
    pub pairs: Vec<Pair>,
    ways: Vec<Ways>,
    /// Pairs of edges that share a node.
    forks: Vec<(NodeId, [EdgeId; 2])>,
    /// Smaller clearances of some pairs, whose edges are in ascending order.
    pub smaller: FxHashMap<[EdgeId; 2], f64>,
    /// Smaller clearances of terminals that are close to others.
    tips: FxHashMap<NodeId, f64>,
}

/// Clearances of fixed terminals that are closer to others than vessels are to be, but do not overlap. Vessels that run there
/// side by side would be pushed apart without end.
pub(super) fn tip_clearances(skeleton: &Skeleton, adjacency: &Adjacency, clearance: f64) -> FxHashMap<NodeId, f64> {
    let mut wide = skeleton.clone();
    wide.nodes.iter_mut().for_each(|node| node.radius *= clearance);
    let mut tips = FxHashMap::default();
    for pair in wide.crowded_terminals(adjacency) {
        let own = clearance * pair.distance / pair.radii;
        for node in pair.nodes.into_iter().filter(|_| own >= 1.0) {
            tips.entry(node).and_modify(|least: &mut f64| *least = least.min(own)).or_insert(own);
        }
    }
    tips
}

/// Bounding box of all points within `clearance` radii of a tube's axis.
fn reach_box(tube: &Tube, clearance: f64) -> Aabb {
    let ball = |p, r: f64| Aabb::of_points([p]).grown(clearance * r);
    ball(&tube.a, tube.ra).union(&ball(&tube.b, tube.rb))
}

impl Contacts {
    /// Finds all pairs that may come within `clearance` sums of their radii while the nodes of each edge move by at most its skin.
    /// In `measured` networks without those in the crotch of a bifurcation, which do not overlap.
    pub fn find(frame: &Frame, clearance: f64, skins: &[f64], measured: bool) -> Self {
        let s = &frame.skeleton;
        let found = search(frame, clearance, skins, &vec![true; s.edges.len()]);
        let crotches = if measured { in_crotches(s, &frame.adjacency, clearance) } else { Vec::new() };
        let crotches: FxHashSet<[EdgeId; 2]> = crotches.into_iter().collect();
        let tips = if measured { tip_clearances(s, &frame.adjacency, clearance) } else { FxHashMap::default() };
        let mut contacts = Self { tips, ..Self::default() };
        for (pairs, ways) in &found {
            for pair in pairs {
                contacts.add(pair, ways);
            }
        }
        for node in s.node_ids() {
            let edges = frame.adjacency.edges(node);
            if edges.len() > 2 || frame.is_fold[node.index()] {
                for (i, &e) in edges.iter().enumerate() {
                    let pairs = edges[..i].iter().map(|&f| (node, [f, e]));
                    contacts.forks.extend(pairs.filter(|(_, pair)| !crotches.contains(&ascending(*pair))));
                }
            }
        }
        contacts.pairs.retain(|pair| !crotches.contains(&ascending(pair.edges)));
        contacts
    }

    /// Searches again for the pairs of edges of `nodes`. Other nodes may still move as far as before the last search.
    pub fn search_again(&mut self, frame: &Frame, clearance: f64, skins: &[f64], nodes: &[bool]) {
        let is_searched: Vec<bool> =
            frame.skeleton.edges.iter().map(|edge| edge.nodes.iter().any(|node| nodes[node.index()])).collect();
        let found = search(frame, clearance, skins, &is_searched);
        let mut new: Vec<(Pair, &[Ways])> =
            found.iter().flat_map(|(pairs, ways)| pairs.iter().map(move |pair| (*pair, &ways[..]))).collect();
        new.par_sort_unstable_by_key(|(pair, _)| pair.edges);
        let (old_pairs, old_ways) = (std::mem::take(&mut self.pairs), std::mem::take(&mut self.ways));
        let mut new = new.into_iter().peekable();
        for pair in old_pairs.iter().filter(|pair| pair.edges.iter().all(|edge| !is_searched[edge.index()])) {
            while let Some((pair, ways)) = new.next_if(|(other, _)| other.edges < pair.edges) {
                self.add(&pair, ways);
            }
            self.add(pair, &old_ways);
        }
        new.for_each(|(pair, ways)| self.add(&pair, ways));
    }

    /// Adds a pair whose distances along the skeleton are in `ways`.
    fn add(&mut self, pair: &Pair, ways: &[Ways]) {
        let own = ways.get(pair.ways as usize).map_or(u32::MAX, |own| {
            self.ways.push(*own);
            self.ways.len() as u32 - 1
        });
        self.pairs.push(Pair { ways: own, ..*pair });
    }

    /// Drops pairs whose nodes are all fixed.
    pub fn drop_fixed(&mut self, frame: &Frame) {
        let moves = |e: EdgeId| frame.skeleton.edge(e).nodes.iter().any(|n| frame.mobility[n.index()] > 0.0);
        self.pairs.retain(|pair| pair.edges.into_iter().any(moves));
        self.forks.retain(|(_, pair)| pair.iter().any(|&e| moves(e)));
    }

    /// Corrections of all pairs closer than `clearance` sums of their radii. `moved`: upper bound of the displacement of each node
    /// since the last search for its contacts.
    pub fn pushes(&self, frame: &Frame, clearance: f64, moved: &[f64]) -> Vec<Push> {
        let of_edge = |edge: &Edge| edge.nodes.map(|n| moved[n.index()]).into_iter().fold(0.0, f64::max);
        let moved: Vec<f64> = frame.skeleton.edges.iter().map(of_edge).collect();
        let is_asleep = |pair: &Pair| {
            let [e, f] = pair.edges.map(|e| moved[e.index()]);
            e + f < f64::from(pair.slack)
        };
        let apart = self.pairs.par_iter().with_min_len(512).fold(Vec::new, |mut out, pair| {
            if !is_asleep(pair) {
                self.push_apart(frame, pair, self.clearance(pair.edges, clearance), &mut out);
            }
            out
        });
        let forks = self.forks.par_iter().with_min_len(512).fold(Vec::new, |mut out, fork| {
            push_fork(frame, fork, self.clearance(fork.1, clearance), &mut out);
            out
        });
        // Folds preserve the order of the pairs, for any division of the work.
        let mut all: Vec<Push> = apart.collect::<Vec<_>>().concat();
        all.extend(forks.collect::<Vec<_>>().concat());
        all
    }

    /// Clearance of a pair.
    fn clearance(&self, edges: [EdgeId; 2], usual: f64) -> f64 {
        if self.smaller.is_empty() {
            usual
        } else {
            self.smaller.get(&ascending(edges)).map_or(usual, |c| c.min(usual))
        }
    }

    /// Clearances at the ends of two edges.
    fn at_ends(&self, frame: &Frame, edges: [EdgeId; 2], usual: f64) -> [[f64; 2]; 2] {
        let own = |n: NodeId| self.tips.get(&n).map_or(usual, |c| c.min(usual));
        if self.tips.is_empty() { [[usual; 2]; 2] } else { edges.map(|e| frame.skeleton.edge(e).nodes.map(own)) }
    }

    fn push_apart(&self, frame: &Frame, pair: &Pair, clearance: f64, out: &mut Vec<Push>) {
        let [a, b] = pair.edges.map(|e| frame.skeleton.tube(e));
        let axes = segment_segment([&a.a, &a.b], [&b.a, &b.b]);
        if axes.distance >= clearance * (a.max_radius() + b.max_radius()) {
            return;
        }
        let ends = self.at_ends(frame, pair.edges, clearance);
        let place = if let Some(&ways) = self.ways.get(pair.ways as usize) {
            deepest_apart(&a, &b, ways, ends)
        } else {
            let wide = |t: &Tube, by: [f64; 2]| Tube { ra: by[0] * t.ra, rb: by[1] * t.rb, ..*t };
            let near = tube_tube(&wide(&a, ends[0]), &wide(&b, ends[1]));
            (near.gap < 0.0).then_some((near.s, near.t))
        };
        if let Some(place) = place {
            push_tubes(frame, pair.edges, [a, b], place, mean([a, b], place, ends), out);
        }
    }
}

/// Clearance at a place of each tube, from those at their ends.
fn mean([a, b]: [Tube; 2], (s, t): (f64, f64), ends: [[f64; 2]; 2]) -> f64 {
    let usual = ends[0][0];
    if ends == [[usual; 2]; 2] {
        return usual;
    }
    let wide = |tube: &Tube, by: [f64; 2], x: f64| by[0] * tube.ra * (1.0 - x) + by[1] * tube.rb * x;
    (wide(&a, ends[0], s) + wide(&b, ends[1], t)) / (a.radius(s) + b.radius(t))
}

/// Edges in ascending order.
fn ascending([e, f]: [EdgeId; 2]) -> [EdgeId; 2] {
    [e.min(f), e.max(f)]
}

/// Pairs of edges, one of which at least is searched, with their distances along the skeleton. Those of the first edge are
/// sorted, in chunks.
fn search(frame: &Frame, clearance: f64, skins: &[f64], is_searched: &[bool]) -> Vec<(Vec<Pair>, Vec<Ways>)> {
    let s = &frame.skeleton;
    let boxes: Vec<Aabb> =
        s.edge_ids().zip(skins).map(|(e, skin)| reach_box(&s.tube(e), clearance).grown(*skin)).collect();
    let tree = Bvh::new(&boxes);
    let edges: Vec<u32> = (0..).zip(is_searched).filter_map(|(e, &searched)| searched.then_some(e)).collect();
    let chunks = edges.par_chunks(256).map_init(
        || (Vec::new(), [LocalDistances::default(), LocalDistances::default()]),
        |(near, walks), chunk| {
            let mut out = (Vec::new(), Vec::new());
            for &e in chunk {
                near.clear();
                tree.query(&boxes[e as usize], |f| {
                    if f > e || !is_searched[f as usize] {
                        near.push(EdgeId(f));
                    }
                });
                near.sort_unstable();
                pairs_of(frame, EdgeId(e), near, (clearance, skins), walks, &mut out);
            }
            out
        },
    );
    chunks.collect()
}

fn pairs_of(
    frame: &Frame,
    first: EdgeId,
    near: &[EdgeId],
    (clearance, skins): (f64, &[f64]),
    walks: &mut [LocalDistances; 2],
    out: &mut (Vec<Pair>, Vec<Ways>),
) {
    let s = &frame.skeleton;
    let tube = s.tube(first);
    let ends = s.edge(first).nodes;
    let (mut radius, mut furthest) = (tube.max_radius(), 0.0_f64);
    let start = out.0.len();
    for &second in near {
        let other = s.tube(second);
        let nodes = s.edge(second).nodes;
        if ends.iter().any(|n| nodes.contains(n)) {
            continue;
        }
        let axes = segment_segment([&tube.a, &tube.b], [&other.a, &other.b]);
        let skin = skins[first.index()] + skins[second.index()];
        let slack = axes.distance - clearance * (tube.max_radius() + other.max_radius());
        if slack < skin {
            radius = radius.max(other.max_radius());
            furthest = furthest.max(skin);
            out.0.push(Pair { edges: [first, second], ways: u32::MAX, slack: (slack as f32).next_down() });
        }
    }
    if out.0.len() == start {
        return;
    }
    for (walk, end) in walks.iter_mut().zip(ends) {
        walk.search(s, &frame.adjacency, end, JOINED * radius + furthest);
    }
    for i in start..out.0.len() {
        let nodes = s.edge(out.0[i].edges[1]).nodes;
        let ways = walks.each_ref().map(|walk| nodes.map(|n| walk.of(n)));
        if ways.iter().flatten().any(|w| w.is_finite()) {
            out.0[i].ways = out.1.len() as u32;
            out.1.push(ways);
        }
    }
    for pair in out.0[start..].iter_mut().filter(|pair| !pair.edges.is_sorted()) {
        pair.edges.reverse();
        if let Some([[_, a], [b, _]]) = out.1.get_mut(pair.ways as usize) {
            std::mem::swap(a, b);
        }
    }
}

/// Pushes two vessels of one node apart if they are too close beyond three radii from it.
fn push_fork(frame: &Frame, &(node, edges): &(NodeId, [EdgeId; 2]), clearance: f64, out: &mut Vec<Push>) {
    let [a, b] = edges.map(|e| frame.skeleton.tube(e));
    let [e, f] = edges.map(|e| frame.skeleton.edge(e));
    let far = [e.other(node), f.other(node)];
    let [u, v] = far.map(|n| frame.at(n) - frame.at(node));
    let (lu, lv) = (u.norm(), v.norm());
    let radius = a.min_radius().max(b.min_radius());
    if lu + lv <= JOINED * radius {
        return;
    }
    if frame.is_as_close_as_may_be(node, far) {
        return;
    }
    // Equal vessels separate within three radii if sin(angle / 2) > clearance / 3.
    let half = (clearance / 3.0).min(1.0);
    if u.dot(&v) < (1.0 - 2.0 * half * half) * lu * lv {
        return;
    }
    let mut ways = [[f64::INFINITY; 2]; 2];
    ways[e.end(node)][f.end(node)] = 0.0;
    let Some((s, t)) = deepest_apart(&a, &b, ways, [[clearance; 2]; 2]) else { return };
    let Closeness { normal, distance, radii } = closeness(&a, &b, (s, t));
    // The places keep their distance from the node, beyond which vessels count as separate. The node can thus open the
    // bifurcation by moving towards both ends, though directions do not change to first order.
    let (u, v) = (u / lu, v / lv);
    let [s, t] = [(s, e), (t, f)].map(|(x, edge)| if edge.end(node) == 0 { x } else { 1.0 - x });
    let across = |axis: &Vec3| normal - axis * axis.dot(&normal);
    let (by_e, by_f) = (across(&u) * s, across(&v) * -t);
    let gradient = [(far[0], by_e), (far[1], by_f), (node, -by_e - by_f)];
    project(frame, &gradient, clearance * radii - distance, 0.5 * radii, out);
}

/// Requests the distance at one place of each tube.
fn push_tubes(
    frame: &Frame,
    edges: [EdgeId; 2],
    [a, b]: [Tube; 2],
    (s, t): (f64, f64),
    clearance: f64,
    out: &mut Vec<Push>,
) {
    let Closeness { normal, distance, radii } = closeness(&a, &b, (s, t));
    let [e, f] = edges.map(|e| frame.skeleton.edge(e).nodes);
    let gradient = [(e[0], normal * (1.0 - s)), (e[1], normal * s), (f[0], normal * (t - 1.0)), (f[1], normal * -t)];
    project(frame, &gradient, clearance * radii - distance, 0.5 * radii, out);
}

/// Relative position of two tubes at a place of each.
struct Closeness {
    /// Push direction of the first tube.
    normal: Vec3,
    /// Distance of the axes.
    distance: f64,
    /// Sum of the radii.
    radii: f64,
}

fn closeness(a: &Tube, b: &Tube, (s, t): (f64, f64)) -> Closeness {
    let way = a.point(s) - b.point(t);
    let (distance, radii) = (way.norm(), a.radius(s) + b.radius(t));
    // Intersecting axes define no direction.
    let normal = if distance > 1e-6 * radii { way / distance } else { parting(a, b) };
    Closeness { normal, distance, radii }
}

/// Push direction for vessels with intersecting axes: normal to both, or to one if they are parallel.
fn parting(a: &Tube, b: &Tube) -> Vec3 {
    let (d, e) = (a.b - a.a, b.b - b.a);
    let across = d.cross(&e);
    if across.norm() > 1e-6 * d.norm() * e.norm() {
        return across.normalize();
    }
    let mut axis = Vec3::zeros();
    axis[d.iamin()] = 1.0;
    d.cross(&axis).try_normalize(0.0).unwrap_or(axis)
}

#[cfg(test)]
mod tests {
    use super::super::tests::tangle;
    use super::*;
    use anastomesh_skeleton::paper_unit;

    #[test]
    fn searching_again_finds_the_contacts_of_moved_nodes() {
        let skeleton = tangle(6, 3);
        let unit = paper_unit(&skeleton);
        let mut frame = Frame::new(skeleton, 1e9, 1e9, unit);
        let (clearance, skins) = (1.1, &vec![15.0 * unit; frame.skeleton.edges.len()]);
        let mut contacts = Contacts::find(&frame, clearance, skins, false);
        let before: Vec<_> = contacts.pairs.iter().map(|pair| pair.edges).collect();
        let is_moved: Vec<bool> = (0..frame.skeleton.nodes.len()).map(|i| i % 7 == 3).collect();
        for (node, _) in frame.skeleton.nodes.iter_mut().zip(&is_moved).filter(|(_, moved)| **moved) {
            node.position += Vec3::new(4.0, -3.0, 2.0) * unit;
        }
        contacts.search_again(&frame, clearance, skins, &is_moved);
        let anew = Contacts::find(&frame, clearance, skins, false);
        let edges = |contacts: &Contacts| contacts.pairs.iter().map(|pair| pair.edges).collect::<Vec<_>>();
        assert_eq!(edges(&contacts), edges(&anew));
        assert_ne!(edges(&anew), before);
        let is_searched = |e: EdgeId| frame.skeleton.edge(e).nodes.iter().any(|n| is_moved[n.index()]);
        let (mut reversed, mut compared) = (0, 0);
        for (pair, other) in contacts.pairs.iter().zip(&anew.pairs) {
            let [own, other] = [(&contacts, pair), (&anew, other)].map(|(of, pair)| of.ways.get(pair.ways as usize));
            let (Some(own), Some(other), true) = (own, other, pair.edges.into_iter().any(is_searched)) else {
                continue;
            };
            compared += 1;
            reversed += usize::from(!is_searched(pair.edges[0]) && own[0][1] != own[1][0]);
            for (x, y) in own.as_flattened().iter().zip(other.as_flattened()) {
                assert!(!(x.is_finite() && y.is_finite()) || (x - y).abs() < 1e-9 * x.max(1.0), "{own:?} {other:?}");
            }
        }
        assert!(compared > 50 && reversed > 10, "{compared} {reversed}");
    }

    #[test]
    fn pairs_that_are_not_computed_ask_for_nothing() {
        let skeleton = tangle(6, 3);
        let unit = paper_unit(&skeleton);
        let mut frame = Frame::new(skeleton, 1e9, 1e9, unit);
        let (clearance, skins) = (1.1, vec![15.0 * unit; frame.skeleton.edges.len()]);
        let contacts = Contacts::find(&frame, clearance, &skins, false);
        let none = vec![0.0; frame.skeleton.nodes.len()];
        let all = vec![f64::INFINITY; none.len()];
        let (mut moved, mut pushes) = (none, Vec::new());
        for round in 0..8 {
            for (i, node) in frame.skeleton.nodes.iter_mut().enumerate().filter(|(i, _)| i % 8 == round) {
                let step = Vec3::new(2.0, -1.0, 2.0) * ((i % 5) as f64 * unit);
                node.position += step;
                moved[i] += step.norm();
            }
            let now = contacts.pushes(&frame, clearance, &moved);
            assert_eq!(now, contacts.pushes(&frame, clearance, &all));
            assert_ne!(now, pushes);
            pushes = now;
        }
        let asleep = contacts.pairs.iter().filter(|pair| {
            let far = |e: EdgeId| frame.skeleton.edge(e).nodes.iter().map(|n| moved[n.index()]).fold(0.0, f64::max);
            far(pair.edges[0]) + far(pair.edges[1]) < f64::from(pair.slack)
        });
        assert!(asleep.count() > 20 && !pushes.is_empty());
    }
}

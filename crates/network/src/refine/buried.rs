//! Buried terminals: those inside another vessel of their own bifurcation, which they have not left at their end. Their vessel
//! is turned away from the other one, about the bifurcation.

use super::crowd::APART;
use super::overlapping::in_crotches;
use super::params::{Crowded, RefineParams};
use anastomesh_mesh::geometry::{Point3, Vec3, point_segment};
use anastomesh_skeleton::{Branches, EdgeId, NodeId, Skeleton};
use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};

/// Maximum number of sweeps: a terminal that leaves one vessel may enter another.
const SWEEPS: usize = 20;

/// Terminal inside another vessel of its bifurcation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BuriedTip {
    /// The terminal, as an index into the input.
    pub node: u32,
    /// Ends of the other vessel's edge at this place.
    pub edge: [u32; 2],
    /// Distance of the terminal from the axis of the other vessel.
    pub distance: f64,
    /// Sum of both radii there.
    pub radii: f64,
    /// True if the terminal is outside now.
    pub resolved: bool,
    /// Displacement of the terminal.
    pub moved: f64,
}

/// A terminal in another vessel.
#[derive(Clone, Copy)]
struct Place {
    tip: NodeId,
    /// Its edge.
    own: EdgeId,
    /// Edge of the other vessel.
    other: EdgeId,
    /// From the axis of the other vessel to the terminal.
    way: Vec3,
    radii: f64,
}

impl Place {
    fn of(skeleton: &Skeleton, own: EdgeId, tip: NodeId, other: EdgeId) -> Self {
        let (tube, at) = (skeleton.tube(other), skeleton.node(tip));
        let (t, _) = point_segment(&at.position, &tube.a, &tube.b);
        Self { tip, own, other, way: at.position - tube.point(t), radii: at.radius + tube.radius(t) }
    }

    /// Distance in sums of the radii.
    fn relative(&self) -> f64 {
        self.way.norm() / self.radii
    }
}

/// Lists buried terminals, and turns their vessels away if `params.crowded` parts terminals. The other vessels of the bifurcation
/// must be in their places: this comes after terminals were parted.
pub(super) fn treat(skeleton: &mut Skeleton, params: &RefineParams) -> Vec<BuriedTip> {
    let found = buried(skeleton);
    let branches = skeleton.branches(&skeleton.adjacency());
    let before: Vec<Point3> = found.iter().map(|place| skeleton.node(place.tip).position).collect();
    let mut left = found.clone();
    if params.crowded == Crowded::Part {
        for _ in 0..SWEEPS {
            for place in &left {
                turn(skeleton, &branches, place);
            }
            left = buried(skeleton);
            if left.is_empty() {
                break;
            }
        }
    }
    let original = |n: NodeId| skeleton.node(n).original;
    let report = |(place, before): (&Place, Point3)| BuriedTip {
        node: original(place.tip),
        edge: skeleton.edge(place.other).nodes.map(original),
        distance: place.way.norm(),
        radii: place.radii,
        resolved: left.iter().all(|other| other.tip != place.tip),
        moved: (skeleton.node(place.tip).position - before).norm(),
    };
    found.iter().zip(before).map(report).collect()
}

/// Terminals inside a vessel with which they share a crotch, each with the vessel that it is deepest in.
fn buried(skeleton: &Skeleton) -> Vec<Place> {
    let adjacency = skeleton.adjacency();
    let mut deepest: FxHashMap<NodeId, Place> = FxHashMap::default();
    for pair in in_crotches(skeleton, &adjacency, 1.0) {
        for (own, other) in [(pair[0], pair[1]), (pair[1], pair[0])] {
            let Some(tip) = skeleton.edge(own).nodes.into_iter().find(|&n| adjacency.valence(n) == 1) else { continue };
            let place = Place::of(skeleton, own, tip, other);
            if place.relative() < 1.0 {
                let deep = deepest.entry(tip).or_insert(place);
                if place.relative() < deep.relative() {
                    *deep = place;
                }
            }
        }
    }
    let mut all: Vec<Place> = deepest.into_values().collect();
    all.sort_unstable_by_key(|place| place.tip);
    all
}

/// Turns the vessel of a terminal about its bifurcation until the terminal is `APART`. Each node moves in proportion to its
/// distance along the vessel.
fn turn(skeleton: &mut Skeleton, branches: &Branches, place: &Place) {
    // Another vessel may have moved since.
    let place = Place::of(skeleton, place.own, place.tip, place.other);
    let lacking = APART * place.radii - place.way.norm();
    let branch = &branches.list[branches.of_edge[place.own.index()].0.index()];
    if lacking <= 0.0 || branch.length() <= 0.0 {
        return;
    }
    let tube = skeleton.tube(place.other);
    let away = place.way.try_normalize(1e-9 * place.radii).unwrap_or_else(|| across(tube.b - tube.a)) * lacking;
    let is_last = branch.ends()[1] == place.tip;
    for (node, arc) in branch.nodes.iter().zip(&branch.arc) {
        let share = arc / branch.length();
        skeleton.nodes[node.index()].position += away * if is_last { share } else { 1.0 - share };
    }
}

/// A direction at right angles to another.
fn across(axis: Vec3) -> Vec3 {
    let mut other = Vec3::zeros();
    other[axis.iamin()] = 1.0;
    axis.cross(&other).try_normalize(0.0).unwrap_or(other)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{network, run};
    use super::*;

    /// A trunk, and two branches that leave it at an angle of 2 degrees. The shorter one ends inside the other.
    fn narrow_fork() -> Skeleton {
        let points =
            [[-30.0, 0.0, 0.0], [0.0; 3], [12.0, 0.2, 0.0], [24.0, 0.4, 0.0], [60.0, -1.0, 0.0], [90.0, -9.0, 0.0]];
        network(&points, 1.0, &[(0, 1), (1, 2), (2, 3), (1, 4), (4, 5)])
    }

    #[test]
    fn a_terminal_inside_another_vessel_turns_out_of_it() {
        let given = narrow_fork();
        let refined = run(&given, &RefineParams::default());
        let [tip] = &refined.report.buried[..] else { panic!("{:?}", refined.report.buried) };
        assert!(tip.node == 3 && tip.edge == [1, 4] && tip.resolved, "{tip:?}");
        assert!((0.7..1.0).contains(&tip.distance) && tip.radii == 2.0);
        let after = &refined.skeleton;
        assert!(buried(after).is_empty());
        let moved = |i: usize| (after.nodes[i].position - given.nodes[i].position).norm();
        assert!((moved(3) - tip.moved).abs() < 1e-12 && (moved(2) - 0.5 * tip.moved).abs() < 1e-2);
        assert!(moved(0) + moved(1) + moved(4) + moved(5) == 0.0);
    }

    #[test]
    fn it_is_listed_alone_if_terminals_are_kept() {
        let kept = run(&narrow_fork(), &RefineParams { crowded: Crowded::Keep, ..RefineParams::default() });
        assert!(kept.report.buried.iter().all(|tip| !tip.resolved && tip.moved == 0.0));
        assert_eq!(kept.report.buried.len(), 1);
    }
}

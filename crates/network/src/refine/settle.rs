//! Return of displaced nodes towards their places.
//!
//! A group of vessels goes back as a whole in `tighten`, until the first two of them touch. Here each node goes back
//! alone: it is pulled to its place, and projection keeps the vessels apart. No node ends further away than it was.

use super::contact::Contacts;
use super::frame::Frame;
use super::params::RefineError;
use super::shape;
use super::tighten::{Groups, close, kept};
use anastomesh_mesh::geometry::{Point3, Vec3};
use anastomesh_mesh::progress::Progress;
use anastomesh_skeleton::{Adjacency, Edge, EdgeId, Node, NodeId, Overlap, Overlaps, Skeleton};
use rustc_hash::{FxHashMap, FxHashSet};

/// Maximum number of rounds in which nodes return that came too close to others. In the second half, whole groups do.
const ROUNDS: usize = 24;
/// Reduction of the share by which a node returns, from each node to the next.
const FALL: f64 = 0.34;
/// Number of pulls, and fraction of the displacement that each takes back.
const PULLS: usize = 40;
const PULL: f64 = 0.12;
/// Projections after each pull, and after the last one.
const PROJECTIONS: usize = 4;
const LAST_PROJECTIONS: usize = 80;
/// Maximum number of pairs of close vessels, a constant and a number per edge. Vessels of denser networks do not settle.
const MAX_PAIRS: [usize; 2] = [100_000, 200];
/// Factor on the clearance of the projections, which leave pairs slightly short of it.
const MARGIN: f64 = 1.005;
/// Exponent of the combined correction of a node, as in the iterations.
const AVERAGE: f64 = 0.25;
/// Relative distance by which a pair may come closer than it was, or than the clearance.
const TOLERANCE: f64 = 0.004;

/// Moves displaced nodes back towards `origin`. `clearance`: target distance of the iterations, in sums of radii; `unit`: the
/// paper's unit.
///
/// # Errors
/// [`RefineError::Cancelled`].
pub(super) fn settle(
    skeleton: &mut Skeleton,
    origin: &[Point3],
    clearance: f64,
    unit: f64,
    progress: &dyn Progress,
) -> Result<(), RefineError> {
    let Some(groups) = Groups::of(skeleton, origin, clearance) else { return Ok(()) };
    let adjacency = skeleton.adjacency();
    let touching = |s: &Skeleton| close(s, &adjacency, kept(clearance));
    // Distances of pairs that lack the clearance already, relative to it.
    let relative = |o: &Overlap| o.distance / o.radii;
    let before: FxHashMap<[EdgeId; 2], f64> = touching(skeleton).pairs.iter().map(|o| (o.edges, relative(o))).collect();
    let overlapping: FxHashSet<[EdgeId; 2]> = close(skeleton, &adjacency, 1.0).pairs.iter().map(|o| o.edges).collect();
    let settled = settled(skeleton, origin, (&groups.of_node, &before), kept(clearance), unit, progress)?;
    // Nodes that come too close to others return to where they were, with those around them. Then others may be too close to
    // these.
    let moved: Vec<Point3> = skeleton.nodes.iter().map(|node| node.position).collect();
    let mut shares = vec![0.0_f64; moved.len()];
    for round in 0..=ROUNDS {
        if progress.is_cancelled() {
            return Err(RefineError::Cancelled);
        }
        let mut state = skeleton.clone();
        for (i, _) in groups.of_node.iter().enumerate().filter(|(_, group)| group.is_some()) {
            state.nodes[i].position = settled[i] + (moved[i] - settled[i]) * shares[i];
        }
        let mut after = touching(&state);
        after.pairs.retain(|o| relative(o) < before.get(&o.edges).copied().unwrap_or(1.0) - TOLERANCE);
        if after.pairs.is_empty() {
            // The rule for crotches depends on radii: pairs that it leaves out with the clearance may overlap without.
            after = close(&state, &adjacency, 1.0);
            after.pairs.retain(|o| !overlapping.contains(&o.edges));
        }
        if after.pairs.is_empty() {
            *skeleton = state;
            break;
        }
        if round < ROUNDS / 2 {
            return_around(&state, &adjacency, &after, &mut shares);
        } else {
            let worse = groups.touching(after.pairs);
            let returns = |group: &Option<usize>| group.is_some_and(|g| worse[g]);
            shares
                .iter_mut()
                .zip(&groups.of_node)
                .filter(|(_, group)| returns(group))
                .for_each(|(share, _)| *share = 1.0);
        }
    }
    Ok(())
}

/// Makes the nodes of close pairs return, and those around them in part.
fn return_around(skeleton: &Skeleton, adjacency: &Adjacency, close: &Overlaps, shares: &mut [f64]) {
    let mut ring: Vec<NodeId> = close.pairs.iter().flat_map(|o| o.nodes).flatten().collect();
    let mut seen = FxHashSet::default();
    // A node that has returned already leaves it to those around it.
    let mut share: f64 = 1.0;
    while share > 0.0 {
        ring.retain(|node| seen.insert(*node));
        let is_spent = ring.iter().all(|node| shares[node.index()] >= share);
        for node in &ring {
            shares[node.index()] = shares[node.index()].max(share);
        }
        share = if is_spent { share } else { share - FALL };
        let around =
            |node: &NodeId| adjacency.edges(*node).iter().map(|&edge| skeleton.edge(edge).other(*node)).collect();
        ring = ring.iter().flat_map(|node| -> Vec<NodeId> { around(node) }).collect();
        if ring.is_empty() {
            break;
        }
    }
}

/// Positions of the nodes after pulls and projections. Nodes without a group stay. `before`: relative distances of pairs
/// without the clearance, which keep these.
fn settled(
    skeleton: &Skeleton,
    origin: &[Point3],
    (groups, before): (&[Option<usize>], &FxHashMap<[EdgeId; 2], f64>),
    clearance: f64,
    unit: f64,
    progress: &dyn Progress,
) -> Result<Vec<Point3>, RefineError> {
    let mut frame = Frame::new(skeleton.clone(), 0.0, f64::INFINITY, unit);
    frame.hold();
    frame.origin = origin.to_vec();
    let mut off = vec![0.0_f64; origin.len()];
    for node in skeleton.node_ids().filter(|n| groups[n.index()].is_some()) {
        off[node.index()] = (frame.at(node) - origin[node.index()]).norm();
        frame.loosen(node, off[node.index()]);
    }
    // A node stays within its displacement of its place, so that these pairs suffice.
    let skin = |edge: &Edge| 2.0 * edge.nodes.map(|n| off[n.index()]).into_iter().fold(0.0, f64::max);
    let skins: Vec<f64> = skeleton.edges.iter().map(skin).collect();
    let mut contacts = Contacts::find(&frame, MARGIN * clearance, &skins, true);
    contacts.drop_fixed(&frame);
    if contacts.pairs.len() > MAX_PAIRS[0] + MAX_PAIRS[1] * skeleton.edges.len() {
        return Ok(skeleton.nodes.iter().map(|n| n.position).collect());
    }
    // Pairs that cannot have the clearance would push all nodes around them for nothing.
    contacts.smaller = before.iter().map(|(&pair, relative)| (pair, MARGIN * clearance * relative)).collect();
    for pull in 0..=PULLS {
        if pull < PULLS {
            for i in (0..origin.len()).filter(|&i| frame.mobility[i] > 0.0) {
                let from = frame.skeleton.nodes[i].position;
                frame.skeleton.nodes[i].position = from + (origin[i] - from) * PULL;
            }
        }
        for _ in 0..if pull < PULLS { PROJECTIONS } else { LAST_PROJECTIONS } {
            if progress.is_cancelled() {
                return Err(RefineError::Cancelled);
            }
            if !project(&mut frame, &contacts, &skeleton.nodes, MARGIN * clearance) {
                break;
            }
        }
    }
    Ok(frame.skeleton.nodes.iter().map(|n| n.position).collect())
}

/// Pushes vessels apart once. Returns false if all have the clearance. `searched`: nodes at the search for contacts.
fn project(frame: &mut Frame, contacts: &Contacts, searched: &[Node], clearance: f64) -> bool {
    let nodes = frame.skeleton.nodes.iter().zip(searched);
    let moved: Vec<f64> = nodes.map(|(now, then)| (now.position - then.position).norm()).collect();
    let pushes = contacts.pushes(frame, clearance, &moved);
    if pushes.is_empty() {
        return false;
    }
    let n = frame.origin.len();
    let (mut sum, mut count) = (vec![Vec3::zeros(); n], vec![0_u32; n]);
    for (node, push) in pushes {
        sum[node.index()] += push;
        count[node.index()] += 1;
    }
    sum.iter_mut().zip(&count).for_each(|(sum, &count)| *sum /= libm::pow(f64::from(count.max(1)), AVERAGE));
    frame.clip(&mut sum);
    shape::smooth_steps(frame, &mut sum, &count);
    for (i, step) in sum.iter().enumerate().filter(|(_, step)| step.norm_squared() > 0.0) {
        let home = frame.origin[i];
        let way = frame.skeleton.nodes[i].position + step - home;
        let share = (frame.leash[i] / way.norm()).min(1.0);
        frame.skeleton.nodes[i].position = home + way * share;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_skeleton::fixtures::network;

    /// A vessel along x, and one along y that came from a height of 1.2 and went up to `height`, far beyond the crossing too.
    fn crossing(height: f64) -> (Skeleton, Vec<Point3>) {
        let ys = [-12.0, -8.0, -4.0, 0.0, 4.0, 8.0, 12.0];
        let place = |&y: &f64| [0.0, y, if y.abs() < 12.0 { height } else { 1.2 }];
        let mut points = vec![[-9.0, 0.0, 0.0], [9.0, 0.0, 0.0]];
        points.extend(ys.iter().map(place));
        let edges: Vec<(u32, u32)> = [(0, 1)].into_iter().chain((2..8).map(|i| (i, i + 1))).collect();
        let skeleton = network(&points, 1.0, &edges);
        let mut origin: Vec<Point3> = skeleton.nodes.iter().map(|n| n.position).collect();
        origin[2..].iter_mut().for_each(|p| p.z = 1.2);
        (skeleton, origin)
    }

    #[test]
    fn nodes_go_back_by_themselves() {
        let (mut skeleton, origin) = crossing(2.4);
        let before = skeleton.clone();
        settle(&mut skeleton, &origin, 1.2, 1.0, &()).unwrap();
        let heights: Vec<f64> = skeleton.nodes[2..].iter().map(|n| n.position.z).collect();
        assert!((2.1..2.39).contains(&heights[3]), "{heights:?}");
        assert!(heights[1] < 2.0 && heights[5] < 2.0, "{heights:?}");
        assert!(close(&skeleton, &skeleton.adjacency(), kept(1.2)).pairs.is_empty());
        let off = |s: &Skeleton, i: usize| (s.nodes[i].position - origin[i]).norm();
        assert!((0..skeleton.nodes.len()).all(|i| off(&skeleton, i) <= off(&before, i) + 1e-12));
    }

    #[test]
    fn vessels_that_are_too_close_come_no_closer() {
        let (mut skeleton, origin) = crossing(1.9);
        let relative =
            |s: &Skeleton| close(s, &s.adjacency(), 1.2).pairs.iter().map(|o| o.distance / o.radii).collect();
        let before: Vec<f64> = relative(&skeleton);
        settle(&mut skeleton, &origin, 1.2, 1.0, &()).unwrap();
        let after: Vec<f64> = relative(&skeleton);
        assert!(after.iter().all(|x| *x >= before[0] - TOLERANCE), "{before:?} {after:?}");
    }

    #[test]
    fn it_can_be_cancelled() {
        struct Stops;
        impl Progress for Stops {
            fn is_cancelled(&self) -> bool {
                true
            }
        }
        let (mut skeleton, origin) = crossing(2.4);
        assert_eq!(settle(&mut skeleton, &origin, 1.2, 1.0, &Stops), Err(RefineError::Cancelled));
    }
}

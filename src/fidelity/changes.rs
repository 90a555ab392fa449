//! Changes of the network between its file and its mesh: what was moved, shrunk, extended, fused or dropped.
//!
//! The repairs report what they do in lengths. Here a dropped vessel counts by its length outside the lumen, in its radii.
//! A spur within a thick vessel is no loss, and a thin branch of the same length is one.

use anastomesh_mesh::Cap;
use anastomesh_network::{PrepareReport, RefineReport, TouchedBy, TouchingTip, Treatment};
use anastomesh_skeleton::Tubes;
use anastomesh_skeleton::{Branch, NodeId, Skeleton};
use rustc_hash::{FxHashMap, FxHashSet};
use serde::Serialize;

/// Minimum displacement of a node, or of a line from that with which it was merged, in its radii, that counts as a change.
const MOVED: f64 = 0.05;
/// Minimum displacement of a cap, in its radii, that counts as extended.
const EXTENDED: f64 = 0.1;
/// Step along a dropped vessel, in its radii.
const STEP: f64 = 0.25;
/// Distance beyond a wall, in radii of its vessel, from which a place lies outside the lumen.
const OUTSIDE: f64 = 0.02;
/// Maximum samples along a dropped vessel.
const MOST_STEPS: usize = 4000;

/// Number of changes of a kind, with the largest.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Change {
    /// Number of changes.
    pub count: usize,
    /// Size of the largest, in the unit of its kind.
    pub worst: f64,
    /// Node of the largest, as index in the file.
    pub node: u32,
}

impl Change {
    /// Adds a change to those of a kind.
    pub(crate) fn add(kind: &mut Option<Self>, size: f64, node: u32) {
        let Some(all) = kind else {
            *kind = Some(Self { count: 1, worst: size, node });
            return;
        };
        all.count += 1;
        if size > all.worst {
            (all.worst, all.node) = (size, node);
        }
    }
}

/// Changes between the given network and the meshed one, by kind; `None` without a change.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Changes {
    /// Nodes moved by the refinement, in their radii.
    pub moved: Option<Change>,
    /// Vessel pairs with a reduced radius, as the fraction by which it is smaller.
    pub shrunk: Option<Change>,
    /// Missing or implausible radii that were filled, as the filled value in the unit of the network.
    pub filled: Option<Change>,
    /// Tips whose cap lies beyond the given end, in lengths of their vessel.
    pub extended: Option<Change>,
    /// Lines that were merged with others, by their largest distance from these, in radii.
    pub merged: Option<Change>,
    /// Bifurcations joined within one lumen, by their distance in the unit of the network.
    pub joined: Option<Change>,
    /// Blocks in which overlapping vessels are one lumen, by their number of nodes.
    pub one_lumen: Option<Change>,
    /// Loops closed within one lumen, by their length in the unit of the network.
    pub fused: Option<Change>,
    /// Vessels that were dropped or shortened, by their missing length outside the lumen, in radii of the vessel.
    pub dropped: Option<Change>,
}

/// Reports of what was done to a network.
#[derive(Clone, Copy, Debug)]
pub struct Repairs<'a> {
    /// Report of the preparation.
    pub prepare: &'a PrepareReport,
    /// Report of the refinement, if there was one.
    pub refine: Option<&'a RefineReport>,
}

impl Changes {
    /// Compares a network with the given one. `prepared` is the network before refinement. `caps` are those of the mesh.
    pub(crate) fn of(given: &Skeleton, prepared: &Skeleton, made: &Skeleton, repairs: Repairs, caps: &[Cap]) -> Self {
        let Repairs { prepare, refine } = repairs;
        let mut changes = Self::default();
        // Where a repair put a tip is no move of the refinement.
        let is_moved = |t: &&TouchingTip| t.done != TouchedBy::Left;
        let tips: FxHashSet<u32> = prepare.touching.iter().filter(is_moved).map(|t| t.tip).collect();
        if let Some(refine) = refine {
            changes.move_nodes(prepared, made, &tips);
            for pair in &refine.residual.pairs {
                if let Treatment::Shrunk { kept } = pair.treatment {
                    Change::add(&mut changes.shrunk, 1.0 - kept, pair.edges[0][0]);
                }
            }
        }
        for radius in &prepare.radii {
            Change::add(&mut changes.filled, radius.filled, radius.node);
        }
        for line in prepare.merge.merged.iter().filter(|line| line.apart > MOVED) {
            Change::add(&mut changes.merged, line.apart, line.nodes[0]);
        }
        for l in &prepare.joined.loops {
            Change::add(&mut changes.fused, l.length, l.nodes[0]);
        }
        for joined in &prepare.joined.nodes {
            Change::add(&mut changes.joined, joined.distance, joined.node);
        }
        let vessels = Tips::of(given);
        for tip in prepare.short_tips.iter().filter(|t| t.put_out) {
            Change::add(&mut changes.extended, tip.needed / tip.length.max(f64::MIN_POSITIVE) - 1.0, tip.tip);
        }
        let known: FxHashSet<u32> = prepare.short_tips.iter().map(|t| t.tip).collect();
        for cap in caps.iter().filter(|cap| !known.contains(&cap.node)) {
            if let Some(share) = vessels.extension(cap) {
                Change::add(&mut changes.extended, share, cap.node);
            }
        }
        changes.drop_vessels(&vessels, made, prepare);
        changes
    }

    /// Nodes that moved. Only the first node of each name was in the file. Further ones are points of bends and parts of
    /// split nodes, which count by their distance from the axis.
    fn move_nodes(&mut self, prepared: &Skeleton, made: &Skeleton, tips: &FxHashSet<u32>) {
        let was: FxHashMap<u32, _> = prepared.nodes.iter().rev().map(|n| (n.original, n)).collect();
        let mut seen = FxHashSet::default();
        let tubes = (made.nodes.len() > prepared.nodes.len()).then(|| Tubes::of(prepared));
        for node in made.nodes.iter().filter(|n| !tips.contains(&n.original)) {
            let before = was.get(&node.original).filter(|_| seen.insert(node.original));
            let off_axis = || {
                let near = tubes.as_ref()?.nearest(&node.position, node.radius, |distance, _| distance)?;
                Some(near.distance / near.radius)
            };
            let radii = match before {
                Some(before) => (node.position - before.position).norm() / before.radius,
                None => off_axis().unwrap_or(0.0),
            };
            if radii > MOVED {
                Change::add(&mut self.moved, radii, node.original);
            }
        }
    }

    /// Vessels that repairs removed or shortened.
    fn drop_vessels(&mut self, vessels: &Tips, made: &Skeleton, prepare: &PrepareReport) {
        // Length that a repair took from the vessel of each tip; infinite if all of it.
        let mut taken: Vec<(u32, f64)> = Vec::new();
        taken.extend(prepare.spurs.iter().map(|s| (s.tip, f64::INFINITY)));
        taken.extend(prepare.short_tips.iter().filter(|t| !t.put_out).map(|t| (t.tip, f64::INFINITY)));
        for tip in &prepare.touching {
            let by = match tip.done {
                TouchedBy::Retracted { by } => by,
                TouchedBy::Removed => f64::INFINITY,
                TouchedBy::Extended { .. } | TouchedBy::Joined | TouchedBy::Left => continue,
            };
            match taken.iter_mut().find(|(node, _)| *node == tip.tip) {
                Some((_, sum)) => *sum += by,
                None => taken.push((tip.tip, by)),
            }
        }
        // Only tips of merged lines outside the lumen are a loss: most lines begin with others at the inlet.
        let merged: Vec<(u32, f64)> = merged_tips(vessels, prepare).collect();
        if taken.is_empty() && merged.is_empty() {
            return;
        }
        let tubes = Tubes::of(made);
        for (tip, by) in merged {
            let lost = vessels.length_outside(tip, by, &tubes);
            if lost > 0.0 {
                Change::add(&mut self.dropped, lost, tip);
            }
        }
        for (tip, by) in taken {
            let lost = vessels.length_outside(tip, by, &tubes);
            Change::add(&mut self.dropped, lost, tip);
        }
    }
}

/// Tips of lines that were merged with others, with the length of the merged part.
fn merged_tips(vessels: &Tips, prepare: &PrepareReport) -> impl Iterator<Item = (u32, f64)> {
    let ends = prepare.merge.merged.iter().flat_map(|m| m.nodes.map(|node| (node, m.length)));
    ends.filter(|(node, _)| vessels.branches.contains_key(node))
}

/// Vessels of the given network that end in a terminal, by the index of the terminal in the file.
struct Tips<'a> {
    given: &'a Skeleton,
    branches: FxHashMap<u32, Branch>,
}

impl<'a> Tips<'a> {
    fn of(given: &'a Skeleton) -> Self {
        let adjacency = given.adjacency();
        let mut branches = FxHashMap::default();
        for branch in given.branches(&adjacency).list {
            for end in branch.ends() {
                if adjacency.valence(end) == 1 {
                    branches.insert(given.node(end).original, branch.clone());
                }
            }
        }
        Self { given, branches }
    }

    /// Nodes of a terminal's vessel, from the terminal.
    fn nodes(&self, tip: u32) -> Option<Vec<NodeId>> {
        let branch = self.branches.get(&tip)?;
        let mut nodes = branch.nodes.clone();
        if self.given.node(nodes[0]).original != tip {
            nodes.reverse();
        }
        Some(nodes)
    }

    /// Distance of a cap beyond the given end of its vessel, in lengths of the vessel; `None` if it is not beyond.
    fn extension(&self, cap: &Cap) -> Option<f64> {
        let nodes = self.nodes(cap.node)?;
        let [tip, next] = [0, 1].map(|i| nodes.get(i).map(|&n| self.given.node(n).position));
        let outwards = (tip? - next?).try_normalize(0.0)?;
        let beyond = (cap.center - tip?).dot(&outwards);
        let length = self.branches.get(&cap.node)?.length();
        (beyond > EXTENDED * cap.radius && length > 0.0).then(|| beyond / length)
    }

    /// Length of a vessel outside the lumen of these tubes, in its radii, at most `by` from its terminal.
    fn length_outside(&self, tip: u32, by: f64, tubes: &Tubes) -> f64 {
        let (Some(nodes), Some(branch)) = (self.nodes(tip), self.branches.get(&tip)) else { return 0.0 };
        let radius = branch.mean_radius(self.given);
        let step = (STEP * radius).max(branch.length() / MOST_STEPS as f64);
        // A piece at the wall is no loss.
        let in_radii = |lost: f64| if lost > step { lost.min(by) / radius } else { 0.0 };
        let (mut lost, mut inside) = (0.0, 0.0);
        for pair in nodes.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|n| self.given.node(n).position);
            let length = (b - a).norm();
            let count = (length / step).ceil().max(1.0) as usize;
            for k in 0..count {
                let place = a + (b - a) * ((k as f64 + 0.5) / count as f64);
                let near = tubes.nearest_wall(&place);
                if near.is_none_or(|near| near.distance > (1.0 + OUTSIDE) * near.radius) {
                    lost += length / count as f64;
                    inside = 0.0;
                } else {
                    inside += length / count as f64;
                }
                // The vessel continues within the lumen. A tip may lie within another one before.
                if lost >= by || lost > 0.0 && inside > 2.0 * radius {
                    return in_radii(lost);
                }
            }
        }
        in_radii(lost)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::geometry::{Point3, Vec3};
    use anastomesh_network::{Merged, Spur, SpurReason};
    use anastomesh_skeleton::fixtures::network;

    /// A thick vessel with a thin branch of length 10 at its middle.
    fn forked() -> Skeleton {
        let points = [[0.0; 3], [20.0, 0.0, 0.0], [40.0, 0.0, 0.0], [20.0, 10.0, 0.0]];
        let mut given = network(&points, 2.0, &[(0, 1), (1, 2), (1, 3)]);
        given.edges[2].radii = [0.5; 2];
        given.nodes[3].radius = 0.5;
        given
    }

    fn of(given: &Skeleton, made: &Skeleton, prepare: &PrepareReport, caps: &[Cap]) -> Changes {
        Changes::of(given, given, made, Repairs { prepare, refine: None }, caps)
    }

    #[test]
    fn a_removed_branch_counts_by_its_length_outside_the_lumen() {
        let given = forked();
        let mut made = given.clone();
        made.edges.pop();
        let spur = Spur { tip: 3, from: 1, length: 10.0, radius: 2.0, reason: SpurReason::Short };
        let prepare = PrepareReport { spurs: vec![spur], ..PrepareReport::default() };
        let dropped = of(&given, &made, &prepare, &[]).dropped.expect("a loss");
        // 8 of 10 lie outside the vessel of radius 2, which are 16 radii of the branch.
        assert!((dropped.worst - 15.6).abs() < 0.5 && dropped.node == 3 && dropped.count == 1, "{dropped:?}");
        // A branch within the lumen is no loss.
        let mut short = given;
        short.nodes[3].position.y = 1.5;
        assert_eq!(of(&short, &made, &prepare, &[]).dropped, Some(Change { count: 1, worst: 0.0, node: 3 }));
    }

    #[test]
    fn the_end_of_a_merged_line_counts_outside_the_lumen() {
        let given = forked();
        let mut made = given.clone();
        made.edges.pop();
        let mut prepare = PrepareReport::default();
        let run = Merged { nodes: [1, 3], with: [0, 1], length: 10.0, apart: 1.0, partings: Vec::new() };
        prepare.merge.merged.push(run);
        let dropped = of(&given, &made, &prepare, &[]).dropped.expect("a loss");
        assert!((dropped.worst - 15.6).abs() < 0.5 && dropped.node == 3 && dropped.count == 1, "{dropped:?}");
        assert_eq!(of(&given, &given, &prepare, &[]).dropped, None);
    }

    #[test]
    fn merged_lines_count_unless_they_coincide() {
        let given = forked();
        let mut prepare = PrepareReport::default();
        let run = |apart| Merged { nodes: [1, 3], with: [0, 1], length: 10.0, apart, partings: Vec::new() };
        prepare.merge.merged.extend([run(0.01), run(0.9), run(0.3)]);
        let merged = of(&given, &given, &prepare, &[]).merged;
        assert_eq!(merged, Some(Change { count: 2, worst: 0.9, node: 1 }));
    }

    #[test]
    fn a_tip_that_touches_a_vessel_and_was_left_there_counts_once_refinement_moves_it() {
        let given = forked();
        let mut made = given.clone();
        made.nodes[3].position.x += 1.0;
        let report = RefineReport::default();
        let moved = |done| {
            let tip = TouchingTip { tip: 3, with: [0, 1], done };
            let prepare = PrepareReport { touching: vec![tip], ..PrepareReport::default() };
            Changes::of(&given, &given, &made, Repairs { prepare: &prepare, refine: Some(&report) }, &[]).moved
        };
        assert_eq!(moved(TouchedBy::Left), Some(Change { count: 1, worst: 2.0, node: 3 }));
        assert_eq!(moved(TouchedBy::Joined), None);
    }

    #[test]
    fn a_cap_beyond_its_vessel_counts_in_lengths_of_the_vessel() {
        let given = forked();
        let cap = |y: f64| Cap { node: 3, center: Point3::new(20.0, y, 0.0), normal: Vec3::y(), radius: 0.5 };
        let none = PrepareReport::default();
        assert_eq!(of(&given, &given, &none, &[cap(9.0)]), Changes::default());
        let extended = of(&given, &given, &none, &[cap(30.0)]).extended.expect("extended");
        assert!((extended.worst - 2.0).abs() < 1e-12 && extended.node == 3, "{extended:?}");
    }
}

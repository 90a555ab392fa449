//! Limits on the difference between a mesh and its network.

use super::defect::Defect;
use crate::fidelity::{Changes, Displaced, Fidelity, Repairs};
use anastomesh_skeleton::{Branch, NodeId, Skeleton};
use rustc_hash::{FxHashMap, FxHashSet};

/// Default limit of the displacement of a measured axis, in radii.
pub(super) const MEASURED: f64 = 1.0;
/// Default limit of the relative difference between the volume of a mesh and of the given lumen.
pub(super) const LUMEN: f64 = 0.1;
/// Maximum length of a vessel that a repair may drop, in its radii.
const DROPPED: f64 = 2.0;
/// Maximum distance of a cap beyond the given end of its vessel, in lengths of the vessel.
const EXTENDED: f64 = 1.0;

/// Limits on the difference between a mesh or a refined network and the given one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Limits {
    /// Maximum displacement of the axis in radii, at any place. By default 1 in measured networks, at 99 % of the axis and
    /// wherever no listed change requires more; without limit in others.
    pub displacement: Option<f64>,
    /// Maximum relative difference of the volume from that of the given lumen (default: 0.1).
    pub lumen: Option<f64>,
}

anastomesh_mesh::setters!(Limits {
    displacement: impl Into<Option<f64>>,
    lumen: impl Into<Option<f64>>,
});

impl Limits {
    /// Differences beyond the limits. `networks`: the given network, and the prepared one before refinement.
    pub(crate) fn unfaithful(
        self,
        networks: [&Skeleton; 2],
        repairs: Repairs,
        fidelity: &Fidelity,
        changes: &Changes,
    ) -> Vec<Defect> {
        let mut defects = Vec::new();
        let (excess, bound) = (fidelity.swelling(), self.lumen.unwrap_or(LUMEN));
        if excess.abs() > bound {
            defects.push(Defect::Lumen { excess, bound });
        }
        defects.extend(self.displaced(networks, repairs, fidelity));
        if let Some(vessels) = changes.dropped.filter(|change| change.worst > DROPPED) {
            defects.push(Defect::Dropped { vessels, bound: DROPPED });
        }
        if let Some(tips) = changes.extended.filter(|change| change.worst > EXTENDED) {
            defects.push(Defect::Extended { tips, bound: EXTENDED });
        }
        defects
    }

    /// Place of the furthest displacement beyond the limit, if there is no defect: listed changes require such displacements.
    pub(crate) fn excused(self, repairs: Repairs, fidelity: &Fidelity, defects: &[Defect]) -> Option<Displaced> {
        let bound = self.bound(repairs)?;
        let is_defect = defects.iter().any(|defect| matches!(defect, Defect::Displaced { .. }));
        fidelity.axis.furthest.first().filter(|place| !is_defect && place.radii > bound).copied()
    }

    /// Limit of the displacement; `None` without one.
    fn bound(self, repairs: Repairs) -> Option<f64> {
        self.displacement.or(repairs.prepare.measured.then_some(MEASURED))
    }

    /// Places where the axis is further from the given one than it may be.
    fn displaced(self, networks: [&Skeleton; 2], repairs: Repairs, fidelity: &Fidelity) -> Option<Defect> {
        let bound = self.bound(repairs)?;
        let excused = if self.displacement.is_none() { excused(networks, repairs) } else { FxHashSet::default() };
        let is_excused = |d: &Displaced| d.meshed.iter().chain(&d.given).any(|node| excused.contains(node));
        let p99 = fidelity.axis.spread.p99;
        let far = fidelity.axis.furthest.iter().take_while(|d| d.radii > bound);
        let all: Vec<Displaced> = far.copied().collect();
        let unexcused: Vec<Displaced> = all.iter().filter(|d| !is_excused(d)).copied().collect();
        match (unexcused.is_empty(), p99 > bound) {
            (false, _) => Some(Defect::Displaced { bound, p99, places: unexcused }),
            // A few places may be excused, but not one in a hundred.
            (true, true) => Some(Defect::Displaced { bound, p99, places: all }),
            (true, false) => None,
        }
    }
}

/// Nodes of a vessel that resampling removed beside an excused node: the vessel moves there as well.
fn between(vessel: &[u32], known: &FxHashSet<u32>, excused: &FxHashSet<u32>) -> Vec<u32> {
    let mut all = Vec::new();
    let mut start = 0;
    for end in (1..vessel.len()).filter(|&i| known.contains(&vessel[i]) || i + 1 == vessel.len()) {
        if excused.contains(&vessel[start]) || excused.contains(&vessel[end]) {
            all.extend(&vessel[start + 1..end]);
        }
        start = end;
    }
    all
}

/// Nodes that a listed change may move far. Either an overlap required it, or the node was split as it has many vessels. Or
/// a repair removed its vessel, merged it with another line, or moved the vessel's end.
fn excused([given, prepared]: [&Skeleton; 2], repairs: Repairs) -> FxHashSet<u32> {
    let Repairs { prepare, refine } = repairs;
    let moved = refine.iter().flat_map(|r| r.demanded.iter().map(|far| far.node));
    let crowded = refine.iter().flat_map(|r| r.crowded.iter().flat_map(|pair| pair.nodes));
    let buried = refine.iter().flat_map(|r| r.buried.iter().map(|tip| tip.node));
    let joined = prepare.joined.nodes.iter().flat_map(|j| [j.node, j.into]);
    let mut nodes: FxHashSet<u32> = moved.chain(crowded).chain(buried).chain(joined).collect();
    let adjacency = given.adjacency();
    let name = |n: NodeId| given.node(n).original;
    nodes.extend(given.node_ids().filter(|&n| adjacency.valence(n) > 3).map(name));
    let touching = prepare.touching.iter().map(|t| t.tip);
    let short = prepare.short_tips.iter().map(|t| t.tip);
    let ends: FxHashSet<u32> = touching.chain(short).chain(prepare.spurs.iter().map(|s| s.tip)).collect();
    let cured = |branch: &&Branch| branch.ends().into_iter().any(|n| ends.contains(&name(n)));
    let branches = given.branches(&adjacency).list;
    for branch in branches.iter().filter(cured) {
        nodes.extend(branch.nodes.iter().map(|&n| name(n)));
    }
    let known: FxHashSet<u32> = prepared.nodes.iter().map(|n| n.original).collect();
    for branch in &branches {
        let names: Vec<u32> = branch.nodes.iter().map(|&n| name(n)).collect();
        nodes.extend(between(&names, &known, &nodes));
    }
    // Merged ends of lines: of these only the merged part.
    let merged: FxHashMap<u32, f64> =
        prepare.merge.merged.iter().flat_map(|m| m.nodes.map(|node| (node, m.length))).collect();
    for branch in &branches {
        let (length, [first, last]) = (branch.length(), branch.ends());
        let is_tip = |n: NodeId| adjacency.valence(n) == 1;
        let merged_from = |n: NodeId| merged.get(&name(n)).filter(|_| is_tip(n)).map_or(-1.0, |by| by * (1.0 + 1e-9));
        let [from_first, from_last] = [first, last].map(merged_from);
        let places = branch.nodes.iter().zip(&branch.arc);
        let is_merged = |arc: f64| arc <= from_first || length - arc <= from_last;
        nodes.extend(places.filter(|(_, arc)| is_merged(**arc)).map(|(&n, _)| name(n)));
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_mesh::geometry::Vec3;
    use anastomesh_network::{FarNode, PrepareReport, RefineReport};
    use anastomesh_skeleton::fixtures::network;

    fn set(nodes: &[u32]) -> FxHashSet<u32> {
        nodes.iter().copied().collect()
    }

    #[test]
    fn points_that_resampling_removed_move_with_their_neighbours() {
        let vessel = [0, 1, 2, 3, 4, 5, 6];
        assert_eq!(between(&vessel, &set(&[0, 3, 6]), &set(&[6])), [4, 5]);
        assert_eq!(between(&vessel, &set(&[0, 3, 6]), &set(&[3])), [1, 2, 4, 5]);
        assert!(between(&vessel, &set(&[0, 3, 6]), &set(&[])).is_empty());
    }

    /// A vessel whose middle moved by two radii: a defect, unless an overlap required it.
    #[test]
    fn a_displacement_that_an_overlap_requires_is_named_and_no_defect() {
        let given = network(
            &[[0.0; 3], [300.0, 0.0, 0.0], [301.0, 0.0, 0.0], [600.0, 0.0, 0.0]],
            1.0,
            &[(0, 1), (1, 2), (2, 3)],
        );
        let mut meshed = given.clone();
        meshed.nodes[1].position += Vec3::new(0.0, 2.0, 0.0);
        let tubes = anastomesh_skeleton::Tubes::of(&meshed);
        let axis = crate::fidelity::Displacements::of(&given, &meshed, &tubes);
        let mut fidelity = Fidelity { axis, ..Fidelity::default() };
        fidelity.axis.spread.p99 = 0.5;
        let prepare = PrepareReport { measured: true, ..PrepareReport::default() };
        let of = |demanded: &[FarNode]| {
            let mut report = RefineReport::default();
            report.demanded = demanded.to_vec();
            let repairs = Repairs { prepare: &prepare, refine: Some(&report) };
            let limits = Limits::default();
            let defects = limits.unfaithful([&given, &given], repairs, &fidelity, &Changes::default());
            let excused = limits.excused(repairs, &fidelity, &defects);
            (defects.len(), excused.is_some())
        };
        assert_eq!(of(&[]), (1, false));
        assert_eq!(of(&[FarNode { node: 1, radii: 2.0 }]), (0, true));
    }
}

//! Networks of a run, from the one that was read to the one that is meshed.

use crate::fidelity::Compared;
use anastomesh_io::network::NodeNames;
use anastomesh_mesh::geometry::Point3;
use anastomesh_network::{Island, PrepareReport, TouchedBy, TouchingTip, take_back};
use anastomesh_network::{RefineReport, Refined};
use anastomesh_skeleton::{CrotchRule, CrotchSearch, EdgeId, LocalDistances, NodeId, Overlap, Skeleton, clean};
use rustc_hash::FxHashSet;
use std::sync::Arc;

/// Networks of a run, and what was done to get from one to the next. Those that do not differ are shared.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Networks {
    /// Network as it was read, cleaned and with usable radii. The mesh is compared with it.
    pub given: Arc<Skeleton>,
    /// `given` with as many points as its shape needs.
    pub outline: Arc<Skeleton>,
    /// Network after the cures, before refinement.
    pub prepared: Arc<Skeleton>,
    /// Network to be meshed: refined and with tips retracted, where that was done.
    pub network: Arc<Skeleton>,
    /// Names of the nodes in the file.
    pub names: NodeNames,
    /// Report of the cures, and of tips that were retracted since.
    pub prepare: PrepareReport,
    /// Report of the refinement; `None` if `network` was not refined.
    pub refine: Option<RefineReport>,
    /// Network as refinement left it; `None` as `refine`.
    pub refined: Option<Arc<RefinedAxis>>,
    /// Number of tips in `prepare` that the cures treated, before any attempt to mesh.
    tips_cured: usize,
}

/// Refined network, before terminals were retracted.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RefinedAxis {
    /// Network.
    pub skeleton: Arc<Skeleton>,
    /// Position of each node before it moved.
    pub origin: Vec<Point3>,
}

/// Distance of two axes, in sums of radii, below which overlapping vessels of different branch points make a valid mesh of
/// a grown network impossible. Overlaps of valid meshes in the shared networks are shallower.
const HOPELESS: f64 = 0.6;
/// Maximum number of edges of a measured network that is meshed as given although such vessels overlap.
const SMALL: usize = 10_000;
/// Maximum number of overlaps without a common node for which a grown network is refined locally: a number, and a fraction of
/// the edges.
const FEW: (usize, f64) = (3, 0.015);
/// Distance along the vessels, in sums of radii, from which such an overlap joins two lumens whatever the network is.
const FAR: f64 = 6.0;
/// Maximum number of overlaps for which that distance is searched.
const SEARCHED: usize = 1000;

impl Networks {
    pub(super) fn new(
        given: Skeleton,
        outline: Skeleton,
        prepared: Skeleton,
        names: NodeNames,
        prepare: PrepareReport,
    ) -> Self {
        let given = Arc::new(given);
        let [outline, prepared] = [outline, prepared].map(|network| shared(network, &given));
        let tips_cured = prepare.touching.len();
        Self {
            given,
            outline,
            network: Arc::clone(&prepared),
            prepared,
            names,
            prepare,
            refine: None,
            refined: None,
            tips_cured,
        }
    }

    /// Networks to compare a mesh with; `meshed` is the network that was meshed, with nodes split.
    pub(crate) fn compared<'a>(&'a self, meshed: &'a Skeleton) -> Compared<'a> {
        Compared { given: &self.given, outline: &self.outline, meshed }
    }

    /// Takes a refined network as the one to be meshed.
    pub(super) fn take_refined(&mut self, refined: Refined) {
        let Refined { skeleton, origin, report, .. } = refined;
        self.network = Arc::new(skeleton);
        self.refine = Some(report);
        self.refined = Some(Arc::new(RefinedAxis { skeleton: Arc::clone(&self.network), origin }));
    }

    /// Takes the reports of a refinement that moved nothing.
    pub(super) fn refined_as(&mut self, other: Self) {
        (self.refine, self.refined) = (other.refine, other.refined);
    }

    /// Networks of another attempt: the prepared network, as it is or refined.
    pub(super) fn again(&self, refined: Option<Refined>) -> Self {
        let mut again = Self { network: Arc::clone(&self.prepared), refine: None, refined: None, ..self.clone() };
        again.prepare.touching.truncate(self.tips_cured);
        if let Some(refined) = refined {
            again.take_refined(refined);
        }
        again
    }

    /// Retracts terminals, given by their `original` and the number of their earlier retractions. Returns what was done,
    /// nothing if no terminal can be retracted.
    pub(super) fn retract(&mut self, tips: &[(u32, u32)]) -> Vec<TouchingTip> {
        if tips.is_empty() {
            return Vec::new();
        }
        // Where no vessel would remain all stay.
        let Ok((network, told)) = take_back(&self.network, tips) else { return Vec::new() };
        if told.iter().all(|tip| tip.done == TouchedBy::Left) {
            return Vec::new();
        }
        self.network = Arc::new(network);
        self.prepare.touching.extend(told.iter().copied());
        told
    }

    /// True if all overlapping vessels of the prepared network leave one bifurcation.
    pub(super) fn overlaps_at_forks_alone(&self) -> bool {
        !self.overlaps_apart(f64::INFINITY)
    }

    /// True if the prepared network may give a valid mesh without refinement. Many overlaps of measured networks do no harm,
    /// so those are meshed as given unless that takes long.
    pub(super) fn may_be_sound_as_given(&self) -> bool {
        let is_small = self.prepare.measured && self.prepared.edges.len() <= SMALL;
        if is_small { !self.excludes_a_mesh() } else { !self.overlaps_apart(HOPELESS) }
    }

    /// True if few vessels of a grown network overlap, so that it may suffice to move these.
    pub(super) fn may_move_locally(&self) -> bool {
        let network = &self.prepared;
        let overlaps = network.overlaps(&network.adjacency()).pairs;
        let apart = overlaps.iter().filter(|overlap| !overlap.shares_node()).count();
        !self.prepare.measured && (apart <= FEW.0 || apart as f64 <= FEW.1 * network.edges.len() as f64)
    }

    /// True if overlaps of the prepared network exclude a valid mesh without refinement. Distant vessels overlap so deeply that
    /// their walls intersect, or their lumens join. Overlaps at tips do not count, as tips can be retracted. Neither do those
    /// in the crotch of a bifurcation.
    pub(super) fn excludes_a_mesh(&self) -> bool {
        let network = &self.prepared;
        let adjacency = network.adjacency();
        let is_tip = |node: NodeId| adjacency.valence(node) < 2;
        let at_tip = |overlap: &Overlap| {
            let near = |(nodes, point): (&[NodeId; 2], &Point3)| {
                nodes.iter().any(|&n| is_tip(n) && (network.node(n).position - point).norm() < FAR * overlap.radii)
            };
            overlap.nodes.iter().zip(&overlap.points).any(near)
        };
        let mut along = LocalDistances::default();
        let mut is_far = |overlap: &Overlap| {
            let [a, b] = overlap.nodes;
            a.into_iter().all(|start| {
                along.search(network, &adjacency, start, FAR * overlap.radii);
                b.into_iter().all(|end| along.of(end).is_infinite())
            })
        };
        let overlaps = network.overlaps(&adjacency).pairs;
        let mut crotches = CrotchSearch::default();
        let mut in_crotch = |o: &Overlap| crotches.is_in_crotch(network, &adjacency, o, CrotchRule::default());
        let deep = overlaps.iter().filter(|o| o.distance < HOPELESS * o.radii && !at_tip(o));
        deep.take(SEARCHED).any(|o| is_far(o) && !in_crotch(o))
    }

    /// True if vessels that leave no common bifurcation overlap, with axes closer than a share of their radii.
    fn overlaps_apart(&self, share: f64) -> bool {
        let network = &self.prepared;
        let adjacency = network.adjacency();
        let branches = network.branches(&adjacency);
        let ends = |edge: EdgeId| branches.list[branches.of_edge[edge.index()].0.index()].ends();
        let meet_at_fork = |edges: [EdgeId; 2]| ends(edges[0]).iter().any(|end| ends(edges[1]).contains(end));
        let apart = |overlap: &Overlap| overlap.distance < share * overlap.radii && !meet_at_fork(overlap.edges);
        network.overlaps(&adjacency).pairs.iter().any(apart)
    }
}

/// Network without the components that contain the nodes of removed islands.
pub(crate) fn without_islands(network: Skeleton, islands: &[Island]) -> Skeleton {
    if islands.is_empty() {
        return network;
    }
    let removed: FxHashSet<u32> = islands.iter().map(|island| island.node).collect();
    let of_node = network.components(&network.adjacency()).of_node;
    let is_removed = |n: NodeId| removed.contains(&network.node(n).original);
    let gone: FxHashSet<u32> = network.node_ids().filter(|&n| is_removed(n)).map(|n| of_node[n.index()]).collect();
    let mut rest = network.clone();
    rest.edges.retain(|edge| !gone.contains(&of_node[edge.nodes[0].index()]));
    // Without an edge left, nothing was removed.
    clean(&rest).map_or(network, |(rest, _)| rest)
}

/// Shares `other` if the network is equal to it: networks have millions of vessels.
fn shared(network: Skeleton, other: &Arc<Skeleton>) -> Arc<Skeleton> {
    if network == **other { Arc::clone(other) } else { Arc::new(network) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anastomesh_skeleton::fixtures::network;

    #[test]
    fn another_attempt_begins_without_the_tips_that_were_retracted() {
        // The tip of the second vessel ends in the wall of the first.
        let points = [[0.0, 0.0, -20.0], [0.0, 0.0, 20.0], [1.2, 0.0, 0.0], [20.0, 0.0, 0.0]];
        let given = network(&points, 1.0, &[(0, 1), (2, 3)]);
        let mut networks =
            Networks::new(given.clone(), given.clone(), given, NodeNames::default(), PrepareReport::default());
        assert!(Arc::ptr_eq(&networks.given, &networks.network));
        assert!(networks.retract(&[]).is_empty());
        let told = networks.retract(&[(2, 0)]);
        assert!(told.len() == 1 && told[0].tip == 2, "{told:?}");
        assert!(networks.network.nodes[2].position.x > 2.0 && networks.prepare.touching == told);
        let again = networks.again(None);
        assert!(Arc::ptr_eq(&again.network, &again.prepared) && again.prepare.touching.is_empty());
    }
}

//! What was done to a network before it was meshed, and what the mesh is held against.

use super::network::PreparedNetwork;
use super::progress::Bars;
use crate::fidelity::{Compared, Displaced, Fidelity, lumen_of};
use crate::pipeline::{Estimate, MeshPlan, RunError, RunReport, Store, Stored, TooLarge, mesh_shared};
use crate::prepare::{PrepareReport, TouchedBy, take_back};
use crate::refine::{self, RefineParams, RefineReport, Refined, split_shared};
use crate::report::fidelity::displaced;
use crate::report::prepare::touching;
use anastomesh_io::network::NodeNames;
use anastomesh_mesh::check::{CheckReport, Line};
use anastomesh_mesh::progress::Progress;
use anastomesh_skeleton::{Branch, EdgeId, NodeId, Skeleton};
use rustc_hash::FxHashSet;
use serde::Serialize;
use std::sync::Arc;

/// How far a measured axis may be from where it was given, in radii, unless an overlap demands more.
const FURTHEST: f64 = 1.0;

/// A refined network whose lumen is larger or smaller by this share is tried as it was, too, if only vessels overlap there
/// that leave one branch point: those may be kept apart.
const SWOLLEN: f64 = 0.05;
/// With how much more clearance a network is refined again whose walls are joined though its vessels do not overlap: walls come
/// closer to each other than tubes do, by the width of the field's kernel.
const WIDER: f64 = 1.2;
const NOT_VALID: &str = "no valid mesh";

/// How often tips that could not be capped are drawn back.
const ROUNDS: usize = 4;

/// What was done to the network before it was meshed.
#[derive(Serialize)]
pub struct Before {
    /// As it was read, with usable radii.
    #[serde(skip)]
    given: Arc<Skeleton>,
    /// The same with as many points as its shape needs.
    #[serde(skip)]
    outline: Arc<Skeleton>,
    /// What is to be meshed.
    #[serde(skip)]
    pub network: Arc<Skeleton>,
    /// The same with nodes of many vessels split.
    #[serde(skip)]
    meshed: Arc<Skeleton>,
    /// What the file calls its nodes.
    #[serde(skip)]
    pub names: NodeNames,
    prepare: PrepareReport,
    #[serde(skip_serializing_if = "Option::is_none")]
    refine: Option<RefineReport>,
    /// What was to be meshed before it was refined, and how it was.
    #[serde(skip)]
    unrefined: Option<(Arc<Skeleton>, RefineParams)>,
}

/// A mesh whose blocks are in a store, and what it was made of.
pub struct Made<'a> {
    pub stored: Stored<'a>,
    pub before: Before,
}

impl Made<'_> {
    /// Whether it is valid, and all of the network.
    fn is_sound(&self, plan: &MeshPlan) -> bool {
        let Stored { check, report, .. } = &self.stored;
        report.failed.is_empty() && check.is_valid() && report.keeps_vessels(plan.fuse)
    }

    /// By how much its volume differs from that of the lumen as it was given, as a share of that.
    fn swelling(&self) -> f64 {
        (self.stored.check.counts.volume / lumen_of(&self.before.outline) - 1.0).abs()
    }
}

/// Where and how a network is meshed.
#[derive(Clone, Copy)]
pub struct Meshing<'a, 'b> {
    pub store: &'a Store,
    pub plan: &'b MeshPlan,
    /// Hears what it will take, and may refuse.
    pub fits: &'b dyn Fn(&Estimate) -> Result<(), TooLarge>,
    /// Whether tips of a measured network that could not be capped are drawn back.
    pub touches: bool,
    pub bars: &'a Bars,
}

impl Before {
    pub fn new(prepared: PreparedNetwork, refined: Option<(Refined, RefineParams)>) -> Self {
        let PreparedNetwork { given, outline, skeleton, report: prepare, names, .. } = prepared;
        let given = Arc::new(given);
        let [outline, skeleton] = [outline, skeleton].map(|network| shared(network, &given));
        let (network, refine, unrefined) = match refined {
            Some((Refined { skeleton: moved, report, .. }, params)) => {
                (Arc::new(moved), Some(report), Some((skeleton, params)))
            }
            None => (skeleton, None, None),
        };
        let meshed = split_shared(&network).0;
        Self { given, outline, network, meshed, names, prepare, refine, unrefined }
    }

    /// The networks that the mesh is held against.
    pub fn compared(&self) -> Compared<'_> {
        Compared { given: &self.given, outline: &self.outline, meshed: &self.meshed }
    }

    /// What refinement did, and to what; none if it was not refined.
    pub fn refinement(&self) -> Option<(&RefineReport, &Skeleton)> {
        Some((self.refine.as_ref()?, self.unrefined.as_ref().map_or(&*self.given, |(network, _)| network)))
    }

    /// Meshes it into a store. Refinement is not to end in something worse than none: where the refined network gives no
    /// sound mesh, or one of another volume, it is tried as it was; where that is not sound either, refined with more clearance.
    pub fn mesh<'a>(self, how: Meshing<'a, '_>) -> Result<Made<'a>, (RunError, Box<Self>)> {
        let first = self.mesh_alone(how);
        let (second, fault, least) = match &first {
            Ok(made) if made.is_sound(how.plan) => match made.swelling() {
                swelling if swelling > SWOLLEN => {
                    let before = made.before.as_it_was().filter(|before| overlap_at_forks_alone(&before.network));
                    (before, "a lumen of another size", swelling)
                }
                _ => (None, "", 0.0),
            },
            Ok(made) => (made.before.as_it_was(), NOT_VALID, f64::INFINITY),
            Err((RunError::BlocksFailed(_), before)) => (before.as_it_was(), NOT_VALID, f64::INFINITY),
            Err(_) => (None, "", 0.0),
        };
        let second = second.and_then(|before| before.mesh_alone(how).ok()).filter(|made| made.is_sound(how.plan));
        match second.filter(|made| made.swelling() < least) {
            Some(made) => {
                how.bars.note(&format!(
                    "refined, the network gives {fault}; as it was, it gives a valid mesh: that is kept"
                ));
                Ok(made)
            }
            None if fault == NOT_VALID => Self::wider(first, how),
            None => first,
        }
    }

    /// What came of a network, or what comes of it once it is refined with more clearance, if that is sound.
    fn wider<'a>(
        first: Result<Made<'a>, (RunError, Box<Self>)>,
        how: Meshing<'a, '_>,
    ) -> Result<Made<'a>, (RunError, Box<Self>)> {
        let before = match &first {
            Ok(made) => &made.before,
            Err((_, before)) => &**before,
        };
        let sound = |before: Self| before.mesh_alone(how).ok().filter(|made| made.is_sound(how.plan));
        match before.with_more_room(how.bars).and_then(sound) {
            Some(made) => {
                how.bars
                    .note("the network was refined again, with more clearance: walls were joined that are to be apart");
                Ok(made)
            }
            None => first,
        }
    }

    /// Meshes it, and again as long as tips have to be drawn back: those that could not be capped, of a measured network, and
    /// of any that lacks nothing else or comes to nothing.
    fn mesh_alone<'a>(mut self, how: Meshing<'a, '_>) -> Result<Made<'a>, (RunError, Box<Self>)> {
        let Meshing { store, plan, fits, touches, bars } = how;
        let mut round = 0;
        loop {
            let made = mesh_shared(store, &self.network, plan, fits, bars);
            round += 1;
            let tips = match &made {
                Ok(Stored { report, check, .. }) if self.prepare.measured || lacks_but_caps(check) => {
                    open_tips(report, plan)
                }
                Err(RunError::BlocksFailed(report)) => open_tips(report, plan),
                _ => Vec::new(),
            };
            // Blocks that this does not change are found in the store.
            if round > ROUNDS || !touches || !self.take_back(&tips, bars) {
                return match made {
                    Ok(stored) => Ok(Made { stored, before: self }),
                    Err(error) => Err((error, Box::new(self))),
                };
            }
        }
    }

    /// The same without refinement; none if it was not refined.
    fn as_it_was(&self) -> Option<Self> {
        let (network, _) = self.unrefined.clone()?;
        Some(self.with(network, None))
    }

    /// The same refined with more clearance; none if it was not refined, or is not to be any more.
    fn with_more_room(&self, bars: &Bars) -> Option<Self> {
        let (network, params) = self.unrefined.as_ref()?;
        let params = RefineParams { clearance: WIDER * params.clearance, ..params.clone() };
        let Refined { skeleton, report, .. } = refine::refine(network, &params, bars).ok()?;
        Some(self.with(Arc::new(skeleton), Some(report)))
    }

    /// The same with another network to be meshed.
    fn with(&self, network: Arc<Skeleton>, refine: Option<RefineReport>) -> Self {
        Self {
            given: Arc::clone(&self.given),
            outline: Arc::clone(&self.outline),
            meshed: split_shared(&network).0,
            network,
            names: self.names.clone(),
            prepare: self.prepare.clone(),
            refine,
            unrefined: None,
        }
    }

    /// Draws tips back; says which, and whether there were any.
    fn take_back(&mut self, tips: &[u32], bars: &Bars) -> bool {
        if tips.is_empty() {
            return false;
        }
        // Where no vessel would remain all stay.
        let Ok((network, told)) = take_back(&self.network, tips) else { return false };
        let done = told.iter().any(|tip| tip.done != TouchedBy::Left);
        if done {
            touching(&told).lines().for_each(|line| bars.note(line));
            self.network = Arc::new(network);
            self.meshed = split_shared(&self.network).0;
            self.prepare.touching.extend(told);
        }
        done
    }

    /// Places of the network that are further from what was meshed than they may be, in words; none when there are none.
    pub fn unfaithful(&self, fidelity: &Fidelity, most: Option<f64>) -> Option<String> {
        let bound = most.or(self.prepare.measured.then_some(FURTHEST))?;
        let excused = self.demanded();
        let excused =
            |d: &&Displaced| most.is_none() && d.meshed.iter().chain(&d.given).any(|node| excused.contains(node));
        let far = fidelity.axis.furthest.iter().take_while(|d| d.radii > bound).filter(|d| !excused(d));
        displaced(&far.copied().collect::<Vec<_>>(), bound)
    }

    /// Nodes that may be far from where they were: an overlap demanded it, a node of many vessels was split within its ball, or
    /// a cure in the report took their vessel off or moved its end.
    fn demanded(&self) -> FxHashSet<u32> {
        let moved = self.refine.iter().flat_map(|r| r.demanded.iter().map(|far| far.node));
        let crowded = self.refine.iter().flat_map(|r| r.crowded.iter().flat_map(|pair| pair.nodes));
        let joined = self.prepare.joined.nodes.iter().flat_map(|j| [j.node, j.into]);
        let mut nodes: FxHashSet<u32> = moved.chain(crowded).chain(joined).collect();
        let adjacency = self.given.adjacency();
        let name = |n: NodeId| self.given.node(n).original;
        nodes.extend(self.given.node_ids().filter(|&n| adjacency.valence(n) > 3).map(name));
        let touching = self.prepare.touching.iter().map(|t| t.tip);
        let ends = touching
            .chain(self.prepare.short_tips.iter().map(|t| t.tip))
            .chain(self.prepare.spurs.iter().map(|s| s.tip));
        let ends: FxHashSet<u32> = ends.collect();
        let cured = |branch: &&Branch| branch.ends().into_iter().any(|n| ends.contains(&name(n)));
        for branch in self.given.branches(&adjacency).list.iter().filter(cured) {
            nodes.extend(branch.nodes.iter().map(|&n| name(n)));
        }
        nodes
    }
}

/// A network, once more only if it differs from one that is there: there are millions of vessels.
fn shared(network: Skeleton, other: &Arc<Skeleton>) -> Arc<Skeleton> {
    if network == **other { Arc::clone(other) } else { Arc::new(network) }
}

/// Whether all vessels that overlap leave one branch point.
fn overlap_at_forks_alone(network: &Skeleton) -> bool {
    let adjacency = network.adjacency();
    let branches = network.branches(&adjacency);
    let ends = |edge: EdgeId| branches.list[branches.of_edge[edge.index()].0.index()].ends();
    network.overlaps(&adjacency).pairs.iter().all(|o| ends(o.edges[0]).iter().any(|end| ends(o.edges[1]).contains(end)))
}

/// Terminals that could not be capped, but inlets that were asked for.
fn open_tips(report: &RunReport, plan: &MeshPlan) -> Vec<u32> {
    report.uncapped().filter(|n| !plan.roots.contains(n)).collect()
}

/// Whether a mesh would be valid if each terminal had its cap.
fn lacks_but_caps(check: &CheckReport) -> bool {
    check.failed().all(|line| line.line == Line::CapPerTerminal)
}

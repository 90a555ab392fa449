//! Strategies to mesh a network: as given where that can succeed, then as planned, then fallbacks until a mesh is sound.

use super::error::MeshingError;
use super::limits;
use super::networks::Networks;
use crate::fidelity::{Displacements, lumen_of};
use crate::pipeline::{Estimate, MeshPlan, Meshed, RunError, RunReport, Store, TooLarge, Whole, mesh_shared};
use anastomesh_mesh::check::{CheckReport, Line};
use anastomesh_mesh::progress::Progress;
use anastomesh_network::touching_text;
use anastomesh_network::{Freedom, RefineParams, Residual, refine};
use anastomesh_skeleton::NodeId;
use anastomesh_skeleton::Tubes;
use serde::Serialize;
use std::sync::Arc;

/// Maximum retractions of terminals per strategy. Each one meshes the network again; unchanged blocks come from the store.
const MAX_RETRACTIONS: usize = 8;

/// Maximum retractions of one terminal. On the shared networks, none that was open after them had a cap after a fourth.
const RETRACTIONS_OF_TIP: u32 = 3;

/// Relative volume error of a refined network above which it is meshed without refinement. Applies if only vessels of one
/// branch point overlap.
const MAX_VOLUME_ERROR: f64 = 0.05;

/// Factor on the clearance of the refinement where walls became joined although no vessels overlap. Walls come closer to each
/// other than tubes do, by the width of the field's kernel.
const WIDER: f64 = 1.2;

/// Distance of axes, in sums of radii, below which vessels are moved apart then: walls of tubes that almost touch fuse.
const NEAR: f64 = 1.1;

/// Factors on ρ where walls of vessels intersect that do not overlap.
const FINER: [f64; 2] = [2.0, 4.0];
/// Maximum edges of a network that is meshed with finer edges because a block failed.
const FEW_EDGES: usize = 2_000;

/// Network that an attempt meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Strategy {
    /// The prepared network before refinement, if its overlaps do not exclude a valid mesh.
    AsGiven,
    /// The prepared grown network, of which only overlapping vessels were moved.
    OverlapsMoved,
    /// The prepared network, refined if the run asks for it.
    Planned,
    /// The network of the attempt before, with terminals retracted that could not be capped.
    RetractedTips,
    /// The prepared network, without refinement.
    Unrefined,
    /// The prepared network, refined with more clearance.
    WiderClearance,
    /// The network of the best attempt before, with finer edges.
    FinerEdges,
    /// The network of the best attempt before, then the refined one, with vessels that overlap as one lumen.
    Fused,
}

impl Strategy {
    /// Strategies that replace a planned network which gives no sound mesh, in order.
    const FALLBACKS: [Self; 2] = [Self::Unrefined, Self::WiderClearance];
}

/// Fault of an attempt.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Fault {
    /// There is no mesh.
    NoMesh,
    /// The mesh is not valid, lacks blocks, or does not keep the vessels.
    Invalid,
    /// The volume differs from that of the given lumen, as a share of it.
    Volume(f64),
}

/// Attempt to mesh a network.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Attempt {
    /// Network that was meshed.
    pub strategy: Strategy,
    /// Reason to try another strategy; `None` if the mesh is sound.
    pub fault: Option<Fault>,
}

/// Mesh of an attempt.
pub(super) struct Candidate<'a> {
    pub stored: Meshed<Whole<'a>>,
    pub networks: Networks,
    /// Index of the attempt.
    pub attempt: usize,
}

/// Attempt without a mesh.
pub(super) struct Failure {
    pub error: RunError,
    pub networks: Box<Networks>,
}

impl Failure {
    /// True if no strategy follows: the run was cancelled, or blocks cannot be stored. Another strategy would give a mesh that
    /// depends on faults of the disk.
    fn stops(&self) -> bool {
        matches!(self.error, RunError::Cancelled | RunError::Store(_))
    }

    /// True if the limit on memory is exceeded even by a refined network. `lengthens`: refinement lengthens vessels.
    fn is_final(&self, lengthens: impl FnOnce() -> bool) -> bool {
        let RunError::TooLarge(error) = &self.error else { return false };
        match **error {
            TooLarge::Block { .. } => !lengthens(),
            TooLarge::Regions { .. } => true,
            TooLarge::Whole { .. } | TooLarge::Disk { .. } => false,
        }
    }

    pub(super) fn into_error(self) -> MeshingError {
        match self.error {
            RunError::BlocksFailed(report) => MeshingError::Blocks { report, networks: self.networks },
            error => error.into(),
        }
    }
}

type Outcome<'a> = Result<Candidate<'a>, Failure>;

/// Store and parameters of a run, and its attempts so far.
pub(super) struct Meshing<'a, 'b> {
    pub store: &'a Store,
    pub plan: &'b MeshPlan,
    pub fits: &'b dyn Fn(&Estimate) -> Result<(), TooLarge>,
    pub progress: &'a dyn Progress,
    pub retracts: bool,
    /// Parameters of the refinement, if there is one.
    pub refine: Option<RefineParams>,
    /// Refines a network that was first meshed as given.
    pub refined: &'b dyn Fn(&Networks) -> Result<Networks, MeshingError>,
    pub attempts: Vec<Attempt>,
}

/// Meshes a network. Refinement must never give a worse mesh than none.
///
/// A sound mesh of the network as given is kept, and nothing is moved. Otherwise the network is refined. If that gives no
/// sound mesh, or another volume, fallbacks follow. The best mesh is kept; of equally good ones, the planned one. If only
/// walls intersect, or blocks fail, and no vessels overlap, finer edges are tried. If the network was to be refined
/// and no mesh is valid, vessels that still overlap or touch are fused.
pub(super) fn mesh<'a>(networks: Networks, meshing: &mut Meshing<'a, '_>) -> Result<Candidate<'a>, MeshingError> {
    let best = if meshing.refine.is_some() && networks.refine.is_none() {
        as_given_or_refined(&networks, meshing)
    } else {
        let planned = meshing.attempt(Strategy::Planned, networks);
        or_fallback(planned, true, meshing).map_err(Failure::into_error)
    };
    let best = finer(best, meshing);
    fused(best, meshing)
}

/// Meshes a network as given, and refined if that gives no sound mesh; the better one is kept.
fn as_given_or_refined<'a>(networks: &Networks, meshing: &mut Meshing<'a, '_>) -> Result<Candidate<'a>, MeshingError> {
    let may_be_sound = networks.may_be_sound_as_given();
    let mut as_given = may_be_sound.then(|| meshing.attempt(Strategy::AsGiven, networks.clone()));
    match as_given {
        Some(Ok(candidate)) if meshing.attempts[candidate.attempt].fault.is_none() => {
            meshing.progress.note("the network gives a valid mesh as it is: nothing was moved");
            return Ok(candidate);
        }
        // Blocks become smaller only if vessels are lengthened, so that more of them can be cut.
        Some(Err(failure)) if failure.stops() || failure.is_final(|| meshing.lengthens(networks)) => {
            return Err(failure.into_error());
        }
        _ => {}
    }
    let local = match meshing.with_overlaps_moved(networks)? {
        Some(local) if meshing.attempts[local.attempt].fault.is_none() => return Ok(local),
        // A valid one has a lumen of another size.
        local => local.filter(|made| meshing.fault_of(&made.stored).is_none()),
    };
    let refined = (meshing.refined)(networks)?;
    // Where nothing moves, the first attempt is that of the refined network, too.
    let first = match as_given.take_if(|_| refined.network == networks.network) {
        Some(mut same) => {
            match &mut same {
                Ok(candidate) => candidate.networks.refined_as(refined),
                Err(failure) => failure.networks.refined_as(refined),
            }
            same
        }
        None => meshing.attempt(Strategy::Planned, refined),
    };
    let planned = or_fallback(first, !may_be_sound, meshing);
    let as_given = as_given.and_then(Result::ok);
    let is_valid = |made: &Candidate| meshing.fault_of(&made.stored).is_none();
    match (as_given, local, planned) {
        (_, _, Err(failure)) if !matches!(failure.error, RunError::BlocksFailed(_)) => Err(failure.into_error()),
        (as_given, Some(local), planned) if !as_given.iter().chain(&planned).any(is_valid) => Ok(local),
        (Some(as_given), _, Err(_)) => Ok(as_given),
        (Some(as_given), _, Ok(planned)) if meshing.is_closer(&as_given, &planned) => {
            let why = "refinement gives a mesh that differs more from the given network: nothing was moved";
            meshing.progress.note(why);
            Ok(as_given)
        }
        (_, _, planned) => planned.map_err(Failure::into_error),
    }
}

/// Meshes fallbacks if a refined network gave no sound mesh. `unrefined`: the network before refinement is a fallback.
fn or_fallback<'a>(first: Outcome<'a>, unrefined: bool, meshing: &mut Meshing<'a, '_>) -> Outcome<'a> {
    let (fault, networks) = match &first {
        Ok(candidate) => (meshing.attempts[candidate.attempt].fault, &candidate.networks),
        Err(Failure { error, networks }) => {
            (matches!(error, RunError::BlocksFailed(_)).then_some(Fault::NoMesh), &**networks)
        }
    };
    let Some(fault) = fault.filter(|_| networks.refine.is_some()) else { return first };
    for strategy in Strategy::FALLBACKS.into_iter().filter(|&s| unrefined || s != Strategy::Unrefined) {
        let Some(again) = meshing.networks_for(strategy, fault, networks) else { continue };
        match meshing.attempt(strategy, again) {
            Ok(candidate) if meshing.is_better(&candidate, fault) => {
                meshing.progress.note(&kept(strategy, fault));
                return Ok(candidate);
            }
            Err(failure) if failure.stops() => return Err(failure),
            Ok(_) | Err(_) => {}
        }
    }
    first
}

/// Meshes with finer edges if walls intersect or are joined although no vessels overlap: coarse walls deviate more from their tubes.
fn finer<'a>(
    best: Result<Candidate<'a>, MeshingError>,
    meshing: &mut Meshing<'a, '_>,
) -> Result<Candidate<'a>, MeshingError> {
    let intersects =
        |check: &CheckReport| !check.is_valid() && check.failed().all(|line| line.line == Line::NoSelfIntersection);
    let (networks, factors) = match &best {
        Ok(made) if intersects(&made.stored.check) => (made.networks.clone(), &FINER[..]),
        Err(MeshingError::Blocks { networks, .. }) if networks.network.edges.len() <= FEW_EDGES => {
            (Networks::clone(networks), &FINER[..1])
        }
        _ => return best,
    };
    let is_too_costly = best.is_err() && meshing.store.is_hopeless();
    if is_too_costly || !networks.network.overlaps(&networks.network.adjacency()).pairs.is_empty() {
        return best;
    }
    for factor in factors {
        let plan = MeshPlan { rho: factor * meshing.plan.rho, ..meshing.plan.clone() };
        match meshing.attempt_by(&plan, Strategy::FinerEdges, networks.clone()) {
            Ok(candidate) if meshing.fault_of(&candidate.stored).is_none() => {
                let rho = plan.rho;
                meshing
                    .progress
                    .note(&format!("walls that almost touch were not apart: meshed with finer edges, rho {rho}"));
                return Ok(candidate);
            }
            Err(failure) if failure.stops() => return Err(failure.into_error()),
            Ok(_) | Err(_) => {}
        }
    }
    best
}

/// Meshes with vessels that overlap or touch fused if the network was to be refined, and no attempt gave a valid mesh.
fn fused<'a>(
    best: Result<Candidate<'a>, MeshingError>,
    meshing: &mut Meshing<'a, '_>,
) -> Result<Candidate<'a>, MeshingError> {
    let networks = match &best {
        Ok(made) if meshing.fault_of(&made.stored).is_some() => &made.networks,
        Err(MeshingError::Blocks { networks, .. }) => networks,
        _ => return best,
    };
    let may_fuse = !meshing.plan.fuse && meshing.refine.as_ref().is_some_and(|of| of.residual == Residual::Shrink);
    if !may_fuse {
        return best;
    }
    let plan = MeshPlan { fuse: true, ..meshing.plan.clone() };
    let refined = networks.refine.is_none().then(|| (meshing.refined)(networks)).transpose()?;
    for networks in [Some(networks.clone()), refined].into_iter().flatten() {
        let network = &networks.network;
        let overlaps = network.overlaps(&network.adjacency());
        let none_meet = overlaps.pairs.is_empty() && overlaps.unconnected.is_empty();
        if meshing.store.is_hopeless() || none_meet {
            continue;
        }
        match meshing.attempt_by(&plan, Strategy::Fused, networks) {
            Ok(candidate) if fault(&candidate.stored.check, &candidate.stored.report, &plan).is_none() => {
                meshing.progress.note(
                    "no mesh with these vessels apart is valid: those that overlap or touch were meshed as one lumen",
                );
                return Ok(candidate);
            }
            Err(failure) if failure.stops() => return Err(failure.into_error()),
            Ok(_) | Err(_) => {}
        }
    }
    best
}

/// Fault of a mesh but for its volume.
pub(super) fn fault(check: &CheckReport, report: &RunReport, plan: &MeshPlan) -> Option<Fault> {
    let is_sound = report.failed.is_empty() && check.is_valid() && report.keeps_vessels(plan.fuse);
    (!is_sound).then_some(Fault::Invalid)
}

/// Note on a fallback that is kept.
fn kept(strategy: Strategy, fault: Fault) -> String {
    match (strategy, fault) {
        (Strategy::WiderClearance, _) => {
            "the network was refined again, with more clearance: walls were joined that are to be apart".into()
        }
        (_, fault) => {
            let gives = if matches!(fault, Fault::Volume(_)) { "a lumen of another size" } else { "no valid mesh" };
            format!("refined, the network gives {gives}; as it was, it gives a valid mesh: that is kept")
        }
    }
}

/// Difference between a mesh and the given network, as a share of the usual limits. The larger one counts of the volume error
/// and the displacement of the axis.
fn difference(Candidate { stored, networks, .. }: &Candidate) -> f64 {
    let meshed: &Arc<_> = &stored.network;
    let axis = Displacements::of(&networks.given, meshed, &Tubes::of(meshed)).spread.p99;
    (volume_error(stored, networks) / limits::LUMEN).max(axis / limits::MEASURED)
}

/// Relative difference of a mesh's volume from that of the given lumen.
fn volume_error(stored: &Meshed<Whole>, networks: &Networks) -> f64 {
    (stored.check.counts.volume / lumen_of(&networks.outline) - 1.0).abs()
}

impl<'a> Meshing<'a, '_> {
    /// Network of a fallback; `None` if it does not apply to the fault.
    fn networks_for(&self, strategy: Strategy, fault: Fault, networks: &Networks) -> Option<Networks> {
        match (strategy, fault) {
            (Strategy::Unrefined, Fault::Volume(_)) if !networks.overlaps_at_forks_alone() => None,
            (Strategy::Unrefined, _) if networks.prepare.measured && networks.excludes_a_mesh() => None,
            (Strategy::Unrefined, _) => Some(networks.again(None)),
            // Another refinement would leave them, too.
            (Strategy::WiderClearance, _)
                if networks.refine.as_ref().is_some_and(|r| r.gave_up || r.residual.left > 0) =>
            {
                None
            }
            (Strategy::WiderClearance, Fault::NoMesh | Fault::Invalid) => {
                let params = self.refine.as_ref()?;
                let params = params.clone().clearance(WIDER * params.clearance).near(NEAR);
                Some(networks.again(Some(refine(&networks.prepared, &params, self.progress).ok()?)))
            }
            _ => None,
        }
    }

    /// Meshes a grown network of which only overlapping vessels were moved; `None` if many overlap, or there is no mesh.
    fn with_overlaps_moved(&mut self, networks: &Networks) -> Result<Option<Candidate<'a>>, MeshingError> {
        let Some(params) = self.refine.clone().filter(|params| params.freedom == Freedom::Auto) else {
            return Ok(None);
        };
        if !(self.lengthens(networks) && networks.may_move_locally()) {
            return Ok(None);
        }
        let refined = refine(&networks.prepared, &params.freedom(Freedom::Measured), self.progress)?;
        match self.attempt(Strategy::OverlapsMoved, networks.again(Some(refined))) {
            Err(failure) if failure.stops() => Err(failure.into_error()),
            made => Ok(made.ok()),
        }
    }

    /// True if the refinement may lengthen vessels of a network.
    fn lengthens(&self, networks: &Networks) -> bool {
        self.refine.as_ref().is_some_and(|params| params.lengthens(&networks.prepared))
    }

    /// True if the first mesh is sound and the second is not, or differs no less from the given network. Of two meshes that are not
    /// sound, the second one must differ by more than the usual limits, too.
    fn is_closer(&self, first: &Candidate, second: &Candidate) -> bool {
        match [first, second].map(|candidate| self.fault_of(&candidate.stored)) {
            [None, None] => difference(first) <= difference(second),
            [None, Some(_)] => true,
            [Some(_), None] => false,
            [Some(_), Some(_)] => difference(second) > difference(first).max(1.0),
        }
    }

    /// True if the mesh of a fallback is valid, and its volume error smaller if that was the fault.
    fn is_better(&self, candidate: &Candidate, fault: Fault) -> bool {
        let Candidate { stored, networks, .. } = candidate;
        self.fault_of(stored).is_none()
            && match fault {
                Fault::Volume(before) => volume_error(stored, networks) < before,
                Fault::NoMesh | Fault::Invalid => true,
            }
    }

    fn fault_of(&self, stored: &Meshed<Whole>) -> Option<Fault> {
        fault(&stored.check, &stored.report, self.plan)
    }

    /// Meshes a network by another plan.
    fn attempt_by(&mut self, plan: &MeshPlan, strategy: Strategy, networks: Networks) -> Outcome<'a> {
        let attempts = std::mem::take(&mut self.attempts);
        let mut other = Meshing { plan, attempts, refine: self.refine.clone(), ..*self };
        let made = other.attempt(strategy, networks);
        self.attempts = other.attempts;
        made
    }

    /// Meshes a network, and again as long as terminals that could not be capped can be retracted.
    fn attempt(&mut self, mut strategy: Strategy, mut networks: Networks) -> Outcome<'a> {
        // A refinement would keep what further retractions lose.
        let most = if strategy == Strategy::AsGiven { 1 } else { RETRACTIONS_OF_TIP };
        let mut retractions = 0;
        let mut retracted: Vec<u32> = Vec::new();
        loop {
            let made = mesh_shared(self.store, &networks.network, self.plan, self.fits, self.progress);
            let told = if retractions < MAX_RETRACTIONS && self.retracts && !self.store.is_hopeless() {
                let before = |tip| retracted.iter().filter(|before| **before == tip).count() as u32;
                let tips = self.open_tips(&made, networks.prepare.measured).into_iter().map(|tip| (tip, before(tip)));
                networks.retract(&tips.filter(|(_, before)| *before < most).collect::<Vec<_>>())
            } else {
                Vec::new()
            };
            let fault = made.as_ref().map_or(Some(Fault::NoMesh), |stored| self.fault_of(stored));
            if told.is_empty() {
                return self.ended(strategy, made, fault, networks);
            }
            self.attempts.push(Attempt { strategy, fault });
            let name = |node| networks.names.of(NodeId(node));
            touching_text(&told, &name).lines().for_each(|line| self.progress.note(line));
            retracted.extend(told.iter().map(|touching| touching.tip));
            strategy = Strategy::RetractedTips;
            retractions += 1;
        }
    }

    /// Records the last attempt of a strategy.
    fn ended(
        &mut self,
        strategy: Strategy,
        made: Result<Meshed<Whole<'a>>, RunError>,
        fault: Option<Fault>,
        networks: Networks,
    ) -> Outcome<'a> {
        let limit = if networks.refine.is_some() { MAX_VOLUME_ERROR } else { limits::LUMEN };
        let volume = |stored: &Meshed<Whole>| {
            let error = self.refine.as_ref().map(|_| volume_error(stored, &networks));
            error.filter(|&error| error > limit).map(Fault::Volume)
        };
        let fault = fault.or_else(|| made.as_ref().ok().and_then(volume));
        self.attempts.push(Attempt { strategy, fault });
        match made {
            Ok(stored) => Ok(Candidate { stored, networks, attempt: self.attempts.len() - 1 }),
            Err(error) => Err(Failure { error, networks: Box::new(networks) }),
        }
    }

    /// Terminals to retract, by their indices in the file: those that could not be capped, but for named inlets. Of a grown
    /// network only if its mesh lacks nothing else, or there is none.
    fn open_tips(&self, made: &Result<Meshed<Whole>, RunError>, measured: bool) -> Vec<u32> {
        let report = match made {
            Ok(Meshed { report, check, .. }) if measured || lacks_but_caps(check) => report,
            Err(RunError::BlocksFailed(report)) => report,
            _ => return Vec::new(),
        };
        report.uncapped().filter(|node| !self.plan.roots.contains(node)).collect()
    }
}

/// True if a mesh would be valid if each terminal had its cap.
fn lacks_but_caps(check: &CheckReport) -> bool {
    check.failed().all(|line| line.line == Line::CapPerTerminal)
}

//! A network ready to be meshed.

use super::error::MeshingError;
use super::limits::Limits;
use super::networks::Networks;
use super::result::NetworkMesh;
use super::strategy::{self, Attempt, Candidate, Meshing, Strategy};
use crate::fidelity::Changes;
use crate::pipeline::{
    Clock, Estimate, FlowPlan, Forecast, Inlets, KeyMaker, Manifest, MeshPlan, Meshed, RunError, Shard, ShareReport,
    Store, Stored, TooLarge, Whole, fingerprint, make_share, mesh_in_memory,
};
use anastomesh_io::network::NetworkNote;
use anastomesh_mesh::VolumeMesh;
use anastomesh_mesh::progress::{Progress, Stage};
use anastomesh_mesh::source::gather;
use anastomesh_network::{Freedom, RefineParams, Refined, refine};

/// Bytes of memory per tetrahedron of a mesh that is held while its joints are smoothed and it is checked.
const HELD_PER_TET: f64 = 150.0;

/// Settings of a run that its later stages need.
#[derive(Clone, Debug)]
pub(super) struct Settings {
    pub refine: Option<RefineParams>,
    /// True if terminals that could not be capped are retracted.
    pub retracts: bool,
    pub flow: FlowPlan,
    pub limits: Limits,
}

/// Network with its cures applied and its inlets chosen, and the plan to mesh it by.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct PreparedRun {
    /// Networks so far.
    pub networks: Networks,
    /// Decisions of the reader.
    pub notes: Vec<NetworkNote>,
    /// Inlets, and why they are.
    pub inlets: Inlets,
    /// Terminals that were extended by less than asked for because another vessel is in the way: index in the file, and length
    /// in radii.
    pub cut_short: Vec<(u32, f64)>,
    /// Plan, with the named inlets as roots.
    pub plan: MeshPlan,
    pub(super) settings: Settings,
}

impl PreparedRun {
    /// Refines the network, if the run asks for it and the network is not tried as given first. Runs that share a work
    /// directory refine once; `store` is that directory.
    ///
    /// # Errors
    /// If a parameter is out of range, the run is cancelled, or the work directory cannot be used.
    pub fn refined(mut self, store: Option<&Store>, progress: &dyn Progress) -> Result<Self, MeshingError> {
        // The search for overlaps comes last, as it takes a second in large networks.
        let Some(params) = self.refinement().filter(|_| self.networks.refine.is_none()) else { return Ok(self) };
        let may_move_locally = || params.freedom == Freedom::Auto && self.networks.may_move_locally();
        if self.plan.smooths_joints() || !(self.networks.may_be_sound_as_given() || may_move_locally()) {
            self.networks = refined(&self.networks, &params, store, progress)?;
        }
        Ok(self)
    }

    /// Refinement parameters that know whether the network is measured: resampled polylines do not look so any more.
    fn refinement(&self) -> Option<RefineParams> {
        self.settings.refine.clone().map(|params| params.fitted(self.networks.prepare.measured))
    }

    /// Estimates the mesh from the vessels alone, before the network is cut into blocks.
    pub fn rough_estimate(&self) -> Estimate {
        Estimate::rough(&self.networks.network, &self.plan)
    }

    /// Cuts the network into blocks, and estimates what they will take.
    ///
    /// # Errors
    /// If the network cannot be cut.
    pub fn forecast(&self) -> Result<Forecast, MeshingError> {
        Ok(Forecast::of(&self.networks.network, &self.plan)?)
    }

    /// Identifies this run to a work directory.
    pub fn manifest(&self) -> Manifest {
        let refine = self.settings.refine.as_ref().map(|params| format!("{params:?}"));
        // Blocks that are done do not depend on whether failed ones are left out.
        let plan = MeshPlan { keep_going: false, ..self.plan.clone() };
        Manifest::new(&self.networks.prepared, serde_json::json!({ "mesh": plan, "refine": refine }))
    }

    /// Meshes the share of the blocks that belongs to a shard. The networks that this does not need are dropped first.
    ///
    /// # Errors
    /// See [`MeshingError`].
    pub fn make_share(
        self,
        store: &Store,
        shard: Shard,
        fits: &dyn Fn(&Estimate) -> Result<(), TooLarge>,
        progress: &dyn Progress,
    ) -> Result<ShareReport, MeshingError> {
        let Self { networks: Networks { network, .. }, plan, .. } = self.refined(Some(store), progress)?;
        Ok(make_share(store, network, &plan, shard, fits, progress)?)
    }

    /// Meshes into a store; the mesh is never in memory as a whole. Joints are not smoothed. `fits` hears what the run will
    /// take before anything is meshed, and may refuse.
    ///
    /// # Errors
    /// See [`MeshingError`].
    pub fn mesh_into<'a>(
        self,
        store: &'a Store,
        fits: &dyn Fn(&Estimate) -> Result<(), TooLarge>,
        progress: &'a dyn Progress,
    ) -> Result<NetworkMesh<Whole<'a>>, MeshingError> {
        let run = self.refined(Some(store), progress)?;
        let refine = run.refinement();
        let Self { networks, plan, settings, .. } = run;
        let again = |networks: &Networks| match &refine {
            Some(params) => refined(networks, params, Some(store), progress),
            None => Ok(networks.clone()),
        };
        let mut meshing = Meshing {
            store,
            plan: &plan,
            fits,
            progress,
            retracts: settings.retracts,
            refine: refine.clone(),
            refined: &again,
            attempts: Vec::new(),
        };
        let best = strategy::mesh(networks, &mut meshing);
        let attempts = meshing.attempts;
        let Candidate { stored, networks, attempt } = best?;
        let Stored { whole: mesh, expectation, check, report, network } = stored;
        let found = NetworkMesh {
            mesh,
            expectation,
            check,
            report,
            network,
            networks,
            attempts,
            kept: attempt,
            fidelity: None,
            changes: Changes::default(),
            caps: None,
            defects: Vec::new(),
            excused: None,
        };
        found.evaluated(&plan, &settings.flow, settings.limits, progress)
    }

    /// Meshes in memory. Woven joints are smoothed, if the plan asks for it; that is one attempt, without fallbacks.
    ///
    /// # Errors
    /// See [`MeshingError`].
    pub fn mesh(self, progress: &dyn Progress) -> Result<NetworkMesh<VolumeMesh>, MeshingError> {
        if !self.plan.smooths_joints() {
            let store = Store::in_memory();
            let made = self.mesh_into(&store, &|_| Ok(()), progress)?;
            let mut clock = Clock::default();
            let mesh = clock.time(progress, Stage::Merge, 0, || gather(&made.mesh))?;
            let mut made = made.with_mesh(mesh);
            made.report.stages.extend(clock.stages());
            return Ok(made);
        }
        let Self { networks, plan, settings, .. } = self.refined(None, progress)?;
        let estimate = Estimate::rough(&networks.network, &plan);
        let bytes = (estimate.tets * HELD_PER_TET) as u64;
        if bytes > plan.memory {
            let (why, instead) = ("woven joints", "--joint disc");
            return Err(RunError::from(TooLarge::Whole { estimate, why, instead, bytes, memory: plan.memory }).into());
        }
        let Meshed { mesh, expectation, check, report, network } =
            match mesh_in_memory(&networks.network, &plan, progress) {
                Ok(meshed) => meshed,
                Err(error) => return Err(strategy::Failure { error, networks: Box::new(networks) }.into_error()),
            };
        let fault = strategy::fault(&check, &report, &plan);
        let found = NetworkMesh {
            mesh,
            expectation,
            check,
            report,
            network,
            networks,
            attempts: vec![Attempt { strategy: Strategy::Planned, fault }],
            kept: 0,
            fidelity: None,
            changes: Changes::default(),
            caps: None,
            defects: Vec::new(),
            excused: None,
        };
        found.evaluated(&plan, &settings.flow, settings.limits, progress)
    }
}

/// Networks with the prepared one refined, by a work directory only once.
fn refined(
    networks: &Networks,
    params: &RefineParams,
    store: Option<&Store>,
    progress: &dyn Progress,
) -> Result<Networks, MeshingError> {
    let network = &networks.prepared;
    let make = || Ok::<Refined, MeshingError>(refine(network, params, progress)?);
    let key = || {
        let mut key = KeyMaker::new("refined");
        key.text(&format!("{:?} {params:?}", fingerprint(network)));
        key.finish()
    };
    let refined = match store {
        Some(store) => store.once(("refined", key), progress, make)?,
        None => make()?,
    };
    Ok(networks.again(Some(refined)))
}

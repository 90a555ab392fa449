//! Mesh of a run, and what is known of it.

use super::defect::Defect;
use super::error::MeshingError;
use super::limits::Limits;
use super::networks::Networks;
use super::strategy::Attempt;
use crate::fidelity::{Change, Changes, Displaced, Fidelity, Repairs};
use crate::pipeline::{Clock, MeshPlan, Meshed, RunReport};
use anastomesh_flow::{Caps, FlowPlan};
use anastomesh_io::volume::MeshNotes;
use anastomesh_mesh::Cap;
use anastomesh_mesh::check::{CheckReport, Expectation};
use anastomesh_mesh::progress::{Progress, Stage};
use anastomesh_mesh::source::MeshSource;
use anastomesh_skeleton::Skeleton;
use std::sync::Arc;

/// Mesh of a network, and what was done and found.
#[derive(Debug)]
#[non_exhaustive]
pub struct NetworkMesh<M> {
    /// The mesh: in memory, or to be read from its store in passes.
    pub mesh: M,
    /// Expected topology of the mesh.
    pub expectation: Expectation,
    /// Report of the validity check.
    pub check: CheckReport,
    /// Report of the mesher.
    pub report: RunReport,
    /// Network that was meshed: `networks.network` with nodes of more than three vessels split.
    pub network: Arc<Skeleton>,
    /// Networks from the given one to that which was meshed, with the reports of cures and refinement.
    pub networks: Networks,
    /// Attempts in order.
    pub attempts: Vec<Attempt>,
    /// Index of the attempt that gave this mesh.
    pub kept: usize,
    /// Comparison of the mesh with the given network; `None` if the plan is hollow.
    pub fidelity: Option<Fidelity>,
    /// Changes of the given network: what was moved, shrunk, merged, extended, fused or dropped.
    pub changes: Changes,
    /// Inlets and outlets with their one-dimensional flow; `None` if the plan is hollow.
    pub caps: Option<Caps>,
    /// Defects; empty if the mesh is valid and that of its network.
    pub defects: Vec<Defect>,
    /// Place of the furthest displacement of the axis beyond the limit that listed changes require; `None` with a defect.
    pub excused: Option<Displaced>,
}

impl<M> NetworkMesh<M> {
    /// True if the mesh is valid and contains the vessels.
    pub fn is_valid(&self) -> bool {
        !self.defects.iter().any(|defect| matches!(defect, Defect::Invalid | Defect::VesselsNotKept))
    }

    /// Notes for the file of the mesh: expectation, flow, the program and its options. Where [`Caps::group`] has merged
    /// outlets, only inlets have patches of their own.
    pub fn notes(&self, generator: String, options: String) -> MeshNotes {
        let mut expectation = self.expectation.clone();
        if let Some(caps) = self.caps.as_ref().filter(|caps| caps.is_grouped()) {
            expectation.terminals = caps.alone();
        }
        let flow = self.caps.as_ref().map(Caps::flow);
        MeshNotes { expectation: Some(expectation), generator, options, regions: Vec::new(), flow }
    }

    /// Result before its evaluation.
    pub(super) fn of(made: Meshed<M>, networks: Networks, attempts: Vec<Attempt>, kept: usize) -> Self {
        let Meshed { mesh, expectation, check, report, network } = made;
        let (fidelity, changes, caps, defects, excused) = (None, Changes::default(), None, Vec::new(), None);
        Self {
            mesh,
            expectation,
            check,
            report,
            network,
            networks,
            attempts,
            kept,
            fidelity,
            changes,
            caps,
            defects,
            excused,
        }
    }

    /// Replaces the mesh.
    pub(super) fn with_mesh<N>(self, mesh: N) -> NetworkMesh<N> {
        let Self { expectation, check, report, network, networks, attempts, kept, .. } = self;
        let Self { fidelity, changes, caps, defects, excused, .. } = self;
        let made = Meshed { mesh, expectation, check, report, network };
        NetworkMesh { fidelity, changes, caps, defects, excused, ..NetworkMesh::of(made, networks, attempts, kept) }
    }
}

impl<M: MeshSource> NetworkMesh<M> {
    /// Compares the mesh with its network, computes the flow and lists the defects.
    pub(super) fn evaluated(
        mut self,
        plan: &MeshPlan,
        flow: &FlowPlan,
        limits: Limits,
        progress: &dyn Progress,
    ) -> Result<Self, MeshingError> {
        if !plan.hollow {
            let mut clock = Clock::default();
            let networks = self.networks.compared(&self.network);
            let compare = || Fidelity::of(networks, &self.mesh, self.check.counts.volume);
            self.fidelity = Some(clock.time(progress, Stage::Compare, 0, compare)?);
            self.caps = Some(Caps::of(&self.mesh, &self.network, flow, &self.networks.names)?);
            self.report.stages.extend(clock.stages());
        }
        let caps: Vec<Cap> = self.caps.iter().flat_map(|caps| caps.rows.iter().map(|row| row.cap)).collect();
        let Networks { given, prepared, prepare, refine, .. } = &self.networks;
        let repairs = Repairs { prepare, refine: refine.as_ref() };
        self.changes = Changes::of(given, prepared, &self.network, repairs, &caps);
        for block in &self.report.fused {
            let node = block.nodes.first().copied().unwrap_or_default();
            Change::add(&mut self.changes.one_lumen, block.nodes.len() as f64, node);
        }
        self.defects = self.find_defects(plan, limits);
        self.excused = self.fidelity.as_ref().and_then(|fidelity| limits.excused(repairs, fidelity, &self.defects));
        Ok(self)
    }

    fn find_defects(&self, plan: &MeshPlan, limits: Limits) -> Vec<Defect> {
        let mut defects = Vec::new();
        if !self.report.failed.is_empty() {
            defects.push(Defect::MissingBlocks(self.report.failed.len()));
        }
        if !self.check.is_valid() {
            defects.push(Defect::Invalid);
        }
        // Without that request, further loops exist in a valid mesh only if it was the last resort to fuse vessels.
        let are_fused = !plan.fuse && self.check.is_valid() && self.report.anastomoses > 0;
        if are_fused || !self.report.keeps_vessels(plan.fuse) {
            defects.push(Defect::VesselsNotKept);
        }
        // Vessels of missing blocks are no change of the network.
        if let Some(fidelity) = self.fidelity.as_ref().filter(|_| self.report.failed.is_empty()) {
            let Networks { given, prepared, prepare, refine, .. } = &self.networks;
            let repairs = Repairs { prepare, refine: refine.as_ref() };
            defects.extend(limits.unfaithful([given, prepared], repairs, fidelity, &self.changes));
        }
        defects
    }
}

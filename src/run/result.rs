//! Mesh of a run, and what is known of it.

use super::error::MeshingError;
use super::networks::Networks;
use super::strategy::Attempt;
use crate::fidelity::{Displaced, Fidelity};
use crate::pipeline::{Caps, Clock, FlowPlan, MeshPlan, RunReport};
use anastomesh_io::volume::MeshNotes;
use anastomesh_mesh::check::{CheckReport, Expectation};
use anastomesh_mesh::progress::{Progress, Stage};
use anastomesh_mesh::source::MeshSource;
use anastomesh_skeleton::{Branch, NodeId, Skeleton};
use rustc_hash::FxHashSet;
use std::sync::Arc;

/// Maximum distance of the axis of a measured network from the given one, in radii, unless an overlap demands more.
const MAX_MEASURED_DISPLACEMENT: f64 = 1.0;

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
    /// Inlets and outlets with their one-dimensional flow; `None` if the plan is hollow.
    pub caps: Option<Caps>,
    /// Defects; empty if the mesh is valid and that of its network.
    pub defects: Vec<Defect>,
}

/// Reason why a mesh is not what was asked for.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Defect {
    /// Blocks that could not be meshed are missing.
    MissingBlocks(usize),
    /// The check failed.
    Invalid,
    /// An axis is outside the wall, or vessels became one lumen.
    VesselsNotKept,
    /// The meshed axis is too far from the given one.
    Displaced {
        /// Maximum distance, in radii.
        bound: f64,
        /// Places that are further, the furthest first.
        places: Vec<Displaced>,
    },
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
        MeshNotes { expectation: Some(expectation), generator, options, regions: false, flow }
    }

    /// Replaces the mesh.
    pub(super) fn with_mesh<N>(self, mesh: N) -> NetworkMesh<N> {
        let Self { expectation, check, report, network, networks, attempts, kept, fidelity, caps, defects, .. } = self;
        NetworkMesh { mesh, expectation, check, report, network, networks, attempts, kept, fidelity, caps, defects }
    }
}

impl<M: MeshSource> NetworkMesh<M> {
    /// Compares the mesh with its network, computes the flow and lists the defects.
    pub(super) fn evaluated(
        mut self,
        plan: &MeshPlan,
        flow: &FlowPlan,
        max_displacement: Option<f64>,
        progress: &dyn Progress,
    ) -> Result<Self, MeshingError> {
        if !plan.hollow {
            let mut clock = Clock::default();
            let networks = self.networks.compared(&self.network);
            let compare = || Fidelity::of(networks, &self.mesh, self.check.counts.volume);
            self.fidelity = Some(clock.time(progress, Stage::Check, 0, compare)?);
            self.caps = Some(Caps::of(&self.mesh, &self.network, flow, &self.networks.names)?);
            self.report.stages.extend(clock.stages());
        }
        self.defects = self.find_defects(plan, max_displacement);
        Ok(self)
    }

    fn find_defects(&self, plan: &MeshPlan, max_displacement: Option<f64>) -> Vec<Defect> {
        let mut defects = Vec::new();
        if !self.report.failed.is_empty() {
            defects.push(Defect::MissingBlocks(self.report.failed.len()));
        }
        if !self.check.is_valid() {
            defects.push(Defect::Invalid);
        }
        if !self.report.keeps_vessels(plan.fuse) {
            defects.push(Defect::VesselsNotKept);
        }
        defects
            .extend(self.fidelity.as_ref().and_then(|fidelity| displaced(&self.networks, fidelity, max_displacement)));
        defects
    }
}

/// Places where the meshed axis is further from the given one than it may be.
fn displaced(networks: &Networks, fidelity: &Fidelity, max_displacement: Option<f64>) -> Option<Defect> {
    let usual = networks.prepare.measured.then_some(MAX_MEASURED_DISPLACEMENT);
    let bound = max_displacement.or(usual)?;
    let excused = if max_displacement.is_none() { excused(networks) } else { FxHashSet::default() };
    let is_excused = |d: &Displaced| d.meshed.iter().chain(&d.given).any(|node| excused.contains(node));
    let far = fidelity.axis.furthest.iter().take_while(|d| d.radii > bound);
    let places: Vec<Displaced> = far.filter(|d| !is_excused(d)).copied().collect();
    (!places.is_empty()).then_some(Defect::Displaced { bound, places })
}

/// Nodes that may be far from where they were: an overlap demanded it, a node of many vessels was split within its ball, or
/// a cure in the report took their vessel off or moved its end.
fn excused(networks: &Networks) -> FxHashSet<u32> {
    let Networks { given, prepare, refine, .. } = networks;
    let moved = refine.iter().flat_map(|r| r.demanded.iter().map(|far| far.node));
    let crowded = refine.iter().flat_map(|r| r.crowded.iter().flat_map(|pair| pair.nodes));
    let joined = prepare.joined.nodes.iter().flat_map(|j| [j.node, j.into]);
    let mut nodes: FxHashSet<u32> = moved.chain(crowded).chain(joined).collect();
    let adjacency = given.adjacency();
    let name = |n: NodeId| given.node(n).original;
    nodes.extend(given.node_ids().filter(|&n| adjacency.valence(n) > 3).map(name));
    let touching = prepare.touching.iter().map(|t| t.tip);
    let short = prepare.short_tips.iter().map(|t| t.tip);
    let ends: FxHashSet<u32> = touching.chain(short).chain(prepare.spurs.iter().map(|s| s.tip)).collect();
    let cured = |branch: &&Branch| branch.ends().into_iter().any(|n| ends.contains(&name(n)));
    for branch in given.branches(&adjacency).list.iter().filter(cured) {
        nodes.extend(branch.nodes.iter().map(|&n| name(n)));
    }
    nodes
}

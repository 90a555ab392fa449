//! Builder of a run.

use super::error::MeshingError;
use super::limits::Limits;
use super::networks::{Networks, without_islands};
use super::prepared::{PreparedRun, Settings};
use super::result::NetworkMesh;
use crate::pipeline::{Estimate, MeshPlan, Store, TooLarge, Whole};
use anastomesh_flow::{FlowPlan, Inlets};
use anastomesh_io::network::NetworkFile;
use anastomesh_mesh::VolumeMesh;
use anastomesh_mesh::progress::Progress;
use anastomesh_network::{PrepareParams, Prepared, Touching, prepare};
use anastomesh_network::{RefineParams, Residual};
use anastomesh_skeleton::{Extended, NodeId, Skeleton};
use rustc_hash::FxHashSet;

/// Meshes a network as the verb `mesh` does: cures, inlets, refinement, fallbacks, comparison with the network, flow.
///
/// ```
/// use anastomesh::io::{NetworkOptions, read_network};
/// use anastomesh::meshing::Run;
/// use anastomesh::network::RefineParams;
///
/// let file = read_network("fixtures/tree_30.vtp".as_ref(), &NetworkOptions::default())?;
/// let made = Run::new(file).refine(RefineParams::default()).mesh(&())?;
/// assert!(made.defects.is_empty(), "{:?}", made.defects);
/// assert_eq!(made.mesh.patches[1].name, "inlet");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Run {
    file: NetworkFile,
    plan: MeshPlan,
    prepare: PrepareParams,
    refine: Option<RefineParams>,
    roots: Vec<String>,
    /// Lengths by which inlets and outlets are extended, in their radii.
    extension: [f64; 2],
    flow: FlowPlan,
    limits: Limits,
}

impl Run {
    /// Starts from a network as it was read.
    pub fn new(file: NetworkFile) -> Self {
        Self {
            file,
            plan: MeshPlan::default(),
            prepare: PrepareParams::default().only_measured(true),
            refine: None,
            roots: Vec::new(),
            extension: [0.0; 2],
            flow: FlowPlan::default(),
            limits: Limits::default(),
        }
    }

    /// Starts from a network in memory. Its nodes are named by their indices.
    pub fn of_skeleton(skeleton: Skeleton) -> Self {
        Self::new(NetworkFile { skeleton, ..NetworkFile::default() })
    }

    /// Sets how the network is meshed. `plan.roots` are inlets beside those of [`Run::roots`].
    #[must_use]
    pub fn plan(mut self, plan: MeshPlan) -> Self {
        self.plan = plan;
        self
    }

    /// Sets the cures (default: all, of measured networks only).
    #[must_use]
    pub fn prepare(mut self, params: PrepareParams) -> Self {
        self.prepare = params;
        self
    }

    /// Refines the network before it is meshed (default: not).
    #[must_use]
    pub fn refine(mut self, params: RefineParams) -> Self {
        self.refine = Some(params);
        self
    }

    /// Names inlets as the file names its nodes (default: the roots of the file; in components without one, the terminal
    /// of largest radius).
    #[must_use]
    pub fn roots(mut self, names: impl IntoIterator<Item = impl Into<String>>) -> Self {
        self.roots = names.into_iter().map(Into::into).collect();
        self
    }

    /// Extends inlets and outlets straight on, by multiples of their radii (default: 0, not).
    #[must_use]
    pub fn extend(mut self, inlets: f64, outlets: f64) -> Self {
        self.extension = [inlets, outlets];
        self
    }

    /// Sets the flow (default: blood in SI units at Reynolds number 1, with pressure 0 at outlets).
    #[must_use]
    pub fn flow(mut self, flow: FlowPlan) -> Self {
        self.flow = flow;
        self
    }

    /// Sets the limits on the difference between the mesh and the given network.
    #[must_use]
    pub fn limits(mut self, limits: Limits) -> Self {
        self.limits = limits;
        self
    }

    /// Applies the cures and chooses the inlets.
    ///
    /// # Errors
    /// If a plan is out of range, the network cannot be used, or a named inlet is not a terminal.
    pub fn prepared(self) -> Result<PreparedRun, MeshingError> {
        let Self { file, mut plan, prepare: mut params, refine, mut roots, extension, flow, limits } = self;
        plan.validate()?;
        flow.check()?;
        params.lossless |= refine.is_some();
        let NetworkFile { skeleton: raw, groups, notes, names, roots: roots_of_file, .. } = file;
        let Prepared { skeleton, given, outline, report } = prepare(&raw, &groups, &params)?;
        // Components that the caller asked to remove are not part of the network to compare with.
        let [given, outline] = [given, outline].map(|network| without_islands(network, &report.islands));
        drop(raw);
        roots.extend(plan.roots.iter().map(|&root| names.of(NodeId(root))));
        let inlets = Inlets::of(&skeleton, &names, &roots_of_file, &roots)?;
        plan.roots.clone_from(&inlets.roots);
        plan.fuse |= refine.as_ref().is_some_and(|refine| refine.residual == Residual::Fuse);
        let ([given, outline, skeleton], cut_short) = extended([given, outline, skeleton], &inlets, extension);
        let networks = Networks::new(given, outline, skeleton, names, report);
        let retracts = params.touching != Touching::Keep;
        flow.check_with(&networks.prepared, &inlets.sites(&networks.prepared), &networks.names)?;
        let settings = Settings { refine, retracts, flow, limits };
        Ok(PreparedRun { networks, notes, inlets, cut_short, plan, settings })
    }

    /// Meshes into a store; the mesh is never in memory as a whole. `fits` hears what the run will take before anything is
    /// meshed, and may refuse.
    ///
    /// # Errors
    /// See [`MeshingError`].
    pub fn mesh_into<'a>(
        self,
        store: &'a Store,
        fits: &dyn Fn(&Estimate) -> Result<(), TooLarge>,
        progress: &'a dyn Progress,
    ) -> Result<NetworkMesh<Whole<'a>>, MeshingError> {
        self.prepared()?.mesh_into(store, fits, progress)
    }

    /// Meshes in memory.
    ///
    /// # Errors
    /// See [`MeshingError`].
    pub fn mesh(self, progress: &dyn Progress) -> Result<NetworkMesh<VolumeMesh>, MeshingError> {
        self.prepared()?.mesh(progress)
    }
}

/// Networks with inlets and outlets extended by multiples of their radii, and the terminals of the last one that got less.
fn extended(networks: [Skeleton; 3], inlets: &Inlets, by: [f64; 2]) -> ([Skeleton; 3], Vec<(u32, f64)>) {
    let mut cut_short = Vec::new();
    if by == [0.0; 2] {
        return (networks, cut_short);
    }
    let inlets: FxHashSet<u32> = inlets.list.iter().map(|inlet| inlet.original).collect();
    // What the mesh is compared with is extended as well.
    let extended = networks.map(|network| {
        let by = |node: NodeId| by[usize::from(!inlets.contains(&network.node(node).original))];
        let radii = network.adjacency().terminals().into_iter().map(|node| (node, by(node))).collect();
        let Extended { skeleton, cut_short: less } = network.extended(&radii);
        cut_short = less.iter().map(|&(node, radii)| (skeleton.node(node).original, radii)).collect();
        skeleton
    });
    (extended, cut_short)
}

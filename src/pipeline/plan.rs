//! Parameters of a run.

use crate::block::{BlockParams, EndStyle};
use anastomesh_skeleton::resolution::{FOLLOW, RHO};
use anastomesh_skeleton::{LEAST_SIZE, SizeAt};
use anastomesh_tet::{Layers, LayersError};
use std::borrow::Cow;

/// Joint style at cuts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum JointStyle {
    /// One pass. The disc at each cut depends on the vessel alone, so blocks are meshed in any order. Joints are not smoothed,
    /// because smoothing makes them worse.
    #[default]
    Disc,
    /// Two passes with the whole mesh in memory. Clusters end in surfaces that suit their walls. Then a connector is woven
    /// between the ends of its two clusters (section 3.2.3), and joints are smoothed (section 3.2.4).
    Woven,
    /// No vessel is cut; every component is one cluster. Where edges do not follow the radius, the thinnest
    /// vessel sets the resolution. For comparison.
    None,
}

/// Parameters of a run of the mesher.
///
/// ```
/// use anastomesh::meshing::MeshPlan;
///
/// assert!(MeshPlan::default().rho(2.0).validate().is_err());
/// assert!(MeshPlan::default().rho(4.0).fuse(true).validate().is_ok());
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct MeshPlan {
    /// Resolution ρ: voxels across the thinnest vessel of a cluster; larger is finer.
    pub rho: f64,
    /// Exponent of edge lengths over the vessel radius. 1: ρ voxels across every vessel;
    /// 0: the thinnest vessel sets the edge length of its whole cluster.
    pub follow: f64,
    /// Aspect ratio of tetrahedra along template tubes between bifurcations and caps.
    pub stretch: f64,
    /// Factors on edge lengths at forks and stretch of tubes from a node array, or edge lengths at points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size_at: Option<SizeAt>,
    /// Ratio of edge lengths on the axis to those at the wall.
    pub core: f64,
    /// Layers along the wall.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layers: Option<Layers>,
    /// Joint style at cuts.
    pub joint: JointStyle,
    /// Do not smooth woven joints.
    pub frozen_joints: bool,
    /// Memory limit in bytes, for blocks while they are made and for walls while they are checked. It limits the number of
    /// blocks made at a time. The mesh does not depend on it.
    #[serde(skip)]
    pub memory: u64,
    /// Terminals that are inlets, as indices of nodes in the file that was read. Components without one take the
    /// terminal of largest radius.
    pub roots: Vec<u32>,
    /// Fuse overlapping vessels to one lumen. The expected number of loops includes those of fused vessels.
    pub fuse: bool,
    /// Make only the closed surfaces of the blocks. The result is the boundary of the mesh.
    pub hollow: bool,
    /// Blocks with a folded vertex on the wall are tried in other ways, too: no shell can grow there.
    pub unfolded: bool,
    /// Leave out blocks that fail instead of stopping.
    pub keep_going: bool,
    /// Folder for the inputs of failed blocks; `None` writes no dumps.
    #[serde(skip)]
    pub dump_dir: Option<std::path::PathBuf>,
}

anastomesh_mesh::setters!(MeshPlan {
    rho: f64,
    follow: f64,
    stretch: f64,
    size_at: impl Into<Option<SizeAt>>,
    core: f64,
    layers: impl Into<Option<Layers>>,
    joint: JointStyle,
    frozen_joints: bool,
    memory: u64,
    roots: Vec<u32>,
    fuse: bool,
    hollow: bool,
    unfolded: bool,
    keep_going: bool,
    dump_dir: impl Into<Option<std::path::PathBuf>>,
});

impl Default for MeshPlan {
    fn default() -> Self {
        Self {
            rho: RHO,
            follow: FOLLOW,
            stretch: 1.0,
            size_at: None,
            core: 1.0,
            layers: None,
            joint: JointStyle::default(),
            frozen_joints: false,
            memory: 2 << 30,
            roots: Vec::new(),
            fuse: false,
            hollow: false,
            unfolded: false,
            keep_going: false,
            dump_dir: None,
        }
    }
}

/// Invalid plan.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// Woven joints are an optional part of the program.
    #[error("this build has no woven joints: give --joint disc, or build with the cargo feature `woven`")]
    NoWovenJoints,
    /// ρ is out of range.
    #[error("rho = {0} is out of range: give at least 2.5 (usual are 3 to 5; larger is finer)")]
    Rho(f64),
    /// The exponent is out of range.
    #[error("follow = {0} is out of range: give 0 (uniform edge length) to 1 (proportional to the radius)")]
    Follow(f64),
    /// The stretch is out of range.
    #[error("stretch = {0} is out of range: give 1 (isotropic) to {MOST_STRETCH}")]
    Stretch(f64),
    /// Stretch needs template tubes, which only the joint style `Disc` has.
    #[error("stretch = {0} needs the joint style disc")]
    StretchWoven(f64),
    /// The factor at forks is out of range.
    #[error("size-at = {0} is out of range: give {LEAST_SIZE} (shortest edges at bifurcations) to 1 (no change)")]
    SizeAt(f64),
    /// Factors at forks need fixed discs, which only the joint style `Disc` has.
    #[error("shorter edges (size-at, sizes-from) need the joint style disc")]
    SizeAtWoven,
    /// Edge lengths at points are compared with those of edges that are proportional to the radius.
    #[error("sizes-from needs follow = 1, and follow is {0}: omit it")]
    FieldFollow(f64),
    /// Two options set the stretch of tubes.
    #[error("stretch = {stretch} and the size-at array '{array}' both set the stretch of tubes: omit one")]
    StretchTwice {
        /// First option.
        stretch: f64,
        /// Second option.
        array: String,
    },
    /// The core ratio is out of range.
    #[error("core = {0} is out of range: give {least} to {most} (ratio of edge lengths, axis to wall)",
        least = CORES[0], most = CORES[1])]
    Core(f64),
    /// The parameters of layers are invalid.
    #[error(transparent)]
    Layers(#[from] LayersError),
    /// Layers need filled blocks and the joint style `Disc`.
    #[error("layers need the joint style disc and a volume mesh")]
    LayersWoven,
}

/// Edges longer than this, in edges across, follow no taper and no bend.
pub const MOST_STRETCH: f64 = 20.0;
/// Range of the ratio of edge lengths on the axis to those at the wall.
const CORES: [f64; 2] = [0.5, 4.0];

impl MeshPlan {
    /// True if connectors are made after their clusters.
    pub fn weaves_joints(&self) -> bool {
        self.joint == JointStyle::Woven
    }

    /// True if joints are smoothed after assembly.
    pub fn smooths_joints(&self) -> bool {
        self.weaves_joints() && !self.frozen_joints
    }

    /// Parameters of a block as it is first tried. The partition has to know the kernel's width, too.
    pub fn block_params(&self) -> BlockParams {
        let ends = match self.joint {
            JointStyle::Woven | JointStyle::None => EndStyle::Disc,
            JointStyle::Disc => EndStyle::Shared,
        };
        let Self { follow, stretch, core, layers, hollow, unfolded, .. } = *self;
        BlockParams { follow, ends, stretch, core, layers, hollow, unfolded, ..BlockParams::with_rho(self.rho) }
    }

    /// The plan of a block that is a tube, where the network says how long its edges are: stretched so.
    pub(crate) fn of_tube(&self, size: Option<f64>) -> Cow<'_, Self> {
        match size.map(|size| size.clamp(1.0, MOST_STRETCH)) {
            Some(stretch) if stretch != self.stretch => Cow::Owned(Self { stretch, ..self.clone() }),
            _ => Cow::Borrowed(self),
        }
    }

    fn validate_sizes(&self, size_at: &SizeAt) -> Result<(), PlanError> {
        match size_at {
            _ if self.joint != JointStyle::Disc => Err(PlanError::SizeAtWoven),
            SizeAt::Forks(factor) if !(LEAST_SIZE..=1.0).contains(factor) => Err(PlanError::SizeAt(*factor)),
            SizeAt::Nodes(sizes) if self.stretch != 1.0 => {
                Err(PlanError::StretchTwice { stretch: self.stretch, array: sizes.array().to_owned() })
            }
            SizeAt::Field(_) if self.follow != 1.0 => Err(PlanError::FieldFollow(self.follow)),
            SizeAt::Forks(_) | SizeAt::Nodes(_) | SizeAt::Field(_) => Ok(()),
        }
    }

    /// # Errors
    /// A parameter is out of range.
    pub fn validate(&self) -> Result<(), PlanError> {
        if self.weaves_joints() && !cfg!(feature = "woven") {
            return Err(PlanError::NoWovenJoints);
        }
        // Below 2.5 voxels across, a vessel is no tube any more; how fine is too fine, memory tells. NaN fails too.
        if !(2.5..f64::INFINITY).contains(&self.rho) {
            return Err(PlanError::Rho(self.rho));
        }
        if !(0.0..=1.0).contains(&self.follow) {
            return Err(PlanError::Follow(self.follow));
        }
        if !(CORES[0]..=CORES[1]).contains(&self.core) {
            return Err(PlanError::Core(self.core));
        }
        if let Some(layers) = &self.layers {
            layers.check()?;
            if self.joint != JointStyle::Disc || self.hollow {
                return Err(PlanError::LayersWoven);
            }
        }
        self.size_at.as_ref().map_or(Ok(()), |size_at| self.validate_sizes(size_at))?;
        match self.stretch {
            1.0 => Ok(()),
            stretch if !(1.0..=MOST_STRETCH).contains(&stretch) => Err(PlanError::Stretch(stretch)),
            stretch if self.joint != JointStyle::Disc => Err(PlanError::StretchWoven(stretch)),
            _ => Ok(()),
        }
    }
}

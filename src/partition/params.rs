//! Parameters of the partition and errors of its input.

use anastomesh_skeleton::resolution::{KAPPA, RHO};
use std::collections::{BTreeMap, BTreeSet};

use anastomesh_skeleton::{BranchId, CutRules, EdgeId, NodeId, SizeField, Skeleton};

/// Parameters of the partition. Lengths are in radii of the respective vessel unless stated otherwise.
#[derive(Clone, Debug, PartialEq)]
pub struct PartitionParams {
    /// Resolution ρ: a cluster is contoured with voxels of 2 · (its smallest radius) / ρ.
    pub rho: f64,
    /// Width κ of the convolution kernel: σ = κ r. Controls the distance at which two vessels fuse.
    pub kappa: f64,
    /// Rules for a cut, as in equations 11 and 12.
    pub cuts: CutRules,
    /// Rules for cuts in clusters that would otherwise be too large: little more than space for two discs.
    pub eager_cuts: CutRules,
    /// Maximum number of nodes per cluster.
    pub large: usize,
    /// Branches that follow `eager_cuts`. Branches of clusters above `large` are added.
    pub eager: BTreeSet<BranchId>,
    /// Length of the straight extension of a vessel beyond its end plane.
    pub overrun: f64,
    /// Minimum length of the overrun, in voxels.
    pub overrun_voxels: f64,
    /// Minimum overrun of a terminal obstructed by another vessel. At 0.4 the wall is 1.3 % thinner at the plane than
    /// the vessel. The tip is then no longer than the ball at the vessel's end.
    pub shortest_overrun: f64,
    /// Cut branches with a terminal wherever possible, so that straight tubes connect bifurcations and caps.
    pub cut_terminals: bool,
    /// Minimum length of a terminal branch to be cut otherwise.
    pub long: f64,
    /// Minimum ratio of its radii for a terminal branch to be cut.
    pub taper: f64,
    /// Maximum connector length.
    pub longest_connector: f64,
    /// Branches that must not be cut.
    pub forbidden_cuts: BTreeSet<BranchId>,
    /// Pairs of uncut branches that must share a cluster, even if they do not meet in the skeleton.
    pub together: BTreeSet<[BranchId; 2]>,
    /// Shift of cut planes, as a fraction of the free space, in [−1, 1]. A positive value moves the plane at the
    /// branch's start towards its end. A negative value moves the plane at the end towards the start.
    pub shifted_cuts: BTreeMap<BranchId, f64>,
    /// Requested edge lengths: no vessel is cut where they are shorter than the resolution's, as discs at cuts are not.
    pub size_field: Option<SizeField>,
}

impl Default for PartitionParams {
    fn default() -> Self {
        Self {
            rho: RHO,
            kappa: KAPPA,
            cuts: CutRules::default(),
            eager_cuts: CutRules { node_distance: 1.5, angle_margin: 1.1, ..CutRules::default() },
            large: 100,
            eager: BTreeSet::new(),
            overrun: 1.0,
            overrun_voxels: 1.6,
            shortest_overrun: 0.4,
            cut_terminals: false,
            long: 30.0,
            taper: 2.0,
            longest_connector: 200.0,
            forbidden_cuts: BTreeSet::new(),
            together: BTreeSet::new(),
            shifted_cuts: BTreeMap::new(),
            size_field: None,
        }
    }
}

impl PartitionParams {
    /// Cut rules of a branch.
    pub(super) fn rules(&self, branch: u32) -> CutRules {
        if self.eager.contains(&BranchId(branch)) { self.eager_cuts } else { self.cuts }
    }

    /// Minimum distance of two parallel vessels' axes, in sums of their radii, without fusion. Equal tubes of the
    /// convolution surface fuse at √(1 + 2 κ² ln 2); 5 % are added.
    pub fn blending(&self) -> f64 {
        1.05 * (1.0 + 2.0 * self.kappa * self.kappa * std::f64::consts::LN_2).sqrt()
    }

    /// Rule for overrun lengths.
    pub(super) fn overruns(&self) -> Overruns {
        Overruns { radii: self.overrun, voxels: self.overrun_voxels, rho: self.rho }
    }

    pub(super) fn check(&self) -> Result<(), PartitionError> {
        let all = [
            ("rho", self.rho),
            ("kappa", self.kappa),
            ("node_distance", self.cuts.node_distance),
            ("angle_margin", self.cuts.angle_margin),
            ("room", self.cuts.room),
            ("overrun", self.overrun),
            ("overrun_voxels", self.overrun_voxels),
            ("shortest_overrun", self.shortest_overrun),
            ("long", self.long),
            ("taper", self.taper),
            ("longest_connector", self.longest_connector),
            ("max_turn", self.cuts.max_turn),
        ];
        match all.into_iter().find(|(_, value)| !(value.is_finite() && *value > 0.0)) {
            Some((name, value)) => Err(PartitionError::Parameter { name, value }),
            None => Ok(()),
        }
    }
}

/// Rule for overrun lengths.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Overruns {
    radii: f64,
    voxels: f64,
    rho: f64,
}

impl Overruns {
    /// Overrun length of a vessel of radius `radius` in a cluster with smallest radius `r_min`.
    pub fn length(self, radius: f64, r_min: f64) -> f64 {
        (self.radii * radius).max(self.voxels * 2.0 * r_min / self.rho)
    }
}

/// Reasons why a skeleton cannot be partitioned. Cleaning removes all of them.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PartitionError {
    /// A parameter is not a positive number.
    #[error("partition parameter {name} is {value}; it must be positive")]
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The caller asked for a stop.
    #[error("cancelled")]
    Cancelled,
    /// An edge refers to a node that does not exist.
    #[error("edge {} joins node {}, which does not exist", edge.0, node.0)]
    NoSuchNode {
        /// The edge.
        edge: EdgeId,
        /// The missing node.
        node: NodeId,
    },
    /// An edge has a length or radius that is zero, negative or not a number.
    #[error("edge {} has length {length} and radii {} and {}; all must be positive", edge.0, radii[0], radii[1])]
    BadEdge {
        /// The edge.
        edge: EdgeId,
        /// Its length.
        length: f64,
        /// Radii at its ends.
        radii: [f64; 2],
    },
}

/// Checks the preconditions of the partition.
pub(super) fn check_skeleton(skeleton: &Skeleton) -> Result<(), PartitionError> {
    for (i, edge) in skeleton.edges.iter().enumerate() {
        let id = EdgeId(i as u32);
        if let Some(&node) = edge.nodes.iter().find(|n| n.0 as usize >= skeleton.nodes.len()) {
            return Err(PartitionError::NoSuchNode { edge: id, node });
        }
        let (length, radii) = (skeleton.tube(id).length(), edge.radii);
        let good = |x: f64| x.is_finite() && x > 0.0;
        if !(good(length) && radii.into_iter().all(good)) {
            return Err(PartitionError::BadEdge { edge: id, length, radii });
        }
    }
    Ok(())
}

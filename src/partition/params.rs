//! What a caller may choose about the partition, and what may be wrong with its input.

use anastomesh_skeleton::resolution::{KAPPA, RHO};
use std::collections::{BTreeMap, BTreeSet};

use anastomesh_skeleton::{BranchId, CutRules, EdgeId, NodeId, Skeleton};

/// How a skeleton is cut. Lengths are in radii of the vessel concerned unless said otherwise.
#[derive(Clone, Debug, PartialEq)]
pub struct PartitionParams {
    /// Resolution ρ: a cluster is contoured with voxels of 2 · (its smallest radius) / ρ.
    pub rho: f64,
    /// Width κ of the convolution kernel: σ = κ r. Decides how close two vessels may come before they fuse.
    pub kappa: f64,
    /// What a cut needs, in the terms of equations 11 and 12.
    pub cuts: CutRules,
    /// What it needs where a cluster would be too large otherwise: room for two discs, and little more.
    pub eager_cuts: CutRules,
    /// A cluster of more nodes than this is too large.
    pub large: usize,
    /// Branches that are cut as `eager_cuts` says; those of clusters that are too large are added to them.
    pub eager: BTreeSet<BranchId>,
    /// Length of the straight piece that continues a vessel beyond its end plane.
    pub overrun: f64,
    /// Least length of that piece in voxels.
    pub overrun_voxels: f64,
    /// What a terminal's overrun may be shortened to when another vessel is in its way. At 0.4 the wall is 1.3 % thinner
    /// at the plane than the vessel, and its tip no longer than the ball at the vessel's end.
    pub shortest_overrun: f64,
    /// Branches with a terminal are cut wherever there is room: what lies between forks and caps is then tubes.
    pub cut_terminals: bool,
    /// Else a branch with a terminal is cut when it is longer than this; a longer piece of any branch is cut again.
    pub long: f64,
    /// A branch with a terminal is also cut when its radii differ by more than this factor.
    pub taper: f64,
    /// Longest connector.
    pub longest_connector: f64,
    /// Branches that must not be cut.
    pub forbidden_cuts: BTreeSet<BranchId>,
    /// Pairs of branches that are to be in one cluster, though they may meet nowhere in the skeleton. They are not cut.
    pub together: BTreeSet<[BranchId; 2]>,
    /// Branches whose planes are to be moved off their usual place by a share of the room there is, in [−1, 1]: a
    /// positive value moves the plane at the branch's start towards its end, a negative one the plane at its end
    /// towards its start.
    pub shifted_cuts: BTreeMap<BranchId, f64>,
}

impl Default for PartitionParams {
    fn default() -> Self {
        Self {
            rho: RHO,
            kappa: KAPPA,
            cuts: CutRules::default(),
            eager_cuts: CutRules { node_distance: 1.5, angle_margin: 1.1, room: 1.0, ..CutRules::default() },
            large: 150,
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
        }
    }
}

impl PartitionParams {
    /// What a cut of a branch needs.
    pub(super) fn rules(&self, branch: u32) -> CutRules {
        if self.eager.contains(&BranchId(branch)) { self.eager_cuts } else { self.cuts }
    }

    /// How far the axes of two parallel vessels have to be apart, in sums of their radii, to stay two vessels: the
    /// distance at which equal tubes of the convolution surface fuse, √(1 + 2 κ² ln 2), and 5 % more.
    pub fn blending(&self) -> f64 {
        1.05 * (1.0 + 2.0 * self.kappa * self.kappa * std::f64::consts::LN_2).sqrt()
    }

    /// What says how long overruns are.
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

/// What says how long overruns are.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Overruns {
    radii: f64,
    voxels: f64,
    rho: f64,
}

impl Overruns {
    /// Length of the overrun of a vessel of radius `radius` in a cluster whose smallest radius is `r_min`.
    pub fn length(self, radius: f64, r_min: f64) -> f64 {
        (self.radii * radius).max(self.voxels * 2.0 * r_min / self.rho)
    }
}

/// Why a skeleton cannot be partitioned. Cleaning removes all of these from a skeleton.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PartitionError {
    /// A parameter is not a positive number.
    #[error("partition parameter {name} is {value}; it has to be a positive number")]
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// An edge names a node that does not exist.
    #[error("edge {} joins node {}, which does not exist", edge.0, node.0)]
    NoSuchNode {
        /// The edge.
        edge: EdgeId,
        /// The node that it names.
        node: NodeId,
    },
    /// An edge whose length or radius is zero, negative or not a number.
    #[error("edge {} has length {length} and radii {} and {}; all have to be positive", edge.0, radii[0], radii[1])]
    BadEdge {
        /// The edge.
        edge: EdgeId,
        /// Its length.
        length: f64,
        /// Radii at its ends.
        radii: [f64; 2],
    },
}

/// Checks what the partition relies on.
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

//! Parameters of the refinement and their errors.

use super::figures::Metric;
use anastomesh_skeleton::SkeletonError;
use anastomesh_skeleton::resolution::RHO;
use serde::Serialize;

/// Treatment of vessels that still overlap after the iterations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Residual {
    /// List them.
    Report,
    /// Reduce their radii at the overlap, smoothly and by at most 30 %.
    #[default]
    Shrink,
    /// List them as vessels to be meshed together.
    Fuse,
}

/// Treatment of terminals that are too close for two caps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Crowded {
    /// List them.
    Keep,
    /// Move them apart, no further than two caps need.
    #[default]
    Part,
    /// Merge them: of two vessels from one node the thinner is removed, others are joined.
    Merge,
}

/// Freedom of node movement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Freedom {
    /// `Measured` if vessels are polylines or nothing overlaps, else `Grown`.
    #[default]
    Auto,
    /// Only overlapping vessels move, by up to a radius of the node; further only if the overlap remains.
    Measured,
    /// Only overlapping vessels move, by at most this many radii of the node.
    Radii(f64),
    /// As in the paper: vessels are also lengthened and opened so that they can be cut.
    Grown,
}

/// Parameters of the refinement. Lengths are in radii or in the paper's unit (`unit` of the report), in which the
/// median edge radius is 0.448. Results are thus independent of the unit of the file.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct RefineParams {
    /// Maximum number of iterations.
    pub iterations: usize,
    /// Fraction of the iterations in which the paper's three forces act; the rest is projection.
    pub forces: f64,
    /// Rate ℓ1 of the barrier force (7).
    pub barrier_rate: f64,
    /// Rate ℓ2 of the repelling force (8).
    pub repel_rate: f64,
    /// Rate ℓ3 of the angle force (10).
    pub angle_rate: f64,
    /// Target distance of two vessel axes, in sums of their radii.
    pub clearance: f64,
    /// Distance of two axes, in sums of the radii, below which measured vessels move as if they overlapped.
    pub near: f64,
    /// Displacement limit of terminals and roots, in the unit of the skeleton; 0 fixes them.
    pub free_terminals: f64,
    /// Displacement limit of any node, in the paper's unit.
    pub furthest: f64,
    /// Freedom of node movement.
    pub freedom: Freedom,
    /// Allow bends in stuck vessels: new nodes of valence 2.
    pub bends: bool,
    /// Treatment of terminals that are too close together.
    pub crowded: Crowded,
    /// Metrics in which the result must not be worse than the input.
    pub hold: Vec<Metric>,
    /// Treatment of overlaps that remain at the end.
    pub residual: Residual,
    /// Maximum reduction of a radius, as a fraction.
    pub shrink: f64,
    /// Voxels across the thinnest vessel, as in meshing. Shrunk vessels keep a gap of one voxel.
    pub rho: f64,
    /// Sampling interval of the metrics, in iterations, in addition to the first ten. 0 samples only start and end.
    pub every: usize,
}

anastomesh_mesh::setters!(RefineParams {
    iterations: usize,
    forces: f64,
    barrier_rate: f64,
    repel_rate: f64,
    angle_rate: f64,
    clearance: f64,
    near: f64,
    free_terminals: f64,
    furthest: f64,
    freedom: Freedom,
    bends: bool,
    crowded: Crowded,
    hold: Vec<Metric>,
    residual: Residual,
    shrink: f64,
    rho: f64,
    every: usize,
});

impl Default for RefineParams {
    fn default() -> Self {
        Self {
            iterations: 200,
            forces: 0.1,
            barrier_rate: 25.0,
            repel_rate: 0.3,
            angle_rate: 0.02,
            clearance: 1.2,
            near: 1.0,
            free_terminals: 0.0,
            furthest: 21.0,
            freedom: Freedom::Auto,
            bends: true,
            crowded: Crowded::Part,
            hold: vec![Metric::Overlaps, Metric::FarPairs],
            residual: Residual::Shrink,
            shrink: 0.3,
            rho: RHO,
            every: 10,
        }
    }
}

/// Errors of the refinement.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RefineError {
    /// A parameter is out of its range.
    #[error("refinement: {name} is {value}; it must be {expected}")]
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// Value found.
        value: f64,
        /// Expected range.
        expected: &'static str,
    },
    /// The skeleton is not usable.
    #[error(transparent)]
    Skeleton(#[from] SkeletonError),
    /// The caller cancelled the run.
    #[error("cancelled")]
    Cancelled,
}

impl RefineParams {
    /// Parameters for a network of which it is known whether it is measured: polylines that were resampled do not look so any
    /// more.
    #[must_use]
    pub fn fitted(self, measured: bool) -> Self {
        let freedom = if measured && self.freedom == Freedom::Auto { Freedom::Measured } else { self.freedom };
        Self { freedom, ..self }
    }

    pub(super) fn check(&self) -> Result<(), RefineError> {
        let at_least_0 = "0 or more";
        let all = [
            ("the share of steps with forces", self.forces, 0.0, 1.0, "from 0 to 1"),
            ("the barrier rate", self.barrier_rate, 0.0, 1e6, "from 0 to 1e6"),
            ("the repel rate", self.repel_rate, 0.0, 1e6, "from 0 to 1e6"),
            ("the angle rate", self.angle_rate, 0.0, 1.0, "from 0 to 1"),
            ("the clearance", self.clearance, 1.0, 4.0, "from 1 to 4"),
            ("the distance of vessels that move", self.near, 1.0, 4.0, "from 1 to 4"),
            ("the way that terminals are free to go", self.free_terminals, 0.0, f64::MAX, at_least_0),
            ("the furthest way of a node", self.furthest, 0.0, f64::INFINITY, at_least_0),
            ("the largest shrinking", self.shrink, 0.0, 0.3, "from 0 to 0.3"),
            ("rho", self.rho, 2.5, 64.0, "from 2.5 to 64"),
        ];
        let way = match self.freedom {
            Freedom::Radii(radii) => Some(("the way that a node may go", radii, 0.0, f64::MAX, at_least_0)),
            _ => None,
        };
        for (name, value, low, high, expected) in all.into_iter().chain(way) {
            if !(low..=high).contains(&value) {
                return Err(RefineError::Parameter { name, value, expected });
            }
        }
        Ok(())
    }
}

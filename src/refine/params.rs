//! What a caller may choose about the refinement, and what may be wrong with it.

use super::figures::Metric;
use anastomesh_skeleton::SkeletonError;
use anastomesh_skeleton::resolution::RHO;
use serde::Serialize;

/// What is done about vessels that still overlap when the nodes have come to rest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Residual {
    /// They are listed.
    Report,
    /// Their radii are reduced where they meet, smoothly and by 30 % at most.
    #[default]
    Shrink,
    /// They are listed as vessels that are to be meshed together.
    Fuse,
}

/// What is done about terminals that are too close to each other for two caps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Crowded {
    /// They are listed.
    Keep,
    /// They are moved apart, no further than two caps need.
    #[default]
    Part,
    /// They become one: of two vessels that leave one node the thinner is taken away, others are joined.
    Merge,
}

/// How freely the nodes of a network move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Freedom {
    /// As in a measured network where vessels are polylines, or where nothing overlaps; else as in a grown one.
    #[default]
    Auto,
    /// Nothing moves but what overlaps, by a radius of the node; further only where an overlap is not parted by that.
    Measured,
    /// Nothing moves but what overlaps, by so many radii of the node at most.
    Radii(f64),
    /// As the paper has it: vessels are lengthened and opened, too, so that they can be cut.
    Grown,
}

/// How a skeleton is refined. Lengths are in the paper's unit (`unit` of the report: the length in which the median
/// radius of an edge is 0.448) or in radii, so that the unit of the file makes no difference.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RefineParams {
    /// Steps at most.
    pub iterations: usize,
    /// The share of them in which the paper's three forces act; the rest is projection.
    pub forces: f64,
    /// Rate ℓ1 of the barrier force (7).
    pub barrier_rate: f64,
    /// Rate ℓ2 of the repelling force (8).
    pub repel_rate: f64,
    /// Rate ℓ3 of the angle force (10).
    pub angle_rate: f64,
    /// How far the axes of two vessels are to be apart, in sums of their radii.
    pub clearance: f64,
    /// How far terminals and roots may move, in the unit of the skeleton; 0 holds them.
    pub free_terminals: f64,
    /// How far any node may go from where it was, in the paper's unit.
    pub furthest: f64,
    /// How freely nodes move.
    pub freedom: Freedom,
    /// Vessels that are stuck get a bend: a new node of valence 2.
    pub bends: bool,
    /// What is done about terminals that are too close to each other.
    pub crowded: Crowded,
    /// The result is not worse than the input in these.
    pub hold: Vec<Metric>,
    /// What is done about vessels that overlap in the end.
    pub residual: Residual,
    /// Largest share by which a radius may be reduced.
    pub shrink: f64,
    /// Voxels across the thinnest vessel, as in meshing: shrunk vessels clear each other by a voxel.
    pub rho: f64,
    /// The metrics are measured every so many iterations, and after each of the first ten; 0: at the ends only.
    pub every: usize,
}

impl Default for RefineParams {
    fn default() -> Self {
        Self {
            iterations: 200,
            forces: 0.1,
            barrier_rate: 25.0,
            repel_rate: 0.3,
            angle_rate: 0.02,
            clearance: 1.2,
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

/// Why a skeleton is not refined.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RefineError {
    /// A parameter is out of its range.
    #[error("refinement: {name} is {value}; it has to be {expected}")]
    Parameter {
        /// Which one.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it has to be.
        expected: &'static str,
    },
    /// The skeleton cannot be used.
    #[error(transparent)]
    Skeleton(#[from] SkeletonError),
    /// The caller said so.
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

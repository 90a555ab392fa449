//! Defects of a mesh.

use crate::fidelity::{Change, Displaced};
use serde::Serialize;

/// Reason why a mesh is not what was asked for.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
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
        /// 99th percentile of the distance along the axis, in radii.
        p99: f64,
        /// Places that are further and that no listed change requires, the furthest first.
        places: Vec<Displaced>,
    },
    /// The volume differs too much from that of the given lumen.
    Lumen {
        /// Relative excess of the volume; negative if the mesh is smaller.
        excess: f64,
        /// Maximum relative difference.
        bound: f64,
    },
    /// A repair dropped too much of a vessel.
    Dropped {
        /// Vessels of which a part is missing, in radii.
        vessels: Change,
        /// Maximum missing length, in radii.
        bound: f64,
    },
    /// A cap lies too far beyond the given end of its vessel.
    Extended {
        /// Extended tips, in lengths of their vessel.
        tips: Change,
        /// Maximum extension, in lengths of the vessel.
        bound: f64,
    },
}

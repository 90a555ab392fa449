//! Errors of a block.

use super::connector_surface::{ConnectorFault, Division};
use super::end_surface::CutEnd;
use crate::partition::{ClusterId, CutId};
use crate::surface::{CapError, SurfaceError};
use anastomesh_mesh::budget::{OverBudget, Stop};
use anastomesh_mesh::check::Line;
use anastomesh_mesh::units::{counted, number};
use anastomesh_tet::TetError;

/// Reasons for a missing end surface at a cut.
#[non_exhaustive]
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FlattenFailure {
    /// No tetrahedron lies beyond the plane near the vessel's axis.
    #[error("no wall lies beyond the cut plane")]
    NothingBeyond,
    /// The part beyond the plane is connected to something far from the vessel's axis: a fused neighbour.
    #[error("the part beyond the cut plane extends into another vessel")]
    LeavesVessel,
    /// Flattening removed tetrahedra down to the depth limit.
    #[error("flattening of the end exceeded the depth limit")]
    TooDeep,
    /// Handles, pinched vertices or several loops remain.
    #[error("the end surface is not a disc")]
    NotADisc,
    /// The disc at the cut differs from the shared disc of the vessel.
    #[error("the disc at the cut differs from the shared disc")]
    NotShared,
    /// The work limit is reached.
    #[error("flattening of the end exceeded the work limit")]
    Budget,
}

/// Failure of one block. Every variant identifies the block, and the place if there is one.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BlockError {
    /// A parameter is out of range.
    #[error("block parameter {name} = {value} is out of range")]
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// Trimmed ends are an optional part of the program.
    #[error("this program was built without woven joints: build it with the cargo feature `woven`")]
    NoWovenJoints,
    /// The wall could not be created.
    #[error("cluster {}: {source}", cluster.0)]
    Surface {
        /// The cluster.
        cluster: ClusterId,
        /// Reason of the failure.
        source: SurfaceError,
    },
    /// The wall's genus differs from the skeleton's loop count: neighbours fused, or a loop closed.
    #[error("cluster {}: expected {}, found {}", cluster.0, counted(*loops as usize, "loop"), counted(*handles as usize, "handle"))]
    Genus {
        /// The cluster.
        cluster: ClusterId,
        /// Genus of the wall.
        handles: i64,
        /// Independent loops of the cluster's tubes.
        loops: i64,
    },
    /// A part of a vessel's axis lies outside the wall.
    #[error("cluster {}: the axis of a vessel lies outside the wall near {at:?}", cluster.0)]
    Outside {
        /// The cluster.
        cluster: ClusterId,
        /// Point on the axis.
        at: [f64; 3],
    },
    /// Vessels that are distant along the skeleton share one lumen, whatever the genus.
    #[error("cluster {}: two vessels fused near {at:?}", cluster.0)]
    Fused {
        /// The cluster.
        cluster: ClusterId,
        /// Point on the axis of one of them.
        at: [f64; 3],
    },
    /// There is no narrow gap to close ([`super::BlockParams::close_gaps`]): another try with the same wall would be in vain.
    #[error("cluster {}: no narrow gap to close", cluster.0)]
    NoGap {
        /// The cluster.
        cluster: ClusterId,
    },
    /// The caller asked for a stop, or the cluster exceeds its budget.
    #[error("cluster {}: {source}", cluster.0)]
    Stopped {
        /// The cluster.
        cluster: ClusterId,
        /// Reason of the stop.
        source: Stop,
    },
    /// The cluster is expected to take more memory than is allowed.
    #[error(
        "cluster {}: it needs {:.1} GiB of memory, more than the limit of {:.1} GiB",
        cluster.0, gibibytes(*bytes), gibibytes(*limit)
    )]
    Memory {
        /// The cluster.
        cluster: ClusterId,
        /// Expected bytes.
        bytes: u64,
        /// Bytes that are allowed.
        limit: u64,
    },
    /// A terminal could not be capped.
    #[error("cluster {}: {source}", cluster.0)]
    Cap {
        /// The cluster.
        cluster: ClusterId,
        /// End and reason of the failure.
        source: CapError,
    },
    /// A cluster's surface could not be filled.
    #[error("cluster {}: {source}", cluster.0)]
    Tetrahedra {
        /// The cluster.
        cluster: ClusterId,
        /// Reason of the failure.
        source: TetError,
    },
    /// A cluster has no valid end at a cut.
    #[error("cluster {}, cut {}: {failure} near {at:?}", cluster.0, cut.0)]
    End {
        /// The cluster.
        cluster: ClusterId,
        /// Index of the end in `Cluster::ends`.
        end: u32,
        /// Cut at the end.
        cut: CutId,
        /// Intersection of the axis with the cut plane.
        at: [f64; 3],
        /// Reason of the failure.
        failure: FlattenFailure,
    },
    /// An end or a cap is not on the boundary of the block, which is a bug.
    #[error("{block}: {source}")]
    Faces {
        /// `cluster 12` or `connector 7`.
        block: String,
        /// Face at fault.
        source: NotOnBoundary,
    },
    /// The block contains a tetrahedron so flat that a retry is worthwhile.
    #[error("{block}: {}", too_flat(*ratio, *dihedral, *limits))]
    Flat {
        /// `cluster 12` or `connector 7`.
        block: String,
        /// Smallest radius ratio.
        ratio: f64,
        /// Smallest dihedral angle, in degrees.
        dihedral: f64,
        /// Required minimum of both.
        limits: [f64; 2],
    },
    /// The wall of the block has a vertex from which no shell can grow, so that a retry is worthwhile.
    #[error("{block}: the wall is folded near {at:?}")]
    Folded {
        /// `cluster 12` or `connector 7`.
        block: String,
        /// The vertex.
        at: [f64; 3],
    },
    /// The surface of a hollow block is invalid.
    #[error("{block}: invalid surface: the condition '{}' failed", line.statement())]
    Unsound {
        /// `cluster 12` or `connector 7`.
        block: String,
        /// Violated check.
        line: Line,
    },
    /// No division of a connector works.
    #[error("connector of cut {} near {at:?}: {}", cut.0, attempts.last().map_or_else(String::new, |a| a.failure.to_string()))]
    Connector {
        /// The cut.
        cut: CutId,
        /// Point on the cut's path.
        at: [f64; 3],
        /// Failed attempts in order.
        attempts: Vec<ConnectorAttempt>,
    },
}

fn gibibytes(bytes: u64) -> f64 {
    bytes as f64 / f64::from(1 << 30)
}

/// Text on the quantity of a block that is below its limit.
fn too_flat(ratio: f64, dihedral: f64, [least_ratio, least_dihedral]: [f64; 2]) -> String {
    if ratio < least_ratio {
        format!("radius ratio {} is below {}", number(ratio), number(least_ratio))
    } else if dihedral < least_dihedral {
        format!("dihedral angle {dihedral:.1}° is below {}°", number(least_dihedral))
    } else {
        "its validity check failed".into()
    }
}

/// Failed attempt at a connector.
#[derive(Clone, Debug, PartialEq)]
pub struct ConnectorAttempt {
    /// Division of the tube.
    pub division: Division,
    /// Reason of the failure.
    pub failure: ConnectorFailure,
}

/// Reasons for a failed attempt at a connector.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConnectorFailure {
    /// The surface could not be created.
    #[error(transparent)]
    Surface(ConnectorFault),
    /// The surface could not be filled.
    #[error(transparent)]
    Tetrahedra(TetError),
}

/// Face assigned to an end that does not close the block, which is a bug.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("face {face:?} is not on the boundary of the block, or belongs to two of its ends")]
pub struct NotOnBoundary {
    /// Vertices of the face in the block.
    pub face: [u32; 3],
}

impl BlockError {
    /// True if the thinnest vessel requires more grid cells than allowed.
    pub fn is_too_fine(&self) -> bool {
        matches!(self, Self::Surface { source: SurfaceError::TooLarge { .. }, .. })
    }

    /// True if the caller asked for a stop.
    pub fn is_cancelled(&self) -> bool {
        matches!(self, Self::Stopped { source: Stop::Cancelled, .. })
    }

    /// True if the block exceeds its budget.
    pub fn is_over_budget(&self) -> bool {
        matches!(self, Self::Stopped { source: Stop::OverBudget(_), .. })
    }

    /// Failure of a cluster's wall.
    pub(super) fn of_wall(cluster: ClusterId, source: SurfaceError) -> Self {
        match source {
            SurfaceError::Stopped(source) => Self::Stopped { cluster, source },
            source => Self::Surface { cluster, source },
        }
    }

    /// Failure of a cluster's tetrahedra.
    pub(super) fn of_filling(cluster: ClusterId, source: TetError) -> Self {
        match source {
            TetError::Cancelled => Self::Stopped { cluster, source: Stop::Cancelled },
            TetError::OverBudget { limit } => Self::Stopped { cluster, source: OverBudget { limit }.into() },
            source => Self::Tetrahedra { cluster, source },
        }
    }

    /// Readable name of the failed stage.
    pub fn stage(&self) -> &'static str {
        match self {
            Self::Parameter { .. } | Self::NoWovenJoints => "parameters",
            Self::Surface { .. }
            | Self::Genus { .. }
            | Self::Outside { .. }
            | Self::Fused { .. }
            | Self::NoGap { .. } => "wall",
            Self::Stopped { .. } | Self::Memory { .. } => "budget",
            Self::Cap { .. } => "caps",
            Self::Tetrahedra { .. } => "tetrahedra",
            Self::End { .. } => "ends",
            Self::Faces { .. } | Self::Flat { .. } | Self::Folded { .. } | Self::Unsound { .. } => "check",
            Self::Connector { attempts, .. } => match attempts.last().map(|attempt| &attempt.failure) {
                Some(ConnectorFailure::Tetrahedra(_)) => "tetrahedra",
                Some(ConnectorFailure::Surface(_)) | None => "wall",
            },
        }
    }

    /// Failure of a cluster at a cut; `end` is the index among all its ends.
    pub(crate) fn at_end(cluster: ClusterId, end: u32, cut: &CutEnd, failure: FlattenFailure) -> Self {
        Self::End { cluster, end, cut: cut.cut, at: cut.section.origin.coords.into(), failure }
    }
}

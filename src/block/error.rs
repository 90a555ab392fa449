//! What can go wrong with one block.

use super::connector_surface::{ConnectorFault, Division};
use super::end_surface::CutEnd;
use crate::partition::{ClusterId, CutId};
use crate::surface::{CapError, SurfaceError};
use anastomesh_mesh::check::Line;
use anastomesh_tet::TetError;

/// Why no end surface could be exposed at a cut.
#[non_exhaustive]
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FlattenFailure {
    /// No tetrahedron lies beyond the plane near the vessel's axis.
    #[error("nothing lies beyond the cut plane")]
    NothingBeyond,
    /// The piece beyond the plane is joined to something far from the vessel's axis: a fused neighbour.
    #[error("the piece beyond the cut plane leaves its vessel")]
    LeavesVessel,
    /// Flattening removed tetrahedra down to the depth limit.
    #[error("flattening went too deep")]
    TooDeep,
    /// Handles, pinched vertices or several loops remain.
    #[error("the end surface is not one disc")]
    NotADisc,
    /// The disc at the cut is not the one that the vessel gives.
    #[error("the disc at the cut is not the shared one")]
    NotShared,
    /// The work budget is spent.
    #[error("flattening does not end")]
    Budget,
}

/// Failure of one block. Every variant says which block, and where there is a place to look at.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BlockError {
    /// A parameter makes no sense.
    #[error("block parameter {name} = {value} is out of range")]
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The wall could not be made.
    #[error("cluster {}: {source}", cluster.0)]
    Surface {
        /// The cluster.
        cluster: ClusterId,
        /// Why.
        source: SurfaceError,
    },
    /// The wall has other handles than the skeleton has loops: neighbours fused, or a loop closed over.
    #[error("cluster {}: the wall has {handles} handles, the skeleton {loops} loops", cluster.0)]
    Genus {
        /// The cluster.
        cluster: ClusterId,
        /// Genus of the wall.
        handles: i64,
        /// Independent loops of the cluster's tubes.
        loops: i64,
    },
    /// The wall leaves a vessel's axis out.
    #[error("cluster {}: the axis of a vessel is not within the wall near {at:?}", cluster.0)]
    Outside {
        /// The cluster.
        cluster: ClusterId,
        /// A place of the axis.
        at: [f64; 3],
    },
    /// Vessels that are far from each other along the skeleton have one lumen, whatever the genus says.
    #[error("cluster {}: two vessels fused near {at:?}", cluster.0)]
    Fused {
        /// The cluster.
        cluster: ClusterId,
        /// A place on the axis of one of them.
        at: [f64; 3],
    },
    /// A terminal could not be capped.
    #[error("cluster {}: {source}", cluster.0)]
    Cap {
        /// The cluster.
        cluster: ClusterId,
        /// Which end, and why.
        source: CapError,
    },
    /// A cluster's surface could not be filled.
    #[error("cluster {}: {source}", cluster.0)]
    Tetrahedra {
        /// The cluster.
        cluster: ClusterId,
        /// Why.
        source: TetError,
    },
    /// A cluster has no sound end at a cut.
    #[error("cluster {}, cut {}: {failure} near {at:?}", cluster.0, cut.0)]
    End {
        /// The cluster.
        cluster: ClusterId,
        /// Index of the end in `Cluster::ends`.
        end: u32,
        /// The cut there.
        cut: CutId,
        /// Where the axis meets the cut plane.
        at: [f64; 3],
        /// What failed.
        failure: FlattenFailure,
    },
    /// An end or a cap is not on the boundary of the block: a fault of the program.
    #[error("{block}: {source}")]
    Faces {
        /// `cluster 12` or `connector 7`.
        block: String,
        /// Which face.
        source: NotOnBoundary,
    },
    /// The block came out, but with a tetrahedron so flat that another try is worth its time.
    #[error("{block}: a tetrahedron is all but flat (radius ratio {ratio:.2e}, dihedral angle {dihedral:.1}°)")]
    Flat {
        /// `cluster 12` or `connector 7`.
        block: String,
        /// The smallest radius ratio.
        ratio: f64,
        /// The smallest dihedral angle in degrees.
        dihedral: f64,
    },
    /// The surface of a block that is not filled could not be filled.
    #[error("{block}: its surface is not sound: it does not hold that {}", line.statement())]
    Unsound {
        /// `cluster 12` or `connector 7`.
        block: String,
        /// What does not hold.
        line: Line,
    },
    /// No way of building a connector works.
    #[error("connector of cut {} near {at:?}: {}", cut.0, attempts.last().map_or_else(String::new, |a| a.failure.to_string()))]
    Connector {
        /// The cut.
        cut: CutId,
        /// Middle of the cut's path.
        at: [f64; 3],
        /// What was tried, in order, and why it failed.
        attempts: Vec<ConnectorAttempt>,
    },
}

/// An attempt at a connector that failed.
#[derive(Clone, Debug, PartialEq)]
pub struct ConnectorAttempt {
    /// How the tube was divided.
    pub division: Division,
    /// Why it failed.
    pub failure: ConnectorFailure,
}

/// Why an attempt at a connector failed.
#[non_exhaustive]
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConnectorFailure {
    /// The surface could not be made.
    #[error(transparent)]
    Surface(ConnectorFault),
    /// The surface could not be filled.
    #[error(transparent)]
    Tetrahedra(TetError),
}

/// A face that was said to close a block and does not: a fault of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("face {face:?} does not lie on the block's boundary, or belongs to two of its ends")]
pub struct NotOnBoundary {
    /// Its vertices in the block.
    pub face: [u32; 3],
}

impl BlockError {
    /// Whether the thinnest vessel asks for a grid of more cells than there may be.
    pub fn is_too_fine(&self) -> bool {
        matches!(self, Self::Surface { source: SurfaceError::TooLarge { .. }, .. })
    }

    /// What was being done, for people.
    pub fn stage(&self) -> &'static str {
        match self {
            Self::Parameter { .. } => "parameters",
            Self::Surface { .. } | Self::Genus { .. } | Self::Outside { .. } | Self::Fused { .. } => "wall",
            Self::Cap { .. } => "caps",
            Self::Tetrahedra { .. } => "tetrahedra",
            Self::End { .. } => "ends",
            Self::Faces { .. } | Self::Flat { .. } | Self::Unsound { .. } => "check",
            Self::Connector { attempts, .. } => match attempts.last().map(|attempt| &attempt.failure) {
                Some(ConnectorFailure::Tetrahedra(_)) => "tetrahedra",
                Some(ConnectorFailure::Surface(_)) | None => "wall",
            },
        }
    }

    /// Of a cluster that fails at a cut; `end` is the index among all its ends.
    pub(crate) fn at_end(cluster: ClusterId, end: u32, cut: &CutEnd, failure: FlattenFailure) -> Self {
        Self::End { cluster, end, cut: cut.cut, at: cut.section.origin.coords.into(), failure }
    }
}

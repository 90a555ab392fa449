//! What can go wrong with one block.

use crate::partition::{ClusterId, CutId};

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
    /// The work budget is spent.
    #[error("flattening does not end")]
    Budget,
}

/// Failure of one block. Every variant says which block, and where in space there is a place to look at.
#[non_exhaustive]
#[derive(Clone, Debug, thiserror::Error)]
pub enum BlockError {
    /// Trimming or flattening failed at one end of a cluster.
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
}

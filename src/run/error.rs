//! Errors of a run.

use super::networks::Networks;
use crate::pipeline::{PlanError, RunError, RunReport, StoreError};
use anastomesh_flow::{CapsError, FlowError, NoTerminal};
use anastomesh_mesh::units::counted;
use anastomesh_network::RefineError;
use anastomesh_skeleton::SkeletonError;
use std::io;

/// Reason why a run has no mesh.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MeshingError {
    /// The network cannot be used.
    #[error(transparent)]
    Skeleton(#[from] SkeletonError),
    /// A named inlet is not a terminal.
    #[error(transparent)]
    Inlet(#[from] NoTerminal),
    /// The flow plan does not fit the network.
    #[error(transparent)]
    Flow(#[from] FlowError),
    /// The network cannot be refined.
    #[error(transparent)]
    Refine(#[from] RefineError),
    /// Blocks failed in every attempt.
    #[error("{} could not be meshed", counted(.report.failed.len(), "block"))]
    Blocks {
        /// Report of the attempt, with the failed blocks.
        report: Box<RunReport>,
        /// Networks of the attempt.
        networks: Box<Networks>,
    },
    /// The mesher stopped for another reason.
    #[error(transparent)]
    Run(#[from] RunError),
}

impl From<PlanError> for MeshingError {
    fn from(error: PlanError) -> Self {
        RunError::from(error).into()
    }
}

impl From<CapsError> for MeshingError {
    fn from(error: CapsError) -> Self {
        match error {
            CapsError::Flow(error) => error.into(),
            CapsError::Mesh(error) => error.into(),
        }
    }
}

impl From<StoreError> for MeshingError {
    fn from(error: StoreError) -> Self {
        RunError::from(error).into()
    }
}

impl From<io::Error> for MeshingError {
    fn from(error: io::Error) -> Self {
        RunError::from(error).into()
    }
}

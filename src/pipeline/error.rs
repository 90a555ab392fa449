//! Errors of meshing runs.

use std::io;

use super::estimate::TooLarge;
use super::plan::PlanError;
use super::report::RunReport;
use super::store::StoreError;
use crate::partition::PartitionError;
use anastomesh_flow::NotATerminal;
use anastomesh_mesh::progress::Cancelled;
use anastomesh_mesh::units::counted;

/// Reasons why a run produces no mesh.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The plan is invalid.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A requested root is not a terminal.
    #[error(transparent)]
    Root(#[from] NotATerminal),
    /// The network could not be partitioned.
    #[error(transparent)]
    Partition(PartitionError),
    /// Memory or disk space is insufficient.
    #[error(transparent)]
    TooLarge(Box<TooLarge>),
    /// Finished blocks cannot be stored or read.
    #[error(transparent)]
    Store(StoreError),
    /// Blocks failed in every attempt; the report lists them.
    #[error("{} could not be meshed", counted(.0.failed.len(), "block"))]
    BlocksFailed(Box<RunReport>),
    /// Caps are not on the boundary: an internal error.
    #[error("{0}; this is an internal error: please report it")]
    Label(String),
    /// The run was cancelled. Finished blocks are in the store.
    #[error("cancelled")]
    Cancelled,
}

impl From<TooLarge> for RunError {
    fn from(error: TooLarge) -> Self {
        Self::TooLarge(Box::new(error))
    }
}

impl From<PartitionError> for RunError {
    fn from(error: PartitionError) -> Self {
        if error == PartitionError::Cancelled { Self::Cancelled } else { Self::Partition(error) }
    }
}

impl From<StoreError> for RunError {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::Read(error) if Cancelled::is_in(&error) => Self::Cancelled,
            error => Self::Store(error),
        }
    }
}

impl From<io::Error> for RunError {
    fn from(error: io::Error) -> Self {
        StoreError::from(error).into()
    }
}

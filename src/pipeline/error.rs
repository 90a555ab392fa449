//! Why a network could not be meshed.

use std::io;

use super::estimate::TooLarge;
use super::plan::PlanError;
use super::report::RunReport;
use super::store::StoreError;
use super::terminals::NotATerminal;
use crate::partition::PartitionError;
use anastomesh_mesh::progress::Cancelled;

/// Why there is no mesh.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// The plan cannot be run.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A root that is none.
    #[error(transparent)]
    Root(#[from] NotATerminal),
    /// The network could not be partitioned.
    #[error(transparent)]
    Partition(#[from] PartitionError),
    /// The machine is too small for it.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// Finished blocks cannot be kept or read.
    #[error(transparent)]
    Store(StoreError),
    /// Blocks failed to the end; the report lists them.
    #[error("{} block(s) could not be meshed", .0.failed.len())]
    BlocksFailed(Box<RunReport>),
    /// Caps are not where they should be: a fault of the program.
    #[error("{0}; this is a fault of the program")]
    Label(String),
    /// It was told to stop. Blocks that were finished are in the store.
    #[error("cancelled")]
    Cancelled,
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

//! Progress reports and cancellation.

use super::error::TetError;
pub use anastomesh_mesh::progress::{Progress, Stage};

/// Observer of a run. Long loops report to it periodically, and end with [`TetError::Cancelled`] on request.
#[derive(Clone, Copy, Default)]
pub struct Watch<'a> {
    who: Option<&'a dyn Progress>,
    is_told: bool,
}

impl<'a> Watch<'a> {
    /// Watch without a receiver; it never stops a run.
    pub const NOBODY: Watch<'static> = Watch { who: None, is_told: false };

    /// Reports everything to `who`, and asks for cancellation.
    pub fn of(who: &'a dyn Progress) -> Self {
        Self { who: Some(who), is_told: true }
    }

    /// Only asks for cancellation, without reports: the run is part of a larger one.
    pub fn asking(who: &'a dyn Progress) -> Self {
        Self { who: Some(who), is_told: false }
    }

    /// Reports, then checks for cancellation.
    ///
    /// # Errors
    /// [`TetError::Cancelled`] if the caller cancels.
    #[inline]
    pub fn report(&self, stage: Stage, done: usize, total: usize) -> Result<(), TetError> {
        if let Some(who) = self.who.filter(|_| self.is_told) {
            who.at(stage, done as u64, total as u64);
        }
        self.ask()
    }

    /// Checks for cancellation.
    ///
    /// # Errors
    /// [`TetError::Cancelled`] if the caller cancels.
    #[inline]
    pub fn ask(&self) -> Result<(), TetError> {
        if self.who.is_some_and(Progress::is_cancelled) { Err(TetError::Cancelled) } else { Ok(()) }
    }
}

impl std::fmt::Debug for Watch<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("Watch").field("who", &self.who.is_some()).field("is_told", &self.is_told).finish()
    }
}

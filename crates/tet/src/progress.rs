//! Progress reports and cancellation.

use super::error::TetError;
use anastomesh_mesh::budget::{Budget, Stop};
pub use anastomesh_mesh::progress::{Progress, Stage};

/// Observer of a run. Long loops report to it periodically. They end with [`TetError::Cancelled`] on request, and with
/// [`TetError::OverBudget`] if they exceed its budget.
#[derive(Clone, Copy, Default)]
pub struct Watch<'a> {
    who: Option<&'a dyn Progress>,
    is_told: bool,
    budget: Option<&'a Budget>,
}

impl<'a> Watch<'a> {
    /// Watch without a receiver; it never stops a run.
    pub const NOBODY: Watch<'static> = Watch { who: None, is_told: false, budget: None };

    /// Reports everything to `who`, and asks for cancellation.
    pub fn of(who: &'a dyn Progress) -> Self {
        Self { who: Some(who), is_told: true, budget: None }
    }

    /// Only asks for cancellation, without reports: the run is part of a larger one.
    pub fn asking(who: &'a dyn Progress) -> Self {
        Self { who: Some(who), is_told: false, budget: None }
    }

    /// Asks for cancellation like this watch, without reports.
    #[must_use]
    pub fn silent(&self) -> Self {
        Self { is_told: false, ..*self }
    }

    /// Limits the work by a budget, in place of the present one.
    #[must_use]
    pub fn within<'b>(&self, budget: &'b Budget) -> Watch<'b>
    where
        'a: 'b,
    {
        Watch { budget: Some(budget), ..*self }
    }

    /// Operations that the budget leaves.
    pub fn left(&self) -> u64 {
        self.budget.map_or(u64::MAX, Budget::left)
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
        if self.is_cancelled() { Err(TetError::Cancelled) } else { Ok(()) }
    }

    /// True if the caller cancels.
    #[inline]
    pub fn is_cancelled(&self) -> bool {
        self.who.is_some_and(Progress::is_cancelled)
    }

    /// Counts operations of about 0.1 µs each, and checks for cancellation. Calls at least every 100 ms keep stop
    /// requests prompt.
    ///
    /// # Errors
    /// [`Stop`] if the caller cancels or the budget is exceeded.
    #[inline]
    pub fn spend(&self, operations: usize) -> Result<(), Stop> {
        if self.is_cancelled() {
            return Err(Stop::Cancelled);
        }
        Ok(self.budget.map_or(Ok(()), |budget| budget.spend(operations as u64))?)
    }
}

/// Counter of small operations that passes them on to a watch, some thousands at a time.
#[derive(Debug)]
pub struct Counter<'a> {
    watch: &'a Watch<'a>,
    counted: usize,
}

/// Operations that a [`Counter`] passes on at a time.
const AT_A_TIME: usize = 50_000;

impl<'a> Counter<'a> {
    /// Counter for a watch.
    pub fn new(watch: &'a Watch) -> Self {
        Self { watch, counted: 0 }
    }

    /// Counts operations.
    ///
    /// # Errors
    /// See [`Watch::spend`].
    #[inline]
    pub fn add(&mut self, operations: usize) -> Result<(), Stop> {
        self.counted += operations;
        if self.counted < AT_A_TIME { Ok(()) } else { self.end() }
    }

    /// Passes on the rest.
    ///
    /// # Errors
    /// See [`Watch::spend`].
    pub fn end(&mut self) -> Result<(), Stop> {
        self.watch.spend(std::mem::take(&mut self.counted))
    }
}

impl std::fmt::Debug for Watch<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("Watch").field("who", &self.who.is_some()).field("is_told", &self.is_told).finish()
    }
}

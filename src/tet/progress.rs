//! Telling a caller how far things are, and being told to stop.

use super::error::TetError;

/// What the tetrahedralizer is at; in this order, where a stage is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Stage {
    /// The input is checked.
    Validate,
    /// The Delaunay tetrahedralization of the points.
    Delaunay,
    /// Missing edges and triangles are recovered.
    Recover,
    /// What lies outside goes.
    Carve,
    /// Points are put where tetrahedra are too large or badly shaped.
    Refine,
    /// Tetrahedra are improved.
    Optimize,
    /// The mesh is proved to be what was asked for.
    Certify,
}

/// How far a stage is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// The stage.
    pub stage: Stage,
    /// Work done in it, in units of its own.
    pub done: u64,
    /// All of its work as far as is known; 0 when it is not known. `done == total` ends a stage.
    pub total: u64,
}

/// What is called with the progress; on the thread that does the work.
pub(super) type OnProgress = dyn Fn(Progress) + Send + Sync;

/// What is asked whether to stop.
pub type Cancel<'a> = dyn Fn() -> bool + Send + Sync + 'a;

/// Who watches a run. Long loops report to it every now and then, and end with [`TetError::Cancelled`] when told so.
#[derive(Clone, Copy, Default)]
pub struct Watch<'a> {
    on_progress: Option<&'a OnProgress>,
    cancel: Option<&'a Cancel<'a>>,
}

impl<'a> Watch<'a> {
    pub const NOBODY: Watch<'static> = Watch { on_progress: None, cancel: None };

    /// Nobody looks on, but this is asked, often, whether to stop.
    pub fn until(cancel: &'a Cancel<'a>) -> Self {
        Self::new(None, Some(cancel))
    }

    pub(super) fn new(on_progress: Option<&'a OnProgress>, cancel: Option<&'a Cancel<'a>>) -> Self {
        Self { on_progress, cancel }
    }

    /// Reports, then asks whether to go on.
    ///
    /// # Errors
    /// [`TetError::Cancelled`] when the caller says so.
    #[inline]
    pub fn report(&self, stage: Stage, done: usize, total: usize) -> Result<(), TetError> {
        if let Some(tell) = self.on_progress {
            tell(Progress { stage, done: done as u64, total: total as u64 });
        }
        self.ask()
    }

    /// Asks whether to go on.
    ///
    /// # Errors
    /// [`TetError::Cancelled`] when the caller says so.
    #[inline]
    pub fn ask(&self) -> Result<(), TetError> {
        if self.cancel.is_some_and(|stop| stop()) { Err(TetError::Cancelled) } else { Ok(()) }
    }
}

impl std::fmt::Debug for Watch<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.debug_struct("Watch")
            .field("on_progress", &self.on_progress.is_some())
            .field("cancel", &self.cancel.is_some())
            .finish()
    }
}

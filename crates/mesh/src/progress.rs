//! Progress reports of long operations, and their cancellation.

use std::io;

/// Stage of a run. A run may skip stages.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Stage {
    /// Reads and repairs the input.
    Read,
    /// Moves the nodes of a network apart (3.1); counted in iterations.
    Move,
    /// Splits nodes of valence above 3 (3.1), searches for overlapping vessels.
    Prepare,
    /// Cuts vessels, forms clusters (3.2.1).
    Partition,
    /// Meshes clusters (3.2.2).
    Clusters,
    /// Meshes connectors between the ends of their clusters (3.2.3).
    Connectors,
    /// Meshes clusters and connectors in one pass.
    Blocks,
    /// Merges blocks into one mesh.
    Merge,
    /// Smooths joints (3.2.4).
    Joints,
    /// Verifies the mesh.
    Check,
    /// Compares the mesh with its network.
    Compare,
    /// Writes the mesh.
    Write,
    /// Writes an HTML report.
    Report,
    /// Checks a surface or a complex.
    Validate,
    /// Remeshes a surface.
    Remesh,
    /// Computes the Delaunay tetrahedralization of its points.
    Delaunay,
    /// Recovers missing edges and triangles.
    Recover,
    /// Removes tetrahedra outside.
    Carve,
    /// Inserts points where tetrahedra are too large or badly shaped.
    Refine,
    /// Improves tetrahedra.
    Optimize,
    /// Certifies the mesh against the input.
    Certify,
    /// Fills tissue in pieces.
    Tissue,
    /// Divides the vessels between the cells of a mesh around them.
    Embed,
}

impl Stage {
    /// Human-readable name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Move => "move",
            Self::Prepare => "prepare",
            Self::Partition => "partition",
            Self::Clusters => "clusters",
            Self::Connectors => "connectors",
            Self::Blocks => "blocks",
            Self::Merge => "merge",
            Self::Joints => "joints",
            Self::Check => "check",
            Self::Compare => "compare",
            Self::Write => "write",
            Self::Report => "report",
            Self::Validate => "validate",
            Self::Remesh => "remesh",
            Self::Delaunay => "delaunay",
            Self::Recover => "recover",
            Self::Carve => "carve",
            Self::Refine => "refine",
            Self::Optimize => "optimize",
            Self::Certify => "certify",
            Self::Tissue => "tissue",
            Self::Embed => "embed",
        }
    }
}

/// Progress listener of long operations: tetrahedralization, moving the nodes of a network, meshing. May be called from
/// several threads. `()` ignores all reports.
///
/// ```
/// use anastomesh_mesh::progress::{Progress, Stage};
/// use std::sync::atomic::{AtomicBool, Ordering};
///
/// /// Prints progress and asks to stop as soon as recovery begins.
/// #[derive(Default)]
/// struct UntilRecovery(AtomicBool);
///
/// impl Progress for UntilRecovery {
///     fn at(&self, stage: Stage, done: u64, total: u64) {
///         println!("{}: {done} of {total}", stage.name());
///         self.0.fetch_or(stage == Stage::Recover, Ordering::Relaxed);
///     }
///
///     fn is_cancelled(&self) -> bool {
///         self.0.load(Ordering::Relaxed)
///     }
/// }
///
/// let listener = UntilRecovery::default();
/// listener.at(Stage::Delaunay, 20, 20);
/// assert!(!listener.is_cancelled());
/// listener.at(Stage::Recover, 0, 7);
/// assert!(listener.is_cancelled());
/// ```
pub trait Progress: Sync {
    /// Reports the progress of a stage in its own units; `total` is 0 if unknown. A stage begins with the first call
    /// that names it and ends when another one is named or `done` is `total`. Threads may report out of order.
    fn at(&self, _stage: Stage, _done: u64, _total: u64) {}

    /// Passes on a message for the user.
    fn note(&self, _message: &str) {}

    /// True to cancel; called often, from all threads. The operation then fails with its error `Cancelled`.
    fn is_cancelled(&self) -> bool {
        false
    }
}

impl Progress for () {}

/// Cancellation of a run, as the cause of an [`io::Error`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

impl Cancelled {
    /// True if cancellation caused an error.
    pub fn is_in(error: &io::Error) -> bool {
        error.get_ref().is_some_and(<dyn std::error::Error + Send + Sync>::is::<Self>)
    }
}

/// Returns an error if the run was cancelled.
///
/// # Errors
/// [`Cancelled`] inside an [`io::Error`], if the caller asked for a stop.
pub fn ask(progress: &dyn Progress) -> io::Result<()> {
    if progress.is_cancelled() { Err(io::Error::other(Cancelled)) } else { Ok(()) }
}

/// Cancels after a given number of queries.
#[doc(hidden)]
#[derive(Debug)]
pub struct StopsAfter {
    times: usize,
    asked: std::sync::atomic::AtomicUsize,
}

impl StopsAfter {
    pub fn new(times: usize) -> Self {
        Self { times, asked: 0.into() }
    }

    /// Number of queries so far.
    pub fn asked(&self) -> usize {
        self.asked.load(std::sync::atomic::Ordering::Relaxed)
    }
}

impl Progress for StopsAfter {
    fn is_cancelled(&self) -> bool {
        self.asked.fetch_add(1, std::sync::atomic::Ordering::Relaxed) >= self.times
    }
}

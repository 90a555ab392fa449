//! Floor 1: how whatever takes long tells how far it is, and is told to stop.

use std::io;

/// What is being done. Not everything comes in every run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Stage {
    /// The nodes of a network are moved apart (3.1); counted in iterations.
    Move,
    /// Nodes of valence above 3 are split (3.1), overlapping vessels are looked for.
    Prepare,
    /// Vessels are cut, clusters formed (3.2.1).
    Partition,
    /// Clusters are meshed (3.2.2).
    Clusters,
    /// Connectors are meshed between the ends of their clusters (3.2.3).
    Connectors,
    /// Clusters and connectors are meshed in one pass.
    Blocks,
    /// Blocks become one mesh.
    Merge,
    /// Joints are smoothed (3.2.4).
    Joints,
    /// The mesh is verified.
    Check,
    /// The mesh is written.
    Write,
    /// A surface or a complex is checked.
    Validate,
    /// The Delaunay tetrahedralization of its points.
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

impl Stage {
    /// Its name for people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Move => "move",
            Self::Prepare => "prepare",
            Self::Partition => "partition",
            Self::Clusters => "clusters",
            Self::Connectors => "connectors",
            Self::Blocks => "blocks",
            Self::Merge => "merge",
            Self::Joints => "joints",
            Self::Check => "check",
            Self::Write => "write",
            Self::Validate => "validate",
            Self::Delaunay => "delaunay",
            Self::Recover => "recover",
            Self::Carve => "carve",
            Self::Refine => "refine",
            Self::Optimize => "optimize",
            Self::Certify => "certify",
        }
    }
}

/// Listens to whatever takes long: tetrahedralizing a surface, moving the nodes of a network, meshing it. May be called
/// from several threads. `()` listens to nothing.
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
    /// So much of a stage is done, in units of its own, of `total` as far as that is known; 0 when it is not. A stage
    /// begins with the first call that names it and is over when another one is named or `done` is `total`. Calls of
    /// several threads may come in another order than that of their numbers.
    fn at(&self, _stage: Stage, _done: u64, _total: u64) {}

    /// Something that a person should read.
    fn note(&self, _message: &str) {}

    /// Asked often, from all threads: whether to stop. What was asked for then fails with its error `Cancelled`.
    fn is_cancelled(&self) -> bool {
        false
    }
}

impl Progress for () {}

/// A run was told to stop, where that is told by an [`io::Error`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

impl Cancelled {
    /// Whether this is why something failed.
    pub fn is_in(error: &io::Error) -> bool {
        error.get_ref().is_some_and(<dyn std::error::Error + Send + Sync>::is::<Self>)
    }
}

/// Fails with [`Cancelled`] when the operation has to stop.
///
/// # Errors
/// [`Cancelled`].
pub fn ask(progress: &dyn Progress) -> io::Result<()> {
    if progress.is_cancelled() { Err(io::Error::other(Cancelled)) } else { Ok(()) }
}

/// Says to stop once it has been asked so many times.
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

    /// How often it has been asked.
    pub fn asked(&self) -> usize {
        self.asked.load(std::sync::atomic::Ordering::Relaxed)
    }
}

impl Progress for StopsAfter {
    fn is_cancelled(&self) -> bool {
        self.asked.fetch_add(1, std::sync::atomic::Ordering::Relaxed) >= self.times
    }
}

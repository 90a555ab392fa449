//! How a run tells of its progress, and is told to stop.

/// The stages of a run, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stage {
    /// Nodes of valence above 3 are split (3.1), overlapping vessels are looked for.
    Prepare,
    /// Vessels are cut, clusters formed (3.2.1).
    Partition,
    /// Clusters are meshed (3.2.2).
    Clusters,
    /// Connectors are woven and meshed (3.2.3).
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
}

impl Stage {
    /// Its name for people.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Prepare => "prepare",
            Stage::Partition => "partition",
            Stage::Clusters => "clusters",
            Stage::Connectors => "connectors",
            Stage::Blocks => "blocks",
            Stage::Merge => "merge",
            Stage::Joints => "joints",
            Stage::Check => "check",
            Stage::Write => "write",
        }
    }
}

/// Listens to a run. Called from several threads.
///
/// ```
/// use anastomesh::network::{Observer, Stage};
///
/// struct Stages;
///
/// impl Observer for Stages {
///     fn begin(&self, stage: Stage, _: u64) {
///         println!("{}", stage.name());
///     }
/// }
/// ```
pub trait Observer: Sync {
    /// A stage begins; `total` is the sum of what `advance` will say, 0 when it will say nothing.
    fn begin(&self, _stage: Stage, _total: u64) {}
    /// So much more of the current stage is done.
    fn advance(&self, _amount: u64) {}
    /// A stage is over.
    fn end(&self, _stage: Stage) {}
    /// Something that a person should read.
    fn note(&self, _message: &str) {}
    /// Asked often, from all threads: whether to stop. What was done so far stays in the store.
    fn is_cancelled(&self) -> bool {
        false
    }
}

/// Listens to nothing.
impl Observer for () {}

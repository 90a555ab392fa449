//! Block ends and joints as in the paper (sections 3.2.2 to 3.2.4), for `--joint woven`. Clusters are trimmed at cut
//! planes and flattened (`cluster`: `trim`, `flatten`, `relax`). Connectors run between these ends. The merged mesh is
//! collected in memory (`assembly`), its joints are smoothed (`joints`), and its boundary is labelled (`label`).
//!
//! Only the pipeline uses this module, and only if a plan requests it; joints between discs do not need it.

mod assembly;
mod cluster;
mod flatten;
mod joints;
mod label;
mod region;
mod relax;
mod trim;

pub use assembly::Assembly;
pub use cluster::mesh_trimmed;
pub use joints::JointReport;

#[cfg(test)]
mod fixtures;
#[cfg(test)]
mod joint_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod trim_tests;

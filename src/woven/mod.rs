//! Floor 5: how the paper ends blocks and joins them (3.2.2 to 3.2.4), for `--joint woven`. Tetrahedra beyond a cut plane are
//! taken off a cluster and what that exposes is made flat (`cluster`: `trim`, `flatten`, `relax`); connectors run between the
//! ends that their clusters have; the whole is collected in memory (`assembly`), its joints are smoothed (`joints`) and its
//! boundary is labelled anew (`label`).
//!
//! Only the pipeline imports from this room, and only where a plan asks for it: joints between discs do not come here.

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
mod joint_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod trim_tests;

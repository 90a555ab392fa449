//! A run in memory.

use super::error::RunError;
use super::plan::MeshPlan;
use super::run::{Meshed, mesh_timed};
#[cfg(feature = "woven")]
use super::smoothed::mesh_smoothed;
use super::store::Store;
use super::timing::Clock;
use anastomesh_mesh::progress::{Progress, Stage};
use anastomesh_mesh::source::gather;
use anastomesh_skeleton::Skeleton;
use std::sync::Arc;

/// Meshes a cleaned network in memory. Uses the current rayon pool; the result does not depend on its size.
///
/// ```
/// use anastomesh::io::{NetworkOptions, read_network};
/// use anastomesh::meshing::{MeshPlan, mesh_network};
/// use anastomesh::network::clean;
///
/// let file = read_network("fixtures/tree_30.swc".as_ref(), &NetworkOptions::default())?;
/// let (network, _) = clean(&file.skeleton)?;
/// let made = mesh_network(&network, &MeshPlan::default(), &())?;
/// assert!(made.check.is_valid(), "{}", made.check);
/// assert_eq!(made.mesh.patches[0].name, "wall");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// See [`RunError`]. With `plan.keep_going`, blocks that fail are left out and listed in the report instead.
pub fn mesh_network(network: &Skeleton, plan: &MeshPlan, progress: &dyn Progress) -> Result<Meshed, RunError> {
    mesh_in_memory(&Arc::new(network.clone()), plan, progress)
}

/// Meshes a shared network in memory.
pub(crate) fn mesh_in_memory(
    network: &Arc<Skeleton>,
    plan: &MeshPlan,
    progress: &dyn Progress,
) -> Result<Meshed, RunError> {
    let (store, clock) = (Store::in_memory(), &mut Clock::default());
    #[cfg(feature = "woven")]
    if plan.smooths_joints() {
        return mesh_smoothed(&store, network, plan, progress, clock);
    }
    let Meshed { mesh: whole, expectation, check, mut report, network } =
        mesh_timed(&store, network, plan, &|_| Ok(()), progress, clock)?;
    let mesh = clock.time(progress, Stage::Merge, 0, || gather(&whole))?;
    report.stages = clock.stages();
    Ok(Meshed { mesh, expectation, check, report, network })
}

//! A run in memory whose joints are smoothed after merging, for woven joints.

use super::error::RunError;
use super::plan::MeshPlan;
use super::report::MeshSize;
use super::routes::Uncut;
use super::run::{Job, Meshed};
use super::store::Store;
use super::timing::Clock;
use crate::woven::Assembly;
use anastomesh_mesh::WALL;
use anastomesh_mesh::check::check_volume_with;
use anastomesh_mesh::progress::{Progress, Stage, ask};
use anastomesh_mesh::source::{MeshSource, SourceCounts};
use anastomesh_skeleton::Skeleton;
use std::io;
use std::sync::Arc;

/// The mesh in memory, its joints smoothed.
pub(super) fn mesh_smoothed(
    store: &Store,
    network: &Arc<Skeleton>,
    plan: &MeshPlan,
    progress: &dyn Progress,
    clock: &mut Clock,
) -> Result<Meshed, RunError> {
    let job = Job::of(network, plan, store, progress, clock)?;
    let network = Arc::clone(&job.skeleton);
    let mut blocks = job.run(clock).build(&Uncut::default(), None, &|_| Ok(()))?;
    let whole = job.numbered(&mut blocks, clock)?;
    let (mut report, expectation) = job.described(blocks)?;
    ask(progress)?;
    let mut assembly = clock.time(progress, Stage::Merge, 0, || Assembly::new(&whole, whole.joint_vertices()?))?;
    report.joints = Some(clock.time(progress, Stage::Joints, 0, || assembly.smooth(progress)));
    ask(progress)?;
    let labelled = clock.time(progress, Stage::Merge, 0, || assembly.label());
    let (mesh, neighbors) = labelled.map_err(|error| RunError::Label(error.to_string()))?;
    ask(progress)?;
    let check = || check_volume_with(&mesh, neighbors, Some(&expectation));
    let check = clock.time(progress, Stage::Check, 0, check);
    report.mesh = mesh_size(&mesh)?;
    report.stages = clock.stages();
    Ok(Meshed { mesh, expectation, check, report, network })
}

/// Counts a mesh, in one pass over its boundary.
fn mesh_size(mesh: &dyn MeshSource) -> io::Result<MeshSize> {
    let SourceCounts { points, tets, boundary } = mesh.counts();
    let mut wall_triangles = 0;
    mesh.each_faces(|piece| {
        wall_triangles += piece.patches.iter().filter(|&&patch| patch == WALL).count();
        Ok(())
    })?;
    Ok(MeshSize { tets, points, wall_triangles, cap_triangles: boundary - wall_triangles })
}

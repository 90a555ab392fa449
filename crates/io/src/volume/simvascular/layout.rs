//! File names of the folder.

pub(super) const MESH: &str = "mesh-complete.mesh.vtu";
pub(super) const EXTERIOR: &str = "mesh-complete.exterior.vtp";
pub(super) const WALLS: &str = "walls_combined.vtp";
pub(super) const SOLVER: &str = "solver.xml";

/// File of a patch.
pub(super) fn surface_path(patch: &str) -> String {
    format!("mesh-surfaces/{patch}.vtp")
}

pub(super) fn is_ours(name: &str) -> bool {
    let surface = |name: &str| name.strip_prefix("mesh-surfaces/").and_then(|own| own.strip_suffix(".vtp")).is_some();
    [MESH, EXTERIOR, WALLS, SOLVER].contains(&name) || surface(name)
}

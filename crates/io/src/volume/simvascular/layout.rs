//! File names of the folder.

pub(super) const MESH: &str = "mesh-complete.mesh.vtu";
pub(super) const EXTERIOR: &str = "mesh-complete.exterior.vtp";
pub(super) const WALLS: &str = "walls_combined.vtp";
pub(super) const SOLVER: &str = "solver.xml";

/// File of a patch.
pub(super) fn surface_path(patch: &str) -> String {
    format!("mesh-surfaces/{patch}.vtp")
}

/// File of flow rates into an inlet.
pub(super) fn rates_path(patch: &str) -> String {
    format!("{patch}.flow")
}

/// File of velocities at the points of an inlet.
pub(super) fn velocities_path(patch: &str) -> String {
    format!("{patch}.velocity")
}

pub(super) fn is_ours(name: &str) -> bool {
    let inflow = |name: &str| {
        let patch = name.strip_suffix(".flow").or_else(|| name.strip_suffix(".velocity"));
        patch.is_some_and(|patch| !patch.contains('/'))
    };
    let surface = |name: &str| name.strip_prefix("mesh-surfaces/").and_then(|own| own.strip_suffix(".vtp")).is_some();
    let of_mesh = |name: &str| [MESH, EXTERIOR, WALLS].contains(&name) || surface(name);
    // A region has a folder of its own.
    let of_region = name.split_once('/').is_some_and(|(_, rest)| of_mesh(rest));
    name == SOLVER || of_mesh(name) || of_region || inflow(name)
}

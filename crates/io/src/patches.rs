//! Patches that a file gives a number but no name.

use anastomesh_mesh::{Patch, WALL};

/// What a patch with this number is called in the meshes of networks.
pub(super) fn usual_name(id: i32) -> String {
    match id {
        WALL => "wall".into(),
        2 => "inlet".into(),
        3.. => format!("outlet_{}", id - 3),
        _ => format!("patch_{id}"),
    }
}

/// The patches of boundary faces, given the number of each, under their usual names.
pub(super) fn usual_patches(of_faces: &[i32]) -> Vec<Patch> {
    distinct(of_faces.to_vec()).into_iter().map(|id| Patch { id, name: usual_name(id), cap: None }).collect()
}

/// Numbers, ascending, each once.
pub(super) fn distinct(mut ids: Vec<i32>) -> Vec<i32> {
    ids.sort_unstable();
    ids.dedup();
    ids
}

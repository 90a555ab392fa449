//! Default names of patches that have only a number in their file.

use anastomesh_mesh::{Patch, WALL};

/// Default patch name of a number, as in meshes of networks.
pub(super) fn usual_name(id: i32) -> String {
    match id {
        WALL => "wall".into(),
        2 => "inlet".into(),
        3.. => format!("outlet_{}", id - 3),
        _ => format!("patch_{id}"),
    }
}

/// Patches with default names for the patch numbers of boundary faces.
pub(super) fn usual_patches(of_faces: &[i32]) -> Vec<Patch> {
    distinct(of_faces.to_vec()).into_iter().map(|id| Patch { id, name: usual_name(id), cap: None }).collect()
}

/// Distinct numbers in ascending order.
pub(super) fn distinct(mut ids: Vec<i32>) -> Vec<i32> {
    ids.sort_unstable();
    ids.dedup();
    ids
}
